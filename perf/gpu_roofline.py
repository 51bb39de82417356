#!/usr/bin/env python3
"""An ESTIMATE of what the code should reach on GPUs: bytes, operations and atomics of the kernels, divided by what the devices can do. Nothing is measured.

usage: perf/gpu_roofline.py        prints Markdown tables

Bytes and atomics follow from kernels/; operations of collision and membranes are counted in report/performance_counts.py, the others are rounded estimates. Whoever changes a kernel
changes its line here or there.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
import performance_counts as counts  # noqa: E402

# Nominal figures of the vendors. Bandwidth (GB/s): NVIDIA A100 80GB and H100 SXM data sheets; AMD MI250X data sheet and CDNA2 white paper, half of it for one
# GCD. Peaks without matrix units (Tflop/s). Atomics (1e9 additions to scattered addresses a second): one a clock for each slice of L2, 80 at 1.41 GHz, 96 at 1.7 GHz
# and 32 at 1.7 GHz. That is an assumption, as vendors do not give it, and the least certain number here. Doubles are taken at half the rate. Additions to shared memory:
# a loop of compare and swap, taken as 8 clocks for 32 lanes of each of 108, 132 and 110 multiprocessors; an assumption too.
DEVICES = {
    #                      GB/s   FP32   FP64   atomics, shared (1e9/s)
    "A100 80GB SXM": dict(bandwidth=2039, fp32=19.5, fp64=9.7, atomics=113, shared=610),
    "H100 SXM": dict(bandwidth=3350, fp32=67.0, fp64=34.0, atomics=163, shared=900),
    "MI250X, one GCD": dict(bandwidth=1638, fp32=23.9, fp64=23.9, atomics=54, shared=750),
}
BANDWIDTH_REACHED = 0.8  # of the data sheet: what lattice Boltzmann codes get on these devices
FLOPS_REACHED = 0.3      # of the peak: few fused multiply-adds, divisions and roots
LAUNCH = 4e-6            # s from one kernel to the next on a stream that is kept full
WAIT = 15e-6             # s that a wait of the host leaves the device idle: with contacts one a step

NODES, VERTICES = 11.7e6, 7700 * 812  # the largest box of Gross, Krueger and Varnik, EPL 108, 68006 (2014)
LAUNCHES = 19  # a step with walls and contacts on a device (perf/bench_kernels without the sort)


def fluid(real, forced):
    """One node: populations read and written in place; with cells the force read and cleared, the velocity written."""
    flops, moved = counts.collide(real, forced)
    return dict(bytes=moved, flops=flops, double=real == 8)


def spread(points, real):
    """One vertex: position and force (doubles); 3 atomic additions on each of points^3 nodes. Nodes near a vertex are shared with its neighbours, about one vertex to a
    square of nodes: the memory sees each touched node once, `points` of them a vertex (read and written); the rest stays in L2."""
    return dict(bytes=2 * 24 + points * 4 * real * 2, flops=6 * points**3 + 20 * points, atomics=3 * points**3, double=real == 8)


def interpolate(points, real):
    return dict(bytes=2 * 24 + points * 4 * real, flops=6 * points**3 + 20 * points, double=real == 8)


def membrane(real, bending):
    """One vertex: position read, force written; tables are shared by all cells and stay in L2. Two triangles with 9 additions to shared memory and, with bending, three
    edges with 12."""
    flops, moved = counts.membrane(bending, True)
    return dict(bytes=moved, flops=flops, shared=18 + (36 if bending else 0), double=real == 8)


def contact(neighbours=4):
    """One vertex: lists, its own position and those of its neighbours (mostly in L2), force read and written; the check of the lists reads positions twice."""
    return dict(bytes=3 * 24 + 4 + 4 * neighbours + 2 * 24, flops=30 * neighbours, double=True)


def advance():
    """One vertex, averaged: position and two velocities of the past read and written, the velocity read."""
    return dict(bytes=7 * 24, flops=18, double=True)


def seconds(count, cost, device):
    """The slowest of memory, arithmetic and additions to global or shared memory; and which one."""
    times = {
        "bandwidth": count * cost["bytes"] / (BANDWIDTH_REACHED * device["bandwidth"] * 1e9),
        "arithmetic": count * cost["flops"] / (FLOPS_REACHED * device["fp64" if cost["double"] else "fp32"] * 1e12),
        "atomics": count * cost.get("atomics", 0) * (2 if cost["double"] else 1) / (device["atomics"] * 1e9),
        "shared": count * cost.get("shared", 0) * (2 if cost["double"] else 1) / (device["shared"] * 1e9),
    }
    limit = max(times, key=times.get)
    return times[limit], limit


def step(points, real, membrane_real):
    halo_nodes = 6 * (NODES ** (1 / 3)) ** 2 * (2 if points == 4 else 1)
    return {
        "fluid": (NODES, fluid(real, True)),
        "halo": (halo_nodes, dict(bytes=2 * (2 * 4 * real + 5 * real), flops=10, double=real == 8)),
        "spread": (VERTICES, spread(points, real)),
        "interpolate": (VERTICES, interpolate(points, real)),
        "membrane": (VERTICES, membrane(membrane_real, True)),
        "contact": (VERTICES, contact()),
        "advance": (VERTICES, advance()),
    }


def main():
    print("Fluid alone (MLUPS), estimated:\n")
    print("| device | float | double | float, force field | double, force field |")
    print("|---|---|---|---|---|")
    for name, device in DEVICES.items():
        rates = [f"{1e-6 / seconds(1, fluid(real, forced), device)[0]:.0f}" for forced in (False, True) for real in (4, 8)]
        print(f"| {name} | {' | '.join(rates)} |")

    print(f"\nA coupled step, {NODES / 1e6:.1f} million nodes, {VERTICES / 1e6:.2f} million vertices (ms), estimated; in brackets what limits (b bandwidth, a arithmetic, t atomics, s additions to shared memory):\n")
    parts = list(step(4, 4, 4))
    print(f"| device | fluid, membrane, kernel | {' | '.join(parts)} | launches, wait | step |")
    print("|---|---|" + "---|" * (len(parts) + 2))
    letters = {"bandwidth": "b", "arithmetic": "a", "atomics": "t", "shared": "s"}
    for name, device in DEVICES.items():
        for points, real, membrane_real in ((4, 4, 4), (4, 4, 8), (4, 8, 8), (2, 4, 4)):
            times = [seconds(count, cost, device) for count, cost in step(points, real, membrane_real).values()]
            total = sum(t for t, _ in times) + LAUNCHES * LAUNCH + WAIT
            label = {4: "float", 8: "double"}
            cells = [f"{1e3 * t:.2f} ({letters[limit]})" for t, limit in times]
            print(f"| {name} | {label[real]}, {label[membrane_real]}, {points}-point | {' | '.join(cells)} | {1e3 * (LAUNCHES * LAUNCH + WAIT):.2f} | {1e3 * total:.1f} |")


if __name__ == "__main__":
    main()
