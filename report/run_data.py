"""Reads the output folder of a run: run.h5, summary.json and cells.vtkhdf (docs/outputs.md)."""
import json
import pathlib
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy h5py matplotlib 'vtk>=9.4'")


class RunData:
    """The scalars and series of one run. Missing files leave their part empty.

    lattice: attributes of /lattice; series: arrays [T, ...] by name; summary: the dictionary of summary.json.
    """

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.lattice, self.series, self.summary = {}, {}, {}
        if not self.folder.is_dir():
            sys.exit(f"{self.folder} is no folder. Give the output folder of a run.")
        if (self.folder / "run.h5").exists():
            with h5py.File(self.folder / "run.h5", "r") as file:
                self.lattice = dict(file["lattice"].attrs)
                self.series = {name: data[()] for name, data in file["series"].items()}
            rows = min(len(values) for values in self.series.values())  # a file read in the middle of a flush
            self.series = {name: values[:rows] for name, values in self.series.items()}
        if (self.folder / "summary.json").exists():
            self.summary = json.loads((self.folder / "summary.json").read_text())

    def file(self, name):
        """Path of an output file; ends the program with a message when it isn't there."""
        path = self.folder / name
        if not path.exists():
            sys.exit(f"{path} does not exist. The scene must ask for it (docs/outputs.md says which key).")
        return path

    def numbers(self):
        """Title text with what identifies the run: volume fraction and capillary number."""
        parts = []
        if self.lattice.get("phi_geometric", 0) > 0:
            parts.append(rf"$\phi$ = {self.lattice['phi_geometric']:.3g}")
        if self.lattice.get("capillary_number", 0) > 0:
            parts.append(f"Ca = {self.lattice['capillary_number']:.3g}")
        return parts


def snapshot_group(path):
    """Box [3], radius and whether there are walls, of a cells.vtkhdf; the times of its snapshots."""
    with h5py.File(path, "r") as file:
        attributes = file["corpuscle"].attrs
        steps = int(file["VTKHDF/Steps"].attrs["NSteps"])
        return (np.array(attributes["box"]), float(attributes["radius"]), bool(attributes["walls"]),
                file["VTKHDF/Steps/Values"][:steps])
