#!/usr/bin/env python3
"""Tables and figure of the stability search.

    python report/stability.py STABILITY.JSON [--docs DIR]

STABILITY.JSON is written by `corpuscle stability`. Without --docs the figure is put beside it, as stability.png; with --docs DIR the pages
DIR/stability.md, DIR/stability.json and DIR/figures/stability.png are made.
Needs: pip install numpy matplotlib.
"""
import argparse
import json
import math
import pathlib
import shutil
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy matplotlib")

COLOURS = {2: "#D55E00", 3: "#0072B2", 4: "#009E73"}  # Okabe and Ito's palette
MARKERS = {2: "s", 3: "o", 4: "^"}
INK = "#222222"
NAMES = {"red_cell": "κ_S of a red cell", "kappa_S": "κ_S alone", "kappa_alpha": "κ_α alone", "kappa_B": "κ_B", "kappa_A": "κ_A", "kappa_V": "κ_V", "contact": "κ_int",
         "phi_eff": "κ_S of a red cell", "coupling": "κ_S of a red cell", "precision": "κ_S of a red cell", "Ca": "Ca", "Mach": "Ma", "tau": "τ"}
UNITS = {"eta_0": "η₀", "c_s": "", "response": "", "": ""}
SECTIONS = [
    ("How stiff a membrane may be in dense flow", ["red_cell", "kappa_S", "kappa_alpha", "phi_eff", "coupling", "precision"], "in flow"),
    ("Bending, global terms, contact in dense flow", ["kappa_B", "kappa_A", "kappa_V", "contact"], "in flow"),
    ("One cell at rest: kernel, update, mesh edge", ["red_cell", "kappa_S", "kappa_alpha", "kappa_B", "kappa_A", "kappa_V"], "at rest"),
    ("Fluid, relaxation time, capillary number", ["tau", "Mach", "Ca"], None),
]
PROSE = pathlib.Path(__file__).with_name("stability_prose.md")


def limit_text(case):
    """The bracket as a reader wants it: stable value, or a bound where the range ended."""
    stable, unstable = case["stable"], case["unstable"]
    relation = "≥" if case["smallest"] else "≤"
    if stable is None:
        return f"none ({'up' if case['smallest'] else 'down'} to {unstable:.3g})"
    if unstable is None:
        return f"no limit up to {stable:.3g}" if not case["smallest"] else f"no limit down to {stable:.4g}"
    return f"{relation} {stable:.3g}" if not case["smallest"] else f"{relation} {stable:.4g}"


def estimate(case):
    """Largest stable lambda of the linear estimate: nu (2 pi/width)^2/theta, the force being late by theta steps; see the prose."""
    late = 0.5  # by the order of operations; the mean of velocities adds nothing
    return (case["relaxation_time"] - 0.5) / 3 * (2 * math.pi / case["delta_kernel"]) ** 2 / late


def ratio_text(case):
    response = case.get("response")
    return f"{response:.2f} | {response / estimate(case):.2f}" if response else " | "


def table(cases):
    rows = ["| parameter | conditions | stable | unit | λ at the limit | measured / estimate |", "|---|---|---|---|---|---|"]
    for case in cases:
        rows.append(f"| {NAMES[case['parameter']]} | {case['conditions']} | {limit_text(case)} | {UNITS[case['unit']]} | {ratio_text(case)} |")
    return "\n".join(rows)


def update_name(case):
    return case["conditions"].split(", ")[2]


def find(cases, parameter, scene, update=None):
    return [c for c in cases if c["parameter"] == parameter and c["scene"] == scene and (update is None or update_name(c) == update)]


def draw_points(axes, cases, abscissa, update):
    """Stable bracket ends over one condition, a curve for each kernel."""
    for kernel in sorted({c["delta_kernel"] for c in cases}):
        points = sorted((c[abscissa], c["stable"]) for c in cases if c["delta_kernel"] == kernel and c["stable"])
        if points:
            axes.plot(*zip(*points), color=COLOURS[kernel], marker=MARKERS[kernel], linewidth=1.4, label=f"{kernel} points, {update}",
                      linestyle={"averaged": "-", "chebyshev": "--"}.get(update, ":"))


