#!/usr/bin/env python3
"""The shell with which viscosities of suspensions do not depend on the resolution, from the studies in docs/accuracy/ (docs/theory/hydrodynamic_radius.md, The shell of suspensions).

    python report/shell_of_suspensions.py build/release/app/corpuscle

A study counts as many cells as fill phi with some shell; had another shell been counted, the same run would stand for another phi. Viscosities are taken there and back with eta_r - 1 ~ phi^n, the
exponents of the studies; the shell is the one with which runs of all resolutions agree. Forms of the shell that differ in their dependence on the radius are held against each other.
"""
import json
import math
import subprocess
import sys

import numpy as np

from resolution_table import ROOT, STUDIES, studies, viscosities

COARSEST = 4  # meshes of r = 3 fold
RESOLVED = 0.004  # least error of a point, relative: packings differ by that

FORMS = {  # of the shell at a radius: parameter x, by plane and curvature part of the drag's
    "drag + x": lambda plane, curvature, r, x: plane + curvature / r + x,
    "drag × x": lambda plane, curvature, r, x: (plane + curvature / r) * x,
    "x": lambda plane, curvature, r, x: x,
    "plane + x/r": lambda plane, curvature, r, x: plane + x / r,
}


def planned(program, kernel, radius, counted):
    """The cell of scenes/accuracy/phi20.toml as the program plans it."""
    settings = [f"accuracy.radius={radius}", f"accuracy.delta_kernel={kernel}", f"accuracy.counted_shell={counted}", "cells.0.count=5"]
    command = [program, "plan", ROOT / "scenes/accuracy/phi20.toml", "--json", "--threads", "1", *[word for setting in settings for word in ("--set", setting)]]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["cells"][0]


class Shells:
    """Of a kernel: that of the drag, plane + curvature/r, what that of the viscosity has more, and the volume of a red cell with a shell, by Steiner's formula."""

    def __init__(self, program, kernel):
        coarse, fine = planned(program, kernel, 8, "drag"), planned(program, kernel, 16, "drag")
        self.plane = 2 * fine["shell_thickness"] - coarse["shell_thickness"]
        self.curvature = 8 * (coarse["shell_thickness"] - self.plane)
        self.more = planned(program, kernel, 16, "viscosity")["counted_shell"] - fine["shell_thickness"]
        self.volume, self.area, h = fine["volume"] / 16**3, fine["area"] / 16**2, fine["shell_thickness"] / 16
        self.bending = (fine["effective_volume"] / 16**3 - self.volume - self.area * h - 4 / 3 * math.pi * h**3) / h**2

    def effective_volume(self, h):
        """Both in radii of the cell."""
        return self.volume + self.area * h + self.bending * h**2 + 4 / 3 * math.pi * h**3


def points(kernel, shells):
    """phi: (exponent, [(r, counted shell, eta_r, error)])."""
    found = {}
    for phi, of_phi in studies():
        for data in of_phi:
            exponent = data["fraction"]["exponents"]["relative_viscosity"]
            for (counted, points_of_kernel, r), value, error in viscosities(data):
                if not counted.endswith("_shell") or points_of_kernel != kernel or r < COARSEST:
                    continue
                shell = shells.plane + shells.curvature / r + (shells.more if counted == "viscosity_shell" else 0)
                found.setdefault(phi, (exponent, []))[1].append((r, shell, value, max(error, RESOLVED * value)))
    return found


def fit(runs_of, shells, form, x):
    """chi^2, and by phi the common viscosity with its error, if the shell were `form` with the parameter x."""
    total, limits = 0.0, []
    for phi, (exponent, runs) in runs_of.items():
        volumes = [(shells.effective_volume(form(shells.plane, shells.curvature, r, x) / r), shells.effective_volume(shell / r)) for r, shell, _, _ in runs]
        ratio = np.array([would_be / counted for would_be, counted in volumes]) ** exponent
        values, weights = np.array([v - 1 for _, _, v, _ in runs]) / ratio, (ratio / np.array([e for *_, e in runs])) ** 2
        mean = (values * weights).sum() / weights.sum()
        total += (((values - mean) ** 2) * weights).sum()
        limits.append((phi, 1 + mean, weights.sum() ** -0.5))
    return total, limits


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/app/corpuscle"
    print("| points | shell | x | χ² | degrees of freedom | " + " | ".join(f"η_r, φ = {phi:g}" for phi in STUDIES) + " |\n|" + "---|" * (5 + len(STUDIES)))
    for kernel in (2, 3, 4):
        shells = Shells(program, kernel)
        runs_of = points(kernel, shells)
        freedom = sum(len(runs) for _, runs in runs_of.values()) - len(STUDIES) - 1
        for name, form in FORMS.items():
            grid = np.arange(0, 5, 0.005)
            chi2 = np.array([fit(runs_of, shells, form, x)[0] for x in grid])
            best = chi2.argmin()
            # One error: where chi^2 is larger by its value per degree of freedom, since points scatter more than their errors say.
            inside = grid[chi2 < chi2[best] + max(1, chi2[best] / freedom)]
            limits = " | ".join(f"{value:.3f} ± {error:.3f}" for _, value, error in fit(runs_of, shells, form, grid[best])[1])
            print(f"| {kernel} | {name} | {grid[best]:.2f} ± {(inside[-1] - inside[0]) / 2:.2f} | {chi2[best]:.0f} | {freedom} | {limits} |")


if __name__ == "__main__":
    main()
