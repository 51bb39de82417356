"""Suspensions of neo-Hookean capsules: [eta] phi at low phi, and particle stress against wall stress."""

import numpy as np

from analysis import block_error, error_of_seeds
from rows import Row
from simulations import scene, seconds, stokes_accuracy

TITLE = "Suspensions of capsules: dilute limit and the two measurements of stress"
ABOUT = """
Neo-Hookean spheres, Ca_G = 0.15, between walls 12 r apart. The dilute limit of (eta_r - 1)/phi, a line through two volume fractions, is
compared with the [eta] of one capsule in the middle of the same box at the same resolution, so that kernel and box don't enter. The wall
stress is measured on the walls, the particle stress from the membranes.
"""
COST = 6
CA, RADIUS, BOX, RE, TAU, SETTLED = 0.15, 5, (12, 8, 12), 0.1, 3.0, 5
DILUTE, DENSE, SEEDS = (0.02, 0.05), 0.2, (1, 2)
STRAIN, LATE = 20, 10  # wall stress lags by the diffusion of momentum, H^2/(pi^2 nu) = 1.5 units of strain: at LATE 0.1 % of the start is left


def suspension(phi, seed=1):
    cells = {"shape": "sphere", "membrane": {"law": "neo_hookean", "bending": 0.0}}
    cells |= {"volume_fraction": phi} if phi else {"count": 1, "position": [size / 2 for size in BOX]}
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number_G": CA, "reynolds_number_max": RE},
        cells=[cells],
        accuracy=stokes_accuracy(RADIUS, 3, TAU),
        run={"strain": STRAIN if phi else 2 * SETTLED, "seed": seed},
        output={"series_every": 0.05, "snapshot_every": 0},
    )


def scenes():
    todo = {("dilute", phi, seed): suspension(phi, seed) for phi in DILUTE for seed in SEEDS}
    return todo | {("dense", DENSE, 1): suspension(DENSE), "one": suspension(0)}


def excess(result, name, after=SETTLED):
    """eta_r - 1 in the steady part."""
    return result.series(name)[result.series("strain") > after] - 1


def rows(run):
    results = run.all(scenes())
    out = []
    alone = excess(results["one"], "relative_viscosity").mean() / results["one"].lattice["phi_geometric"]
    per_phi, errors, phis = [], [], []
    for target in DILUTE:
        means = [excess(results["dilute", target, seed], "relative_viscosity").mean() for seed in SEEDS]
        inside = [block_error(excess(results["dilute", target, seed], "relative_viscosity")) for seed in SEEDS]
        phi = results["dilute", target, SEEDS[0]].lattice["phi_geometric"]
        phis.append(phi)
        per_phi.append(np.mean(means) / phi)
        errors.append(error_of_seeds(means, inside) / phi)
    slope = (per_phi[1] - per_phi[0]) / (phis[1] - phis[0])
    limit = per_phi[0] - slope * phis[0]
    error = np.hypot(errors[0] * phis[1], errors[1] * phis[0]) / (phis[1] - phis[0])
    each = "; ".join(f"phi {phis[i]:.4f}: {per_phi[i]:.3f} ± {errors[i]:.3f}" for i in range(len(DILUTE)))
    detail = f"r {RADIUS}, box {BOX}, seeds {SEEDS}; {each}"
    out.append(
        Row(
            "capsule_suspension",
            "(eta_r - 1)/phi, phi to 0, over [eta] of one capsule",
            limit / alone,
            1.0,
            "definition of [eta]; [eta] itself is compared in capsule_shear",
            0.03 + 2 * error / alone,
            "2 standard errors, and 3 % as cells away from the middle see a wall (as the box effect of capsule_shear, 5 % at 6 r)",
            error=error / alone,
            settings=detail + f"; one capsule: {alone:.3f}",
            seconds=seconds(results) - results["dense", DENSE, 1].seconds,
        )
    )
    for key in [("dilute", phi, 1) for phi in DILUTE] + [("dense", DENSE, 1)]:
        particle, wall = (excess(results[key], name, LATE) for name in ("relative_viscosity", "wall_relative_viscosity"))
        error = block_error(wall - particle) / particle.mean()
        compressible = 3 * results[key].lattice["viscosity"] * results[key].lattice["shear_rate"]
        out.append(
            Row(
                "capsule_suspension",
                f"wall excess / particle excess, phi = {key[1]}",
                wall.mean() / particle.mean(),
                1.0,
                "momentum balance, exact in the time average",
                compressible + 2 * error,
                f"2 standard errors of the difference, and 3 eta_0 x shear rate = {100 * compressible:.1f} %: the cells' pressure changes the "
                "density at the walls, and the viscosity rho nu with it",
                error=error,
                settings=f"r {RADIUS}, box {BOX}; eta_r = {1 + particle.mean():.4f} ± {block_error(particle):.4f}, {STRAIN - LATE} units of strain",
                seconds=results[key].seconds,
            )
        )
    return out
