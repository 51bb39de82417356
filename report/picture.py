#!/usr/bin/env python3
"""Renders the cells of one snapshot of a run to a PNG, without a display.

    python report/picture.py DIR [--step N] [--color velocity|deformation|cell] [--output PNG]

DIR is the output folder of `corpuscle run`; it must hold cells.vtkhdf (docs/outputs.md).
Needs: pip install 'vtk>=9.4' numpy h5py matplotlib (vtk 9.3 does too where there is a display).
"""
import argparse
import os
import sys

from run_data import RunData, snapshot_group

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy h5py matplotlib 'vtk>=9.4'")

# Okabe and Ito's palette: told apart by colour-blind readers.
CELL_COLOURS = ["#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7"]
INK = "#222222"


def read_snapshot(path, step):
    """vtkPolyData of snapshot `step` (0 ...) and its time."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    reader.UpdateTimeStep(times[step])
    surface = vtk.vtkPolyData()
    surface.DeepCopy(reader.GetOutputDataObject(0))
    return surface, times[step]


def colour_surface(surface, choice, data):
    """Gives every point its colour; returns (colour map name, limits, label) for the colour bar, None without one."""
    points = surface.GetPointData()
    if choice == "cell":
        palette = np.array([matplotlib.colors.to_rgb(c) for c in CELL_COLOURS])
        rgb = palette[vtk_to_numpy(points.GetArray("cell_id")) % len(palette)]
        bar = None
    else:
        if choice == "velocity":
            scale = data.lattice.get("shear_rate", 0) * data.lattice.get("radius", 0)
            values = vtk_to_numpy(points.GetArray("velocity"))[:, 0] / (scale or 1)
            label = r"velocity along the flow, $u_x/(\dot\gamma r)$" if scale else r"velocity $u_x$  [$\Delta x/\Delta t$]"
            largest = max(np.abs(values).max(), 1e-30)
            bar = ("RdYlBu_r", (-largest, largest), label)
        else:
            values = vtk_to_numpy(points.GetArray("deformation"))
            bar = ("viridis", (values.min(), max(values.max(), values.min() + 1e-3)), "deformation $D = (L-B)/(L+B)$")
        rgb = matplotlib.colormaps[bar[0]](plt.Normalize(*bar[1])(values))[:, :3]
    colours = numpy_to_vtk(np.ascontiguousarray(255 * rgb).astype(np.uint8), deep=True)
    colours.SetName("colour")
    points.SetScalars(colours)
    return bar


def actor_of(source, colour, opacity=1.0, lighting=True, width=1.0):
    """A vtkActor of an algorithm's output in one colour."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*matplotlib.colors.to_rgb(colour))
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetLighting(lighting)
    actor.GetProperty().SetLineWidth(width)
    return actor


def cell_actor(surface):
    """The cells with smooth shading: point normals, no splitting of edges (a cell's surface is smooth)."""
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SplittingOff()
    normals.ConsistencyOff()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    shine = actor.GetProperty()
    shine.SetInterpolationToPhong()
    shine.SetAmbient(0.25)
    shine.SetDiffuse(0.85)
    shine.SetSpecular(0.22)
    shine.SetSpecularPower(28)
    return actor


def box_actors(box, walls):
    """Outline of the box and, where there are walls, two translucent planes."""
    outline = vtk.vtkOutlineSource()
    outline.SetBounds(0, box[0], 0, box[1], 0, box[2])
    actors = [actor_of(outline, "#777777", lighting=False, width=2.0)]
    if walls:
        for z in (0.0, box[2]):
            plane = vtk.vtkPlaneSource()
            plane.SetOrigin(0, 0, z)
            plane.SetPoint1(box[0], 0, z)
            plane.SetPoint2(0, box[1], z)
            actors.append(actor_of(plane, "#5B7C99", opacity=0.28, lighting=False))
    return actors


