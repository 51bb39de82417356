"""Common look of the validation's plots."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Okabe and Ito's palette, told apart by colour-blind readers; markers tell the curves apart in grey.
BLUE, ORANGE, GREEN, PURPLE, INK = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#222222"
COLOURS, MARKERS = (BLUE, ORANGE, GREEN, PURPLE), ("o", "s", "^", "D")


def panels(rows, columns, width=9.0, height=3.6, **options):
    """A figure with its axes, width x (rows * height) inches."""
    ink = {name: INK for name in ("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color")}
    plt.rcParams.update({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, **ink})
    return plt.subplots(rows, columns, figsize=(width, rows * height), dpi=140, layout="constrained", **options)


def save(figure, folder, name):
    figure.savefig(folder / name)
    plt.close(figure)
