#!/usr/bin/env python3
"""What models change: pairs of runs with and without one, from the sweeps of scenes/studies (docs/models.md).

    for s in contact contact_single contact_finer bending bending_single bending_finer area volume precision precision_finer; do
      corpuscle sweep scenes/studies/$s.toml --output results/studies/$s --threads 1; done
    python report/model_effects.py results/studies [--document docs/models.md]

Prints a table for each study; with --document it fills the tables of that page between `<!-- study: NAME -->` and `<!-- end -->` and writes the numbers beside it as model_effects.json.
Pairs have the same start. The effect on viscosity (in parts of what the cells add to it, η/η₀ − 1) and deformation is the mean of the difference, its error the scatter of means over stretches of two strain units (of all seeds).
Needs: pip install numpy h5py scipy.
"""
import argparse
import json
import pathlib
import re
import sys

sys.dont_write_bytecode = True

from performance_tables import table  # noqa: E402
from run_data import RunData, h5py, np, snapshot_group  # noqa: E402

try:
    from scipy.spatial import cKDTree
except ImportError as error:
    sys.exit(f"{error}. This script needs: pip install scipy")

SHAPE, PHI, CA = "cells.0.shape", "cells.0.effective_volume_fraction", "flow.capillary_number"
C, SEED = "cells.0.membrane.area_dilation", "run.seed"
BENDING, AREA, VOLUME, PRECISION, CONTACT = "cells.0.membrane.bending", "cells.0.membrane.global_area", "cells.0.membrane.volume", "accuracy.membrane_precision", "contact.enabled"
# Name of the sweep: the key that differs, its value without the model.
STUDIES = {
    "contact": (CONTACT, False),
    "contact_single": (CONTACT, False),
    "contact_finer": (CONTACT, False),
    "bending": (BENDING, 0),
    "bending_single": (BENDING, 0),
    "bending_finer": (BENDING, 0),
    "area": (AREA, 0),
    "volume": (VOLUME, 0),
    "precision": (PRECISION, "single"),
    "precision_finer": (PRECISION, "single"),
}
NAMES = {PHI: "φ_eff", CA: "Ca", C: "C", SHAPE: "cells"}
BLOCK = re.compile(r"^<!-- study: (\w+) -->\n(.*?)^<!-- end -->$", re.MULTILINE | re.DOTALL)
STRETCH = 2.0  # strain units


def positions(path, snapshot):
    """Vertices [V][3] of a snapshot in lattice units, the cell of each, triangles [F][3]; and box and radius."""
    box, radius, walls, _ = snapshot_group(path)
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        first = group["Steps/PointOffsets"][snapshot]
        cell = group["PointData/cell_id"][()]
        points = group["Points"][first:first + len(cell)]
        faces = group["Polygons/Connectivity"][()].reshape(-1, 3)
    return points.astype(float), cell, faces, np.array(box), radius, walls


def smallest_distance(points, cell, box, walls):
    """Between vertices of different cells, lattice units; NaN for one cell."""
    if len(np.unique(cell)) < 2:
        return np.nan
    x = points.copy()
    size = box.copy()
    if walls:
        size[2] = 10 * box[2]  # not periodic
    x[:, 0], x[:, 1] = np.mod(x[:, 0], box[0]), np.mod(x[:, 1], box[1])
    x[:, 2] = np.mod(x[:, 2], size[2])
    tree = cKDTree(x, boxsize=size)
    count = 16
    while True:
        distance, neighbour = tree.query(x, k=count)
        other = cell[neighbour] != cell[:, None]
        found = np.where(other, distance, np.inf).min()
        if found < distance[:, -1].min() or count >= 256:  # nothing closer can be hidden behind own vertices
            return found
        count *= 2


