"""The figures of report/performance.py: roofline, shares of a step, scaling."""

import sys

import performance_counts as counts

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy matplotlib")

INK, GREY = "#222222", "#666666"
# Okabe and Ito's palette, in the order of a step
COLOURS = {
    "membrane": "#0072B2",
    "contact": "#CC79A7",
    "spread": "#E69F00",
    "collide": "#009E73",
    "halo": "#56B4E9",
    "interpolate": "#D55E00",
    "motion": "#F0E442",
    "other": "#999999",
    "outside": "#222222",
}
NAMES = {
    "membrane": "membrane",
    "contact": "contact",
    "spread": "spread",
    "collide": "collide, stream",
    "halo": "halo, walls",
    "interpolate": "interpolate",
    "motion": "vertex motion",
    "other": "other kernels",
    "outside": "outside of kernels",
}
MARKERS = {"collide": "s", "spread": "^", "interpolate": "v", "membrane": "o"}


def style():
    plt.rcParams.update(
        {
            "font.size": 10.5,
            "text.color": INK,
            "axes.labelcolor": INK,
            "axes.edgecolor": INK,
            "xtick.color": INK,
            "ytick.color": INK,
            "axes.spines.top": False,
            "axes.spines.right": False,
        }
    )


def row_of(section, case):
    return next((row for row in section["rows"] if row["case"] == case), None)


def roofline_points(sections):
    """(operator, label, bytes of a number, flops a byte, GFLOPS)."""
    points = []

    def add(operator, label, real, count, per_second):
        flops, traffic = count
        points.append((operator, label, real, flops / traffic, flops * per_second / 1e9))

    for real, name in ((4, "float"), (8, "double")):
        fluid = [row for row in sections["fluid"]["rows"] if row["nodes"] == sections["fluid"]["rows"][0]["nodes"]]
        for force, model in ((False, "BGK periodic"), (True, "BGK walls force")):
            row = next((r for r in fluid if r["model"] == f"{name} {model}"), None)
            if row:
                add("collide", "collide, force" if force else "collide", real, counts.collide(real, force), row["MLUPS"] * 1e6)
        for points_wide in (2, 3, 4):
            row = row_of(sections["coupling"], f"phi 0.36, {points_wide}-point, {name}")
            if row:
                share = np.prod(row["nodes"]) / row["markers"]
                add("spread", f"spread {points_wide}", real, counts.spread(points_wide, real, share), row["spread_M_s"] * 1e6)
                add("interpolate", f"interpolate {points_wide}", real, counts.interpolate(points_wide, real, share), row["interpolate_M_s"] * 1e6)
        for case, bending, global_terms in (("Skalak, bending, area, volume", True, True), ("Skalak", False, False)):
            row = row_of(sections["membrane"], f"{name} {case}")
            if row:
                add("membrane", "membrane, all terms" if bending else "membrane, strain only", real, counts.membrane(bending, global_terms), row["M_s"] * 1e6)
    return points


def annotate_apart(axes, labelled):
    """Labels beside their points, each at the first place around its point where it covers neither a point nor another label."""
    scale = 72 / axes.figure.dpi
    points = [tuple(axes.transData.transform((x, y)) * scale) for x, y, _ in labelled]
    taken = [(px - 5, py - 5, px + 5, py + 5) for px, py in points]  # left, bottom, right, top in points of the page

    def is_free(box):
        return all(box[2] < t[0] or t[2] < box[0] or box[3] < t[1] or t[3] < box[1] for t in taken)

    for (px, py), (x, y, text) in sorted(zip(points, labelled), key=lambda p: -p[0][1]):
        width, height = 4.6 * len(text), 9
        beside = [(9, -height / 2), (-9 - width, -height / 2), (-width / 2, 8), (-width / 2, -8 - height)]
        further = [(dx, d) for d in (14, -23, 26, -35, 38, -47, 50, -59) for dx in (9, -9 - width)]
        dx, dy = next(((dx, dy) for dx, dy in beside + further if is_free((px + dx, py + dy, px + dx + width, py + dy + height))), beside[0])
        taken.append((px + dx, py + dy, px + dx + width, py + dy + height))
        line = {"arrowstyle": "-", "color": "#999999", "linewidth": 0.6, "shrinkB": 4} if (dx, dy) in further else None
        axes.annotate(text, (x, y), xytext=(dx, dy + 1), textcoords="offset points", fontsize=8, color=INK, arrowprops=line)


