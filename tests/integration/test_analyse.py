"""corpuscle analyse from the outside: a small run analysed, its numbers computed again with numpy; partial and running runs; bad input.
Arguments: PROGRAM SOURCE-FOLDER."""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

SCENE = """
[box]
size = [5, 5, 10]
[flow]
capillary_number = 0.1
reynolds_number_max = 0.4
[[cells]]
effective_volume_fraction = 0.25
[accuracy]
radius = 4
delta_kernel = 3
collision = "bgk"
[run]
strain = 4
[output]
series_every = 0.05
snapshot_every = 0
"""


def run(program, *arguments, code=0):
    result = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert result.returncode == code, (arguments, result.returncode, result.stdout[-500:], result.stderr)
    assert code == 0 or (result.stderr.startswith("error: ") and result.stderr.count("\n") == 1), result.stderr
    return result


def close(found, wanted, tolerance=1e-9):
    assert abs(found["value"] - wanted) <= tolerance * abs(wanted), (found["value"], wanted)


class Numbers:
    """What is in run.h5, from sample `first` on, of a grid of whole intervals."""

    def __init__(self, folder, first):
        with h5py.File(folder / "run.h5") as file:
            lattice = dict(file["lattice"].attrs)
            on_grid = file["series/step"][:] % lattice["series_every"] == 0
            self.cells = {name: file["cells"][name][:][on_grid][first:] for name in ("centre", "velocity", "stresslet", "gyration", "volume")}
            self.series = {name: data[:][on_grid][first:] for name, data in file["series"].items()}
            self.kind = dict(file["lattice/cell_types/0"].attrs)
        self.radius, self.rate, self.viscosity, self.nodes = (lattice[name] for name in ("radius", "shear_rate", "viscosity", "nodes"))
        self.interval = self.rate * lattice["series_every"]

    def in_bulk(self, layer):
        z = self.cells["centre"][:, :, 2]
        return (z >= layer * self.radius) & (z <= self.nodes[2] - layer * self.radius)

    def bulk_stress(self, layer):
        """[T, 3, 3] over viscosity x shear rate."""
        volume = self.nodes[0] * self.nodes[1] * (self.nodes[2] - 2 * layer * self.radius)
        sums = np.where(self.in_bulk(layer)[:, :, None, None], self.cells["stresslet"], 0).sum(axis=1)
        return sums / (volume * self.viscosity * self.rate)


def check_numbers(program, folder):
    layer, discard = 2, 1.0
    page = run(program, "analyse", folder, "--wall-layer", layer, "--discard", discard, "--longest-lag", 1).stdout
    found = json.loads((folder / "analysis.json").read_text())
    assert (folder / "analysis.md").read_text() in page and "relative_viscosity" in page
    first = int(np.ceil(discard / (found["run"]["sample_interval"]) - 1e-9))
    data = Numbers(folder, first)
    estimates, curves = found["estimates"], found["curves"]
    assert found["format"] == "corpuscle-analysis-1" and abs(found["run"]["sample_interval"] - data.interval) < 1e-12
    assert abs(found["settings"]["discarded_strain"] - first * data.interval) < 1e-9

    stress, inside = data.bulk_stress(layer), data.in_bulk(layer)
    close(estimates["relative_viscosity"], 1 + stress[:, 0, 2].mean())
    close(estimates["normal_stress_difference_1"], (stress[:, 0, 0] - stress[:, 2, 2]).mean())
    close(estimates["normal_stress_difference_2"], (stress[:, 2, 2] - stress[:, 1, 1]).mean())
    close(estimates["particle_pressure"], -np.trace(stress, axis1=1, axis2=2).mean() / 3)
    close(estimates["bulk_stress_fluctuation"], stress[:, 0, 2].std() / stress[:, 0, 2].mean())
    close(estimates["whole_relative_viscosity"], data.series["relative_viscosity"].mean())
    close(estimates["wall_relative_viscosity"], data.series["wall_relative_viscosity"].mean())

    unit = data.rate * data.radius
    for axis, name in ((1, "y"), (2, "z")):
        close(estimates[f"velocity_variance_{name}"], data.cells["velocity"][:, :, axis][inside].var() / unit**2)
    z, u = data.cells["centre"][:, :, 2] - data.nodes[2] / 2, data.cells["velocity"][:, :, 0]
    close(estimates["shear_rate_bulk"], np.polyfit(z[inside], u[inside], 1)[0] / data.rate, 1e-6)
    lag = 6
    for axis, name in ((1, "y"), (2, "z")):
        x = data.cells["centre"][:, :, axis] / data.radius
        squares = (x[lag:] - x[:-lag])**2
        point = int(np.argmin(np.abs(np.array(curves[f"msd_{name}"]["x"]) - lag * data.interval)))
        assert abs(curves[f"msd_{name}"]["x"][point] - lag * data.interval) < 1e-9
        close({"value": curves[f"msd_{name}"]["value"][point]}, squares[inside[:-lag]].mean(), 1e-7)
        v = data.cells["velocity"][:, :, axis]
        products = (v[:-lag] * v[lag:])[inside[:-lag]].mean() / (v**2)[inside].mean()
        assert abs(curves[f"vacf_{name}"]["value"][point] - products) < 1e-9
    stresslets = data.cells["stresslet"][:, :, 0, 2][inside]
    close(estimates["stress_fluctuation"], stresslets.std() / stresslets.mean())

    bulk_volume = data.nodes[0] * data.nodes[1] * (data.nodes[2] - 2 * layer * data.radius)
    volumes = np.where(inside, data.cells["volume"], 0).sum(axis=1).mean() / bulk_volume
    close(estimates["phi_bulk_geometric"], volumes)
    close(estimates["phi_bulk"], volumes * data.kind["effective_volume"] / data.kind["volume"])
    # Axes of the section with the shear plane, y eliminated: xx yy zz xy xz yz.
    xx, yy, zz, xy, xz, yz = np.moveaxis(data.cells["gyration"], -1, 0)
    plane = np.stack([np.stack([xx - xy**2 / yy, xz - xy * yz / yy], -1), np.stack([xz - xy * yz / yy, zz - yz**2 / yy], -1)], -2)
    axes = np.sqrt(np.linalg.eigvalsh(plane))
    deformation = (axes[..., 1] - axes[..., 0]) / (axes[..., 1] + axes[..., 0])
    per_time = [deformation[t][inside[t]].mean() for t in range(len(deformation))]
    close(estimates["deformation"], np.mean(per_time), 1e-7)
    assert found["settings"]["contact_distance"] > 1
    for name, estimate in estimates.items():
        assert estimate["converged"] == (estimate["reason"] == ""), (name, estimate)
        assert estimate["value"] is not None or estimate["reason"], name
    run(program, "check", folder)


