#!/usr/bin/env python3
"""What accuracy.coupling_every costs and saves: the same scenes with membranes and fluid coupled at every step and at every k-th, and with a higher Reynolds number instead.

usage: perf/coupling_interval.py PROGRAM [TABLE ...]     PROGRAM is bin/corpuscle; prints tables for docs/performance.md; about two minutes of computing

Tables: capsule (deformation of one neo-Hookean capsule), cells (viscosity of red cells), stiff (the same with membranes of 24 eta_0, in the last row 48 eta_0, and the chebyshev update).
Time is the processor time of the process in user mode over its steps, on one thread: other processes disturb it less than the time that passes. Packing is not in it: all runs of a
table start from one packing.
"""

import json
import os
import resource
import sys
import tempfile

from run_scene import run_scene

CAPSULE = """
[box]
size = [6, 6, 6]
[flow]
capillary_number_G = 0.15
reynolds_number_max = 1
[[cells]]
shape = "sphere"
count = 1
position = [3, 3, 3]
membrane = { law = "neo_hookean", bending = 0.0 }
[contact]
enabled = false
[accuracy]
radius = 5
delta_kernel = 3
collision = "trt"
relaxation_time = 1.0
mach_max = 0.3
[run]
strain = 4
discard = 0.6
[output]
series_every = 0.02
snapshot_every = 0
"""
CELLS = """
[box]
size = [5, 5, 5]
[flow]
capillary_number = 0.081
reynolds_number_max = 1
[[cells]]
effective_volume_fraction = 0.4
[accuracy]
radius = 5
delta_kernel = 3
collision = "bgk"
counted_shell = "drag"
mach_max = 0.3
[run]
strain = 8
[output]
series_every = 0.05
snapshot_every = 0
"""
STIFF = """
[box]
size = [4, 4, 4]
[flow]
capillary_number = 4.2e-5
[[cells]]
count = 12
[accuracy]
radius = 6
delta_kernel = 3
collision = "bgk"
vertex_update = "chebyshev"
membrane_precision = "single"
shear_modulus = 4
[run]
strain = 0.3
[output]
series_every = 0.005
snapshot_every = 0
"""
RATE = 0.1 / 6 / 25  # Re = 0.1 at r = 5, tau = 1


def run(program, folder, scene, settings):
    """summary.json of a run and the seconds of processor time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    result = run_scene(program, folder, scene, settings)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if result.returncode != 0:
        sys.exit(result.stderr.strip())
    with open(os.path.join(folder, "run", "summary.json")) as file:
        return json.load(file), seconds


def packed(program, folder, scene):
    """The packing that all runs of a table start from."""
    run(program, folder, scene, {"run.steps": 1})
    path = os.path.join(folder, "packing.h5")
    os.replace(os.path.join(folder, "run", "packing.h5"), path)
    return {"run.packing": f'"{path}"'}


def capsule(program, folder):
    print("| coupled every | Re | D | inclination | A/A₀ | largest volume drift | ms a step | s a strain unit |\n|---|---|---|---|---|---|---|---|")
    for interval, re in [(1, 0.1), (2, 0.1), (4, 0.1), (8, 0.1), (1, 0.2), (1, 0.4), (1, 0.8), (4, 0.2)]:
        s, seconds = run(program, folder, CAPSULE, {"accuracy.shear_rate": RATE * re / 0.1, "accuracy.coupling_every": interval})
        print(f"| {interval} | {re:g} | {s['deformation']:.4f} | {s['inclination']:.4f} | {s['area_ratio']:.4f} | {100 * s['volume_drift_max']:.3f} % "
              f"| {1e3 * seconds / s['steps']:.3f} | {seconds / s['strain']:.2f} |", flush=True)


def viscosities(program, folder, scene, cases, conditions):
    packing = packed(program, folder, scene)
    print("| coupled every | Re | relative viscosity | from the walls | largest volume drift | ms a step | s a strain unit |\n|---|---|---|---|---|---|---|")
    for case in cases:
        s, seconds = run(program, folder, scene, {**packing, **conditions(*case)})
        eta, wall = ("{:.3f} ± {:.3f}".format(s[key], s[key + "_error"] or 0) for key in ("relative_viscosity", "wall_relative_viscosity"))
        print(f"| {case[0]} | {s['reynolds_number']:.3g} | {eta} | {wall} | {100 * s['volume_drift_max']:.2f} % "
              f"| {1e3 * seconds / s['steps']:.3f} | {seconds / s['strain']:.2f} |", flush=True)


def cells(program, folder):
    viscosities(program, folder, CELLS, [(1, 0.1), (2, 0.1), (4, 0.1), (8, 0.1), (1, 0.2), (1, 0.4)],
                lambda interval, re: {"accuracy.shear_rate": RATE * re / 0.1, "accuracy.coupling_every": interval})


def stiff(program, folder):
    viscosities(program, folder, STIFF, [(1, 4), (2, 4), (4, 4), (1, 8)],
                lambda interval, modulus: {"accuracy.coupling_every": interval, "accuracy.shear_modulus": modulus, "accuracy.allow_unstable": "true"})


def main():
    tables = {"capsule": capsule, "cells": cells, "stiff": stiff}
    if len(sys.argv) < 2 or not set(sys.argv[2:]) <= set(tables):
        sys.exit(__doc__)
    for name in sys.argv[2:] or tables:
        print(f"\n{name}\n")
        with tempfile.TemporaryDirectory() as folder:
            tables[name](sys.argv[1], folder)


if __name__ == "__main__":
    main()
