"""The tables of docs/performance.md, each from a section of a result file of ./dev bench."""

import math

# HemoCell (Palabos), as measured for docs/performance.md: GCC 12.2, 2 MPI ranks, double precision, on two cores of another machine (AMD Zen 3).
HEMOCELL = {"fluid": 9.9, "every step": 0.99, "every 20th": 2.6, "MiB": 503}


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows)])


def digits(x, wanted=3):
    """x with `wanted` significant digits, without an exponent."""
    if x == 0:
        return "0"
    before = len(str(int(abs(x)))) if abs(x) >= 1 else 0
    return f"{x:.{max(0, wanted - before)}f}"


def lattice(nodes):
    return " x ".join(map(str, nodes))


def rows_of(result, section):
    return result["sections"][section]["rows"]


def find(rows, case):
    for row in rows:
        if row["case"] == case:
            return row
    raise KeyError(case)


def machine(result):
    m, b = result["machine"], result["build"]
    caches = ", ".join(f"{size} {level}" for level, size in m["caches"].items())
    configuration = " ".join(f"`{k}={v}`" for k, v in result["environment"].items())
    text = (
        f"{m['cpu']}, {m['cores']} cores ({caches}), {m['memory_GiB']} GiB; {b['compiler']}, `{b['flags']}`; Kokkos {b['kokkos_version']} {b['backend']},"
        f" {result['threads']} threads {configuration}; revision {b['revision']}, {result['date'][:10]}, load average {result['load_average']}."
    )
    return (
        text
        + (" **The machine was not idle: these numbers are too low.**" if result["busy"] else "")
        + (" **Tiny sizes (--quick): no measurement.**" if result["quick"] else "")
    )


def bandwidth(result):
    rows = rows_of(result, "bandwidth")
    peaks = {row["case"]: row["GFLOPS"] for row in rows if "GFLOPS" in row}
    sizes = table(
        ["memory touched", "in place (GB/s)", "copy (GB/s)"],
        [[r["case"], digits(r["in_place_GB_s"]), digits(r["copy_GB_s"])] for r in rows if "copy_GB_s" in r],
    )
    return f"{sizes}\n\nMultiply-adds in registers: " + ", ".join(f"{digits(v)} GFLOPS {k.split(', ')[1]}" for k, v in peaks.items()) + "."


def fluid(result):
    return table(
        ["case", "nodes", "MLUPS", "bytes a node", "traffic (B)", "in place, same size (GB/s)", "fraction"],
        [
            [
                r["model"],
                lattice(r["nodes"]),
                digits(r["MLUPS"]),
                digits(r["bytes_per_node"], 4),
                f"{r['traffic_B']:.0f}",
                digits(r["in_place_GB_s"]),
                f"{r['fraction']:.2f}",
            ]
            for r in rows_of(result, "fluid")
        ],
    )


def coupling(result):
    return table(
        ["case", "markers", "spread", "interpolate", "atomics", "textbook, serial", "over atomics", "over textbook"],
        [
            [
                r["case"],
                str(r["markers"]),
                *(digits(r[k]) for k in ("spread_M_s", "interpolate_M_s", "atomic_M_s", "serial_M_s")),
                digits(r["over_atomic"], 2),
                digits(r["over_serial"], 2),
            ]
            for r in rows_of(result, "coupling")
        ],
    )


def membrane(result):
    rows = rows_of(result, "membrane")
    terms = [r["case"].split(" ", 1)[1] for r in rows if r["case"].startswith("float ")]
    return table(["law and terms", "float", "double"], [[t, digits(find(rows, f"float {t}")["M_s"]), digits(find(rows, f"double {t}")["M_s"])] for t in terms])


def contact(result):
    return table(
        ["packing", "vertices", "seconds to pack", "pairs a vertex", "forces (M vertices/s)", "pairs (M/s)", "lists built every time (M vertices/s)"],
        [
            [
                r["case"],
                str(r["vertices"]),
                digits(r["packing_s"]),
                digits(r["pairs_per_vertex"]),
                digits(r["kept_M_s"]),
                digits(r["pairs_M_s"]),
                digits(r["rebuilt_M_s"]),
            ]
            for r in rows_of(result, "contact")
        ],
    )


