#!/usr/bin/env python3
"""Registers, spills, stack, shared memory and occupancy of the hot kernels on an NVIDIA GPU, as the compiler reports them; needs nvcc, no GPU.

usage: perf/gpu_registers.py BUILD_FOLDER [--architecture sm_80] [--vertices 812]

BUILD_FOLDER is one that `./dev build cuda-hopper` or `cuda-ampere` configured, for example build/cuda-hopper. The sources with the hot kernels are compiled once
more with `-Xptxas -v`; nothing in the folder changes. Prints a Markdown table.
"""
import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCES = ["fluid", "coupling", "membrane", "contact", "vertex_motion"]

# Kernel names as the table shows them, in its order: (pattern in the demangled functor, name with groups). Of kernels that share a name (parity of the step, lower and
# upper wall) the one with most registers is shown. Everything else is not hot: start, sampling, copies.
FORCING = {"0": "no force", "1": "uniform force", "2": "force field", "3": "held force", "4": "held force, velocity", "5": "held force, mean velocity"}
KERNELS = [
    (r"CollideStream<(\w+), \w+, (\d), \(corpuscle::Forcing\)(\d)", lambda m: f"collide_stream, {FORCING[m[3]]}"),
    (r"ExchangePopulations<(\w+), (\d)", lambda m: "exchange_populations"),
    (r"BounceBack<(\w+), \w+, (\d), (\w+)", lambda m: "bounce_back"),
    (r"ScatterForce<(\w+)", lambda m: "scatter_force"),
    (r"GatherVelocity<(\w+)", lambda m: "gather_velocity, periodic"),
    (r"ExtendVelocity<(\w+)", lambda m: "gather_velocity, walls"),
    (r"Spread<(\w+), corpuscle::Delta(\d)", lambda m: f"spread, {m[2]}-point"),
    (r"Interpolate<(\w+), corpuscle::Delta(\d)", lambda m: f"interpolate, {m[2]}-point"),
    (r"MembraneBlock<(\w+), corpuscle::(\w+), (\w+)", lambda m: f"membrane_forces, {m[2]}{' + bending' if m[3] == 'true' else ''}"),
    (r"(?<!\w)ContactForce", lambda m: "contact_forces"),
    (r"FindNeighbours", lambda m: "contact lists (rare)"),
    (r"largest_move_squared", lambda m: "contact_moved (reduction)"),
    (r"VertexMotion::advance.*lambda\(int\)#1", lambda m: "advance, euler"),
    (r"VertexMotion::advance.*lambda\(int\)#2", lambda m: "advance, averaged"),
    (r"::smooth_forces\(", lambda m: "smooth_forces (chebyshev)"),
    (r"::chebyshev_stages\(.*lambda\(int\)#2", lambda m: "chebyshev_stage"),
]

# A multiprocessor: registers, threads, blocks, shared memory (KiB). CUDA C++ Programming Guide, "Technical Specifications per Compute Capability".
MULTIPROCESSOR = {"sm_80": (65536, 2048, 32, 164), "sm_90": (65536, 2048, 32, 228)}


def compile_for_figures(folder, architecture, output):
    """Runs ptxas -v on the hot sources; yields (mangled kernel, registers, stack, spill stores, spill loads, static shared bytes)."""
    commands = json.loads((folder / "compile_commands.json").read_text())
    environment = dict(os.environ, PATH=f"/usr/local/cuda/bin:{os.environ['PATH']}", NVCC_WRAPPER_DEFAULT_COMPILER=os.environ.get("CXX", "g++"))
    for name in SOURCES:
        entry = next(e for e in commands if e["file"].endswith(f"/physics/{name}.cpp"))
        arguments = shlex.split(entry["command"])
        arguments[arguments.index("-o") + 1] = str(output / f"{name}.o")
        arguments = [re.sub(r"^-arch=sm_\d+$", f"-arch={architecture}", a) for a in arguments]
        print(f"compiling physics/{name}.cpp", file=sys.stderr)
        log = subprocess.run(arguments + ["-Xptxas", "-v"], cwd=entry["directory"], env=environment, capture_output=True, text=True)
        if log.returncode != 0:
            sys.exit(f"physics/{name}.cpp does not compile:\n{log.stderr}")
        yield from figures(log.stdout + log.stderr)


