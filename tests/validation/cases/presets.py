"""What the presets promise, in the scene that everybody runs first."""

import pathlib
import re

import numpy as np

from analysis import error_of_seeds, stated_resolution, viscosity_at
from rows import Row
from simulations import seconds

TITLE = "Presets: draft, standard and reference in the quickstart"
ABOUT = """
`scenes/quickstart.toml` with each preset, several packings of the coarse ones. The presets are measured settings of docs/accuracy.md, whose studies have
another box, another Reynolds number and other packings. The viscosity is compared with that of the preset reference without the part that the studies
say is its own resolution's; numbers of cells are whole, so all viscosities are taken to phi_eff = 0.2 with eta_r - 1 ~ phi^1.4, the exponent of that study.
The last row compares counted work (time steps, nodes and vertices), which doesn't depend on the machine.
"""
COST = 30
PHI, EXPONENT, SETTLED = 0.2, 1.4, 2.5
SEEDS = {"draft": (1, 2, 3, 4), "standard": (1, 2, 3, 4), "reference": (1,)}
CLAIMED = {"draft": 0.15, "standard": 0.05, "reference": 0.05}  # docs/scene.md
VERTEX_COST = 8.7  # of a node's time, 2 points (docs/performance.md, A coupled step)


def quickstart(preset, seed):
    text = (pathlib.Path(__file__).parents[3] / "scenes/quickstart.toml").read_text()
    text = text.replace('preset = "draft"', f'preset = "{preset}"').replace("[run]\n", f"[run]\nseed = {seed}\n")
    return re.sub(r"(?m)^snapshot_every = .*$", "snapshot_every = 0", re.sub(r"(?m)^#.*\n", "", text))


def scenes():
    return {(preset, seed): quickstart(preset, seed) for preset, seeds in SEEDS.items() for seed in seeds}


def viscosity(result):
    """eta_r at PHI and its statistical error."""
    return viscosity_at(result, PHI, EXPONENT, SETTLED)


def work(result):
    """Node updates, a vertex counted with its time."""
    nodes, vertices = np.prod(result.lattice["nodes"]), result.cell_type["count"] * result.cell_type["vertices"]
    return result.summary["steps"] * float(nodes + VERTEX_COST * vertices)


def rows(run):
    results = run.all(scenes())
    means = {}
    for preset, seeds in SEEDS.items():
        values, errors = zip(*(viscosity(results[preset, seed]) for seed in seeds))
        means[preset] = np.mean(values), error_of_seeds(values, errors)
    shift, known = stated_resolution(results["reference", 1])
    limit = means["reference"][0] / (1 + shift)
    uncertainty = known + means["reference"][1] / means["reference"][0]
    out = []
    for preset, seeds in SEEDS.items():
        mine = {seed: results[preset, seed] for seed in seeds}
        value, error = means[preset]
        off, give_or_take = stated_resolution(mine[1])
        out.append(
            Row(
                "presets",
                f"eta_r, preset {preset}",
                value,
                limit,
                "the preset reference without its stated error",
                CLAIMED[preset] + uncertainty + 2 * error / value,
                "the claim, the uncertainty of the limit, and 2 standard errors",
                error=error,
                settings=f"stated {100 * off:+.0f} ± {100 * give_or_take:.0f} %; seeds {seeds}",
                seconds=seconds(mine),
            )
        )
    ratio = work(results["reference", 1]) / work(results["draft", 1])
    out.append(Row("presets", "work of reference over that of draft", ratio, 20, "required", test="above", settings="updates of nodes, a vertex counted with its time"))
    return out
