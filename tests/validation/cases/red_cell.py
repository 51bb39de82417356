"""A single red cell in shear: tumbling at small Ca, tank-treading with a swinging axis at large Ca."""

import numpy as np

from analysis import rotation_vector, section, unwrapped
from plots import COLOURS, INK, panels, save
from rows import Row
from simulations import scene, seconds

TITLE = "A single red cell: tumbling and tank-treading"
ABOUT = """
The red cell of `scenes/single_red_cell.toml` (kappa_alpha = 2.5 kappa_S, kappa_B = kappa_S r^2/405, equal viscosities) with its axis in the
shear plane. Two angles are followed: that of the shape (the ellipsoid with the cell's second moments) and that of the membrane (mean
rotation of the vertices). A tumbling cell turns both together, a tank-treading one only its membrane while the shape swings about a fixed
inclination.
"""
COST = 6
CAPILLARY = (0.02, 0.08, 0.1, 0.12, 0.16, 0.3)
RADIUS, BOX, RE, TAU, STRAIN, SETTLED = 8, (6, 4, 6), 0.1, 3.0, 40, 15
SOURCE = "simulations of the same cell model: transition at 0.08 < Ca < 0.16 (compare Krüger, Gross, Raabe, Varnik, Soft Matter 9, 9008, 2013)"


def cell(ca):
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number": ca, "reynolds_number_max": RE},
        cells=[{"shape": "red_cell", "count": 1, "position": [size / 2 for size in BOX], "axis": [0.0, 0.0, 1.0]}],
        contact={"enabled": False},
        accuracy={"radius": RADIUS, "relaxation_time": TAU, "mach_max": 0.3},
        run={"strain": STRAIN},
        output={"series_every": 0.05, "snapshot_every": 0.5},
    )


def turned(result):
    """Strain, angle of the shape and angle of the membrane (rad), both positive with the vorticity."""
    strain = result.series("strain")
    shape = -unwrapped(section(result.cells("gyration")[:, 0])[1])
    times, x = result.vertices()
    membrane = np.concatenate([[0], np.cumsum([rotation_vector(a, b)[1] for a, b in zip(x[:-1], x[1:])])])
    return strain, shape, np.interp(strain, times, membrane)


def rates(result):
    """Mean turning rates of shape and membrane over the shear rate."""
    strain, shape, membrane = turned(result)
    first = int(np.searchsorted(strain, SETTLED))
    span = strain[-1] - strain[first]
    return (shape[-1] - shape[first]) / span, (membrane[-1] - membrane[first]) / span


def scenes():
    return {ca: cell(ca) for ca in CAPILLARY}


def rows(run):
    results = run.all(scenes())
    out, tumbling = [], {}
    for ca, result in results.items():
        shape, membrane = rates(result)
        tumbling[ca] = shape > membrane / 2
        drift = f"volume {100 * result.series('volume_drift_max').max():.2f} %, area {100 * result.series('area_drift_max').max():.2f} %"
        if ca <= 0.08 or ca >= 0.16:
            state = "tumbles" if ca <= 0.08 else "tank-treads"
            out.append(
                Row(
                    "red_cell",
                    f"Ca {ca}: {state}; turns of the shape / of the membrane",
                    shape / membrane,
                    0.5,
                    SOURCE,
                    test="above" if ca <= 0.08 else "below",
                    reason="a tumbling cell has 1, a tank-treading one 0",
                    settings=f"r {RADIUS}, box {BOX}, Re {RE}; shape {shape:.3f}, membrane {membrane:.3f} of the shear rate; {drift}",
                    seconds=result.seconds,
                )
            )
    below = max((ca for ca in CAPILLARY if tumbling[ca]), default=0.0)
    above = min((ca for ca in CAPILLARY if not tumbling[ca] and ca > below), default=float("nan"))
    out.append(
        Row(
            "red_cell",
            "transition between tumbling and tank-treading, Ca",
            (below + above) / 2,
            0.12,
            SOURCE,
            1 / 3,
            "the expected interval, 0.12 +- 0.04",
            error=(above - below) / 2,
            settings=f"r {RADIUS}; Ca = {CAPILLARY}",
            seconds=seconds(results),
        )
    )
    return out


def figures(run, folder):
    results = run.all(scenes())
    shown = (CAPILLARY[0], 0.08, 0.12, 0.16, CAPILLARY[-1])
    figure, (left, right) = panels(1, 2, sharex=True)
    for ca, colour in zip(shown, (*COLOURS, INK)):
        strain, shape, membrane = turned(results[ca])
        left.plot(strain, (shape - shape[0]) / (2 * np.pi), color=colour, label=f"Ca = {ca}")
        right.plot(strain, membrane / (2 * np.pi), color=colour)
    left.set(xlabel="strain", ylabel="turns of the shape")
    right.set(xlabel="strain", ylabel="turns of the membrane")
    left.legend(fontsize=9)
    save(figure, folder, "validation_red_cell.png")
    return [("validation_red_cell.png", "A red cell in shear: a tumbling cell turns as a whole, in a tank-treading one only the membrane turns.")]
