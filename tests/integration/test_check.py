"""corpuscle check: nothing to say about a good run, a sensible word about every kind of damage, and never a crash.
Arguments: program, source folder."""
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py

from expectations import expect, finish

program = sys.argv[1]

SCENE = """
[box]
size = [5, 5, 5]
[flow]
capillary_number = 0.1
[[cells]]
count = 2
[accuracy]
radius = 4
[run]
steps = 60
[output]
series_every = 0.002
snapshot_every = 0.01
fluid = true
"""


def check(folder, *options):
    return subprocess.run([program, "check", str(folder), *options], capture_output=True, text=True, timeout=120)


def problems(folder):
    answer = check(folder, "--json")
    expect(answer.returncode in (0, 1), f"exit code {answer.returncode}: {answer.stderr}")
    report = json.loads(answer.stdout)
    expect((answer.returncode == 0) == (report["problems"] == []), "the exit code tells whether there are problems")
    return report


def damaged(name, damage, file, words):
    """A copy of the good results after `damage(folder)` has a problem of `file` whose text contains `words`."""
    folder = work / "damaged"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(good, folder)
    damage(folder)
    found = problems(folder)["problems"]
    expect(any(p["file"] == file and words in p["problem"] and p["advice"] for p in found), f"{name}: no '{words}' of {file} in {found}")


def edit(file, action):
    def damage(folder):
        with h5py.File(folder / file, "r+") as data:
            action(data)
    return damage


def remove(file):
    return lambda folder: (folder / file).unlink()


def rewrite(file, old, new):
    def damage(folder):
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new))
    return damage


def set_value(data, name, index, value):
    data[name][index] = value


