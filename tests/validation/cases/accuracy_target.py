"""The error that accuracy.target promises, in a scene that no study of docs/accuracy.md contains."""

import numpy as np

from analysis import error_of_seeds, stated_resolution, viscosity_at
from rows import Row
from simulations import scene, seconds

TITLE = "Accuracy asked for: accuracy.target in a scene of its own"
ABOUT = """
The studies behind `accuracy.target` (docs/accuracy.md) have phi = 0.2 and 0.45, Ca = 0.08 and one box. Here phi_eff = 0.32, Ca = 0.03, and the box
is longer: what the program chooses for a target, several packings, is compared with the limit that follows from the finest resolution
and the error that is stated for that one. Numbers of cells are whole, so all viscosities are taken to phi_eff = 0.32 with
eta_r - 1 ~ phi^1.5, between the exponents of both studies.
"""
COST = 6
PHI, CA, BOX, STRAIN, SETTLED, EXPONENT = 0.32, 0.03, (6, 4.5, 6), 20, 5, 1.5
TARGETS, SEEDS, FINEST = (0.12, 0.05), (1, 2, 3, 4), 9


def suspension(seed, **accuracy):
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number": CA, "reynolds_number_max": 0.1},
        cells=[{"shape": "red_cell", "effective_volume_fraction": PHI}],
        accuracy=accuracy,
        run={"strain": STRAIN, "seed": seed},
        output={"series_every": 0.05, "snapshot_every": 0},
    )


def scenes():
    todo = {(target, seed): suspension(seed, target=target) for target in TARGETS for seed in SEEDS}
    fine = {("finest", kernel): suspension(1, radius=FINEST, delta_kernel=kernel, collision="trt", relaxation_time=2.0) for kernel in (2, 3)}
    return todo | fine


def viscosity(result):
    """eta_r at PHI and its statistical error."""
    return viscosity_at(result, PHI, EXPONENT, SETTLED)


def limit(results):
    """eta_r without what the finest runs say about their own resolution, and its relative uncertainty: half of what their kernels differ by, statistics, and what is stated."""
    values, errors, known = [], [], []
    for kernel in (2, 3):
        value, error = viscosity(results["finest", kernel])
        shift, uncertainty = stated_resolution(results["finest", kernel])
        values.append(value / (1 + shift))
        errors.append(error / value)
        known.append(uncertainty)
    mean = np.mean(values)
    return mean, np.hypot(abs(values[1] - values[0]) / 2 / mean, np.hypot(*errors) / 2) + min(known)


def rows(run):
    results = run.all(scenes())
    reference, uncertainty = limit(results)
    finest = ", ".join("{}-point {:.3f} ± {:.3f}".format(kernel, *viscosity(results["finest", kernel])) for kernel in (2, 3))
    out = []
    for target in TARGETS:
        mine = {seed: results[target, seed] for seed in SEEDS}
        values, errors = zip(*(viscosity(result) for result in mine.values()))
        value = np.mean(values)
        error = error_of_seeds(values, errors)
        chosen = mine[SEEDS[0]].summary["viscosity_resolution_error_reason"]
        shift, known = stated_resolution(mine[SEEDS[0]])
        out.append(
            Row(
                "accuracy_target",
                f"eta_r, accuracy.target = {target:g}",
                value,
                reference,
                "limit from the finest resolution here and its stated error",
                target + uncertainty + 2 * error / value,
                "what was asked for, the uncertainty of the limit, and 2 standard errors",
                error=error,
                settings=f"chosen: {chosen}; stated {100 * shift:+.0f} ± {100 * known:.0f} %; "
                f"box {BOX}, Ca {CA}, seeds {SEEDS}; r {FINEST}: {finest}",
                seconds=seconds(mine),
            )
        )
    return out
