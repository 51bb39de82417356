"""Runs scenes for the validation, each once: results stay in a work folder, named by the scene's text and the program's sources."""

import hashlib
import json
import os
import pathlib
import subprocess
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor

import h5py
import numpy as np

ROOMS = ("core", "kernels", "physics", "io", "app")  # what a result depends on


def toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml_value(v)}" for k, v in value.items()) + " }"
    return repr(value)


def scene(cells=(), **sections):
    """Text of a scene: every section a dictionary, `cells` a list of them. Keys and units: docs/scene.md."""
    lines = []
    for name, section in sections.items():
        lines += [f"[{name}]"] + [f"{k} = {toml_value(v)}" for k, v in section.items()] + [""]
    for cell in cells:
        lines += ["[[cells]]"] + [f"{k} = {toml_value(v)}" for k, v in cell.items()] + [""]
    return "\n".join(lines)


def stokes_accuracy(radius, kernel, tau, **others):
    """[accuracy] of a case in creeping flow: TRT, whose stationary flow does not depend on tau, so that a large tau saves steps."""
    return {"radius": radius, "delta_kernel": kernel, "collision": "trt", "relaxation_time": tau, "precision": "single", "mach_max": 0.3} | others


class Result:
    """What one run wrote (docs/outputs.md)."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.seconds = self.summary["wall_seconds"]
        with h5py.File(self.folder / "run.h5") as file:
            self.lattice = dict(file["lattice"].attrs)
            self.cell_type = dict(file["lattice/cell_types/0"].attrs) if "lattice/cell_types/0" in file else {}

    def series(self, name):
        with h5py.File(self.folder / "run.h5") as file:
            return file["series/" + name][:]

    def cells(self, name):
        with h5py.File(self.folder / "run.h5") as file:
            return file["cells/" + name][:]

    def vertices(self):
        """Strain [S] of the snapshots and positions [S, vertices, 3] of all vertices, in lattice units."""
        with h5py.File(self.folder / "cells.vtkhdf") as file:
            root = file["VTKHDF"]
            times = root["Steps/Values"][:]
            points = root["Points"][:].astype(float)
        return times, points.reshape(len(times), -1, 3)


class Simulations:
    """A pool of single-threaded runs: small boxes gain more from two runs at a time than from two threads a run."""

    def __init__(self, program, source, folder, jobs=2, log=print):
        self.program, self.folder, self.log = str(program), pathlib.Path(folder), log
        self.folder.mkdir(parents=True, exist_ok=True)
        self.revision = self._revision(pathlib.Path(source))
        self._pool = ThreadPoolExecutor(jobs)
        self._futures, self._lock, self._running, self._stopped = {}, threading.Lock(), set(), False

    @staticmethod
    def _revision(source):
        digest = hashlib.sha256()
        for room in ROOMS:
            for path in sorted((source / room).rglob("*.[ch]pp")):
                digest.update(path.read_bytes())
        return digest.hexdigest()[:12]

    def all(self, scenes):
        """Runs the scenes (name -> text) that have no result yet, and returns name -> Result. Names show up in the progress only."""
        futures = {name: self._submit(name, text) for name, text in scenes.items()}
        return {name: future.result() for name, future in futures.items()}

    def _submit(self, name, text):
        key = hashlib.sha256((self.revision + text).encode()).hexdigest()[:16]
        with self._lock:
            if key not in self._futures:
                folder = self.folder / key
                if (folder / "complete").exists():
                    self._futures[key] = future = Future()
                    future.set_result(Result(folder))
                else:
                    self._futures[key] = self._pool.submit(self._simulate, str(name), text, folder)
            return self._futures[key]

    def _simulate(self, name, text, folder):
        if self._stopped:
            raise RuntimeError("stopped")
        folder.mkdir(exist_ok=True)
        (folder / "asked.toml").write_text(f"# {name}\n{text}")
        begin = time.monotonic()
        command = [self.program, "run", str(folder / "asked.toml"), "--output", str(folder / "run"), "--overwrite", "--threads", "1"]
        with open(folder / "log.txt", "w") as log:
            process = subprocess.Popen(
                command, stdout=log, stderr=subprocess.STDOUT, env={**os.environ, "OMP_NUM_THREADS": "1", "OMP_PROC_BIND": "false"}
            )
            self._running.add(process)
            code = process.wait()
            self._running.discard(process)
        if code != 0:
            last = (folder / "log.txt").read_text().strip().splitlines()[-1:]
            raise RuntimeError(f"{name}: exit code {code}: {' '.join(last)} ({folder})")
        for path in (folder / "run").iterdir():
            path.replace(folder / path.name)
        (folder / "run").rmdir()
        (folder / "complete").touch()
        self.log(f"  {time.monotonic() - begin:7.1f} s  {name}")
        return Result(folder)

    def total_seconds(self):
        """Run time of all simulations that were asked for, in core seconds."""
        return seconds([future.result() for future in self._futures.values() if future.done() and not future.exception()])

    def stop(self):
        """Ends the runs under way; what they have not finished is run again the next time."""
        self._stopped = True
        for process in list(self._running):
            process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)


def seconds(results):
    """Run time of the given results together, in core seconds."""
    return sum(result.seconds for result in (results.values() if isinstance(results, dict) else results))


def steady_mean(values, strain, after):
    """Mean of the part with strain > after, and half of the drift between its two halves as its error."""
    part = np.asarray(values)[np.asarray(strain) > after]
    half = len(part) // 2
    return part.mean(), abs(part[half:].mean() - part[:half].mean()) / 2
