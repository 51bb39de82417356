"""The same bits for any number of threads: runs a small suspension with 1, 2 and 4 threads, with each vertex update, and compares every dataset."""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SCENE = """
[box]
size = [5, 5, 6]
[flow]
capillary_number = 0.05
[[cells]]
count = 12
[[cells]]
shape = "sphere"
relative_radius = 0.6
count = 5
[accuracy]
radius = 4
delta_kernel = 4
collision = "trt"
[run]
strain = 0.3
[output]
series_every = 0.05
snapshot_every = 0.1
fluid = true
"""


def datasets(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def compare(program, folder, update):
    results = {}
    for threads in (1, 2, 4):
        output = folder / f"{update}{threads}"
        subprocess.run([program, "run", folder / "scene.toml", "--output", output, "--threads", str(threads), "--set", f"accuracy.vertex_update={update}"],
                       check=True, stdout=subprocess.DEVNULL)
        results[threads] = {name: datasets(output / name) for name in ("run.h5", "packing.h5", "cells.vtkhdf", "fluid.vtkhdf")}
    compared = 0
    for threads in (2, 4):
        for file, reference in results[1].items():
            other = results[threads][file]
            assert reference.keys() == other.keys(), f"{file}: other datasets with {threads} threads"
            for name, values in reference.items():
                equal = np.array_equal(values, other[name], equal_nan=values.dtype.kind == "f")
                assert equal, f"{update}: {file}:{name} differs between 1 and {threads} threads"
                compared += 1
    assert compared > 60, compared
    centres = results[1]["run.h5"]["cells/centre"]
    assert np.abs(centres[-1] - centres[0]).max() > 0.1, "nothing moved: the comparison would be empty"
    return compared


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.toml").write_text(SCENE)
        compared = sum(compare(program, folder, update) for update in ("averaged", "chebyshev"))
        print(f"{compared} datasets are equal bit for bit")


if __name__ == "__main__":
    main()