def shear_arrows(box, radius):
    """Arrows along the motion of the walls, outside the box; returns actors and (tip, middle, sign) of each in box coordinates."""
    length = min(0.45 * box[0], 6 * radius)
    unit = min(radius, length / 5)  # thickness and distance; small in a box that hardly holds one cell
    actors, places = [], []
    # The camera looks from the front and from above: the upper arrow is clear of the box at the back, the lower one at the front.
    for y, z, sign in ((box[1], box[2] + 0.7 * unit, 1), (0.0, -0.8 * unit, -1)):
        source = vtk.vtkArrowSource()
        source.SetShaftRadius(0.09 * unit / length)
        source.SetTipRadius(0.26 * unit / length)
        source.SetTipLength(0.95 * unit / length)
        source.SetTipResolution(48)
        source.SetShaftResolution(32)
        place = vtk.vtkTransform()
        place.Translate(box[0] / 2 - sign * length / 2, y, z)
        place.Scale(sign * length, length, length)
        moved = vtk.vtkTransformFilter()
        moved.SetInputConnection(source.GetOutputPort())
        moved.SetTransform(place)
        actors.append(actor_of(moved, INK, lighting=False))
        places.append((np.array([box[0] / 2 + sign * (length / 2 + 0.4 * unit), y, z]), sign))
    return actors, places


def set_camera(renderer, points, centre, aspect):
    """Looks along y, a little from above and from the right, so near that `points` [n][3] fill the view."""
    camera = renderer.GetActiveCamera()
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(18)
    back = np.array([0.42, -1.0, 0.30])
    back /= np.linalg.norm(back)  # from the scene to the camera
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    tangent = 0.97 * np.tan(np.radians(camera.GetViewAngle() / 2))
    focus = centre.copy()
    for _ in range(10):  # perspective: the view's middle and its distance depend on each other
        x, y, z = ((points - focus) @ axis for axis in (right, up, back))
        distance = max((np.abs(y) / tangent + z).max(), (np.abs(x) / (tangent * aspect) + z).max())
        x, y = x / (distance - z), y / (distance - z)
        focus = focus + distance / 2 * (right * (x.max() + x.min()) + up * (y.max() + y.min()))
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + back * distance))
    renderer.ResetCameraClippingRange()


def set_lights(renderer):
    """A warm key light from the upper left, a cool fill from the right, a weak one from below."""
    renderer.RemoveAllLights()
    renderer.AutomaticLightCreationOff()
    for position, colour, strength in (((-0.9, 1.1, 1.0), "#FFF8EE", 0.78), ((1.2, 0.1, 0.8), "#EAF2FF", 0.34), ((0.1, -0.8, 1), "#FFFFFF", 0.30)):
        light = vtk.vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*position)
        light.SetFocalPoint(0, 0, 0)
        light.SetColor(*matplotlib.colors.to_rgb(colour))
        light.SetIntensity(strength)
        renderer.AddLight(light)


def add_occlusion(renderer, radius):
    """Darkens the gaps between cells (screen-space ambient occlusion), which is what shows their depth."""
    occlusion = vtk.vtkSSAOPass()
    occlusion.SetDelegatePass(vtk.vtkRenderStepsPass())
    occlusion.SetRadius(1.2 * radius)
    occlusion.SetBias(0.03 * radius)
    occlusion.SetKernelSize(96)
    occlusion.BlurOn()
    renderer.SetPass(occlusion)


def new_window():
    """An off-screen window: without a display VTK falls back to EGL or software, and need not say so."""
    version = vtk.vtkVersion()
    if not os.environ.get("DISPLAY") and (version.GetVTKMajorVersion(), version.GetVTKMinorVersion()) < (9, 4) and sys.platform == "linux":
        sys.exit(f"VTK {version.GetVTKVersion()} draws only with a display. Set DISPLAY (xvfb-run), or: pip install 'vtk>=9.4'")
    verbosity = vtk.vtkLogger.GetCurrentVerbosityCutoff()
    vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)
    window = vtk.vtkRenderWindow()
    vtk.vtkLogger.SetStderrVerbosity(verbosity)
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    return window


def render(surface, box, radius, walls, moving, width, height, framed=None):
    """RGB image [height][width][3] of the scene and the arrows' label points in pixels (origin at the upper left). The view is filled by the cells, or by
    the points `framed` [n][3] for the same view of several surfaces."""
    factor = 2  # rendered larger and averaged down: smooth edges with every pass
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(cell_actor(surface))
    arrows, places = shear_arrows(box, radius) if moving else ([], [])
    for actor in box_actors(box, walls) + arrows:
        renderer.AddActor(actor)
    window = new_window()
    window.SetSize(factor * width, factor * height)
    window.AddRenderer(renderer)
    extents = [(0, box[0], 0, box[1], 0, box[2])] + [arrow.GetBounds() for arrow in arrows]
    corners = [[extent[i & 1], extent[2 + (i >> 1 & 1)], extent[4 + (i >> 2)]] for extent in extents for i in range(8)]
    if framed is None:
        framed = vtk_to_numpy(surface.GetPoints().GetData())
    set_camera(renderer, np.vstack([framed, corners]), box / 2, width / height)
    set_lights(renderer)
    add_occlusion(renderer, radius)
    window.Render()

    grabber = vtk.vtkWindowToImageFilter()
    grabber.SetInput(window)
    grabber.ReadFrontBufferOff()
    grabber.Update()
    pixels = vtk_to_numpy(grabber.GetOutput().GetPointData().GetScalars())[:, :3]
    pixels = pixels.reshape(height, factor, width, factor, 3).astype(float).mean(axis=(1, 3))[::-1] / 255
    labels = []
    for place, sign in places:
        renderer.SetWorldPoint(*place, 1)
        renderer.WorldToDisplay()
        column, row, _ = renderer.GetDisplayPoint()
        labels.append((column / factor, height - row / factor, sign))
    return pixels, labels