def roofline(sections, path):
    points = roofline_points(sections)
    bandwidth = [row for row in sections["bandwidth"]["rows"] if "in_place_GB_s" in row]
    peaks = {row["case"]: row["GFLOPS"] for row in sections["bandwidth"]["rows"] if "GFLOPS" in row}
    figure, panels = plt.subplots(1, 2, figsize=(13, 6), dpi=150, layout="constrained", sharex=True, sharey=True)
    for axes, real, name in ((panels[0], 4, "float"), (panels[1], 8, "double")):
        peak = peaks[f"peak, {name}"]
        x = np.geomspace(0.15, 200, 200)
        for row, line in ((bandwidth[-1], "-"), (bandwidth[min(1, len(bandwidth) - 1)], "--")):
            axes.plot(
                x, np.minimum(row["in_place_GB_s"] * x, peak), line, color=INK, linewidth=1.2, label=f"in place, {row['case']}: {row['in_place_GB_s']:.0f} GB/s"
            )
        axes.plot([], [], " ", label=f"peak of multiply-adds: {peak:.0f} GFLOPS")
        axes.set(xscale="log", yscale="log", xlabel="flops a byte, counted", title=f"{name}", xlim=(0.15, 200))
        own = [p for p in points if p[2] == real]
        for operator in MARKERS:
            chosen = [p for p in own if p[0] == operator]
            axes.plot(
                [p[3] for p in chosen],
                [p[4] for p in chosen],
                MARKERS[operator],
                color=COLOURS[operator],
                markersize=8,
                markeredgecolor=INK,
                markeredgewidth=0.6,
                linestyle="none",
                label=NAMES[operator],
            )
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.set_axisbelow(True)
    lowest = min(p[4] for p in points)
    panels[0].set_ylim(10 ** np.floor(np.log10(lowest * 0.8)), 2 * max(peaks.values()))
    panels[0].set_ylabel("GFLOPS, measured rate x counted flops")
    figure.canvas.draw()  # fixes the layout that the labels are placed in
    for axes, real in zip(panels, (4, 8)):
        annotate_apart(axes, [(p[3], p[4], p[1]) for p in points if p[2] == real])
        axes.legend(frameon=False, fontsize=8.5, loc="lower right")
    figure.savefig(path)
    plt.close(figure)


def shares(sections, path):
    rows = sections["step"]["rows"]
    figure, axes = plt.subplots(figsize=(11, 0.55 * len(rows) + 1.8), dpi=150, layout="constrained")
    for i, row in enumerate(rows):
        left = 0
        for name in COLOURS:
            width = 100 * row[f"{name}_ms"] / row["step_ms"]
            axes.barh(i, width, left=left, color=COLOURS[name], edgecolor="white", linewidth=0.6, height=0.72, label=NAMES[name] if i == 0 else None)
            if width > 5:
                axes.text(
                    left + width / 2,
                    i,
                    f"{width:.0f}",
                    ha="center",
                    va="center",
                    fontsize=9,
                    color=INK if name in ("spread", "motion", "halo", "contact") else "white",
                )
            left += width
        axes.text(101, i, f"{row['step_ms']:.1f} ms, {row['MLUPS']:.1f} MLUPS", va="center", fontsize=9)
    axes.set_yticks(range(len(rows)), [row["case"] + ("" if row["contact"] else "*") for row in rows])
    axes.invert_yaxis()
    axes.set(xlim=(0, 100), xlabel="share of a step in per cent" + ("" if all(row["contact"] for row in rows) else "     (* cells overlap: no contact forces)"))
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=5, frameon=False, fontsize=9)
    figure.savefig(path)
    plt.close(figure)