def check_layer_of_series(program, folder):
    """The bulk that run.h5 knows is that of 4 radii: recomputed from stresslets it is the same to the last digits."""
    run(program, "analyse", folder, "--discard", 0, "--output", folder / "four.json")
    four = json.loads((folder / "four.json").read_text())
    data = Numbers(folder, 0)
    close(four["estimates"]["relative_viscosity"], data.series["bulk_relative_viscosity"].mean())
    assert np.allclose(data.bulk_stress(4) * data.viscosity * data.rate, data.series["bulk_particle_stress"], rtol=1e-12, atol=1e-20)
    assert (folder / "four.md").exists()


def check_parts(program, folder, work):
    """What a run lacks makes its own observables null, with a reason; the others are there."""
    def variant(change):
        target = work / "variant"
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir()
        shutil.copy(folder / "run.h5", target)
        with h5py.File(target / "run.h5", "r+") as file:
            change(file)
        run(program, "analyse", target, "--wall-layer", 2)
        return json.loads((target / "analysis.json").read_text())

    def without_cells(file):
        del file["cells"]

    def cut(rows):
        def change(file):
            for group in ("series", "cells"):
                for name, data in file[group].items():
                    if name not in ("type", "type_names"):
                        data.resize(rows, axis=0)
        return change

    def uneven(file):
        file["cells/stresslet"].resize(20, axis=0)

    found = variant(without_cells)
    assert found["estimates"]["velocity_variance_y"]["value"] is None and "trajectories" in found["estimates"]["velocity_variance_y"]["reason"]
    assert found["estimates"]["wall_relative_viscosity"]["value"] > 1
    found = variant(cut(1))
    assert found["run"]["samples"] == 1 and found["estimates"]["relative_viscosity"]["value"] > 1
    assert not found["estimates"]["relative_viscosity"]["converged"] and found["estimates"]["diffusivity_msd_y"]["value"] is None
    assert variant(uneven)["run"]["samples"] == 20
    (work / "variant/summary.json").write_text('{"stopped_by": "guard"}')
    run(program, "analyse", work / "variant", "--wall-layer", 2)
    assert any("guard" in text for text in json.loads((work / "variant/analysis.json").read_text())["warnings"])
    found = variant(lambda file: file.__delitem__("series/wall_shear_stress"))
    assert any("wall_shear_stress" in text for text in found["warnings"]) and found["estimates"]["relative_viscosity"]["value"] > 1


