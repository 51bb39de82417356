"""Checkpoints from the outside: a run that is extended, killed, or stopped by a signal or the wall time goes on bit for bit.
Arguments: PROGRAM SOURCE-FOLDER."""
import json
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

import h5py

from kills import SCENE, command, differences, kill_and_resume, start

STEPS = 2001


def check_equal(a, b, what, samples=11):
    """`samples`: at least so many, so that the comparison of statistics means something."""
    different, compared = differences(a, b)
    assert not different, f"{what}: {different}"
    assert compared > 50, compared
    x, y = (json.loads((folder / "summary.json").read_text()) for folder in (a, b))
    for key in x.keys() - {"wall_seconds", "mlups", "threads", "bytes_peak"}:
        assert x[key] == y[key], f"{what}: summary.json: {key}"
    x, y = (json.loads((folder / "statistics.json").read_text()) for folder in (a, b))
    assert x["run"]["samples"] >= samples and x == y, f"{what}: statistics.json"
    print(f"{what}: {compared} datasets are equal bit for bit")


def check_extension(program, folder):
    """n steps, then n more, against 2 n steps: n odd, so that the populations lie the other way round in memory; other numbers of threads."""
    n = 151
    for update in ("averaged", "chebyshev"):
        scene = folder / f"{update}.toml"
        scene.write_text(SCENE.format(steps=2 * n, checkpoint_steps=10000).replace("radius = 4", f'radius = 4\nvertex_update = "{update}"'))
        once, twice = folder / f"{update}-once", folder / f"{update}-twice"
        # Live statistics leave out a share of the length that is known when the run starts.
        command(program, "run", scene, "--output", once, "--threads", 1, "--set", "run.discard=0")
        command(program, "run", scene, "--output", twice, "--threads", 2, "--set", f"run.steps={n}", "--set", "run.discard=0")
        with h5py.File(twice / "run.h5") as file:
            assert file["series/step"][-1] == n and file["series/step"][-1] % file["lattice"].attrs["series_every"] != 0, "the last sample is off the cadence"
        log = command(program, "resume", twice, "--threads", 1, "--until", f"steps={2 * n}").stdout
        assert f"going on at step {n} of {2 * n}" in log, log
        check_equal(once, twice, f"{update}, {n} + {n} steps")
        command(program, "resume", twice)
        check_equal(once, twice, f"{update}, and resumed although it is finished")
    short = command(program, "resume", folder / "averaged-twice", "--until", "steps=9", check=2)
    assert "larger value" in short.stderr, short.stderr
    return folder / "averaged-once"


def check_coupling_interval(program, folder):
    """Coupled every third step: a length of 151 steps means 153, cadences are multiples of 3, and a run that stops in between stops at a coupling."""
    scene = folder / "interval.toml"
    scene.write_text(SCENE.format(steps=302, checkpoint_steps=100).replace("radius = 4", "radius = 4\ncoupling_every = 3"))
    once, twice = folder / "interval-once", folder / "interval-twice"
    command(program, "run", scene, "--output", once, "--threads", 1, "--set", "run.discard=0")
    command(program, "run", scene, "--output", twice, "--threads", 2, "--set", "run.steps=151", "--set", "run.discard=0")
    with h5py.File(twice / "run.h5") as file:
        lattice = file["lattice"].attrs
        assert lattice["coupling_every"] == 3 and lattice["steps"] == 153, dict(lattice)
        assert lattice["series_every"] % 3 == 0 and lattice["snapshot_every"] % 3 == 0, dict(lattice)
        assert (file["series/step"][:] % 3 == 0).all() and file["series/step"][-1] == 153
    log = command(program, "resume", twice, "--threads", 1, "--until", "steps=302").stdout
    assert "going on at step 153 of 303" in log, log
    check_equal(once, twice, "coupled every third step, 153 + 150 steps")
    endless, output, whole = folder / "endless.toml", folder / "interval-stopped", folder / "interval-whole"
    endless.write_text(scene.read_text().replace("steps = 302", "steps = 200000\ndiscard = 0"))
    process = start(program, endless, output)
    time.sleep(0.5)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60) == 130
    process.stderr.close()
    stopped = json.loads((output / "summary.json").read_text())["steps"]
    assert 0 <= stopped < 200000 and stopped % 3 == 0, stopped
    length = max(stopped + 30, 150)  # live statistics want some samples
    log = command(program, "resume", output, "--until", f"steps={length}").stdout
    assert f"going on at step {stopped} of {length}" in log, log
    command(program, "run", endless, "--output", whole, "--set", f"run.steps={length}", "--threads", 1)
    check_equal(whole, output, f"coupled every third step, stopped by a signal at step {stopped}")


