"""Runs a tiny scene and reads its output back with VTK and h5py: PROGRAM SOURCE-FOLDER. Exit 77: the Python modules are missing."""
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"skipped: {error} (needs numpy, h5py, vtk)")
    sys.exit(77)

SCENE = """
[box]
size = [6, 6, 6]
[flow]
capillary_number = 0.1
[[cells]]
shape = "sphere"
count = 2
[accuracy]
radius = 4
[run]
strain = 0.2
[output]
series_every = 0.05
snapshot_every = 0.1
fluid = true
"""


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def steps_of(path):
    """Yields (time, data object) for every step that VTK sees in a VTKHDF file."""
    reader = vtk.vtkHDFReader()
    check(reader.CanReadFile(str(path)), f"VTK can't read {path.name}")
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    check(times is not None, f"{path.name} has no time steps")
    for time in times:
        reader.UpdateTimeStep(time)
        data = reader.GetOutputDataObject(0).NewInstance()
        data.DeepCopy(reader.GetOutputDataObject(0))
        yield time, data


def volume_of(surface, cell):
    """Enclosed volume of one cell of the surface by vtkMassProperties; checks that the cell is closed."""
    surface.GetPointData().SetActiveScalars("cell_id")
    one = vtk.vtkThreshold()
    one.SetInputData(surface)
    one.SetLowerThreshold(cell)
    one.SetUpperThreshold(cell)
    one.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_BETWEEN)
    shell = vtk.vtkGeometryFilter()
    shell.SetInputConnection(one.GetOutputPort())
    edges = vtk.vtkFeatureEdges()
    edges.SetInputConnection(shell.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    check(edges.GetOutput().GetNumberOfCells() == 0, f"the surface of cell {cell} is not closed")
    mass = vtk.vtkMassProperties()
    mass.SetInputConnection(shell.GetOutputPort())
    mass.Update()
    return mass.GetVolume()


def check_cells(path, run):
    """Every snapshot against run.h5."""
    box = np.array(run["lattice"].attrs["nodes"], dtype=float)
    kind = run["lattice/cell_types/0"].attrs
    count, vertices, faces = int(kind["count"]), int(kind["vertices"]), int(kind["faces"])
    radius, largest = float(kind["radius"]), 0.0
    strains, volumes, centres = run["series/strain"][()], run["cells/volume"][()], run["cells/centre"][()]
    strain_per_step = float(run["lattice"].attrs["shear_rate"])
    snapshots, compared = 0, 0
    for time, surface in steps_of(path):
        snapshots += 1
        check(surface.GetClassName() == "vtkPolyData", "cells.vtkhdf is not PolyData")
        check(surface.GetNumberOfPoints() == count * vertices, f"{surface.GetNumberOfPoints()} points")
        check(surface.GetNumberOfPolys() == count * faces, f"{surface.GetNumberOfPolys()} polygons")
        check(surface.GetNumberOfCells() == count * faces, "other cells than polygons")
        points = vtk_to_numpy(surface.GetPoints().GetData()).reshape(count, vertices, 3)
        check((points.min(axis=(0, 1)) > -1.5 * radius).all() and (points.max(axis=(0, 1)) < box + 1.5 * radius).all(), "cells outside the box")
        check(points[..., 2].min() > 0 and points[..., 2].max() < box[2], "vertices beyond a wall")
        data = surface.GetPointData()
        check((vtk_to_numpy(data.GetArray("cell_id")).reshape(count, vertices) == np.arange(count)[:, None]).all(), "cell_id")
        check((vtk_to_numpy(data.GetArray("type")) == 0).all(), "type")
        deformation = vtk_to_numpy(data.GetArray("deformation"))
        check((deformation >= -1e-6).all() and (deformation < 1).all(), "deformation out of range")
        velocity = vtk_to_numpy(data.GetArray("velocity"))
        check(velocity.shape == (count * vertices, 3) and np.isfinite(velocity).all(), "velocity")
        largest = max(largest, np.linalg.norm(velocity, axis=1).max())
        row = np.argmin(abs(strains - time))
        if abs(strains[row] - time) > 1.5 * strain_per_step:
            continue  # the last snapshot may come after the last sample
        compared += 1
        for cell in range(count):
            expected = volumes[row, cell]
            found = volume_of(surface, cell)
            check(abs(found / expected - 1) < 1e-3, f"volume of cell {cell} at strain {time}: {found} in VTK, {expected} in run.h5")
            shift = (points[cell].mean(axis=0) - centres[row, cell]) / box  # whole box lengths, along x and y only
            check(abs(shift - np.round(shift)).max() < 0.05 and round(shift[2]) == 0, f"centre of cell {cell} at strain {time}")
    check(snapshots == 3, f"{snapshots} snapshots instead of 3 (strain 0, 0.1, 0.2)")
    check(compared >= 2, "samples and snapshots are never taken at the same strain")
    check(largest > 0, "nothing moves")


def check_fluid(path, run):
    nodes = tuple(int(n) for n in run["lattice"].attrs["nodes"])
    wall = float(run["lattice"].attrs["wall_velocity"])
    snapshots = 0
    for _, image in steps_of(path):
        snapshots += 1
        check(image.GetDimensions() == nodes, f"fluid.vtkhdf has {image.GetDimensions()} nodes, the lattice {nodes}")
        check(image.GetOrigin() == (0.5, 0.5, 0.5), "origin")
        velocity = vtk_to_numpy(image.GetPointData().GetArray("velocity")).reshape(nodes[2], nodes[1], nodes[0], 3)
        check(np.isfinite(velocity).all() and abs(velocity).max() < 1.5 * wall, "fluid velocity out of range")
        profile = velocity[..., 0].mean(axis=(1, 2))
        check(profile[0] < -0.5 * wall and profile[-1] > 0.5 * wall, "the fluid doesn't follow the walls")
    check(snapshots == 3, f"{snapshots} fluid snapshots")


def check_run_file(run, summary, documentation):
    series = run["series"]
    steps = series["step"][()]
    check(len(steps) in (4, 5), f"{len(steps)} samples instead of 4 or 5 (strain 0, 0.05, 0.1, 0.15, perhaps 0.2)")
    check((np.diff(steps) > 0).all(), "steps don't increase")
    for attribute in ("scene", "version", "git_revision", "cpu_model", "cores", "operating_system", "kokkos_configuration"):
        check(attribute in run.attrs, f"run.h5 lacks the attribute {attribute}")
        check(f"`{attribute}`" in documentation, f"docs/outputs.md doesn't name {attribute}")
    check("capillary_number" in run.attrs["scene"], "the stored scene is not the merged scene")
    names = []
    run.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    for name in names:
        check(f"`/{name}`" in documentation, f"docs/outputs.md doesn't name /{name}")
        check(run[name].attrs["unit"] != "" and run[name].attrs["description"] != "", f"/{name} has no unit or description")
    for name, data in series.items():
        check(len(data) == len(steps), f"/series/{name} has {len(data)} rows, step {len(steps)}")
    for name, data in run["cells"].items():
        check(name in ("type", "type_names") or data.shape[:2] == (len(steps), 2), f"/cells/{name} has the shape {data.shape}")
    # The deviatoric part of the sum of the cells' stresslets is the particle stress.
    volume = np.prod([float(n) for n in run["lattice"].attrs["nodes"]])
    total = run["cells/stresslet"][()].sum(axis=1) / volume
    stress = series["particle_stress"][()]
    scale = abs(stress).max()
    check(np.allclose(total[:, 0, 2], stress[:, 0, 2], atol=1e-6 * scale), "particle_stress differs from the cells' stresslets")
    for key in summary:
        check(f"`{key}`" in documentation, f"docs/outputs.md doesn't name {key} of summary.json")
    check(summary["cell_count"] == 2 and summary["stopped_by"] == "end", "summary.json")


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    documentation = (source / "docs" / "outputs.md").read_text()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.toml").write_text(SCENE)
        output = folder / "out"
        finished = subprocess.run([program, "run", str(folder / "scene.toml"), "--output", str(output)], capture_output=True, text=True)
        check(finished.returncode == 0, f"corpuscle ended with {finished.returncode}:\n{finished.stdout}\n{finished.stderr}")
        check("\x1b" not in finished.stdout and "\r" not in finished.stdout, "escape codes although the output is no terminal")
        with h5py.File(output / "run.h5", "r") as run:
            check_run_file(run, json.loads((output / "summary.json").read_text()), documentation)
            check_cells(output / "cells.vtkhdf", run)
            check_fluid(output / "fluid.vtkhdf", run)
    print("ok")


if __name__ == "__main__":
    main()
