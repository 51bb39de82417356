"""Volume and area of a red cell over 100 units of strain, from stiff to soft."""

import numpy as np

from plots import BLUE, GREEN, ORANGE, panels, save
from rows import Row
from simulations import scene

TITLE = "Drift of volume and area"
ABOUT = """
One red cell in a small box, sheared by 100 units of strain with the settings of a preset. Shown is the largest deviation from the reference
shape in the whole run. Area also changes elastically: the membrane's area modulus is finite, so the area deviation of a soft cell is no
numerical drift; its trend (mean of the last tenth minus mean of the second tenth) is stated beside it.
"""
COST = 16
STIFF_CA = 2.8e-3  # smallest Ca that takes minutes: the explicit membrane costs r/(1.2 Ca) steps per strain
BOX, STRAIN = (3, 2.5, 4), 100
CASES = {
    ("reference", STIFF_CA): 0.25,
    ("reference", 0.081): 0.25,
    ("reference", 1.0): 0.25,  # Re; lowered by the stiffness limit at small Ca
    ("standard", STIFF_CA): 0.25,
    ("standard", 0.081): 0.25,
    ("standard", 1.0): 0.25,
}


def cell(preset, ca, re):
    return scene(
        box={"size": list(BOX)},
        flow={"capillary_number": ca, "reynolds_number_max": re},
        cells=[{"shape": "red_cell", "count": 1, "position": [size / 2 for size in BOX], "axis": [0.3, 0.0, 1.0]}],
        accuracy={"preset": preset, "relaxation_time": 3.0, "mach_max": 0.3},
        run={"strain": STRAIN},
        output={"series_every": 0.1, "snapshot_every": 0},
    )


def scenes():
    return {key: cell(*key, re) for key, re in CASES.items()}


def relative(result):
    """Strain, V/V0 - 1 and A/A0 - 1."""
    return (
        result.series("strain"),
        result.cells("volume")[:, 0] / result.cell_type["volume"] - 1,
        result.cells("area")[:, 0] / result.cell_type["area"] - 1,
    )


def rows(run):
    out = []
    for (preset, ca), result in run.all(scenes()).items():
        strain, volume, area = relative(result)
        for name, values in (("volume", volume), ("area", area)):
            trend = values[strain > 0.9 * STRAIN].mean() - values[(strain > 0.1 * STRAIN) & (strain < 0.2 * STRAIN)].mean()
            out.append(
                Row(
                    "drift",
                    f"largest {name} change (%), {preset}, Ca {ca:g}",
                    100 * np.abs(values).max(),
                    1.0,
                    "required accuracy",
                    test="below",
                    settings=f"r {result.lattice['radius']:g}, box {BOX}, tau 3, Re {result.lattice['reynolds_number']:.2g}, "
                    f"{result.lattice['steps']} steps; trend {100 * trend:+.3f} %",
                    seconds=result.seconds,
                )
            )
    return out


def figures(run, folder):
    figure, axes = panels(1, 2, sharex=True)
    for ((preset, ca), result), colour in zip(run.all(scenes()).items(), 2 * (BLUE, ORANGE, GREEN)):
        strain, volume, area = relative(result)
        for axis, values in zip(axes, (volume, area)):
            axis.plot(
                strain, 100 * values, color=colour, linestyle="-" if preset == "reference" else ":", linewidth=1, label=f"{preset}, Ca = {ca:g}"
            )
    axes[0].set(xlabel="strain", ylabel="volume change (%)")
    axes[1].set(xlabel="strain", ylabel="area change (%)")
    axes[0].legend(fontsize=8)
    save(figure, folder, "validation_drift.png")
    return [("validation_drift.png", "Volume and area of one red cell over 100 units of strain.")]