def scaling(sections, path):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.5, 4.8), dpi=150, layout="constrained")
    rows = sorted(sections["scaling"]["rows"], key=lambda row: row["threads"])
    one, threads = rows[0], [row["threads"] for row in rows]
    long_enough = [name for name in COLOURS if one[f"{name}_ms"] > 0.005 * one["step_ms"] and name not in ("other", "outside")]
    left.set_title(f"one step, {one['cells']} red cells, $\\phi$ = 0.36, 4 points, float")
    if len(rows) > 2:
        left.plot(threads, threads, color="#888888", linewidth=1, linestyle=":", label="ideal")
        left.plot(threads, [one["step_ms"] / row["step_ms"] for row in rows], "D-", color=INK, label="whole step")
        for name, marker in zip(long_enough, "osv^P<>"):
            left.plot(
                threads,
                [one[f"{name}_ms"] / row[f"{name}_ms"] for row in rows],
                marker + "-",
                color=COLOURS[name],
                markeredgecolor=INK,
                markeredgewidth=0.5,
                linewidth=1.2,
                label=NAMES[name],
            )
        left.set_xticks(threads, [str(n) for n in threads])
        left.set(xlabel="threads", ylabel="speedup against one thread", ylim=(0, None))
        left.legend(frameon=False, fontsize=8.5, loc="upper left")
    else:  # lines between two points would say nothing
        last = rows[-1]
        bars = [("whole step", one["step_ms"] / last["step_ms"], "#888888")] + [(NAMES[n], one[f"{n}_ms"] / last[f"{n}_ms"], COLOURS[n]) for n in long_enough]
        left.barh([b[0] for b in bars], [b[1] for b in bars], color=[b[2] for b in bars], edgecolor=INK, linewidth=0.5, height=0.7)
        for i, b in enumerate(bars):
            left.text(b[1] + 0.02 * last["threads"], i, f"{b[1]:.2f}", va="center", fontsize=9)
        left.axvline(last["threads"], color="#888888", linewidth=1, linestyle=":")
        left.invert_yaxis()
        left.set(xlabel=f"speedup with {last['threads']} threads (dotted: ideal)", xlim=(0, 1.15 * max(last["threads"], max(b[1] for b in bars))))
    rows = sections["growth"]["rows"]
    cells = [row["cells"] for row in rows]
    for name, marker in zip(("membrane", "contact", "spread", "collide", "halo", "interpolate"), "osv^P<"):
        right.plot(
            cells,
            [1e3 * row[f"{name}_ms"] / row["cells"] for row in rows],
            marker + "-",
            color=COLOURS[name],
            markeredgecolor=INK,
            markeredgewidth=0.5,
            linewidth=1.2,
            label=NAMES[name],
        )
    right.plot(cells, [row["us_per_cell"] for row in rows], "D-", color=INK, label="whole step")
    right.set(xscale="log", yscale="log", xlabel="cells", ylabel="µs a step and cell", title="cost of a cell, the same packing repeated")
    right.set_xticks(cells, [str(n) for n in cells])
    right.minorticks_off()
    low, high = right.get_ylim()
    right.set_ylim(low / 6, high)  # room for the legend
    right.legend(frameon=False, fontsize=8.5, ncols=3, loc="lower center")
    for axes in (left, right):
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.set_axisbelow(True)
    figure.savefig(path)
    plt.close(figure)


FIGURES = {"roofline": (roofline, ("bandwidth", "fluid", "coupling", "membrane")), "step": (shares, ("step",)), "scaling": (scaling, ("scaling", "growth"))}


def draw_all(sections, folder, stem):
    """Draws what the sections allow; returns the files."""
    style()
    drawn = []
    for name, (draw, needs) in FIGURES.items():
        if all(section in sections for section in needs):
            path = folder / f"{stem}{name}.png"
            draw(sections, path)
            drawn.append(path)
    return drawn
