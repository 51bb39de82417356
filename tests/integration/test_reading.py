"""Reading a run while it goes on: run.h5 and cells.vtkhdf are opened with h5py again and again beside a run that writes many times a second.
What is seen is whole and grows, unless the file was changed while it was open: then parts of the old and the new state may be seen, and the file is opened
again, as docs/outputs.md says. Arguments: PROGRAM SOURCE-FOLDER [SECONDS]: so long rather than 250 opens of each file, to measure how often that is."""
import pathlib
import signal
import sys
import tempfile
import time

import h5py
import numpy as np

from kills import SCENE, start

OPENS, SETTLED = 250, 0.02  # s: file systems keep the time of a change with the precision of a tick of the kernel, up to 10 ms


class Mixed(Exception):
    """What was read doesn't fit together."""


def require(condition, what):
    if not condition:
        raise Mixed(what)


def read_run(path):
    """All of run.h5, each row with its step; the number of samples and what must not change any more."""
    with h5py.File(path, "r") as file:
        data = {f"{group}/{name}": dataset[()] for group in ("series", "cells") for name, dataset in file[group].items()
                if name not in ("type", "type_names")}
        every = file["lattice"].attrs["series_every"]
    rows = {name: len(values) for name, values in data.items()}
    require(len(set(rows.values())) == 1, f"datasets of unequal length: {rows}")
    require(np.array_equal(data["series/step"], every * np.arange(len(data["series/step"]))), f"steps {data['series/step'][-3:]}")
    require((data["cells/volume"] > 0).all(), "a cell without volume")
    return rows["series/step"], [data["series/step"], data["series/strain"], data["cells/centre"]]


def read_cells(path):
    """All of cells.vtkhdf."""
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        snapshots, points = int(root["Steps"].attrs["NSteps"]), int(root["NumberOfPoints"][0])
        data = {name: root[name][()] for name in ("Points", "PointData/velocity", "PointData/deformation")}
        offsets = {name: root["Steps"][name][()] for name in ("Values", "PartOffsets", "PointOffsets", "CellOffsets", "PointDataOffsets/velocity")}
    rows = {name: len(values) / points for name, values in data.items()} | {name: len(values) for name, values in offsets.items()}
    require(set(rows.values()) == {snapshots}, f"{snapshots} snapshots, but datasets of unequal length: {rows}")
    require(np.array_equal(offsets["PointOffsets"], points * np.arange(snapshots)), f"offsets {offsets['PointOffsets'][-3:]}")
    require((np.diff(offsets["Values"]) > 0).all(), f"times {offsets['Values'][-3:]}")
    require((np.ptp(data["Points"].reshape(snapshots, points, 3), axis=1) > 1).all(), "a snapshot whose points lie in one place")
    return snapshots, [offsets["Values"], data["Points"]]


class Watch:
    """Opens one file repeatedly and counts what was seen."""

    def __init__(self, path, read):
        self.path, self.read = path, read
        self.opens = self.changed = self.most_tries = self.states = 0
        self.faults, self.seen, self.open_seconds = [], None, 0.0

    def state(self):
        """Differs when the file is changed; None while that may not show yet."""
        status = self.path.stat()
        settled = time.time() - status.st_mtime > SETTLED and not self.path.with_name(self.path.name + ".journal").exists()
        return (status.st_mtime_ns, status.st_size) if settled else None

    def look(self):
        """One consistent state of the file, opened as often as that takes."""
        for tries in range(1, 50):
            before, begin = self.state(), time.perf_counter()
            try:
                rows, fixed = self.read(self.path)
                self.compare(rows, fixed)
                fault = None
            except (OSError, RuntimeError, KeyError, ValueError, IndexError, Mixed) as error:
                fault = f"{type(error).__name__}: {error}"
            self.open_seconds += time.perf_counter() - begin
            self.opens += 1
            changed = before is None or before != self.state()
            self.changed += changed
            if fault is None:
                self.most_tries = max(self.most_tries, tries)
                if self.seen is None or rows > len(self.seen[0]):
                    self.states, self.seen = self.states + 1, fixed
                return
            assert changed, f"{self.path.name} was not changed while it was open, and yet: {fault}"
            self.faults.append(fault)
        raise AssertionError(f"{self.path.name}: no consistent state in {tries} tries: {self.faults[-5:]}")

    def compare(self, rows, fixed):
        if self.seen is None:
            return
        # What has been seen in a consistent state stays.
        require(rows >= len(self.seen[0]), f"{rows} rows after {len(self.seen[0])}")
        for old, new in zip(self.seen, fixed):
            require(np.array_equal(old, new[:len(old)]), "rows that were read before have changed")

    def report(self):
        kinds = {fault.split(":")[0] for fault in self.faults}
        print(f"{self.path.name}: {self.opens} opens, {1e3 * self.open_seconds / self.opens:.1f} ms each, of {self.states} growing states; the file was or may "
              f"have been changed during {self.changed}; {len(self.faults)} of these saw parts of two states ({', '.join(sorted(kinds)) or 'none'}), "
              f"{self.most_tries} opens in a row at most for a whole one", flush=True)
        for fault in self.faults[:3]:
            print("   ", fault[:200])


def main():
    program, seconds = sys.argv[1], float(sys.argv[3]) if len(sys.argv) > 3 else 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        # Every checkpoint flushes run.h5; snapshots are written one by one.
        (folder / "scene.toml").write_text(SCENE.format(steps=100_000_000, checkpoint_steps=40))
        output = folder / "run"
        process = start(program, folder / "scene.toml", output)
        watches = [Watch(output / "run.h5", read_run), Watch(output / "cells.vtkhdf", read_cells)]
        begin = time.time()
        try:
            while time.time() - begin < seconds if seconds else min(w.opens for w in watches) < OPENS or min(w.states for w in watches) < 20:
                assert process.poll() is None, f"the run ended: {process.stderr.read()}"
                for watch in watches:
                    watch.look()
        finally:
            process.send_signal(signal.SIGTERM)
            code = process.wait(timeout=60)
            process.stderr.close()
        assert code == 130, code
        for watch in watches:
            watch.report()


if __name__ == "__main__":
    main()
