#!/usr/bin/env python3
"""How much crowded cells compress the fluid: the largest deviation of its density, over what stress and viscosity make of it.

usage: perf/compression.py PROGRAM [--strain 4]     PROGRAM is build/release/app/corpuscle; needs h5py and numpy; prints a table for docs/stability.md; about four minutes

The pressure of a fluid that is compressed by a part d of its density is d c_s^2 = d/3. p* is that pressure at the node where d is largest, in units of eta_0 gamma_dot. It is read from
checkpoints every quarter of a strain unit, with tau = 1, where d is small; shown are the median and the largest over the run, and what
`crowding_pressure` (physics/stability_limits.cpp) allows for.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from run_scene import run_scene

SCENE = """
[box]
size = [5, 5, 6]
[flow]
reynolds_number_max = 0.1
[[cells]]
[accuracy]
radius = 4
relaxation_time = 1.0
[run]
strain = 0.5
[output]
series_every = 0.05
snapshot_every = 0
"""
FRACTIONS = {  # by points and Ca
    (4, 0.3): (0.2, 0.45, 0.7, 0.88),
    (4, 0.08): (0.05, 0.2, 0.45, 0.6, 0.7, 0.8, 0.88),
    (4, 0.008): (0.1, 0.2, 0.45, 0.6, 0.7, 0.8, 0.88),
    (4, 0.0008): (0.2, 0.45, 0.7, 0.88),
    (2, 0.08): (0.7, 0.8, 0.88),
    (2, 0.008): (0.7, 0.8, 0.88),
}


def pressure(run):
    """p* of the last checkpoint."""
    with h5py.File(run / "run.h5") as file:
        lattice = dict(file["lattice"].attrs)
    latest = max(run.glob("checkpoint-?.h5"), key=lambda path: path.stat().st_mtime)
    with h5py.File(latest) as file:
        density = sum(file["fluid"][name][()].astype(float) for name in file["fluid"])
    return np.abs(density - density.mean()).max() / 3 / (lattice["viscosity"] * lattice["shear_rate"]), lattice


def bound(program, run, lattice):
    """What the program allows p* to be in this scene."""
    plan = json.loads(subprocess.run([program, "plan", str(run / "scene.toml"), "--threads", "1", "--json"], capture_output=True, text=True, check=True).stdout)
    density = next(margin["value"] for margin in plan["stability"] if margin["name"] == "density of the fluid between cells")
    return density / 3 / (lattice["viscosity"] * lattice["shear_rate"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--strain", type=float, default=4)
    arguments = parser.parse_args()
    print("| φ_eff | points | Ca | p*, median | largest | limit |\n|---|---|---|---|---|---|")
    for phi, kernel, ca in [(phi, *case) for case, fractions in FRACTIONS.items() for phi in fractions]:
        with tempfile.TemporaryDirectory() as folder:
            settings = {"cells.0.effective_volume_fraction": phi, "accuracy.delta_kernel": kernel, "flow.capillary_number": ca}
            run = pathlib.Path(folder) / "run"
            first = run_scene(arguments.program, folder, SCENE, settings)
            if first.returncode != 0:
                print(f"| {phi:g} | {kernel} | {ca:g} | {first.stderr.strip().splitlines()[-1][:100]} | |", flush=True)
                continue
            found, strain = [], 0.5
            while strain < arguments.strain:
                strain += 0.25
                again = subprocess.run([arguments.program, "resume", str(run), "--until", f"strain={strain}", "--threads", "1"], capture_output=True, text=True)
                if again.returncode != 0:
                    print(again.stderr, file=sys.stderr)
                    break
                value, lattice = pressure(run)
                found.append(value)
            print(f"| {lattice['phi_effective']:.3f} | {kernel} | {ca:g} | {np.median(found):.0f} | {max(found):.0f} | {bound(arguments.program, run, lattice):.0f} |", flush=True)


if __name__ == "__main__":
    main()
