"""Suspensions of stiff spheres at low phi: Batchelor's second order and Eilers's formula."""

import numpy as np

import stiff_sphere
from analysis import block_error
from plots import BLUE, GREEN, INK, ORANGE, panels, save
from rows import Row
from simulations import scene, stokes_accuracy

TITLE = "Suspensions of stiff spheres"
ABOUT = """
Stiff spheres (Ca_G = 0.02) at r = 5 lattice units. The kernel makes them hydrodynamically larger: phi_h = phi [eta]/2.5 with the [eta] of a
single one (stiff_sphere, same resolution). Viscosity and phi_h are those of the bulk, four radii away from the walls.
"""
COST = 5
CA, RADIUS, KERNEL, BOX, TAU, STRAIN, SETTLED = 0.02, 5, 3, (8, 8, 14), 3.0, 12, 2
PHI_H = (0.05, 0.10, 0.15)
ASSUMED = 3.4  # [eta] of one sphere, only to choose the number of cells


def suspension(phi_h):
    membrane = stiff_sphere.stiff_membrane(RADIUS, KERNEL)
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number_G": CA, "reynolds_number_max": 0.1},
        cells=[{"shape": "sphere", "volume_fraction": round(phi_h * 2.5 / ASSUMED, 4), "membrane": membrane}],
        accuracy=stokes_accuracy(RADIUS, KERNEL, TAU, shear_modulus=0.8),
        run={"strain": STRAIN},
        output={"series_every": 0.05, "snapshot_every": 0},
    )


def scenes():
    return {phi_h: suspension(phi_h) for phi_h in PHI_H}


def eilers(phi):
    return (1 + 1.25 * phi / (1 - phi / 0.63)) ** 2


def batchelor(phi, second):
    return 1 + 2.5 * phi + second * phi**2


def bulk(result, enlargement):
    """phi_h and eta_r - 1 of the bulk, and the statistical error of the latter at fixed phi_h."""
    late = result.series("strain") > SETTLED
    z, height = result.cells("centre")[late, :, 2], result.lattice["nodes"][2]
    layer = 4 * result.lattice["radius"]
    number = ((z >= layer) & (z <= height - layer)).sum(1)
    box = np.prod(result.lattice["nodes"]) * (height - 2 * layer) / height
    phi = number * result.cell_type["volume"] / box * enlargement
    excess = result.series("bulk_relative_viscosity")[late] - 1
    return phi.mean(), excess.mean(), block_error(excess - 2.5 * phi)


def rows(run):
    enlargement = (1 + stiff_sphere.shells(run)[KERNEL, RADIUS] / RADIUS) ** 3
    out = []
    for target, result in run.all(scenes()).items():
        phi, excess, error = bulk(result, enlargement)
        low, high = batchelor(phi, 5.2), batchelor(phi, 6.2)
        settings = f"r {RADIUS}, box {BOX}, {result.summary['cell_count']} cells, {STRAIN - SETTLED} units of strain; phi_h = phi x {enlargement:.3f}"
        out.append(
            Row(
                "stiff_suspension",
                f"eta_r - 1 at phi_h = {phi:.3f}",
                excess,
                (low + high) / 2 - 1,
                "1 + 2.5 phi + (5.2 to 6.2) phi^2, Batchelor and Green 1972, Batchelor 1977",
                0.05 + (high - low) / 2 / (low - 1) + 2 * error / excess,
                "2 standard errors, half the published interval, 5 % for phi_h (as [eta])",
                error=error,
                settings=settings,
                seconds=result.seconds,
            )
        )
        out.append(
            Row(
                "stiff_suspension",
                f"eta_r at phi_h = {phi:.3f} below Eilers",
                1 + excess,
                eilers(phi),
                "Eilers 1941",
                2 * error / (1 + excess),
                "2 standard errors above the bound",
                error=error,
                settings=settings,
                seconds=result.seconds,
                test="below",
            )
        )
    return out


def figures(run, folder):
    enlargement = (1 + stiff_sphere.shells(run)[KERNEL, RADIUS] / RADIUS) ** 3
    figure, axis = panels(1, 1, width=6)
    points = np.array([bulk(result, enlargement) for result in run.all(scenes()).values()])
    axis.errorbar(
        points[:, 0], 1 + points[:, 1], 2 * points[:, 2], marker="o", linestyle="", color=BLUE, capsize=3, label="corpuscle, two standard errors"
    )
    phi = np.linspace(0, 0.2, 50)
    axis.plot(phi, 1 + 2.5 * phi, color=GREEN, label="Einstein")
    axis.fill_between(phi, batchelor(phi, 5.2), batchelor(phi, 6.2), color=ORANGE, alpha=0.4, label="Batchelor and Green")
    axis.plot(phi, eilers(phi), "--", color=INK, label="Eilers")
    axis.set(xlabel=r"$\phi_h$", ylabel=r"$\eta_r$")
    axis.legend(fontsize=9)
    save(figure, folder, "validation_stiff_suspension.png")
    return [("validation_stiff_suspension.png", "Relative viscosity of stiff spheres.")]
