"""Jeffery orbits of stiff spheroids: period of rotation of the symmetry axis in the shear plane."""

import numpy as np

import stiff_sphere
from analysis import section, to_zero, unwrapped
from plots import BLUE, GREEN, INK, panels, save
from rows import Row
from simulations import scene, seconds

TITLE = "Jeffery orbits of stiff spheroids"
ABOUT = """
A stiff spheroid (Skalak membrane with bending stiffness, Ca_G = 0.02) turns with its axis in the shear plane. Half a period is the strain
in which the axis turns by 180 degrees, averaged over all starts in the run. The kernel's shell makes the particle rounder, (a + h)/(b + h)
instead of a/b: the period is extrapolated to 1/r = 0; and at the largest r it is compared with Jeffery's period of the aspect ratio with
the shell h that [eta] of a stiff sphere gives, without a fit.
"""
COST = 10
SHAPES = {"prolate 2": (2.0, (6, 8, 11)), "prolate 3": (3.0, (8, 10, 12)), "oblate 0.3235": (0.3235, (6, 8, 11))}
BOX, WIDE, CA, RE, TAU, KERNEL = (6, 4, 6), (8, 6, 8), 0.02, 0.1, 3.0, 3
SETTLED = 0.5


def jeffery(p):
    """Period times shear rate."""
    return 2 * np.pi * (p + 1 / p)


def spheroid(p, radius, box=BOX, ca=CA):
    return scene(
        box={"size": list(box)},
        flow={"capillary_number_G": ca, "reynolds_number_max": RE},
        cells=[
            {
                "shape": "spheroid",
                "aspect_ratio": p,
                "count": 1,
                "position": [size / 2 for size in box],
                "axis": [0.0, 0.0, 1.0],
                "membrane": stiff_sphere.stiff_membrane(radius),
            }
        ],
        contact={"enabled": False},
        accuracy={
            "radius": radius,
            "delta_kernel": KERNEL,
            "collision": "trt",
            "relaxation_time": TAU,
            "precision": "single",
            "mach_max": 0.3,
            "shear_modulus": stiff_sphere.MODULUS,
        },
        run={"strain": round(jeffery(p) / 2 + 1.5, 1)},
        output={"series_every": 0.02, "snapshot_every": 0},
    )


def period(result):
    """Period times shear rate, and its spread over the starts within the run."""
    strain = result.series("strain")
    turned = -unwrapped(section(result.cells("gyration")[:, 0])[1])
    starts = np.nonzero((strain > SETTLED) & (turned + np.pi < turned[-1]))[0]
    halves = [np.interp(turned[i] + np.pi, turned, strain) - strain[i] for i in starts]
    return 2 * np.mean(halves), 2 * np.std(halves)


def scenes():
    todo = {}
    for name, (p, radii) in SHAPES.items():
        todo |= {(name, radius): spheroid(p, radius) for radius in radii}
        todo[name, "box"] = spheroid(p, radii[0], box=WIDE)
        todo[name, "stiff"] = spheroid(p, radii[0], ca=CA / 2)
    return todo


def with_shell(p, radius, h):
    """Period of the spheroid whose semi-axes are h larger."""
    long, short = radius + h, radius * min(p, 1 / p) + h
    return jeffery(long / short)


def rows(run):
    results, shell = run.all(scenes()), stiff_sphere.shells(run)
    h = shell[KERNEL, stiff_sphere.RADII[-1]]
    out = []
    for name, (p, radii) in SHAPES.items():
        periods = {key: period(results[name, key])[0] for key in (*radii, "box", "stiff")}
        first = periods[radii[0]]
        cost = seconds([result for key, result in results.items() if key[0] == name])
        limit, error = to_zero([1 / r for r in radii], [periods[r] for r in radii])
        d = section(results[name, radii[-1]].cells("gyration")[:, 0])[0]
        box = periods["box"] - first
        detail = (
            f"r {radii}: {', '.join(f'{periods[r]:.2f}' for r in radii)}; box {WIDE} r instead of {BOX} r: {100 * box / first:+.1f} %; "
            f"Ca_G and Re halved: {100 * (periods['stiff'] / first - 1):+.1f} %; Re {results[name, radii[0]].lattice['reynolds_number']:.3f} to "
            f"{results[name, radii[-1]].lattice['reynolds_number']:.3f}; D in the shear plane {d.min():.3f} to {d.max():.3f} (at rest {d[0]:.3f})"
        )
        out.append(
            Row(
                "jeffery",
                f"period, {name}, r to infinity",
                limit + box,
                jeffery(p),
                "Jeffery 1922",
                0.03,
                "3 %: extrapolation of a shell that shortens the period by up to 30 %, box, inertia and softness below 1 % each",
                error=error,
                settings=detail,
                seconds=cost,
            )
        )
        expected = with_shell(p, radii[-1], h)
        out.append(
            Row(
                "jeffery",
                f"period, {name}, r = {radii[-1]}, aspect ratio with shell",
                periods[radii[-1]] + box,
                expected,
                "Jeffery 1922 with the shell measured by [eta] of a stiff sphere",
                0.03,
                "3 %: an error of 0.1 lattice units in the shell",
                settings=f"h = {h:.2f} lattice units, aspect ratio {(radii[-1] + h) / (radii[-1] * min(p, 1 / p) + h):.3f}; kernel {KERNEL}",
                seconds=results[name, radii[-1]].seconds,
            )
        )
    return out


def figures(run, folder):
    results, h = run.all(scenes()), stiff_sphere.shells(run)[KERNEL, stiff_sphere.RADII[-1]]
    figure, axes = panels(1, len(SHAPES), width=11, sharey=True)
    for (name, (p, radii)), axis in zip(SHAPES.items(), axes):
        for radius, colour in zip((radii[0], radii[-1]), (GREEN, BLUE)):
            result = results[name, radius]
            strain, angle = result.series("strain"), -unwrapped(section(result.cells("gyration")[:, 0])[1])
            axis.plot(strain, np.degrees(angle - angle[0]), color=colour, label=f"r = {radius}")
            if radius == radii[-1]:
                for ratio, style, label in ((p, "--", "Jeffery"), (with_aspect(p, radius, h), ":", "Jeffery, aspect ratio with shell")):
                    axis.plot(strain, np.degrees(orbit(ratio, strain)), style, color=INK, label=label)
        axis.set(title=name, xlabel="strain")
    axes[0].set_ylabel("angle turned (degrees)")
    axes[0].legend(fontsize=8)
    save(figure, folder, "validation_jeffery.png")
    return [("validation_jeffery.png", "Jeffery orbits: angle of the axis from the gradient direction against strain.")]


def with_aspect(p, radius, h):
    """Aspect ratio (> 1 prolate, < 1 oblate) of the spheroid with semi-axes larger by h."""
    ratio = (radius + h) / (radius * min(p, 1 / p) + h)
    return ratio if p > 1 else 1 / ratio


def orbit(p, strain):
    """Angle turned (rad) by the axis of a spheroid of aspect ratio p that starts along the gradient: tan = p tan(strain/(p + 1/p))."""
    phase = strain / (p + 1 / p)
    return np.arctan2(p * np.sin(phase), np.cos(phase)) % (2 * np.pi)