def figures(log):
    kernel = None
    for line in log.splitlines():
        if found := re.search(r"Compiling entry function '(\w+)'", line):
            kernel = found[1]
        elif found := re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line):
            stack, stores, loads = map(int, found.groups())
        elif (found := re.search(r"Used (\d+) registers", line)) and kernel:
            shared = re.search(r"(\d+) bytes smem", line)
            yield kernel, int(found[1]), stack, stores, loads, int(shared[1]) if shared else 0
            kernel = None


def launch(registers, shared_per_block, architecture):
    """Block size that Kokkos picks for a range (the smallest of at least 128 threads with the most threads on a multiprocessor), and the occupancy."""
    all_registers, all_threads, all_blocks, all_shared = MULTIPROCESSOR[architecture]
    per_warp = -(-registers * 32 // 256) * 256  # registers are given to warps in units of 256
    best = (0, 0)
    for block in range(1024, 0, -32):
        blocks = min(all_registers // per_warp // (block // 32), all_threads // block, all_blocks)
        if shared_per_block:
            blocks = min(blocks, all_shared * 1024 // (shared_per_block + 1024))  # 1 KiB a block is the system's
        threads = blocks * block
        if threads > best[1] or (block >= 128 and threads == best[1]):
            best = (block, threads)
    return best[0], best[1] / all_threads


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--architecture", choices=sorted(MULTIPROCESSOR), help="another one than the folder's")
    parser.add_argument("--vertices", type=int, default=812, help="of a cell: its positions lie in shared memory while its forces are computed")
    arguments = parser.parse_args()
    text = (arguments.folder / "compile_commands.json").read_text()
    architecture = arguments.architecture or re.search(r"-arch=(sm_\d+)", text)[1]

    rows, kernels, spilling = {}, 0, 0
    with tempfile.TemporaryDirectory() as output:
        found = list(compile_for_figures(arguments.folder, architecture, Path(output)))
    demangled = subprocess.run(["c++filt"], input="\n".join(f[0] for f in found), capture_output=True, text=True).stdout.splitlines()
    for (_, *values), name in zip(found, demangled):
        if "cuda_parallel_launch" not in name:
            continue
        for position, (pattern, label) in enumerate(KERNELS):
            if match := re.search(pattern, name):
                precision = match[1] if match.groups() and match[1] in ("float", "double") else "double"
                kernel = rows.setdefault((position, label(match)), {})
                kernel[precision] = max(kernel.get(precision, values), values)
                kernels += 1
                spilling += values[2] + values[3] > 0
                break

    print(f"| {architecture}: kernel (float / double) | registers | spilled bytes, stored + loaded | stack (B) | shared (B) | threads a block | occupancy |")
    print("|---|---|---|---|---|---|---|")
    for (_, label), kernel in sorted(rows.items()):
        columns = []
        for precision in [p for p in ("float", "double") if p in kernel]:
            registers, stack, stores, loads, shared = kernel[precision]
            if label.startswith("membrane_forces"):
                shared += 3 * arguments.vertices * (4 if precision == "float" else 8)
            block, occupancy = launch(registers, shared, architecture)
            columns.append((registers, stores + loads, stack, shared, block, f"{100 * occupancy:.0f} %"))
        print(f"| {label} | " + " | ".join(" / ".join(str(c[i]) for c in columns) for i in range(6)) + " |")
    print(f"\n{kernels} kernels, {spilling} with spills.")
    return 1 if spilling else 0


if __name__ == "__main__":
    sys.exit(main())
