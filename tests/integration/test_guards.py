"""A run that blows up ends with exit code 3, a message that says where and what to change, the state for inspection, and all that was computed before."""
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SCENE = """
[box]
size = [4, 4, 4]
[flow]
capillary_number = 0.05
[[cells]]
count = 6
[accuracy]
radius = 4
[run]
steps = 400
[output]
series_every = 0.01
snapshot_every = 0.02
"""


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(SCENE)
        (folder / "fluid.toml").write_text("[box]\nsize = [2, 2, 4]\n[accuracy]\nradius = 4\n[run]\nsteps = 50\n")

        def broken(output, *settings, scene="scene.toml"):
            options = [part for setting in settings for part in ("--set", setting)]
            done = subprocess.run([program, "run", folder / scene, "--output", folder / output, *options], capture_output=True, text=True)
            assert done.returncode == 3, (output, done.returncode, done.stderr)
            lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
            assert len(lines) == 1 and lines[0].startswith("error: The guard on "), done.stderr
            summary = json.loads((folder / output / "summary.json").read_text())
            assert summary["stopped_by"] == "guard", summary["stopped_by"]
            print(lines[0])
            return lines[0], summary

        # Ten times beyond what is stable and more.
        message, summary = broken("stiff", "flow.capillary_number=1e-4", "accuracy.shear_modulus=10", "accuracy.allow_unstable=true", "flow.reynolds_number_max=10")
        for part in ("before step ", "(strain ", "cell ", "(red_cell) ", " cell radii", "accuracy.", "broken.vtkhdf", "is kept in"):
            assert part in message, (part, message)
        assert summary["steps"] < 400
        with h5py.File(folder / "stiff/broken.vtkhdf") as file:
            assert file["VTKHDF/Steps"].attrs["NSteps"] == 1
            cells = np.unique(file["VTKHDF/PointData/cell_id"])
            assert len(cells) == 6, "all cells are there"
            assert file["VTKHDF/Points"].shape == file["VTKHDF/PointData/velocity"].shape and len(file["VTKHDF/Points"]) % 6 == 0
        with h5py.File(folder / "stiff/run.h5") as file:  # what was measured before is kept, and holds no garbage
            assert np.all(np.isfinite(file["series/relative_viscosity"][:])) and np.all(np.isfinite(file["cells/centre"][:]))

        # A limit below what the flow does: the walls move faster than this.
        message, _ = broken("speed", "guards.speed=1e-4", "output.fluid=true")
        assert "(guards.speed)" in message and "broken.vtkhdf and broken_fluid.vtkhdf" in message, message
        with h5py.File(folder / "speed/broken_fluid.vtkhdf") as file:
            assert np.abs(file["VTKHDF/PointData/velocity"][:]).max() > 1e-4

        message, _ = broken("fluid", "guards.speed=1e-4", scene="fluid.toml")
        assert "The guard on the fluid" in message and "broken_fluid.vtkhdf" in message, message
        assert not (folder / "fluid/broken.vtkhdf").exists()

        # The next run into the directory leaves nothing of it.
        subprocess.run([program, "run", folder / "scene.toml", "--output", folder / "speed", "--overwrite", "--set", "run.steps=10"], check=True, capture_output=True)
        assert not list((folder / "speed").glob("broken*"))


if __name__ == "__main__":
    main()