def compose(pixels, labels, bar, title, paths):
    """Adds title, arrow labels and colour bar around the image's used part, and writes it (1600 x 1000) to each of the paths."""
    plt.rcParams.update({"font.size": 20, "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK})
    used = np.flatnonzero((pixels < 0.995).any(axis=(0, 2)))
    first, last = (used[0], used[-1] + 1) if len(used) else (0, pixels.shape[1])
    gap, bar_width = 110, 26
    content = last - first + (gap + bar_width + 130 if bar else 0)
    left = max((1600 - content) / 2, 4)
    figure = plt.figure(figsize=(16, 10), dpi=100, facecolor="white")
    height = pixels.shape[0]
    axes = figure.add_axes((left / 1600, 0.01, (last - first) / 1600, height / 1000))
    axes.imshow(np.clip(pixels[:, first:last], 0, 1), interpolation="none", aspect="auto")
    axes.set_axis_off()
    for column, row, sign in labels:
        axes.text(column - first, row, r"$+\dot\gamma L_z/2$" if sign > 0 else r"$-\dot\gamma L_z/2$", ha="left" if sign > 0 else "right",
                  va="center", fontsize=20)
    figure.suptitle(title, fontsize=26, y=0.978)
    if bar:
        bar_axes = figure.add_axes(((left + last - first + gap) / 1600, 0.2, bar_width / 1600, 0.55))
        mappable = matplotlib.cm.ScalarMappable(plt.Normalize(*bar[1]), bar[0])
        figure.colorbar(mappable, cax=bar_axes).set_label(bar[2], labelpad=12, fontsize=21)
        bar_axes.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(7))
    for path in paths:
        figure.savefig(path)
    plt.close(figure)


def draw_snapshot(data, step, choice, paths):
    """Renders snapshot `step` (negative: from the end) of a RunData, coloured by `choice`, and writes it to each of the paths."""
    path = data.file("cells.vtkhdf")
    box, radius, walls, times = snapshot_group(path)
    if not -len(times) <= step < len(times):
        sys.exit(f"--step {step}: {path} holds {len(times)} snapshots, numbered 0 to {len(times) - 1}.")
    surface, time = read_snapshot(path, step % len(times))
    bar = colour_surface(surface, choice, data)
    moving = data.lattice.get("wall_velocity", 0) != 0
    title = ",   ".join(data.numbers() + [time_text(data, time)])
    pixels, labels = render(surface, box, radius, walls, moving, 1330 if bar else 1590, 915)
    compose(pixels, labels, bar, title, paths)


def time_text(data, time):
    """The time of a snapshot for a title."""
    strained = data.lattice.get("shear_rate", 1) != 0
    return rf"strain $\dot\gamma t$ = {time:.3g}" if strained else f"step {time:.0f}"


def main():
    parser = argparse.ArgumentParser(description="Renders the cells of one snapshot of a run to a PNG (1600 x 1000).")
    parser.add_argument("folder", metavar="DIR", help="output folder of `corpuscle run`")
    parser.add_argument("--step", type=int, default=-1, metavar="N", help="snapshot number, from 0; negative: from the end (default: the last)")
    parser.add_argument("--color", choices=("velocity", "deformation", "cell"), default="velocity", help="what the colour shows (default: velocity)")
    parser.add_argument("--output", metavar="PNG", help="default: DIR/picture.png")
    arguments = parser.parse_args()

    data = RunData(arguments.folder)
    output = arguments.output or str(data.folder / "picture.png")
    draw_snapshot(data, arguments.step, arguments.color, [output])
    print(output)


if __name__ == "__main__":
    main()
