"""A run that blows up ends with exit code 3, a message that says where and what to change, the state for inspection, and all that was computed before.
A start that is broken leaves no checkpoint."""
import json
import pathlib
import shutil
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
relaxation_time = 1.0
delta_kernel = 3
[run]
steps = 400
[output]
series_every = 0.01
snapshot_every = 0.02
"""


def check_broken_start(program, folder, broken):
    """A packing with a cell that is inside out, and one with a cell inside another: the guards speak before a step is done and a checkpoint written."""
    placed = "[[cells]]\ncount = 1\nposition = [1.2, 2, 2]\n[[cells]]\ncount = 1\nposition = [3.7, 2, 2]\n"  # where nothing is packed a start isn't settled, either
    (folder / "placed.toml").write_text(SCENE.replace("[4, 4, 4]", "[5, 4, 4]").replace("[[cells]]\ncount = 6\n", placed))
    healthy = folder / "healthy"
    subprocess.run([program, "run", folder / "placed.toml", "--output", healthy, "--set", "run.steps=5"], check=True, capture_output=True)
    for name, change, guard in (("inside_out", lambda cells: 2 * cells[0].mean(axis=0) - cells[0], "volume"),
                                ("pierced", lambda cells: cells[0] + cells[1].mean(axis=0) - cells[0].mean(axis=0) + [0.7, 0.5, 0.3], "contact")):
        packing = folder / f"{name}.h5"
        shutil.copy(healthy / "packing.h5", packing)
        with h5py.File(packing, "r+") as file:
            cells = file["positions"][:].reshape(2, -1, 3)
            cells[0] = change(cells)
            file["positions"][:] = cells.reshape(-1, 3)
        output = folder / name
        shutil.copytree(healthy, output)  # with the checkpoints of another run
        message, summary = broken(name, f"run.packing={packing}", "--overwrite", scene="placed.toml")
        assert f"The guard on {guard} " in message and "before step 0" in message and "broken.vtkhdf" in message and summary["steps"] == 0, message
        assert not list(output.glob("checkpoint*")), list(output.iterdir())
        refused = subprocess.run([program, "resume", output], capture_output=True, text=True)
        assert refused.returncode == 2 and "holds no checkpoint" in refused.stderr, refused
        report = json.loads(subprocess.run([program, "check", output, "--json"], capture_output=True, text=True).stdout)
        assert [p["problem"] for p in report["problems"]] == ["holds no sample"] and report["resumes_at"] == -1, report


def check_limit_on_resume(program, folder):
    """A limit that the state is beyond already: nothing on disk says that the run has it."""
    before = {path.name: path.read_bytes() for path in (folder / "healthy").iterdir() if path.is_file()}
    stopped = subprocess.run([program, "resume", folder / "healthy", "--until", "steps=9", "--set", "guards.speed=1e-9"], capture_output=True, text=True)
    assert stopped.returncode == 3 and stopped.stderr.count("\n") == 1 and "guards.speed" in stopped.stderr, stopped
    after = {path.name: path.read_bytes() for path in (folder / "healthy").iterdir() if path.is_file()}
    assert {name for name in before if before[name] != after.get(name)} == set(), before.keys()
    subprocess.run([program, "resume", folder / "healthy", "--until", "steps=9"], check=True, capture_output=True)


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(SCENE)
        (folder / "fluid.toml").write_text("[box]\nsize = [2, 2, 4]\n[accuracy]\nradius = 4\n[run]\nsteps = 50\n")

        def broken(output, *settings, scene="scene.toml"):
            options = [part for setting in settings for part in ([setting] if setting.startswith("--") else ["--set", setting])]
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

        check_broken_start(program, folder, broken)
        check_limit_on_resume(program, folder)


if __name__ == "__main__":
    main()