def largest_fold(points, faces):
    """Largest angle between the normals of two triangles at an edge, and the share of edges beyond 90 degrees."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    left, right = owner[order[0::2]], owner[order[1::2]]
    angle = np.degrees(np.arccos(np.clip((normal[left] * normal[right]).sum(axis=1), -1, 1)))
    return angle.max(), (angle > 90).mean()


class Run:
    def __init__(self, folder):
        data = RunData(folder)
        self.summary, self.series = data.summary, data.series
        path = data.file("cells.vtkhdf")
        count = len(snapshot_group(path)[3])
        self.start = self.summary["averaged_from_strain"]
        self.gap, self.fold, self.folded = np.inf, 0.0, 0.0
        for snapshot in range(1, count):
            points, cell, faces, box, _, walls = positions(path, snapshot)
            self.gap = np.fmin(self.gap, smallest_distance(points, cell, box, walls))
            fold, share = largest_fold(points, faces)
            self.fold, self.folded = max(self.fold, fold), max(self.folded, share)

    def stretches(self, other, name, of_cells):
        """Means of the difference other - self over stretches of the averaged part; in parts of what the cells add to 1 in the mean of self."""
        strain = self.series["strain"]
        rows = min(len(strain), len(other.series["strain"]))
        strain, a, b = strain[:rows], self.series[name][:rows], other.series[name][:rows]
        used = strain >= self.start
        scale = a[used].mean() - 1 if of_cells else 1.0
        number = np.floor((strain[used] - self.start) / STRETCH).astype(int)
        whole = max(1, int((strain[used][-1] - self.start + 1e-6) / STRETCH))
        difference = (b - a)[used] / scale
        return [difference[number == i].mean() for i in range(whole)]


def mean_and_error(values):
    values = np.array(values)
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values))) if len(values) > 1 else float("nan")


def study(folder, key, without):
    """One row for each pair, seeds joined: settings, effects with errors, what happened with and without the model."""
    sweep = json.loads((folder / "sweep.json").read_text())
    runs, stopped = {}, {}
    for entry in sweep["runs"]:
        given = entry["overrides"]
        settings = {name: given[name] for name in NAMES if name in given}
        model, seed = given[key] != without, given.get(SEED, 1)
        place = (tuple(sorted(settings.items())), seed, model)
        if entry["state"] != "finished":
            stopped[place] = entry.get("message") or entry["state"]
            continue
        runs[place] = Run(folder / entry["directory"])
    rows = []
    for settings in dict.fromkeys(place[0] for place in [*runs, *stopped]):
        pairs = [(runs[settings, seed, True], runs[settings, seed, False]) for s, seed, model in runs if s == settings and model and (settings, seed, False) in runs]
        row = dict(settings)
        row["stopped"] = [f"{'with' if place[2] else 'without'}: {why}" for place, why in stopped.items() if place[0] == settings]
        if pairs:
            row["viscosity"] = float(np.mean([a.summary["relative_viscosity"] for a, _ in pairs]))
            for name, quantity, of_cells in (("viscosity", "relative_viscosity", True), ("deformation", "mean_deformation", False)):
                change, error = mean_and_error([v for a, b in pairs for v in a.stretches(b, quantity, of_cells)])
                row[f"{name}_change"], row[f"{name}_change_error"] = change, error
            row["deformation"] = float(np.mean([a.summary["mean_deformation"] for a, _ in pairs]))
            for which, index in (("with", 0), ("without", 1)):
                group = [pair[index] for pair in pairs]
                gap = min(run.gap for run in group)
                row[f"gap_{which}"] = float(gap) if np.isfinite(gap) else None
                row[f"fold_{which}"] = float(max(run.fold for run in group))
                row[f"folded_{which}"] = float(max(run.folded for run in group))
                row[f"volume_drift_{which}"] = max(run.summary["volume_drift_max"] for run in group)
                row[f"area_drift_{which}"] = max(run.summary["area_drift_max"] for run in group)
            row["strain"], row["seeds"] = pairs[0][0].summary["strain"], len(pairs)
            row["phi_effective"] = pairs[0][0].summary["phi_effective"]
        rows.append(row)
    return rows


def both(row, name, form):
    values = [row.get(f"{name}_{which}") for which in ("with", "without")]
    return " / ".join("–" if value is None else form(value) for value in values)


def percent(x):
    return f"{100 * x:.2g}" if abs(x) < 0.1 else f"{100 * x:.0f}"


def rendered(rows):
    axes = [key for key in (SHAPE, PHI, CA, C) if any(key in row for row in rows)]
    head = [NAMES[key] for key in axes] + ["η/η₀", "change of η/η₀ − 1, %", "D", "its change", "smallest distance", "largest fold, °", "edges beyond 90°, %", "volume drift, %", "area drift, %"]
    lines = []
    for row in sorted(rows, key=lambda r: [str(r.get(SHAPE, "")), r.get(PHI, 0), r.get(C, 0), -r.get(CA, 0)]):
        line = [str(row.get(key, "")).replace("_", " ") for key in axes]
        if "viscosity" not in row:
            lines.append(line + ["; ".join(row["stopped"])] + [""] * (len(head) - len(axes) - 1))
            continue
        lines.append(line + [
            f"{row['viscosity']:.3f}", f"{100 * row['viscosity_change']:+.2g} ± {100 * row['viscosity_change_error']:.1g}",
            f"{row['deformation']:.3f}", f"{row['deformation_change']:+.2g} ± {row['deformation_change_error']:.1g}",
            both(row, "gap", "{:.2f}".format), both(row, "fold", "{:.0f}".format), both(row, "folded", percent), both(row, "volume_drift", percent), both(row, "area_drift", percent)])
    return table(head, lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="holds the sweeps, each in a folder with the name of its study")
    parser.add_argument("--document", type=pathlib.Path, metavar="PAGE", help="fill the tables of this page")
    options = parser.parse_args()
    found = {}
    for name, (key, without) in STUDIES.items():
        if not (options.folder / name / "sweep.json").is_file():
            print(f"{options.folder / name} holds no sweep: its table stays as it is", file=sys.stderr)
            continue
        found[name] = study(options.folder / name, key, without)
        print(f"\n{name}\n{rendered(found[name])}")
    if options.document is None:
        return
    page = options.document.read_text(encoding="utf-8")
    page = BLOCK.sub(lambda match: f"<!-- study: {match[1]} -->\n{rendered(found[match[1]])}\n<!-- end -->" if match[1] in found else match[0], page)
    options.document.write_text(page, encoding="utf-8")
    numbers = options.document.with_name("model_effects.json")
    kept = json.loads(numbers.read_text(encoding="utf-8")) if numbers.exists() else {}
    numbers.write_text(json.dumps({**kept, **found}, indent=1) + "\n", encoding="utf-8")
    print(options.document, numbers)


if __name__ == "__main__":
    main()