def plot(cases, path):
    plt.rcParams.update({"font.size": 10.5, "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK, "xtick.color": INK, "ytick.color": INK,
                         "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 2, figsize=(11, 8), dpi=150, layout="constrained")
    updates = list(dict.fromkeys(update_name(c) for c in cases if c["scene"] != "fluid alone"))
    ax = axes[0, 0]
    for update in updates:
        draw_points(ax, [c for c in find(cases, "red_cell", "in flow", update) if c["radius"] == 5], "relaxation_time", update)
    ax.set(xlabel=r"relaxation time $\tau$", ylabel=r"largest stable $\kappa_S/\eta_0$", title="red cells, $\\phi_\\mathrm{eff}$ = 0.45, sheared", yscale="log")
    ax.set_ylim(2e-3, None)
    ax = axes[0, 1]
    for update in updates:
        draw_points(ax, find(cases, "kappa_S", "at rest", update), "edge", update)
    ax.set(xlabel="mean edge / lattice spacing", ylabel=r"largest stable $\kappa_S/\eta_0$", title="one cell at rest, $\\tau$ = 1, $\\kappa_S$ alone", yscale="log")
    ax.set_ylim(2e-3, None)
    ax = axes[1, 0]
    for collision, style in (("BGK", "o-"), ("TRT", "s--")):
        points = sorted((c["relaxation_time"] - 0.5, c["limit"]) for c in cases if c["parameter"] == "Mach" and collision in c["conditions"] and c["limit"])
        if points:
            ax.plot(*zip(*points), style, color="#0072B2" if collision == "BGK" else "#D55E00", label=collision)
    ax.set(xlabel=r"$\tau - 1/2$", ylabel="largest stable Ma of the walls", title="fluid alone, Couette flow with noise", xscale="log", ylim=(0, None))
    ax.axhline(0.3, color="#888888", linewidth=1, linestyle=":")
    ax.annotate("0.3: largest mach_max", (0.03, 0.3), xytext=(0, 4), textcoords="offset points", color="#666666", fontsize=9)
    ax = axes[1, 1]
    for update in updates:
        draw_points(ax, find(cases, "phi_eff", "in flow", update) + [c for c in find(cases, "red_cell", "in flow", update) if c["relaxation_time"] == 1 and c["delta_kernel"] != 2 and c["radius"] == 5],
                    "phi_effective", update)
    ax.set(xlabel=r"effective volume fraction $\phi_\mathrm{eff}$", ylabel=r"largest stable $\kappa_S/\eta_0$", title="red cells, $\\tau$ = 1, sheared", yscale="log")
    for ax in axes.flat:
        ax.grid(color="#DDDDDD", linewidth=0.6)
        ax.set_axisbelow(True)
        if ax.get_yscale() == "log":
            low, high = ax.get_ylim()
            ax.set_ylim(10 ** np.floor(np.log10(low) - 1), 10 ** np.ceil(np.log10(high)))  # room for the legend
        if ax.get_legend_handles_labels()[0]:
            ax.legend(frameon=False, fontsize=8.5 if ax is axes[1, 0] else 7.2, columnspacing=1.2, ncols=1 if ax is axes[1, 0] else 3, loc="best" if ax is axes[1, 0] else "lower left")
    figure.savefig(path)


def page(cases):
    """docs/stability.md: the prose, then the measured tables."""
    parts = [PROSE.read_text(encoding="utf-8").rstrip(), ""]
    for title, parameters, scene in SECTIONS:
        chosen = [c for p in parameters for c in cases if c["parameter"] == p and (scene is None or c["scene"] == scene)]
        if chosen:
            parts += [f"## {title}", "", table(chosen), ""]
    return "\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description="Tables and figure of the stability search.")
    parser.add_argument("results", metavar="STABILITY.JSON", type=pathlib.Path)
    parser.add_argument("--docs", metavar="DIR", type=pathlib.Path, help="make stability.md and figures/stability.png there")
    arguments = parser.parse_args()
    if not arguments.results.is_file():
        sys.exit(f"{arguments.results} does not exist. Run `corpuscle stability` first.")
    cases = json.loads(arguments.results.read_text())["cases"]
    if arguments.docs is None:
        picture = arguments.results.with_name("stability.png")
        plot(cases, picture)
        print(table(cases))
        print(picture)
        return
    (arguments.docs / "figures").mkdir(parents=True, exist_ok=True)
    plot(cases, arguments.docs / "figures" / "stability.png")
    (arguments.docs / "stability.md").write_text(page(cases), encoding="utf-8")
    if arguments.results.resolve() != (arguments.docs / "stability.json").resolve():
        shutil.copyfile(arguments.results, arguments.docs / "stability.json")
    print(arguments.docs / "stability.md")


if __name__ == "__main__":
    main()