with tempfile.TemporaryDirectory() as temporary:
    work = pathlib.Path(temporary)
    (work / "scene.toml").write_text(SCENE)
    good = work / "good"
    run = subprocess.run([program, "run", str(work / "scene.toml"), "--output", str(good)], capture_output=True, text=True)
    expect(run.returncode == 0, "the run itself: " + run.stderr)
    expect(not (good / "lock").exists(), "the lock is removed at the end")

    report = problems(good)
    expect(report["problems"] == [], f"a good run has no problems: {report['problems']}")
    expect(report["last_step"] == 60 and report["samples"] > 5 and report["snapshots"] > 2, f"counts: {report}")
    answer = check(good)
    expect(answer.returncode == 0 and "all is well" in answer.stdout, "text for people: " + answer.stdout)

    # NaN where a number has no meaning is no fault: other flows, no cells.
    for name, scene in {
        "poiseuille": SCENE.replace("[flow]", '[flow]\nkind = "poiseuille"'),
        "rest": SCENE.replace("capillary_number = 0.1", 'kind = "rest"').replace("series_every = 0.002\nsnapshot_every = 0.01", ""),
        "no cells": '[box]\nsize = [5, 5, 5]\n[accuracy]\nradius = 4\n[run]\nsteps = 20\n',
        "periodic": '[box]\nsize = [5, 5, 5]\nwalls = false\n[flow]\nkind = "rest"\n[accuracy]\nradius = 4\n[run]\nsteps = 20\n',
    }.items():
        (work / "other.toml").write_text(scene)
        run = subprocess.run([program, "run", str(work / "other.toml"), "--output", str(work / name)], capture_output=True, text=True)
        expect(run.returncode == 0, f"{name}: {run.stderr}")
        expect(problems(work / name)["problems"] == [], f"{name} is well: {problems(work / name)['problems']}")

    expect(check(work / "none").returncode == 2, "no such directory: exit code 2")
    (work / "empty").mkdir()
    answer = check(work / "empty")
    expect(answer.returncode == 2 and answer.stderr.startswith("error: "), "a directory of something else: exit code 2")

    # What is missing
    for file in ("run.h5", "summary.json", "scene.toml"):
        damaged("removed", remove(file), file, "is missing")
    damaged("dataset", edit("run.h5", lambda d: d.__delitem__("series/strain")), "run.h5", "/series/strain is missing")
    # What is inconsistent
    damaged("lengths", edit("run.h5", lambda d: d["cells/centre"].resize(3, 0)), "run.h5", "series of 3 to")
    damaged("gap", edit("run.h5", lambda d: set_value(d, "series/step", slice(3, None), d["series/step"][3:] + d["series/step"][1])), "run.h5", "comes step")
    damaged("doubled", edit("run.h5", lambda d: set_value(d, "series/step", 3, d["series/step"][2])), "run.h5", "sample 3")
    damaged("strain", edit("run.h5", lambda d: set_value(d, "series/strain", 2, 5)), "run.h5", "strain")
    damaged("nan", edit("run.h5", lambda d: set_value(d, "series/relative_viscosity", 4, float("nan"))), "run.h5", "nan in row 4")
    damaged("infinity", edit("run.h5", lambda d: set_value(d, "cells/velocity", (2, 1, 1), float("inf"))), "run.h5", "inf in row 2")
    damaged("cells", edit("run.h5", lambda d: set_value(d, "cells/type", 0, 7)), "run.h5", "lists 1 cells")
    damaged("empty cell", edit("run.h5", lambda d: set_value(d, "cells/volume", (-1, 1), 0)), "run.h5", "/cells/volume of cell 1 is 0")
    damaged("format", edit("run.h5", lambda d: d.attrs.modify("format", "other")), "run.h5", "format")
    damaged("scene", edit("run.h5", lambda d: d.attrs.modify("scene", "[box]\nsize = 3\n")), "run.h5", "box.size")
    damaged("scene.toml", rewrite("scene.toml", "steps = 60", "steps = 61"), "scene.toml", "differs")
    damaged("snapshot", edit("cells.vtkhdf", lambda d: set_value(d, "VTKHDF/Points", (5, 0), float("nan"))), "cells.vtkhdf", "nan in row 5")
    damaged("points", edit("cells.vtkhdf", lambda d: d["VTKHDF/Points"].resize(100, 0)), "cells.vtkhdf", "100 rows instead of")
    damaged("snapshot times", edit("cells.vtkhdf", lambda d: set_value(d, "VTKHDF/Steps/Values", 1, 0)), "cells.vtkhdf", "snapshot 1")
    damaged("faces", edit("cells.vtkhdf", lambda d: set_value(d, "VTKHDF/Polygons/Connectivity", 0, -1)), "cells.vtkhdf", "a face names point -1")
    damaged("grid", edit("fluid.vtkhdf", lambda d: d["VTKHDF"].move("PointData/velocity", "elsewhere")), "fluid.vtkhdf", "velocity")
    damaged("fewer", edit("fluid.vtkhdf", lambda d: d["VTKHDF/Steps"].attrs.modify("NSteps", 1)), "fluid.vtkhdf", "has 1 snapshots")
    damaged("packing", edit("packing.h5", lambda d: set_value(d, "positions", (0, 0), float("nan"))), "packing.h5", "finite")
    damaged("summary steps", rewrite("summary.json", '"steps": 60', '"steps": 80'), "summary.json", "steps is 80")
    damaged("summary mean", rewrite("summary.json", '"cell_count": 2', '"cell_count": 3'), "summary.json", "cell_count is 3")
    for name in ("checkpoint-a.h5", "checkpoint-b.h5"):
        damaged("cut " + name, lambda folder, name=name: (folder / name).write_bytes((folder / name).read_bytes()[:-1]), name, "its end is missing")
    damaged("journal", lambda folder: (folder / "run.h5.journal").write_bytes(b"cut"), "run.h5", "cut off by a kill")
    damaged("no json", lambda folder: (folder / "summary.json").write_text("{"), "summary.json", "JSON")

    # Files cut off anywhere, and flipped bits: always an answer. A flipped number can go unnoticed, a cut cannot.
    chance = random.Random(1)
    for file in ("run.h5", "cells.vtkhdf", "fluid.vtkhdf", "packing.h5"):
        size = (good / file).stat().st_size
        for length in (0, 1, 100, 2000, size // 2, size - 1):
            damaged(f"cut to {length}", lambda folder: os.truncate(folder / file, length), file, "")
    folder = work / "damaged"
    for trial in range(40):
        file = chance.choice(("run.h5", "cells.vtkhdf", "fluid.vtkhdf", "packing.h5"))
        shutil.rmtree(folder)
        shutil.copytree(good, folder)
        data = bytearray((folder / file).read_bytes())
        for _ in range(20):
            data[chance.randrange(min(len(data), 20000))] ^= 1 << chance.randrange(8)
        (folder / file).write_bytes(data)
        problems(folder)

    # While a run goes on, and after a kill: files open in h5py, and a second run is refused.
    long_scene = SCENE.replace("steps = 60", "steps = 10000000")
    (work / "long.toml").write_text(long_scene)
    folder = work / "killed"
    process = subprocess.Popen([program, "run", str(work / "long.toml"), "--output", str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    samples = 0
    deadline = time.time() + 120
    reads = 0
    while time.time() < deadline and samples == 0:
        time.sleep(0.2)
        if not (folder / "cells.vtkhdf").exists():
            continue
        try:
            with h5py.File(folder / "run.h5", "r") as data:
                samples = len(data["series/step"])
            reads += 1
        except OSError as error:  # in the middle of a flush: the next look must succeed
            print("once:", error)
    expect(samples > 0 and reads > 1, "h5py reads the series while the run goes on")
    second = subprocess.run([program, "run", str(work / "scene.toml"), "--output", str(folder), "--overwrite"], capture_output=True, text=True)
    expect(second.returncode == 2 and f"process {process.pid} on " in second.stderr, "a second run into the directory is refused: " + second.stderr)
    answer = check(folder)
    expect(f"process {process.pid}" in answer.stdout and "summary.json" not in answer.stdout, "check knows that a run goes on: " + answer.stdout)
    process.send_signal(signal.SIGKILL)
    process.wait()
    report = problems(folder)
    expect([p["file"] for p in report["problems"] if p["file"] == "summary.json"] and report["samples"] >= samples, f"after a kill: {report}")
    expect(report["resumes_at"] >= 0, f"after a kill there is a checkpoint: {report}")
    (folder / "run.h5.journal").write_bytes(b"cut")
    expect(check(folder, "--recover").stdout.count("journal") == 0 and not (folder / "run.h5.journal").exists(), "a cut journal is removed with --recover")
    with h5py.File(folder / "run.h5", "r") as data:
        expect(len(data["series/step"]) >= samples, "and h5py still reads them")
    third = subprocess.run([program, "run", str(work / "scene.toml"), "--output", str(folder), "--overwrite"], capture_output=True, text=True)
    expect(third.returncode == 0, "the lock of a killed run is none: " + third.stderr)
    expect(problems(folder)["problems"] == [], "the replaced results are whole")

finish()
print("every damage was found, nothing crashed")
