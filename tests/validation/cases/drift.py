"""Volume and area of a red cell over many units of strain, from stiff to soft."""

import numpy as np

from plots import BLUE, GREEN, INK, ORANGE, panels, save
from rows import Row
from simulations import scene

TITLE = "Drift of volume and area"
ABOUT = """
One red cell in a small box, sheared by 100 units of strain with the settings of the presets, and with wider kernels and BGK; at the stiff end, where membranes
relax within the step (chebyshev), by 10 with r = 12, whose 100 would take two hours. Shown is the largest deviation from the reference shape in the
whole run. Area also changes elastically: the membrane's area modulus is finite, so the area deviation of a soft cell is no numerical drift;
its trend (mean of the last tenth minus mean of the second tenth) is stated beside it.
"""
COST = 60
STIFF_CA = 4.2e-5  # the stiffest of Gross et al.
BOX = (3, 2.5, 4)
WIDE, USUAL = "r = 12, 4 points", "r = 8, 3 points"
SETTINGS = {
    WIDE: {"radius": 12, "delta_kernel": 4, "precision": "double", "relaxation_time": 3.0},
    USUAL: {"radius": 8, "delta_kernel": 3, "collision": "bgk", "relaxation_time": 3.0},
} | {preset: {"preset": preset} for preset in ("draft", "standard", "reference")}
CASES = {  # settings, Ca: strain
    (WIDE, STIFF_CA): 10,
    (WIDE, 0.081): 100,
    (WIDE, 1.0): 100,
    (USUAL, STIFF_CA): 100,
    (USUAL, 0.081): 100,
    (USUAL, 1.0): 100,
} | {(preset, 0.081): 100 for preset in ("draft", "standard", "reference")}
PRESET_BOUND = {"draft": 3.0}  # per cent; else 1


def cell(settings, ca, strain):
    stiff = {"vertex_update": "chebyshev", "relaxation_time": 1.0} if ca == STIFF_CA else {}
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number": ca, "reynolds_number_max": 0.25},  # lowered by the stiffness limit at small Ca
        cells=[{"shape": "red_cell", "count": 1, "position": [size / 2 for size in BOX], "axis": [0.3, 0.0, 1.0]}],
        accuracy={"mach_max": 0.3} | SETTINGS[settings] | stiff,
        run={"strain": strain},
        output={"series_every": strain / 1000, "snapshot_every": 0},
    )


def scenes():
    return {key: cell(*key, strain) for key, strain in CASES.items()}


def relative(result):
    """Strain, V/V0 - 1 and A/A0 - 1."""
    return (
        result.series("strain"),
        result.cells("volume")[:, 0] / result.cell_type["volume"] - 1,
        result.cells("area")[:, 0] / result.cell_type["area"] - 1,
    )


def rows(run):
    out = []
    for (settings, ca), result in run.all(scenes()).items():
        strain, volume, area = relative(result)
        end = CASES[settings, ca]
        for name, values in (("volume", volume), ("area", area)):
            trend = values[strain > 0.9 * end].mean() - values[(strain > 0.1 * end) & (strain < 0.2 * end)].mean()
            out.append(
                Row(
                    "drift",
                    f"largest {name} change (%), {settings}, Ca {ca:g}, {end} strain units",
                    100 * np.abs(values).max(),
                    PRESET_BOUND.get(settings, 1.0),
                    "required accuracy",
                    test="below",
                    settings=f"r {result.lattice['radius']:g}, box {BOX}, tau {result.lattice['relaxation_time']:g}, Re {result.lattice['reynolds_number']:.2g}, "
                    f"{result.lattice['steps']} steps; trend {100 * trend:+.3f} %",
                    seconds=result.seconds,
                )
            )
    return out


def figures(run, folder):
    figure, axes = panels(1, 2, sharex=True)
    styles = {WIDE: "-", USUAL: ":", "reference": "-", "standard": ":", "draft": "--"}
    colours = {(True, STIFF_CA): BLUE, (True, 0.081): ORANGE, (True, 1.0): GREEN, (False, 0.081): INK}
    for (settings, ca), result in run.all(scenes()).items():
        strain, volume, area = relative(result)
        for axis, values in zip(axes, (volume, area)):
            axis.plot(
                strain, 100 * values, color=colours[settings in (WIDE, USUAL), ca], linestyle=styles[settings], linewidth=1, label=f"{settings}, Ca = {ca:g}"
            )
    axes[0].set(xlabel="strain", ylabel="volume change (%)")
    axes[1].set(xlabel="strain", ylabel="area change (%)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    save(figure, folder, "validation_drift.png")
    return [("validation_drift.png", "Volume and area of one red cell over up to 100 units of strain.")]
