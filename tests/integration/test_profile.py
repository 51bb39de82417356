"""`run --profile`: a table and entries of summary.json that add up to the time of the run; nothing of it without the option; the same results with and without."""
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SCENE = """
[box]
size = [5, 5, 6]
[flow]
capillary_number = 0.05
[[cells]]
count = 10
[accuracy]
radius = 4
[run]
strain = 0.1
[output]
series_every = 0.02
snapshot_every = 0.05
"""


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(SCENE)

        def run(output, *options):
            done = subprocess.run([program, "run", folder / "scene.toml", "--output", folder / output, *options], check=True, capture_output=True, text=True)
            return done.stdout, json.loads((folder / output / "summary.json").read_text())

        table, with_profile = run("with", "--profile")
        log, without = run("without")
        assert "profile" not in without and "ms a call" not in log
        parts = {part["operator"]: part for part in with_profile["profile"]}
        steps = with_profile["steps"]
        with h5py.File(folder / "with/run.h5") as a, h5py.File(folder / "without/run.h5") as b:
            samples = len(a["series/step"])
            assert np.array_equal(a["cells/centre"], b["cells/centre"]), "measuring changes the results"
        # One more step than the run has measures the final state.
        for operator, calls in {"membrane_forces, bending, area, volume": steps + 1, "collide_stream": steps + 1, "interpolate": steps + 1, "contact_forces": steps + 1,
                                "average_over_cells": samples, "sample_shape": samples}.items():
            assert parts[operator]["calls"] == calls, (operator, parts[operator], calls)
        with h5py.File(folder / "with/cells.vtkhdf") as file:
            assert parts["write_snapshot"]["calls"] == file["VTKHDF/Steps"].attrs["NSteps"]
        assert all(part["seconds"] >= 0 for part in parts.values())
        # The profile also spans the last write of the series, which wall_seconds leaves out; both clocks are read within the same few milliseconds.
        total = sum(part["seconds"] for part in parts.values())
        assert total >= with_profile["wall_seconds"] > 0, (total, with_profile["wall_seconds"])
        for operator in parts:
            assert any(line.startswith(operator) for line in table.splitlines()), operator
    print(f"{len(parts)} operators")


if __name__ == "__main__":
    main()
