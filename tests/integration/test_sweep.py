"""corpuscle sweep as a user meets it: all points run, a stop, a kill and a failed point, points added and changed, a job array with an sbatch of our own.
Arguments: PROGRAM SOURCE-FOLDER."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

from expectations import expect, finish
from kills import SCENE, differences

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = None

TWO_AXES = """
scene = "base.toml"
[[axis]]
key = "run.seed"
values = [1, 2]
[[axis]]
key = "flow.capillary_number"
values = [0.05, 0.02]
"""


def write(name, text, steps=301):
    """A sweep and its base scene in a folder of their own; returns the sweep's path."""
    folder = work / name
    folder.mkdir(exist_ok=True)
    scene = SCENE.format(steps=steps, checkpoint_steps=100).replace("series_every = 0.01", "series_every = 0.05").replace("snapshot_every = 0.05", "snapshot_every = 0.5")
    (folder / "base.toml").write_text(scene)
    (folder / "sweep.toml").write_text(text)
    return folder / "sweep.toml"


def sweep(path, *options, output="out", check=0, **settings):
    result = subprocess.run([program, "sweep", path, "--output", path.parent / output, *map(str, options)], capture_output=True, text=True, timeout=1500, **settings)
    expect(result.returncode == check, f"{path.parent.name} {options}: exit code {result.returncode} instead of {check}: {result.stdout}{result.stderr}")
    return result


def record(path, output="out"):
    return json.loads((path.parent / output / "sweep.json").read_text())


def states(path):
    return {run["name"]: run["state"] for run in record(path)["runs"]}


def steps_of(run):
    return json.loads((run / "summary.json").read_text())["steps"]


