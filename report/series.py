#!/usr/bin/env python3
"""Plots a run's relative viscosity and mean deformation against strain, with the averaged window and the mean with its error.

    python report/series.py DIR [--output PNG]

DIR is the output folder of `corpuscle run`; it must hold run.h5, and summary.json for the means (docs/outputs.md).
Needs: pip install numpy h5py matplotlib.
"""
import argparse
import sys

from run_data import RunData

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy h5py matplotlib 'vtk>=9.4'")

# Okabe and Ito's palette: told apart by colour-blind readers, and in grey by line style.
PARTICLE, WALL, DEFORMATION, INK = "#0072B2", "#D55E00", "#009E73", "#222222"


def limits(curves, reference):
    """Axis limits that show the averaged part well: the first moments of a run, far outside, are cut off."""
    steady = np.concatenate([curve[len(curve) // 10:] for curve in curves] + [np.atleast_1d(reference)])
    steady = steady[np.isfinite(steady)]
    if not len(steady):
        return None
    low, high = steady.min(), steady.max()
    margin = 0.12 * max(high - low, 0.02 * abs(high), 1e-6)
    return low - margin, high + 2 * margin  # room for the legend


def draw_mean(axes, window, mean, error, colour, name):
    """A line at the mean over the window with its error as a band; returns the legend's text."""
    if mean is None or not np.isfinite(mean):
        return name
    axes.plot(window, [mean, mean], color=colour, linewidth=2.4, zorder=4)
    if error is None:
        return f"{name}: {mean:.3f}"
    axes.fill_between(window, mean - error, mean + error, color=colour, alpha=0.3, linewidth=0, zorder=3)
    return f"{name}: {mean:.3f} $\\pm$ {error:.3f}"


def plot(data, path):
    """Draws both panels and writes the PNG."""
    plt.rcParams.update({"font.size": 13, "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK, "xtick.color": INK,
                         "ytick.color": INK, "axes.spines.top": False, "axes.spines.right": False, "xtick.direction": "out"})
    series, summary = data.series, data.summary
    at_rest = not np.any(series["strain"])
    time = series["step"] if at_rest else series["strain"]
    window = [summary.get("averaged_from_strain"), summary.get("averaged_to_strain")]
    if at_rest or None in window:
        window = None
    figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(9, 6.6), dpi=160, height_ratios=(1.7, 1), layout="constrained")

    shown = []
    for key, colour, style, name in (("wall_relative_viscosity", WALL, (0, (4, 1.5)), "from the wall stress"),
                                     ("relative_viscosity", PARTICLE, "-", "from the particle stress")):
        values = series[key]
        if not np.isfinite(values).any():
            continue
        shown.append(values)
        if window:
            name = draw_mean(top, window, summary.get(key), summary.get(key + "_error"), colour, name)
        top.plot(time, values, color=colour, linestyle=style, linewidth=1.1, alpha=0.85, label=name)
    top.set_ylabel(r"relative viscosity $\eta/\eta_0$")
    if shown:
        top.set_ylim(limits(shown, 1.0 if min(np.nanmedian(v) for v in shown) < 1.3 else np.nan))
        handles, names = top.get_legend_handles_labels()
        top.legend(handles[::-1], names[::-1], frameon=False, loc="upper right")

    name = None
    if window:
        name = draw_mean(bottom, window, summary.get("mean_deformation"), summary.get("mean_deformation_error"), DEFORMATION, "mean over the cells")
    bottom.plot(time, series["mean_deformation"], color=DEFORMATION, linewidth=1.3, label=name)
    if name:
        bottom.legend(frameon=False, loc="lower right")
    bottom.set_ylabel("mean deformation $D$")
    bottom.set_xlabel("time step" if at_rest else r"strain $\dot\gamma t$")
    bottom.set_xlim(time[0], time[-1] if time[-1] > time[0] else time[0] + 1)
    for axes in (top, bottom):
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.set_axisbelow(True)
        if window:
            axes.axvspan(*window, color="#8899AA", alpha=0.13, linewidth=0)
    if window:
        top.annotate("averaged", ((window[0] + window[1]) / 2, 0.015), xycoords=("data", "axes fraction"), ha="center", va="bottom",
                     fontsize=11, color="#556677")
    figure.align_ylabels()
    figure.suptitle(",   ".join(data.numbers()), fontsize=15)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description="Plots a run's viscosity and deformation against strain to a PNG.")
    parser.add_argument("folder", metavar="DIR", help="output folder of `corpuscle run`")
    parser.add_argument("--output", metavar="PNG", help="default: DIR/series.png")
    arguments = parser.parse_args()
    data = RunData(arguments.folder)
    data.file("run.h5")
    if not len(data.series.get("step", ())):
        sys.exit(f"{data.folder}/run.h5 holds no samples yet.")
    output = arguments.output or str(data.folder / "series.png")
    plot(data, output)
    print(output)


if __name__ == "__main__":
    main()