def check_scenes(program, work):
    """One cell, no cells, rest, channel flow."""
    def analysed(name, text, *options):
        (work / f"{name}.toml").write_text(text)
        run(program, "run", work / f"{name}.toml", "--output", work / name, "--threads", "1")
        run(program, "analyse", work / name, *options)
        return json.loads((work / name / "analysis.json").read_text())

    brief = "[accuracy]\npreset = 'draft'\nradius = 4\n[run]\nsteps = 60\n[output]\nseries_every = {every}\nsnapshot_every = 0\n"
    one = analysed("one", "[box]\nsize = [4, 4, 4]\n[flow]\ncapillary_number = 0.1\n[[cells]]\ncount = 1\n" + brief.format(every=0.001), "--wall-layer", "1")
    assert one["estimates"]["deformation"]["value"] > 0 and "one cell" in one["estimates"]["velocity_variance_y"]["reason"]
    none = analysed("none", "[box]\nsize = [4, 4, 4]\n" + brief.format(every=0.001))
    assert none["estimates"]["wall_relative_viscosity"]["value"] > 0 and none["run"]["cell_count"] == 0
    rest = analysed("rest", "[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[[cells]]\ncount = 3\n" + brief.format(every=10))
    assert "at rest" in rest["estimates"]["relative_viscosity"]["reason"] and rest["estimates"]["deformation"]["value"] > 0
    assert rest["settings"]["wall_layer"] == 0 and abs(rest["estimates"]["phi_bulk_geometric"]["value"] - rest["run"]["phi_geometric"]) < 0.02
    channel = analysed("channel", "[box]\nsize = [4, 4, 4]\n[flow]\nkind = 'poiseuille'\ncapillary_number = 0.1\n[[cells]]\ncount = 4\n" + brief.format(every=0.001),
                       "--wall-layer", "0.5")
    assert "channel flow" in channel["estimates"]["relative_viscosity"]["reason"] and channel["estimates"]["whole_relative_viscosity"]["value"] > 0
    assert channel["estimates"]["velocity_variance_z"]["value"] is not None


def check_bad_input(program, folder, work):
    empty = work / "empty"
    empty.mkdir()
    assert "no run.h5" in run(program, "analyse", empty, code=2).stderr
    assert "no such directory" in run(program, "analyse", work / "nowhere", code=2).stderr
    assert not list(empty.iterdir())
    (empty / "run.h5").write_bytes((folder / "run.h5").read_bytes()[:5000])
    assert "corpuscle check" in run(program, "analyse", empty, code=2).stderr
    for options, words in ((("--discard", "100"), "--discard 100"), (("--longest-lag", "50"), "--longest-lag 50"), (("--wall-layer", "-1"), "--wall-layer"),
                           (("--mean-flow", "none"), "mean-flow"), (("--output", folder / "page.txt"), ".json"),
                           (("--output", folder / "summary.json"), "would be lost"), (("--discard", "some"), "discard")):
        assert words in run(program, "analyse", folder, *options, code=2).stderr, (options, words)
    assert "relative_viscosity" in json.loads((folder / "summary.json").read_text())


def check_overwrite(program, work):
    """A new run in the place of an old one takes its analysis away."""
    assert (work / "one/analysis.json").exists() and (work / "one/analysis.md").exists()
    run(program, "run", work / "one.toml", "--output", work / "one", "--threads", "1", "--overwrite", "--set", "run.steps=2")
    assert not (work / "one/analysis.json").exists() and not (work / "one/analysis.md").exists()