def step(result):
    parts = ["membrane", "contact", "spread", "collide", "halo", "interpolate", "motion", "outside"]
    rows = [
        [
            r["case"],
            str(r["cells"]),
            digits(r["MLUPS"]),
            digits(r["step_ms"]),
            *(digits(r[p + "_ms"], 2) if r["contact"] or p != "contact" else "–" for p in parts),
            ", ".join(digits(r[k], 3) for k in ("spread_M_s", "interpolate_M_s", "membrane_M_s")),
        ]
        for r in rows_of(result, "step")
    ]
    return (
        table(["case", "cells", "MLUPS", "step (ms)", *parts, "spread, interpolate, membrane (M/s)"], rows)
        + "\n\n"
        + " ".join(result["sections"]["step"]["notes"])
    )


def scaling(result):
    rows = result["sections"]["scaling"]["amdahl"]
    counts = sorted({r["threads"] for r in rows})
    names = list(dict.fromkeys(r["operator"] for r in rows))
    by = {(r["operator"], r["threads"]): r for r in rows}
    head = ["operator", "share of a step, 1 thread", *(f"speedup, {n} threads" for n in counts), f"serial share from {counts[-1]} threads"]
    return table(
        head,
        [
            [
                name,
                f"{100 * by[name, counts[0]]['share']:.1f} %",
                *(digits(by[name, n]["speedup"]) if (name, n) in by else "–" for n in counts),
                f"{100 * by[name, counts[-1]]['serial_share']:.1f} %",
            ]
            for name in names
        ],
    )


def growth(result):
    rows = table(
        ["cells", "nodes", "step (ms)", "µs a cell"],
        [[str(r["cells"]), lattice(r["nodes"]), digits(r["step_ms"]), digits(r["us_per_cell"])] for r in rows_of(result, "growth")],
    )
    return rows + "\n\n" + " ".join(result["sections"]["growth"]["notes"])


def memory(result):
    rows = [
        [
            r["case"],
            lattice(r["nodes"]),
            str(r["vertices"]),
            digits(r["MiB"]),
            digits(r["predicted_MiB"]),
            f"{100 * (r['predicted_MiB'] / r['MiB'] - 1):+.1f} %",
            digits(r["peak_MiB"]) if "peak_MiB" in r else "–",
            digits(r["bytes_per_node"], 4),
            digits(r["bytes_per_vertex"], 4) if "bytes_per_vertex" in r else "–",
        ]
        for r in rows_of(result, "memory")
    ]
    return table(
        ["case", "nodes", "vertices", "allocated (MiB)", "formula (MiB)", "formula off by", "growth of the process (MiB)", "bytes a node", "bytes a vertex"],
        rows,
    )


def models(result):
    """What each optional model costs where it is used; a last column for what is done at some steps only."""

    def cost(r):
        return "{:+.1f} ({:+.1f} … {:+.1f})".format(*(100 * (r["time_ratio" + which] - 1) for which in ("", "_low", "_high")))

    def kernels(r):
        fewer = r["launches_without"] - r["launches_with"]
        return (r["kernels"] or "none of its own") + (f"; {fewer} fewer of others" if fewer > 0 else "")

    rows = [
        [
            r["case"],
            r["left_out_by"],
            kernels(r),
            f"{digits(r['bytes'])} a {r['bytes_per']}" if r["bytes"] else "0",
            cost(r),
            f"{100 * (r['time_ratio'] - 1) / r['every']:+.2f}" if r["every"] > 1 else "the same",
        ]
        for r in rows_of(result, "models")
    ]
    head = ["model", "left out by", "kernels with it", "bytes with it", "time of a step with it, % more than without", "at the usual cadence, %"]
    return table(head, rows) + "\n\n" + " ".join(result["sections"]["models"]["notes"])


