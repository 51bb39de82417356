#!/usr/bin/env python3
"""The shell with which viscosities of suspensions do not depend on the resolution, from the studies in docs/accuracy/ (docs/theory/hydrodynamic_radius.md, The shell of suspensions).

    python report/shell_of_suspensions.py

A study counts as many cells as fill phi with some shell; had another shell been counted, the same run would stand for another phi. Viscosities are taken there and back with eta_r - 1 ~ phi^n, the
exponents of the studies; the shell is the one with which runs of all resolutions agree. Forms of the shell that differ in their dependence on the radius are held against each other.
"""
import json
import math
import pathlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
STUDIES = {0.2: ["phi20"], 0.449: ["phi45", "diffusion"]}
VOLUME, AREA, CURVATURE = 1.5709, 8.7617, 10.6926  # of the red cell with r = 1, for Steiner's formula (corpuscle plan --json with radius = 40 and shell_thickness = 2)
DRAG = {2: (0.28, 0.37), 3: (0.34, 0.55), 4: (0.44, 0.94)}  # plane, curvature: physics/hydrodynamic_size.cpp
VISCOSITY_OVER_PLANE = 0.36
COARSEST = 4  # meshes of r = 3 fold
RESOLVED = 0.004  # least error of a point, relative: packings differ by that

FORMS = {  # of the shell at a radius: parameter x, by plane and curvature part of the drag's
    "drag + x": lambda plane, curvature, r, x: plane + curvature / r + x,
    "drag × x": lambda plane, curvature, r, x: (plane + curvature / r) * x,
    "x": lambda plane, curvature, r, x: x,
    "plane + x/r": lambda plane, curvature, r, x: plane + x / r,
}


def effective_volume(h):
    """Of a red cell with a shell, both in its radius."""
    return VOLUME + AREA * h + CURVATURE * h**2 + 4 / 3 * math.pi * h**3


def points(kernel):
    """phi: (exponent, [(r, counted shell, eta_r, error)])."""
    found = {}
    for phi, names in STUDIES.items():
        for name in names:
            data = json.loads((ROOT / f"docs/accuracy/{name}.json").read_text())
            exponent = data["fraction"]["exponents"]["relative_viscosity"]
            for point in data["points"]:
                settings, observed = point["settings"], point["observed"]["relative_viscosity"]
                r = float(settings["accuracy.radius"])
                if settings.get("size", "effective") != "effective" or int(settings["accuracy.delta_kernel"]) != kernel or r < COARSEST or observed["value"] is None:
                    continue
                plane, curvature = DRAG[kernel]
                shell = plane + curvature / r + (VISCOSITY_OVER_PLANE * plane if settings.get("accuracy.counted_shell") == "viscosity" else 0)
                found.setdefault(phi, (exponent, []))[1].append((r, shell, observed["value"], max(observed["error"], RESOLVED * observed["value"])))
    return found


def fit(kernel, form, x):
    """chi^2, and by phi the common viscosity with its error, if the shell were `form` with the parameter x."""
    total, limits = 0.0, []
    for phi, (exponent, runs) in points_of[kernel].items():
        ratio = np.array([effective_volume(form(*DRAG[kernel], r, x) / r) / effective_volume(shell / r) for r, shell, _, _ in runs]) ** exponent
        values, weights = np.array([v - 1 for _, _, v, _ in runs]) / ratio, (ratio / np.array([e for *_, e in runs])) ** 2
        mean = (values * weights).sum() / weights.sum()
        total += (((values - mean) ** 2) * weights).sum()
        limits.append((phi, 1 + mean, weights.sum() ** -0.5))
    return total, limits


points_of = {kernel: points(kernel) for kernel in DRAG}


def main():
    print("| points | shell | x | χ² | degrees of freedom | " + " | ".join(f"η_r, φ = {phi:g}" for phi in STUDIES) + " |\n|" + "---|" * (5 + len(STUDIES)))
    for kernel in DRAG:
        freedom = sum(len(runs) for _, runs in points_of[kernel].values()) - len(STUDIES) - 1
        for name, form in FORMS.items():
            grid = np.arange(0, 5, 0.005)
            chi2 = np.array([fit(kernel, form, x)[0] for x in grid])
            best = chi2.argmin()
            # One error: where chi^2 is larger by its value per degree of freedom, since points scatter more than their errors say.
            inside = grid[chi2 < chi2[best] + max(1, chi2[best] / freedom)]
            limits = " | ".join(f"{value:.3f} ± {error:.3f}" for _, value, error in fit(kernel, form, grid[best])[1])
            print(f"| {kernel} | {name} | {grid[best]:.2f} ± {(inside[-1] - inside[0]) / 2:.2f} | {chi2[best]:.0f} | {freedom} | {limits} |")


if __name__ == "__main__":
    main()