def begin(path, *options):
    """Starts a sweep in the background and waits until two of its runs have a checkpoint."""
    process = subprocess.Popen([program, "sweep", path, "--output", path.parent / "out", *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    end = time.time() + 100
    while len(list((path.parent / "out").glob("*/checkpoint-a.h5"))) < 2:
        assert process.poll() is None and time.time() < end, process.stdout.read()
        time.sleep(0.01)
    return process


def without_runs(path):
    """Waits until no run holds a lock; returns the names of those that did not come to an end within a minute."""
    for _ in range(600):
        if not list(path.parent.glob("out/*/lock")):
            return []
        time.sleep(0.1)
    return [lock.parent.name for lock in path.parent.glob("out/*/lock")]


def test_all_points():
    path = write("all", TWO_AXES + '[[also]]\nflow.capillary_number = 0.1\n[[where]]\nmatch = { "run.seed" = 2 }\nset = { "run.steps" = 401 }\n')
    table = sweep(path, "--dry-run").stdout
    expect(not (path.parent / "out").exists(), "a dry run writes nothing")
    rows = [line.split() for line in table.splitlines()]
    expect(rows[1][0:4] == ["seed1-Ca0.05", "7", "5120", "301"], f"a row tells cells, nodes and steps: {rows[1]}")
    expect("5 points" in table and "5 left" in table and f"{5120 * (3 * 301 + 2 * 401):.4g} node updates" in table, f"totals: {table}")

    out = sweep(path, "--jobs", 2, "--threads", 1).stdout
    names = ["seed1-Ca0.05", "seed1-Ca0.02", "seed2-Ca0.05", "seed2-Ca0.02", "Ca0.1"]
    expect(states(path) == {name: "finished" for name in names}, f"all finished, in the order of the matrix: {states(path)}")
    first = [line.split()[1] for line in out.splitlines() if line.startswith("starting")][:2]
    expect(set(first) == {"seed2-Ca0.05", "seed2-Ca0.02"}, f"the longest begin: {first}")
    run = record(path)["runs"][2]
    expect(run["overrides"] == {"run.seed": 2, "flow.capillary_number": 0.05, "run.steps": 401} and run["directory"] == "seed2-Ca0.05" and run["exit_code"] == 0, f"sweep.json: {run}")
    expect([steps_of(path.parent / "out" / name) for name in names] == [301, 301, 401, 401, 301], "lengths of the runs")
    expect("results in" in (path.parent / "out/logs/Ca0.1.log").read_text(), "a log of each run, outside of its directory")

    subprocess.run([program, "run", path.parent / "base.toml", "--set", "run.seed=2", "--set", "flow.capillary_number=0.02", "--set", "run.steps=401", "--threads", "1",
                    "--output", path.parent / "reference"], capture_output=True, check=True)
    different, compared = differences(path.parent / "reference", path.parent / "out/seed2-Ca0.02")
    expect(compared > 20 and not different, f"a point is what run --set gives: {different}")

    before = {file: file.stat().st_mtime_ns for file in (path.parent / "out").glob("*/*.h5")}
    out = sweep(path).stdout
    expect("all 5 points are through" in out and "start" not in out, f"what has finished is left alone: {out}")
    expect(before == {file: file.stat().st_mtime_ns for file in (path.parent / "out").glob("*/*.h5")}, "files of finished runs aren't touched")


def test_stop_and_kill():
    path = write("stop", TWO_AXES, steps=2001)
    process = begin(path, "--jobs", 2, "--threads", 1)
    refused = sweep(path, check=2)
    expect("another run is writing there" in refused.stderr and f"process {process.pid}" in refused.stderr, f"a second sweep is refused: {refused.stderr}")
    process.send_signal(signal.SIGTERM)
    out, _ = process.communicate(timeout=100)
    expect(process.returncode == 130, f"SIGTERM: exit code {process.returncode}: {out}")
    expect(sorted(states(path).values()) == ["stopped", "stopped", "waiting", "waiting"], f"after SIGTERM: {states(path)}")
    expect(without_runs(path) == [], "no run goes on after the sweep has stopped")
    stopped = [path.parent / "out" / name for name, state in states(path).items() if state == "stopped"]
    expect(all(0 < steps_of(run) < 2001 for run in stopped), "stopped in the middle, with a checkpoint")

    process = subprocess.Popen([program, "sweep", path, "--output", path.parent / "out", "--jobs", "2", "--threads", "1"], stdout=subprocess.PIPE, text=True)
    begun = 0
    while begun < 2:  # two runs at a time
        begun += process.stdout.readline().startswith(("starting", "resuming"))
    time.sleep(0.3)
    process.kill()
    process.communicate()
    expect("running" in states(path).values(), f"SIGKILL leaves the record as it was: {states(path)}")
    out = sweep(path, "--jobs", 2, "--threads", 1).stdout  # at once, while the orphans may still write their checkpoints
    expect(set(states(path).values()) == {"finished"}, f"after SIGKILL all come to their end: {states(path)}: {out}")
    subprocess.run([program, "run", path.parent / "base.toml", "--output", path.parent / "reference", "--threads", "1"], capture_output=True, check=True)
    different, _ = differences(path.parent / "reference", path.parent / "out/seed1-Ca0.05")
    expect(not different, f"bit for bit as if it had never stopped: {different}")


def test_wall_time():
    path = write("wall", TWO_AXES, steps=20001)
    for seconds in (8, 59):  # with the sanitizers nothing has begun after eight
        begun = time.time()
        sweep(path, "--jobs", 2, "--threads", 1, "--wall-time", f"0:00:{seconds:02}", check=75)
        expect(time.time() - begun < seconds + 32, "the wall time is kept")
        if "stopped" in states(path).values():
            break
    expect("stopped" in states(path).values() and not {"running", "failed"} & set(states(path).values()), f"after the wall time: {states(path)}")
    process = subprocess.Popen([program, "sweep", path, "--output", path.parent / "out", "--jobs", "2", "--threads", "1"], stdout=subprocess.PIPE, text=True)
    while not process.stdout.readline().startswith(("starting", "resuming")):
        pass
    process.send_signal(signal.SIGUSR1)
    process.communicate(timeout=100)
    expect(process.returncode == 75, f"SIGUSR1: exit code {process.returncode}")


def test_failed_point():
    path = write("failed", """
scene = "base.toml"
[[axis]]
key = "guards.volume_drift"
values = [0.1, 0.0003]
""")
    out = sweep(path, "--jobs", 1, check=1).stdout
    run = record(path)["runs"][1]
    expect(states(path)["volume_drift0.1"] == "finished", "the others go on")
    expect(run["state"] == "failed" and run["exit_code"] == 3 and "volume" in run["message"], f"its last message is recorded: {run}")
    expect("1 finished, 1 failed, 0 left" in out, f"the end tells: {out}")
    out = sweep(path, check=1).stdout
    expect("start" not in out and "resum" not in out, f"an unstable run isn't tried again: {out}")
    expect(record(path)["runs"][1] == run, "and keeps its record")
    process = subprocess.run([program, "resume", path.parent / "out/volume_drift0.0003", "--set", "guards.volume_drift=0.1", "--threads", "1"], capture_output=True, text=True)
    expect(process.returncode == 0, f"resumed by hand: {process.stderr}")
    sweep(path)
    expect(states(path)["volume_drift0.0003"] == "finished", "what was done by hand counts")

    # A run that is killed, as by the system when memory runs out, is tried again.
    path = write("killed", 'scene = "base.toml"\n[[axis]]\nkey = "run.seed"\nvalues = [1, 2]\n', steps=4001)
    process = begin(path, "--jobs", 2, "--threads", 1)
    holder = (path.parent / "out/seed1/lock").read_text()
    os.kill(int(re.match(r"process (\d+)", holder)[1]), signal.SIGKILL)
    out, _ = process.communicate(timeout=200)
    run = record(path)["runs"][0]
    expect(process.returncode == 1 and run["state"] == "failed" and run["exit_code"] == 137 and "signal 9" in run["message"], f"killed: {run}: {out}")
    sweep(path)
    expect(set(states(path).values()) == {"finished"}, f"resumed: {states(path)}")


def test_changed_sweep():
    path = write("changed", 'scene = "base.toml"\n[[axis]]\nkey = "run.seed"\nvalues = [1, 2]\n')
    sweep(path)
    # Another axis: the names get longer, but the runs that are there keep theirs.
    path = write("changed", TWO_AXES)
    out = sweep(path).stdout
    expect(list(states(path)) == ["seed1", "seed2", "seed1-Ca0.02", "seed2-Ca0.02"] and set(states(path).values()) == {"finished"}, f"points are added: {states(path)}")
    expect(out.count("starting") == 2, f"only these are run: {out}")
    # A base that changed: nothing is mixed.
    scenes = {file: file.read_text() for file in (path.parent / "out/scenes").iterdir()}
    before = record(path)
    path = write("changed", TWO_AXES.replace('"flow.capillary_number"\nvalues = [0.05, 0.02]', '"flow.capillary_number"\nvalues = [0.05, 0.02, 0.1]'), steps=501)
    refused = sweep(path, check=2).stderr
    expect("have begun with other settings" in refused and "seed1-Ca0.02: run.steps = 301 there, 501 now" in refused, f"changed settings are refused: {refused}")
    expect(record(path) == before and scenes == {file: file.read_text() for file in (path.parent / "out/scenes").iterdir()}, "and nothing is written")
    # Fewer points: the others are left as they are.
    path = write("changed", 'scene = "base.toml"\n[[axis]]\nkey = "run.seed"\nvalues = [1]\n')
    out = sweep(path).stdout
    expect("3 runs in" in out and len(states(path)) == 4, f"what is no point any more stays in the record: {out}")
    # Without its record, the runs are taken up again.
    path = write("changed", TWO_AXES.replace("0.05, 0.02", "0.02, 0.05"))
    (path.parent / "out/sweep.json").unlink()
    refused_or_new = sweep(path).stdout
    expect(states(path)["seed1-Ca0.02"] == "finished" and refused_or_new.count("starting") == 2, f"adopted: {states(path)}: {refused_or_new}")
    # Something else in the place of a point isn't overwritten.
    path = write("foreign", 'scene = "base.toml"\n[[axis]]\nkey = "run.seed"\nvalues = [1, 2]\n')
    (path.parent / "out/seed2").mkdir(parents=True)
    (path.parent / "out/seed2/run.h5").write_text("mine")
    refused = sweep(path, check=2).stderr
    expect("seed2: its directory holds files of something else" in refused and (path.parent / "out/seed2/run.h5").read_text() == "mine", f"foreign files: {refused}")


def test_bad_points():
    path = write("bad", TWO_AXES.replace("[0.05, 0.02]", "[0.05, -1, 2000]"))
    refused = sweep(path, check=2).stderr
    for text in ("4 of 6 points can't be run", "seed1-Ca_-1: --set: flow.capillary_number = -1 is out of range", "seed2-Ca2000: "):
        expect(text in refused, f"all bad points are told at once: {text}: {refused}")
    expect(not (path.parent / "out").exists(), "nothing is written")
    refused = sweep(write("bad", TWO_AXES), "--job-array", "--jobs", 2, check=2).stderr
    expect("--jobs has no effect" in refused, f"options that mean nothing are refused: {refused}")
    if os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") < 100 << 30:
        path = write("huge", 'scene = "base.toml"\n[[axis]]\nkey = "box.size"\nvalues = [[4, 4, 5], [300, 300, 300]]\n')
        refused = sweep(path, check=2).stderr
        expect("need more memory" in refused and "size300x300x300: " in refused, f"more memory than there is: {refused}")


def test_job_array():
    text = 'scene = "base.toml"\n[[axis]]\nkey = "run.seed"\nvalues = [1, 2, 3]\n[[where]]\nmatch = { run.seed = 2 }\nset = { run.steps = 100000 }\n'
    path = write("array's", text)  # the shell must cope with the name
    sweep(path, "--job-array", "--wall-time", "0:30:00", "--threads", 1)
    folder = path.parent / "out"
    script = (folder / "job_array.sh").read_text()
    expect("#SBATCH --array=1-3\n" in script and "#SBATCH --time=0:40:00\n" in script and "#SBATCH --cpus-per-task=1\n" in script, script)
    page = (source / "docs/cluster.md").read_text().split("```sh\n")[1].split("```")[0]
    logic = page[page.index("if ls "):]
    expect(script.endswith(logic), "the script of docs/cluster.md ends with the same lines")
    (work / "sbatch").write_text('#!/bin/bash\nprintf "%s\\n" "$@" > "$FOLDER/submitted"\n')
    (work / "sbatch").chmod(0o755)
    environment = {**os.environ, "PATH": f"{work}:{os.environ['PATH']}", "FOLDER": str(work), "SLURM_CPUS_PER_TASK": "1", "WALL_TIME": "00:05:00"}
    names = list(states(path))
    log = folder / f"logs/{names[1]}.log"
    for task in (1, 2, 3, 2):
        submitted = work / "submitted"
        submitted.unlink(missing_ok=True)
        job = subprocess.Popen(["bash", folder / "job_array.sh"], env={**environment, "SLURM_ARRAY_TASK_ID": str(task)}, stderr=subprocess.PIPE, text=True)
        if task == 2:  # is longer, and its time is over
            resumes = (folder / names[1]).exists()
            while job.poll() is None and not ("going on" in log.read_text() if resumes else (folder / names[1] / "checkpoint-b.h5").exists()):
                time.sleep(0.01)
            job.send_signal(signal.SIGUSR1)
        _, error = job.communicate(timeout=200)
        expect(job.returncode == 0, f"task {task}: exit code {job.returncode}: {error}")
        expect(submitted.exists() == (task == 2), f"task {task} submits itself again only when it isn't through")
        if submitted.exists():
            expect(submitted.read_text().splitlines() == ["--export=ALL", f"--array={task}", str(folder / "job_array.sh")], "only itself")
    path = write("array's", text.replace("[1, 2, 3]", "[0, 1, 2, 3, 4]"))
    sweep(path, "--job-array")
    expect(list(states(path).values()) == ["finished", "stopped", "finished", "waiting", "waiting"], f"the record is brought up to date: {states(path)}")
    expect("#SBATCH --array=2,4-5\n" in (folder / "job_array.sh").read_text(), "what is left, and what was added, with the numbers as before")
    expect((folder / "points.txt").read_text().splitlines() == names + ["seed0", "seed4"], "a line for each task")


def main():
    global work
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        wanted = sys.argv[3:]
        for name, test in list(globals().items()):
            if name.startswith("test_") and (not wanted or name in wanted):
                begun = time.time()
                test()
                print(f"{name}: {time.time() - begun:.1f} s", flush=True)
    finish()


if __name__ == "__main__":
    main()
