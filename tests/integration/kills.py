"""A run that is killed (SIGKILL) again and again and resumed gives the same files as one that never stopped.
As a program: kills.py PROGRAM [--kills N]; test_resume.py has a few."""
import argparse
import pathlib
import random
import signal
import subprocess
import tempfile
import time

import h5py
import numpy as np

# Small, and busy with writing: a sample every few steps, snapshots, checkpoints.
SCENE = """
[box]
size = [4, 4, 5]
[flow]
capillary_number = 0.05
[[cells]]
count = 5
[[cells]]
shape = "sphere"
relative_radius = 0.6
count = 2
[accuracy]
radius = 4
relaxation_time = 1.0
[run]
steps = {steps}
[output]
series_every = 0.01
snapshot_every = 0.05
fluid = true
statistics = true
checkpoint_steps = {checkpoint_steps}
"""
FILES = ("run.h5", "cells.vtkhdf", "fluid.vtkhdf")


def datasets(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        if path.name == "run.h5":
            found["scene"], found["steps"] = np.array(file.attrs["scene"]), np.array(file["lattice"].attrs["steps"])
        else:
            found["NSteps"] = np.array(file["VTKHDF/Steps"].attrs["NSteps"])
    return found


def differences(a, b, files=FILES):
    """Names of the datasets that are not equal bit for bit in the directories of two runs, and how many were compared."""
    different, compared = [], 0
    for file in files:
        x, y = datasets(a / file), datasets(b / file)
        assert x.keys() == y.keys(), f"{file}: other datasets: {x.keys() ^ y.keys()}"
        for name in x:
            compared += 1
            u, v = x[name], y[name]
            if not (u.shape == v.shape and u.dtype == v.dtype and np.array_equal(u, v, equal_nan=u.dtype.kind == "f")):
                different.append(f"{file}:{name}")
    return different, compared


def command(program, *arguments, check=0):
    result = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if result.returncode != check:
        raise AssertionError(f"{arguments}: exit {result.returncode}: {result.stderr}")
    return result


def start(program, scene, output):
    """Begins a run and waits until it can be resumed."""
    process = subprocess.Popen([program, "run", scene, "--output", output, "--threads", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (output / "checkpoint-a.h5").exists():
        time.sleep(0.005)
    return process


def kill_and_resume(program, scene, output, kills, rng, longest):
    """Kills the run after random times, and resumes with one or two threads, until it has been killed so often or is through; then lets it finish.
    Returns how often it was killed, and after how many kills all files could be read at once."""
    process = start(program, scene, output)
    killed = readable = 0
    while True:
        try:
            process.wait(rng.uniform(0, longest))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            killed += 1
            readable += all(can_be_read(output / name) for name in FILES)
        else:
            assert process.returncode == 0, process.stderr.read()
        process.stderr.close()
        if process.returncode == 0 or killed == kills:
            break
        threads = str(rng.choice((1, 2)))
        process = subprocess.Popen([program, "resume", output, "--threads", threads], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    command(program, "resume", output)
    return killed, readable


def can_be_read(path):
    """Whether another program can read the file as the kill left it."""
    try:
        datasets(path)
    except (OSError, RuntimeError, KeyError):
        return False
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--steps", type=int, default=4001)
    parser.add_argument("--checkpoint-steps", type=int, default=61)
    parser.add_argument("--longest", type=float, default=0.8, help="seconds from a start to a kill, at most")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.toml").write_text(SCENE.format(steps=options.steps, checkpoint_steps=options.checkpoint_steps))
        begin = time.time()
        command(options.program, "run", folder / "scene.toml", "--output", folder / "reference", "--threads", "1")
        print(f"without interruption: {time.time() - begin:.1f} s", flush=True)
        rng, killed, readable, rounds = random.Random(options.seed), 0, 0, 0
        while killed < options.kills:
            rounds += 1
            output = folder / f"killed{rounds}"
            k, r = kill_and_resume(options.program, folder / "scene.toml", output, options.kills - killed, rng, options.longest)
            killed, readable = killed + k, readable + r
            different, compared = differences(folder / "reference", output)
            print(f"run {rounds}: killed {k} times, {compared} datasets compared, different: {different or 'none'}", flush=True)
            assert not different
        print(f"{killed} kills in {rounds} runs; after {readable} of them all files could be read as they were")


if __name__ == "__main__":
    main()