def check_running(program, work):
    """A run that goes on can be analysed; so can what an interrupt leaves."""
    (work / "long.toml").write_text(SCENE.replace("strain = 4", "strain = 10000"))
    process = subprocess.Popen([program, "run", work / "long.toml", "--output", work / "long", "--threads", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(600):
            time.sleep(0.2)
            try:
                with h5py.File(work / "long/run.h5") as file:
                    if len(file["series/step"]) > 3:
                        break
            except OSError:
                pass
        run(program, "analyse", work / "long", "--wall-layer", "2")
        found = json.loads((work / "long/analysis.json").read_text())
        assert found["run"]["samples"] > 3 and any("a run is writing here" in text for text in found["warnings"])
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=60)
    run(program, "analyse", work / "long", "--wall-layer", "2")
    found = json.loads((work / "long/analysis.json").read_text())
    assert found["estimates"]["relative_viscosity"]["value"] > 1 and not any("writing here" in text for text in found["warnings"])


def check_sweep(program, folder, work):
    """A made-up sweep: copies of a run with other capillary numbers, one waiting, one damaged, one failed; analysed, again, and with other settings."""
    sweep = work / "sweep"
    sweep.mkdir()
    names = ["Ca0.1", "Ca0.05", "Ca0.02", "Ca0.01", "broken", "waiting"]
    states = ["finished", "stopped", "finished", "failed", "finished", "waiting"]
    (sweep / "sweep.json").write_text(json.dumps({"format": "corpuscle-sweep-1", "scene": "scene.toml", "runs": [
        {"name": name, "directory": name, "overrides": {}, "state": state, "exit_code": 3 if state == "failed" else None,
         "message": "a guard" if state == "failed" else ""} for name, state in zip(names, states)]}))
    for name in names[:4]:
        (sweep / name).mkdir()
        shutil.copy(folder / "run.h5", sweep / name)
        with h5py.File(sweep / name / "run.h5", "r+") as file:
            factor = 0.1 / float(name[2:])
            file["lattice"].attrs["capillary_number"] = float(name[2:])
            file["cells/stresslet"][...] *= factor**0.5
    (sweep / "broken").mkdir()
    (sweep / "broken/run.h5").write_text("nothing")
    options = ("--wall-layer", "2", "--discard", "1")
    log = run(program, "analyse", sweep, *options).stdout
    assert log.count(" analysed\n") == 4, log
    found = json.loads((sweep / "analysis.json").read_text())
    assert [entry["directory"] for entry in found["runs"]] == names[:4]
    for text, words in (("broken", "left out"), ("waiting", "no run.h5"), ("Ca0.01", "a guard"), ("Ca0.05", "as far as it is")):
        assert any(text in warning and words in warning for warning in found["warnings"]), (text, found["warnings"])
    single = json.loads((sweep / "Ca0.02/analysis.json").read_text())["estimates"]["relative_viscosity"]
    assert found["runs"][2]["estimates"]["relative_viscosity"]["value"] == single["value"] > 1
    curve, = found["flow_curves"]
    assert curve["runs"] == ["Ca0.02", "Ca0.05", "Ca0.1"], "failed runs take no part in fits"
    capillary = np.array([entry["run"]["capillary_number"] for entry in found["runs"]])
    viscosity, error = (np.array([entry["estimates"]["relative_viscosity"][part] for entry in found["runs"]]) for part in ("value", "error"))
    slope, _ = np.polyfit(np.log(capillary[:3]), np.log(viscosity[:3]), 1, w=(viscosity / error)[:3])
    close(curve["shear_thinning"]["parameters"]["exponent"], -slope, 1e-6)
    assert "at least 4" in curve["yield_stress"]["reason"]
    with h5py.File(sweep / "analysis.h5") as file:
        assert np.allclose(file["estimates/relative_viscosity/value"], viscosity) and len(file["runs/directory"]) == 4
    lines = (sweep / "analysis.csv").read_text().splitlines()
    assert len(lines) == 5 and lines[0].startswith("directory,capillary_number")
    assert "Flow curves" in (sweep / "analysis.md").read_text()

    # Nothing is done twice; what has changed, or is asked for differently, is.
    times = {name: (sweep / name / "analysis.json").stat().st_mtime_ns for name in names[:4]}
    (sweep / "Ca0.05/run.h5").touch()
    log = run(program, "analyse", sweep, *options).stdout
    assert log.count("was analysed before") == 3, log
    changed = [name for name in names[:4] if (sweep / name / "analysis.json").stat().st_mtime_ns != times[name]]
    assert changed == ["Ca0.05"], changed
    assert "was analysed before" not in run(program, "analyse", sweep, "--wall-layer", "1").stdout

    only = work / "only"
    only.mkdir()
    (only / "sweep.json").write_text((sweep / "sweep.json").read_text())
    assert "no run of the sweep can be analysed" in run(program, "analyse", only, code=2).stderr
    (only / "sweep.json").write_text("{")
    assert "sweep.json" in run(program, "analyse", only, code=2).stderr
    for name in ("run.json", "kept.json"):
        (sweep / "run.h5").write_text("data")
        (sweep / "kept.csv").write_text("data")
        assert "would be lost" in run(program, "analyse", sweep, "--output", sweep / name, code=2).stderr


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        (work / "scene.toml").write_text(SCENE)
        run(program, "run", work / "scene.toml", "--output", work / "a", "--threads", "1")
        check_numbers(program, work / "a")
        check_layer_of_series(program, work / "a")
        check_parts(program, work / "a", work)
        check_bad_input(program, work / "a", work)
        check_scenes(program, work)
        check_overwrite(program, work)
        check_running(program, work)
        check_sweep(program, work / "a", work)
    print("all good")


if __name__ == "__main__":
    main()