def peers(result):
    """HemoCell's settings and ours; its cells are coupled in double precision with its own membrane model."""
    fluids, steps = rows_of(result, "fluid"), rows_of(result, "step")
    alone = find(fluids, "double BGK periodic, " + lattice(fluids[0]["nodes"]))
    ours = lambda case: find(steps, f"phi 0.36, {case}")  # noqa: E731
    cases = [
        ("4-point, double, double membrane", "double, 4-point kernel"),
        ("2-point, double, double membrane", "double, 2-point kernel"),
        ("4-point, float, float membrane", "float, 4-point kernel"),
        ("2-point, float, float membrane", "float, 2-point kernel"),
    ]
    same = [
        [
            "fluid alone",
            "D3Q19 BGK, double",
            digits(HEMOCELL["fluid"], 2),
            "D3Q19 BGK, double, periodic",
            digits(alone["MLUPS"]),
            digits(alone["MLUPS"] / HEMOCELL["fluid"], 2),
        ]
    ]
    for case, setting in cases:
        row = ours(case)
        same.append(
            [
                "coupled at every step",
                "192 red cells x 642 vertices, φ = 0.363, double",
                digits(HEMOCELL["every step"], 2),
                f"{row['cells']} red cells x {row['vertices'] // row['cells']} vertices, φ = {row['phi']:.3f}, {setting}",
                digits(row["MLUPS"]),
                digits(row["MLUPS"] / HEMOCELL["every step"], 2),
            ]
        )
    row = ours(cases[0][0])
    same.append(
        [
            "membrane every 20th, velocity every 5th step",
            "as above",
            digits(HEMOCELL["every 20th"], 2),
            f"every step, {cases[0][1]}",
            digits(row["MLUPS"]),
            digits(row["MLUPS"] / HEMOCELL["every 20th"], 2),
        ]
    )
    return table(["what", "HemoCell", "MLUPS", "corpuscle", "MLUPS", "ratio"], same)


def targets(result):
    fluids, steps, memory_rows = rows_of(result, "fluid"), rows_of(result, "step"), rows_of(result, "memory")
    large = [r for r in fluids if math.prod(r["nodes"]) >= 1e6] or fluids  # smaller ones fit caches that outrun the arithmetic
    worst = lambda model: min((r for r in large if r["model"] == model), key=lambda r: r["fraction"])  # noqa: E731
    rows = []

    def line(what, target, value, text, least=True):
        rows.append([what, f"{'≥' if least else '≤'} {target}", text, "yes" if (value >= target if least else value <= target) else "no"])

    for name in ("float", "double"):
        w = worst(f"{name} BGK walls force")
        line(
            f"fluid, Guo force and walls, {name}: smallest fraction of the in-place bandwidth, 1 M nodes and more",
            0.75,
            w["fraction"],
            f"{w['fraction']:.2f} ({lattice(w['nodes'])})",
        )
    for case, least in (("4-point, float, float membrane", 40), ("4-point, double, double membrane", 20), ("2-point, float, float membrane", 80)):
        mlups = find(steps, f"phi 0.36, {case}")["MLUPS"]
        line(f"coupled at every step, φ = 0.36, {case} (MLUPS)", least, mlups, digits(mlups))
    dense = find(steps, "phi 0.36, 4-point, float, float membrane")
    for key, name, least in (
        ("spread_M_s", "spread, 4-point, float (M markers/s)", 25),
        ("interpolate_M_s", "interpolate, 4-point, float (M markers/s)", 30),
        ("membrane_M_s", "membrane, Skalak, bending, area, volume, float (M vertices/s)", 60),
    ):
        line(name, least, dense[key], digits(dense[key]))
    off = max(abs(r["predicted_MiB"] / r["MiB"] - 1) for r in memory_rows)
    line("formula of the memory off by (%)", 10, 100 * off, digits(100 * off, 2), least=False)
    return table(["what", "target", "measured", "reached"], rows)


def summary(result):
    """The table of the README."""
    fluids, steps = rows_of(result, "fluid"), rows_of(result, "step")
    dense = [row for row in steps if row["case"].startswith("phi 0.36, ")]
    first, nodes = dense[0], lattice(fluids[0]["nodes"])
    head = f"whole coupled step at phi = 0.36, {first['cells']} red cells of {first['vertices'] // first['cells']} vertices, {lattice(first['nodes'])} nodes"
    alone = [digits(find(fluids, f"{precision} BGK periodic, {nodes}")["MLUPS"]) for precision in ("float", "double")]
    return table(
        [head, "MLUPS"],
        [[row["case"].split(", ", 1)[1], digits(row["MLUPS"])] for row in dense] + [[f"fluid alone, float / double, {nodes}", " / ".join(alone)]],
    )


TABLES = {
    "summary": summary,
    "machine": machine,
    "bandwidth": bandwidth,
    "fluid": fluid,
    "coupling": coupling,
    "membrane": membrane,
    "contact": contact,
    "step": step,
    "scaling": scaling,
    "growth": growth,
    "memory": memory,
    "models": models,
    "peers": peers,
    "targets": targets,
}
