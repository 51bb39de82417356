"""Shapes, angles and extrapolations that several cases need."""

import numpy as np


def section(gyration):
    """D and inclination (rad) of the ellipsoid with these second moments [..., 6] (xx yy zz xy xz yz), cut by the shear plane through its centre."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(gyration), -1, 0)
    a, b, c = xx - xy * xy / yy, zz - yz * yz / yy, xz - xy * yz / yy  # Schur complement: the section, not the projection
    mean, half = (a + b) / 2, np.hypot((a - b) / 2, c)
    length, breadth = np.sqrt(mean + half), np.sqrt(mean - half)
    return (length - breadth) / (length + breadth), 0.5 * np.arctan2(2 * c, a - b)


def unwrapped(angle):
    """An angle that is known up to multiples of pi, made continuous in time."""
    return np.unwrap(2 * np.asarray(angle)) / 2


def rotation_vector(before, after):
    """Rotation (vector, rad) of a set of points about their centre (Kabsch)."""
    a, b = before - before.mean(0), after - after.mean(0)
    u, _, vt = np.linalg.svd(a.T @ b)
    turn = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    axial = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    sine = np.linalg.norm(axial)
    return axial if sine == 0 else axial / sine * np.arctan2(sine, (np.trace(turn) - 1) / 2)


def order(radii, values):
    """Order p of f = f_inf + a r^-p through three points; nan where they don't converge monotonically."""
    (r1, r2, r3), (f1, f2, f3) = radii, values
    if (f1 - f2) * (f2 - f3) <= 0:
        return np.nan
    wanted, p = (f1 - f2) / (f2 - f3), np.linspace(0.05, 8, 4000)
    ratio = (r1**-p - r2**-p) / (r2**-p - r3**-p)
    return np.nan if not ratio.min() <= wanted <= ratio.max() else float(np.interp(wanted, ratio, p))


def to_zero(h, values, powers=(1, 2)):
    """Limit h -> 0 of values = f_0 + sum a_k h^k (least squares), and the change when the last power is left out, as its error."""
    h, values = np.asarray(h, float), np.asarray(values, float)

    def limit(p):
        return np.linalg.lstsq(np.stack([np.ones_like(h)] + [h**k for k in p], 1), values, rcond=None)[0][0]

    best = limit(powers)
    return best, abs(best - limit(powers[:-1]))


def resolved(radii, values):
    """Limit r -> infinity of values at three radii, its error, and the observed order of convergence.

    Terms 1/r and 1/r^2 describe a shell of the kernel; where the values converge faster than 1/r^2 no such shell is seen, and the power law
    through them is the limit. The error is the difference between both; where there is no order, the difference to the line in 1/r.
    """
    limit, change = to_zero([1 / r for r in radii], values)
    p = order(radii, values)
    if not np.isfinite(p):
        return limit, change, p
    weights = [float(r) ** -p for r in radii]
    power = values[2] - (values[0] - values[2]) / (weights[0] - weights[2]) * weights[2]
    return power if p > 2 else limit, abs(limit - power), p


def block_error(values, blocks=8):
    """Standard error of the mean of a correlated series, from the scatter of the means of its blocks."""
    means = np.array([block.mean() for block in np.array_split(np.asarray(values), blocks)])
    return means.std(ddof=1) / np.sqrt(blocks)


def error_of_seeds(values, errors):
    """Standard error of the mean of repeats with other seeds: from their scatter or from their own errors, whichever is larger. A single one has no scatter."""
    scatter = np.std(values, ddof=1) if len(values) > 1 else 0.0
    return max(scatter, np.sqrt(np.mean(np.square(errors)))) / np.sqrt(len(values))


def viscosity_at(result, phi, exponent, settled):
    """Mean relative viscosity beyond the strain `settled`, taken from the run's phi_eff to `phi` with eta_r - 1 ~ phi^exponent, and its statistical error."""
    series = result.series("relative_viscosity")[result.series("strain") > settled]
    to_phi = (phi / result.summary["phi_effective"]) ** exponent
    return 1 + (series.mean() - 1) * to_phi, block_error(series) * to_phi


def stated_resolution(result):
    """What the run's summary says about its resolution: relative error of the viscosity and its uncertainty."""
    return result.summary["viscosity_resolution_error"], result.summary["viscosity_resolution_error_uncertainty"]
