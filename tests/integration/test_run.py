"""The main job from the outside: outputs, overrides, refusal to overwrite, reuse of a packing, Ctrl-C, broken runs, plan."""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

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
strain = 0.4
[output]
series_every = 0.02
snapshot_every = 0.2
"""

SUMMARY_KEYS = """capillary_number reynolds_number phi_geometric phi_nominal phi_effective effective_radius cell_count strain relative_viscosity relative_viscosity_error
wall_relative_viscosity normal_stress_difference_1 normal_stress_difference_2 volume_drift_max area_drift_max steps wall_seconds mlups threads
bytes_peak""".split()


def run(program, *arguments, check=True):
    result = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if check and result.returncode != 0:
        raise AssertionError(f"{arguments}: exit {result.returncode}: {result.stderr}")
    return result


def check_outputs(program, folder, scene):
    log = run(program, "run", scene, "--output", folder / "a", "--threads", "2").stdout
    assert "\x1b" not in log and "\r" not in log, "terminal codes in a pipe"
    assert "relative viscosity" in log
    summary = json.loads((folder / "a/summary.json").read_text())
    missing = [key for key in SUMMARY_KEYS if key not in summary]
    assert not missing, missing
    assert summary["cell_count"] == 10 and summary["stopped_by"] == "end" and summary["threads"] == 2
    assert summary["relative_viscosity"] > 1
    with h5py.File(folder / "a/run.h5") as file:
        steps = file["series/step"][:]
        assert np.all(np.diff(steps)[:-1] == steps[1] - steps[0]) and steps[0] == 0
        assert steps[-1] == summary["steps"] and 0 < steps[-1] - steps[-2] <= steps[1] - steps[0], "the series ends with the final state"
        stress = file["series/particle_stress"][:]
        stresslets = file["cells/stresslet"][:]
        plan = json.loads(run(program, "plan", scene, "--json").stdout)
        volume = np.prod(plan["nodes"])
        kind, type_name = file["lattice/cell_types/0"].attrs, plan["cells"][0]["name"]
        radius = plan["cells"][0]["mesh_radius"] + plan["cells"][0]["shell_thickness"]
        assert np.allclose([plan["cells"][0]["effective_radius"], kind["effective_radius"], summary["effective_radius"][type_name]], radius)
        assert np.allclose(stresslets.sum(axis=1) / volume, stress, rtol=1e-10, atol=1e-18), "stress is the sum of the stresslets"
        eta = 1 + stress[:, 0, 2] / (plan["viscosity"] * plan["shear_rate"])
        assert np.allclose(eta, file["series/relative_viscosity"][:])
        # A cell's velocity is the change of its centre from one step to the next: over the sampled interval they agree on average.
        centre, velocity = file["cells/centre"][:], file["cells/velocity"][:]
        moved = (centre[2:, :, 0] - centre[:-2, :, 0]) / (steps[2:] - steps[:-2])[:, None]
        assert np.abs(moved - velocity[1:-1, :, 0]).max() < 0.2 * np.abs(velocity[..., 0]).max()
    again = run(program, "run", scene, "--output", folder / "a", check=False)
    assert again.returncode == 2 and "--overwrite" in again.stderr and again.stderr.count("\n") == 1
    before = (folder / "a/summary.json").read_bytes()
    assert before == (folder / "a/summary.json").read_bytes()
    run(program, "run", scene, "--output", folder / "a", "--overwrite", "--set", "run.strain=0.1")
    assert json.loads((folder / "a/summary.json").read_text())["strain"] < 0.11


def check_packing_reuse(program, folder, scene):
    reuse = f'run.packing="{folder / "a/packing.h5"}"'
    log = run(program, "run", scene, "--output", folder / "b", "--set", reuse, "--set", "run.strain=0.1").stdout
    assert "packing:" not in log
    with h5py.File(folder / "a/run.h5") as a, h5py.File(folder / "b/run.h5") as b:
        assert np.array_equal(a["cells/centre"][0], b["cells/centre"][0]), "same start from the saved packing"
    packed = (folder / "a/packing.h5").read_bytes()
    run(program, "run", scene, "--output", folder / "a", "--overwrite", "--set", reuse, "--set", "run.strain=0.1")
    assert (folder / "a/packing.h5").read_bytes() == packed, "replacing a run keeps the packing that it starts from"
    other = run(program, "run", scene, "--output", folder / "c", "--set", reuse, "--set", "cells.0.count=9", check=False)
    assert other.returncode == 2 and "number of cells" in other.stderr and not (folder / "c").exists(), other.stderr


def check_interrupt(program, folder, scene):
    for name in ("SIGINT", "SIGTERM"):
        output = folder / name
        process = subprocess.Popen([program, "run", scene, "--output", output, "--set", "run.strain=10000", "--set", "output.series_every=0.002"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for _ in range(600):
            if (output / "run.h5").exists():
                break
            time.sleep(0.1)
        time.sleep(1.5)
        process.send_signal(getattr(signal, name))
        process.communicate(timeout=60)
        assert process.returncode == 130, process.returncode
        summary = json.loads((output / "summary.json").read_text())
        assert summary["stopped_by"] == "interrupt" and summary["steps"] > 0
        with h5py.File(output / "run.h5") as file:
            steps = file["series/step"][:]
            assert len(steps) > 1 and summary["steps"] - steps[-1] <= steps[1] - steps[0], "samples up to the interrupt are kept"


def check_disk_full(program, folder, scene):
    """On a small file system of its own: nothing is left when not even the start fits, everything up to then when it fills during the run."""
    disk = folder / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=48k", "tmpfs", disk], capture_output=True).returncode != 0:
        print("disk full: skipped, no permission to mount a tmpfs")
        return
    try:
        result = run(program, "run", scene, "--output", disk / "out", check=False)
        assert result.returncode == 2 and result.stderr.startswith("error: ") and result.stderr.count("\n") == 1, (result.returncode, result.stderr)
        assert not (disk / "out").exists()
        subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
        result = run(program, "run", scene, "--output", disk / "out", "--set", "output.snapshot_every=0.02", "--set", "run.strain=400", check=False)
        assert result.returncode == 1 and result.stderr.startswith("error: "), (result.returncode, result.stderr)
        with h5py.File(disk / "out/cells.vtkhdf") as file:
            assert file["VTKHDF/Steps"].attrs["NSteps"] > 1
    finally:
        subprocess.run(["umount", disk], check=True)


def check_cases(program, folder):
    couette = folder / "couette.toml"
    couette.write_text("[box]\nsize = [2, 2, 4]\n[accuracy]\nradius = 5\ncollision = 'trt'\n[run]\nstrain = 1\n[output]\nfluid = true\nsnapshot_every = 0.5\n")
    run(program, "run", couette, "--output", folder / "couette")
    summary = json.loads((folder / "couette/summary.json").read_text())
    assert summary["relative_viscosity"] == 1 and abs(summary["wall_relative_viscosity"] - 1) < 1e-4
    assert not (folder / "couette/cells.vtkhdf").exists() and (folder / "couette/fluid.vtkhdf").exists()

    single = folder / "single.toml"
    single.write_text("[box]\nsize = [5, 5, 5]\n[flow]\ncapillary_number_G = 0.1\n[[cells]]\nshape = 'sphere'\ncount = 1\n[accuracy]\nradius = 4\n[run]\nstrain = 0.5\n")
    run(program, "run", single, "--output", folder / "single")
    summary = json.loads((folder / "single/summary.json").read_text())
    for key in ("deformation", "inclination", "intrinsic_viscosity", "area_ratio"):
        assert isinstance(summary[key], float), key
    assert 0 < summary["inclination"] < np.pi / 4 + 0.1


def check_mesh_file(program, folder):
    """A cell from an OFF file: an octahedron whose faces are split three times and pushed onto an ellipsoid."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(3):
        middle, split = {}, []
        for a, b, c in faces:
            ends = [(a, b), (b, c), (c, a)]
            for pair in ends:
                key = tuple(sorted(pair))
                if key not in middle:
                    point = np.add(vertices[pair[0]], vertices[pair[1]]) / 2
                    vertices.append(tuple(point / np.linalg.norm(point)))
                    middle[key] = len(vertices) - 1
            ab, bc, ca = (middle[tuple(sorted(pair))] for pair in ends)
            split += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = split
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x} {y} {0.6 * z}" for x, y, z in vertices] + [f"3 {a} {b} {c}" for a, b, c in faces]
    (folder / "ellipsoid.off").write_text("\n".join(lines) + "\n")
    scene = folder / "mesh.toml"
    scene.write_text('[box]\nsize = [5, 5, 5]\n[flow]\ncapillary_number = 0.05\n[[cells]]\nfile = "ellipsoid.off"\ncount = 6\n[accuracy]\nradius = 4\n[run]\nstrain = 0.2\n')
    run(program, "run", scene, "--output", folder / "mesh")
    summary = json.loads((folder / "mesh/summary.json").read_text())
    assert summary["cell_count"] == 6 and summary["relative_viscosity"] > 1 and summary["volume_drift_max"] < 0.01


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = folder / "scene.toml"
        scene.write_text(SCENE)
        check_outputs(program, folder, scene)
        check_packing_reuse(program, folder, scene)
        check_interrupt(program, folder, scene)
        check_disk_full(program, folder, scene)
        check_cases(program, folder)
        check_mesh_file(program, folder)
    print("all good")


if __name__ == "__main__":
    main()
