#!/usr/bin/env python3
"""Pictures of one run in time for ./dev report: its last snapshot, a strip of some, and an animation of all.

    python report/snapshots.py DIR OUTPUT [--prefix TEXT] [--strip 5] [--frames 24]

DIR holds cells.vtkhdf; OUTPUT gets figure_1a.png and .pdf, snapshots.png and .pdf, motion.gif, their names after the prefix. In strip and animation a colour marks a cell.
A program of its own, because a graphics library without a display may end it: the report then goes on without pictures.
Needs: pip install 'vtk>=9.4' numpy h5py matplotlib pillow.
"""
import argparse
import pathlib
import sys

from picture import colour_surface, draw_snapshot, plt, read_snapshot, render, time_text
from run_data import RunData, snapshot_group
from style import PAGE, np, use_style

try:
    from PIL import Image
except ImportError as error:
    sys.exit(f"{error}. The animation needs: pip install pillow")


def chosen(count, wanted):
    """Numbers of `wanted` snapshots of `count`, evenly spread, with the first and the last."""
    return sorted({round(i * (count - 1) / max(wanted - 1, 1)) for i in range(min(wanted, count))})


def images_of(data, steps, width, height):
    """RGB images in bytes [height][width][3] of the cells, each cell in a colour of its own, and the snapshots' times; one camera for all."""
    path = data.file("cells.vtkhdf")
    box, radius, walls, _ = snapshot_group(path)
    margin = np.array([1.2, 1.2, 0.0]) * radius  # how far cells that have their centre in the box may stick out
    framed = np.array([[(-margin[k], box[k] + margin[k])[i >> k & 1] for k in range(3)] for i in range(8)])
    images, times = [], []
    for step in steps:
        surface, time = read_snapshot(path, step)
        colour_surface(surface, "cell", data)
        pixels, _ = render(surface, box, radius, walls, data.lattice.get("wall_velocity", 0) != 0, width, height, framed)
        images.append((255 * np.clip(pixels, 0, 1)).astype(np.uint8))
        times.append(time)
    return images, times


def cropped(images):
    """The part of the images that any of them uses, with a small margin."""
    used = np.any([(image < 253).any(axis=2) for image in images], axis=0)
    rows, columns = np.flatnonzero(used.any(axis=1)), np.flatnonzero(used.any(axis=0))
    if not len(rows):
        return images
    margin = 6
    part = (slice(max(rows[0] - margin, 0), rows[-1] + margin), slice(max(columns[0] - margin, 0), columns[-1] + margin))
    return [image[part] for image in images]


def draw_strip(data, steps, paths):
    images, times = images_of(data, steps, 620, 620)
    images = cropped(images)
    use_style()
    aspect = images[0].shape[0] / images[0].shape[1]
    figure, row = plt.subplots(1, len(images), figsize=(PAGE, PAGE / len(images) * aspect + 0.22), squeeze=False)
    for axes, image, time in zip(row[0], images, times):
        axes.imshow(image, interpolation="antialiased")
        axes.set_axis_off()
        axes.set_title(time_text(data, time), fontsize=7, pad=2)
    for path in paths:
        figure.savefig(path)
    plt.close(figure)


def draw_motion(data, steps, path):
    """An animated GIF of the snapshots, about six a second."""
    images, _ = images_of(data, steps, 480, 480)
    frames = [Image.fromarray(image).quantize(128, dither=Image.Dither.NONE) for image in cropped(images)]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=[160] * (len(frames) - 1) + [900], loop=0)


def main():
    parser = argparse.ArgumentParser(description="Last snapshot, strip and animation of a run.")
    parser.add_argument("folder", metavar="DIR", help="output folder of `corpuscle run` with cells.vtkhdf")
    parser.add_argument("output", metavar="OUTPUT", help="where the pictures go")
    parser.add_argument("--prefix", default="", metavar="TEXT", help="begins the names of the files")
    parser.add_argument("--strip", type=int, default=5, metavar="N", help="snapshots in the strip (default: 5)")
    parser.add_argument("--frames", type=int, default=24, metavar="N", help="most pictures of the animation; 0: none (default: 24)")
    arguments = parser.parse_args()
    data, output = RunData(arguments.folder), pathlib.Path(arguments.output)
    count = len(snapshot_group(data.file("cells.vtkhdf"))[3])
    if count == 0:
        sys.exit(f"{data.folder}/cells.vtkhdf holds no snapshot yet.")
    name = lambda text: output / f"{arguments.prefix}{text}"
    draw_snapshot(data, -1, "velocity", [name("figure_1a.png"), name("figure_1a.pdf")])
    if count > 1 and arguments.strip > 1:
        draw_strip(data, chosen(count, arguments.strip), [name("snapshots.png"), name("snapshots.pdf")])
    if count > 2 and arguments.frames > 1:
        draw_motion(data, chosen(count, arguments.frames), name("motion.gif"))


if __name__ == "__main__":
    main()