def check_damage(program, folder, reference):
    """A newest checkpoint that is damaged: the one before is taken, with a note. Both damaged: refused, nothing is changed."""
    output = folder / "damaged"
    command(program, "run", folder / "averaged.toml", "--output", output, "--set", "run.steps=140", "--set", "output.checkpoint_steps=61")
    newest = max((output / name for name in ("checkpoint-a.h5", "checkpoint-b.h5")), key=lambda path: h5py.File(path).attrs["sequence"])
    data = bytearray(newest.read_bytes())
    data[len(data) // 3] ^= 16
    newest.write_bytes(data)
    broken = folder / "broken"
    shutil.copytree(output, broken)
    result = command(program, "resume", output, "--until", "steps=302", "--threads", 2)
    assert newest.name in result.stderr and "damaged" in result.stderr and "going on at step 122" in result.stdout, result
    different, _ = differences(reference, output)
    assert different in ([], ["run.h5:scene"]), different  # checkpoint_steps is in the scene
    for name in ("checkpoint-a.h5", "checkpoint-b.h5"):
        (broken / name).write_bytes((broken / name).read_bytes()[:1000])
    before = (broken / "run.h5").read_bytes()
    result = command(program, "resume", broken, check=2)
    assert result.stderr.count("\n") == 1 and "no whole checkpoint" in result.stderr, result.stderr
    assert before == (broken / "run.h5").read_bytes()
    result = command(program, "resume", folder, check=2)
    assert "holds no checkpoint" in result.stderr, result.stderr
    print("a damaged checkpoint is left out")


def check_guard(program, folder, reference):
    """A guard whose limit was too low: the checkpoint before it is kept, and the run goes on with another limit as if nothing had been."""
    output = folder / "guard"
    limit = 0.7 * json.loads((reference / "summary.json").read_text())["volume_drift_max"]
    stopped = command(program, "run", folder / "averaged.toml", "--output", output, "--set", f"guards.volume_drift={limit}", "--set", "output.checkpoint_strain=0.002",
                      check=3)
    assert "guards.volume_drift" in stopped.stderr and (output / "broken.vtkhdf").exists(), stopped.stderr
    report = json.loads(command(program, "check", output, "--json").stdout)
    assert not report["problems"] and report["resumes_at"] >= 0, report
    command(program, "resume", output, check=3)
    command(program, "resume", output, "--set", "guards.volume_drift=0.1")
    different, compared = differences(reference, output)
    assert different in ([], ["run.h5:scene"]) and compared > 50, (different, compared)
    refused = command(program, "resume", output, "--set", "flow.capillary_number=1", check=2)
    assert refused.stderr.count("\n") == 1 and "flow.capillary_number" in refused.stderr, refused.stderr
    print("a run that a guard stopped goes on with another limit")


def check_stops(program, folder, reference):
    """Each way to stop a run: its exit code, soon, and the same result after resume."""
    for name, send, code in (("interrupt", signal.SIGINT, 130), ("terminate", signal.SIGTERM, 130), ("user signal", signal.SIGUSR1, 75)):
        output = folder / name.replace(" ", "-")
        process = start(program, folder / "kills.toml", output)
        time.sleep(0.2)
        process.send_signal(send)
        returncode = process.wait(timeout=60)
        process.stderr.close()
        assert returncode == code, (name, returncode)
        summary = json.loads((output / "summary.json").read_text())
        assert summary["stopped_by"] in (name, "interrupt") and summary["steps"] < STEPS, summary
        command(program, "resume", output, "--threads", 2)
        check_equal(reference, output, f"{name} at step {summary['steps']}, exit code {code}")


def check_wall_time(program, folder, reference):
    """A run that would take days stops after two seconds, and once more; then its end is set to where it has come to, and it equals one of that length."""
    output, packing = folder / "wall-time", f'run.packing="{reference / "packing.h5"}"'  # of packing nothing is kept, so it must not be where the time goes
    command(program, "run", folder / "kills.toml", "--output", output, "--set", packing, "--set", "run.steps=100000000", "--set", "run.discard=0",
            "--wall-time", "00:00:02", "--threads", 1, check=75)
    command(program, "resume", output, "--wall-time", "0-00:00:01", "--threads", 1, check=75)
    summary = json.loads((output / "summary.json").read_text())
    assert summary["stopped_by"] == "wall time", summary
    command(program, "resume", output, "--until", f"steps={summary['steps']}")
    once = folder / "until-wall-time"
    command(program, "run", folder / "kills.toml", "--output", once, "--set", packing, "--set", f"run.steps={summary['steps']}", "--set", "run.discard=0", "--threads", 1)
    check_equal(once, output, f"wall time, twice, until step {summary['steps']}", samples=1)  # a slow program doesn't come far
    wrong = command(program, "resume", output, "--wall-time", "90", check=2)
    assert "HH:MM:SS" in wrong.stderr


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        once = check_extension(program, folder)
        check_coupling_interval(program, folder)
        check_damage(program, folder, once)
        check_guard(program, folder, once)
        (folder / "kills.toml").write_text(SCENE.format(steps=STEPS, checkpoint_steps=41))
        reference = folder / "reference"
        command(program, "run", folder / "kills.toml", "--output", reference, "--threads", 1)
        check_stops(program, folder, reference)
        check_wall_time(program, folder, reference)
        seed = int(time.time())
        killed, _ = kill_and_resume(program, folder / "kills.toml", folder / "killed", 8, random.Random(seed), 0.5)
        check_equal(reference, folder / "killed", f"{killed} kills, seed {seed}")


if __name__ == "__main__":
    main()
