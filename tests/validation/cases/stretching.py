"""Stretching of a red cell by optical tweezers against experiment: PROGRAM WORK-FOLDER [--forces pN ...] [--radius r ...] [--threads N].

Runs scenes/stretching.toml with each force and writes WORK-FOLDER/stretching.json, a list of rows with the keys case, quantity, ours, reference, source,
error, tolerance, pass, resolution, seconds, drift (over the last fifth). Lengths in um. Exit code 1 when a row fails.

Reference: axial and transverse diameters of Mills, Qie, Dao, Lim, Suresh, Mech. Chem. Biosyst. 1, 169 (2004). Tolerance: the error bars of the experiment,
+-1 um (axial) and +-0.7 um (transverse). Errors of the simulation are smaller: r = 6 and r = 8 differ by 0.3 um at most (axial, 193 pN; 0.05 um transverse), and
over the last fifth of a run diameters change by less than 0.02 um. The model matters more: with area_dilation = 10 in place of 400 the transverse diameter is
up to 0.8 um larger, outside the bars from 47.5 to 193 pN (G_s = 5.5 uN/m); the real membrane keeps its area locally. Moduli are published ones (G_s = 5.3 uN/m,
bending 2e-19 J); nothing is fitted.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

import h5py
import numpy as np

SCENE = pathlib.Path(__file__).resolve().parents[3] / "scenes" / "stretching.toml"
SOURCE = "Mills et al., Mech. Chem. Biosyst. 1, 169 (2004)"
# force in pN, axial and transverse diameter in um
EXPERIMENT = [(16, 9.21, 6.73), (31, 9.99, 6.11), (47.5, 11.39, 5.47), (67.7, 12.31, 4.96), (88, 13.07, 4.78), (109, 13.64, 4.52), (130, 14.10, 4.46),
              (151, 14.54, 4.46), (193, 15.29, 4.27)]
TOLERANCE = {"axial diameter": 1.0, "transverse diameter": 0.7}


def diameters(program, folder, force, radius, threads):
    """Extents in um along and across the force at the end of a run, and their change over its last fifth."""
    command = [str(program.resolve()), "run", str(SCENE), "--threads", str(threads), "--overwrite", "--output", str(folder),
               "--set", f"accuracy.radius={radius:g}", "--set", f"cells.0.stretch.force={force} pN", "--set", "output.snapshot_every=0"]
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OMP_PROC_BIND="false")
    finished = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if finished.returncode:
        sys.exit(f"{' '.join(command)} ended with code {finished.returncode}: {finished.stderr}")
    with h5py.File(folder / "run.h5", "r") as run:
        extent = run["cells/extent"][:, 0] * float(run["lattice"].attrs["unit_length_m"]) * 1e6
    return extent[-1], np.abs(extent[-1] - extent[-1 - len(extent) // 5])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--forces", type=float, nargs="+", default=[force for force, _, _ in EXPERIMENT], help="pN; those of the experiment")
    parser.add_argument("--radius", type=float, nargs="+", default=[6], help="lattice units per cell radius")
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    known = {force: (axial, transverse) for force, axial, transverse in EXPERIMENT}
    rows = []
    for radius in options.radius:
        for force in options.forces:
            if force not in known:
                sys.exit(f"--forces {force:g}: there is no measurement; there are {', '.join(f'{f:g}' for f in known)}")
            start = time.time()
            extent, drift = diameters(options.program, options.folder / f"stretching_{force:g}pN_r{radius:g}", force, radius, options.threads)
            for axis, (quantity, tolerance) in enumerate(TOLERANCE.items()):
                reference = known[force][axis]
                error = extent[axis] - reference
                rows.append({"case": f"red cell stretched by {force:g} pN", "quantity": f"{quantity} (um)", "ours": round(float(extent[axis]), 3),
                             "reference": reference, "source": SOURCE, "error": round(float(error), 3), "tolerance": tolerance, "pass": bool(abs(error) <= tolerance),
                             "resolution": f"r = {radius:g}", "seconds": round(time.time() - start, 1), "drift": round(float(drift[axis]), 4)})
                print(f"{rows[-1]['case']}, {quantity}: {extent[axis]:.2f} um, measured {reference} +- {tolerance} ({'pass' if rows[-1]['pass'] else 'FAIL'}; "
                      f"r = {radius:g}, last fifth {drift[axis]:.3f} um, {rows[-1]['seconds']} s)", flush=True)
            (options.folder / "stretching.json").write_text(json.dumps(rows, indent=1) + "\n")
    return 0 if all(row["pass"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
