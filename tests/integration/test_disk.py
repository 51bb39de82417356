"""Full disks, limits on file sizes, read-only and vanished directories: the run ends with exit code 1 (2 when it had not begun) and a
message that says what is kept, and what it names can be read. Arguments: program, source folder."""
import contextlib
import os
import pathlib
import re
import resource
import shutil
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
steps = 10000000
[output]
series_every = 0.002
snapshot_every = 0.01
fluid = true
"""


@contextlib.contextmanager
def small_disk(folder, size="3m"):
    """A tmpfs of that size at `folder`; yields False where this machine doesn't let us mount one."""
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "corpuscle_test", str(folder)], capture_output=True).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", str(folder)], check=True)


def run(folder, *options, **settings):
    return subprocess.run([program, "run", str(work / "scene.toml"), "--output", str(folder), *options],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=300, **settings)


def kept_is_true(answer, folder, name):
    """The message's "up to step N (M samples)" is what h5py finds, and `check` finds nothing worse than that the run ended early."""
    said = re.search(r"up to step (\d+) \((\d+) samples\)", answer.stderr)
    if not said:  # stopped before the first flush
        expect("no sample yet" in answer.stderr, f"{name}: says what is kept: {answer.stderr}")
        return
    with h5py.File(folder / "run.h5", "r") as data:
        steps = data["series/step"][:]
        expect(len(steps) == int(said[2]) and steps[-1] == int(said[1]), f"{name}: {said[0]}, h5py: {len(steps)} samples up to {steps[-1]}")
    with h5py.File(folder / "cells.vtkhdf", "r") as data:
        count = data["VTKHDF/Steps"].attrs["NSteps"]
        points = data["VTKHDF/NumberOfPoints"][0]
        expect(count > 0 and len(data["VTKHDF/Points"][: count * points]) == count * points, f"{name}: {count} whole snapshots")
    check = subprocess.run([program, "check", str(folder)], capture_output=True, text=True, timeout=120)
    bad = [line for line in check.stdout.splitlines() if line.startswith("problem:") and "summary.json: is missing" not in line
           and "the run was stopped between both" not in line]
    expect(not bad, f"{name}: check says {bad}")


with tempfile.TemporaryDirectory() as temporary:
    work = pathlib.Path(temporary)
    (work / "scene.toml").write_text(SCENE)

    # A limit on the size of files, as quotas act: snapshots reach it first.
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
    answer = run(work / "limited", preexec_fn=limit)
    expect(answer.returncode == 1, f"file size limit: exit code {answer.returncode}")
    expect("File too large" in answer.stderr, "file size limit: the reason is named: " + answer.stderr)
    kept_is_true(answer, work / "limited", "file size limit")

    # The directory vanishes under the run.
    process = subprocess.Popen([program, "run", str(work / "scene.toml"), "--output", str(work / "gone")],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    deadline = time.time() + 60
    while not (work / "gone" / "checkpoint-a.h5").exists() and time.time() < deadline:  # from here on the run has begun
        time.sleep(0.05)
    time.sleep(0.5)
    shutil.move(work / "gone", work / "moved")  # one step, unlike the removal of file after file
    shutil.rmtree(work / "moved")
    _, message = process.communicate(timeout=120)
    expect(process.returncode == 1, f"directory removed: exit code {process.returncode}")
    expect("Nothing is left" in message and message.startswith("error: "), "directory removed: " + message)

    # A small disk fills up; then it is read-only.
    with small_disk(work / "disk") as mounted:
        if not mounted:
            print("SKIPPED: full and read-only disks, as file systems can't be mounted here")
        else:
            folder = work / "disk" / "results"
            answer = run(folder)
            expect(answer.returncode == 1, f"full disk: exit code {answer.returncode}")
            expect("No space left" in answer.stderr, "full disk: the reason is named: " + answer.stderr)
            kept_is_true(answer, folder, "full disk")

            # Old results survive an --overwrite for which there is no room.
            before = {path.name: path.read_bytes() for path in folder.iterdir()}
            free = shutil.disk_usage(work / "disk").free
            (work / "disk" / "ballast").write_bytes(b"x" * max(0, free - 4096))
            answer = run(folder, "--overwrite")
            expect(answer.returncode == 2, f"overwrite without room: exit code {answer.returncode}: {answer.stderr}")
            after = {path.name: path.read_bytes() for path in folder.iterdir()}
            expect(after == before, f"overwrite without room: the old results are as before: {sorted(after)} {sorted(before)}")

            subprocess.run(["mount", "-o", "remount,ro", str(work / "disk")], check=True)
            for target in (folder, work / "disk" / "other"):
                answer = run(target, "--overwrite")
                expect(answer.returncode == 2 and answer.stderr.startswith("error: "), f"read-only disk: {answer.returncode} {answer.stderr}")
            expect({path.name: path.read_bytes() for path in folder.iterdir()} == before, "read-only disk: the old results are as before")

    if os.getuid() != 0:
        (work / "locked").mkdir(mode=0o555)
        answer = run(work / "locked" / "results")
        expect(answer.returncode == 2 and "permission" in answer.stderr, "read-only directory: " + answer.stderr)

finish()
print("every fault of the disk ended in order")
