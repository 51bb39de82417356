"""A long run of a dense suspension, watched: does the memory grow, does the speed fall, do the cells keep their volume?

Every minute a line: wall time, step, memory, speed, largest drift of a cell's volume and area; at the end the same as a Markdown table and a
verdict. ./dev soak [MINUTES] runs it on all cores. Needs numpy and h5py. Speed is counted in steps a second of processor time, which other work on the
machine disturbs little as long as threads sleep where they wait (OMP_WAIT_POLICY=passive, set here).
"""
import argparse
import os
import pathlib
import signal
import subprocess
import sys
import time

import h5py
import numpy

SCENE = """
[box]
size = [{box}, {box}, {box}]
[flow]
capillary_number = 0.1
[[cells]]
volume_fraction = 0.4
[accuracy]
radius = {radius}
[run]
steps = 1000000000
seed = 1
[output]
series_every = 0.01
snapshot_every = 5
"""


def memory_mb(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    return float("nan")


def processor_seconds(pid):
    """Of all threads of a process, in its own code and in the kernel."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def series(path):
    """Last step, largest volume and area drift since the beginning, strain, when that was written. None before the first flush."""
    try:
        with h5py.File(path, "r") as data:
            steps = data["series/step"][:]
            if len(steps) == 0:
                return None
            return {"step": int(steps[-1]), "samples": len(steps), "strain": float(data["series/strain"][-1]),
                    "volume": data["series/volume_drift_max"][:], "area": data["series/area_drift_max"][:], "written": path.stat().st_mtime}
    except (OSError, KeyError, RuntimeError):
        return None  # in the middle of a flush


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", required=True)
    options.add_argument("--output", required=True, type=pathlib.Path, help="folder for the results and the table; must not exist")
    options.add_argument("--minutes", type=float, default=120)
    options.add_argument("--threads", type=int)
    options.add_argument("--radius", type=float, default=8, help="of a cell, in lattice units")
    options.add_argument("--box", type=float, default=10, help="edge of the box, in cell radii")
    options.add_argument("--every", type=float, default=60, help="seconds between two lines")
    options = options.parse_args()

    options.output.mkdir(parents=True)
    scene = options.output / "soak.toml"
    scene.write_text(SCENE.format(radius=options.radius, box=options.box))
    results = options.output / "results"
    command = [options.program, "run", str(scene), "--output", str(results)]
    if options.threads:
        command += ["--threads", str(options.threads)]
    with open(options.output / "log", "w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env={**os.environ, "OMP_WAIT_POLICY": "passive"})
    begin = None
    rows = []
    try:
        while process.poll() is None:
            time.sleep(min(options.every, 5) if begin is None else options.every)
            state = series(results / "run.h5")
            if state is None:
                continue  # packing, or before the first flush
            if begin is None:
                begin = time.time()
                print("| minute | step | strain | memory MB | steps/s | steps/s of processor | volume drift | area drift |\n|---|---|---|---|---|---|---|---|", flush=True)
            before = rows[-1] if rows else None
            row = {"minute": (time.time() - begin) / 60, "memory": memory_mb(process.pid), "processor": processor_seconds(process.pid), **state}
            row["wall_speed"] = row["speed"] = float("nan")
            if before and state["written"] > before["written"]:
                steps = state["step"] - before["step"]
                row["wall_speed"] = steps / (state["written"] - before["written"])
                row["speed"] = steps / (row["processor"] - before["processor"])
            rows.append(row)
            print("| {minute:.1f} | {step} | {strain:.3f} | {memory:.1f} | {wall_speed:.2f} | {speed:.2f} | {0:.2e} | {1:.2e} |".format(
                row["volume"].max(), row["area"].max(), **row), flush=True)
            if row["minute"] >= options.minutes:
                process.send_signal(signal.SIGTERM)
                break
        code = process.wait(timeout=600)
    finally:
        if process.poll() is None:
            process.kill()
    check = subprocess.run([options.program, "check", str(results)], capture_output=True, text=True)
    sys.exit(verdict(rows, code, check))


def verdict(rows, code, check):
    """Prints what was found; the number of what is wrong."""
    wrong = 0

    def say(good, text):
        nonlocal wrong
        wrong += not good
        print(("ok      " if good else "WRONG   ") + text)

    say(code == 130, f"ended by SIGTERM in order (exit code {code}, 130 expected)")
    say(check.returncode == 0, "corpuscle check: " + check.stdout.strip().replace("\n", "; "))
    if len(rows) < 4:
        print("too short for more")
        return wrong + 1
    # Warm-up: the first quarter. A sample costs a few numbers of 8 bytes, kept for the means of summary.json; snapshots need buffers.
    warm = rows[len(rows) // 4:]
    growth = warm[-1]["memory"] - warm[0]["memory"]
    allowed = 2 + 200e-6 * (warm[-1]["samples"] - warm[0]["samples"])
    say(growth <= allowed, f"memory grew by {growth:.1f} MB after the first quarter, {allowed:.1f} allowed (2 MB and 200 bytes a sample)")
    speeds = numpy.array([row["speed"] for row in warm])
    speeds = speeds[numpy.isfinite(speeds)]
    third = max(1, len(speeds) // 3)
    first, last = numpy.median(speeds[:third]), numpy.median(speeds[-third:])
    say(last >= 0.9 * first, f"speed: {first:.2f} steps a second of processor time in the first third, {last:.2f} in the last, at least 90 % wanted")
    for name, bound in (("volume", 0.03), ("area", 0.3)):
        drift = rows[-1][name]
        half = len(drift) // 2
        earlier, later = drift[:half].max(), drift[half:].max()
        # Cells deform, so the drift fluctuates; what must not be is that it goes on growing after the start of the flow.
        say(later <= bound, f"{name} drift of any cell: at most {earlier:.2e} in the first half, {later:.2e} in the second, {bound:g} allowed")
    return wrong


if __name__ == "__main__":
    main()
