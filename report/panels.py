"""Panels that the figures of ./dev report have in common: a quantity against volume fraction and capillary number, curves of a family of runs."""
import math

from analysis_data import Value
from style import PAGE, Palette, draw_points, log_ticks, np, pale_key, phi_axis, plt


class Missing(Exception):
    """Nothing of a figure can be drawn; the text says why."""


class Drawn:
    """What a figure function returns: the figure, what the paper shows, what is seen here."""

    def __init__(self, figure, paper, seen):
        self.figure, self.paper, self.seen = figure, paper, seen


def palettes(sweep):
    return {"phi": Palette("phi", sweep.phis), "ca": Palette("ca", sweep.cas)}


def abscissas(sweep):
    """What a sweep can be drawn against: "phi", "ca", or both."""
    found = [name for name, values in (("phi", sweep.phis), ("ca", sweep.cas)) if len(values) > 1]
    return found or ["phi"]


def draw_against(axes, sweep, abscissa, value_of, tally, hollow=False, line=True, y_log=True):
    """Points of `value_of(run)` (a Value) against phi with a symbol per Ca, or the other way round. Sets the scales; call finish_against at the end."""
    axes.set_xscale("log")
    axes.set_yscale("log" if y_log else "linear")
    looks = palettes(sweep)["ca" if abscissa == "phi" else "phi"]
    count = 0
    for other in looks.values:
        runs = sweep.of(ca=other) if abscissa == "phi" else sweep.of(phi=other)
        points = [(r.phi if abscissa == "phi" else r.ca, value_of(r), r.name) for r in runs]
        count += draw_points(axes, points, looks.look(other), tally, line=line, hollow=hollow)
    return count


def finish_against(axes, sweep, abscissa, y_label=None):
    """Limits and ticks of a panel of draw_against."""
    values = sweep.phis if abscissa == "phi" else sweep.ca_range()
    margin = 1.12 if abscissa == "phi" else 1.6
    axes.set_xlim(values[0] / margin, values[-1] * margin)
    if abscissa == "phi":
        phi_axis(axes)
    else:
        axes.set_xlabel("capillary number Ca")
        log_ticks(axes.xaxis)
    if axes.get_yscale() == "log":
        log_ticks(axes.yaxis)
    if y_label:
        axes.set_ylabel(y_label)


def key_below(figure, panel_of, sweep, tally, line=True, extra=()):
    """Legends below the figure: capillary numbers under the panels against phi, volume fractions under those against Ca."""
    looks = palettes(sweep)
    wanted = list(panel_of)
    for abscissa in wanted:
        keys = looks["ca" if abscissa == "phi" else "phi"].keys(line=line)
        if abscissa == wanted[0]:
            keys += list(extra) + ([pale_key()] if tally.pale else [])
        place = "lower center" if len(wanted) == 1 else ("lower left" if abscissa == wanted[0] else "lower right")
        figure.legend(handles=keys, loc=f"outside {place}", ncols=3 if len(wanted) > 1 else 5)


def grid_against(sweep, rows, tally, y_log=True, hollow=None, share_rows=False, height=5.2, extra=()):
    """A figure with a row for each (label of the ordinate, function of a run) and a column for each abscissa of the sweep. `hollow`: a second function
    for each row whose points are drawn open. Returns figure and axes [row][column]."""
    columns = abscissas(sweep)
    figure, grid = plt.subplots(len(rows), len(columns), figsize=(PAGE, (height * len(rows) + 1.5) / 2.54), squeeze=False, sharey="all" if share_rows else "row")
    count = 0
    for i, (label, value_of) in enumerate(rows):
        for j, abscissa in enumerate(columns):
            counter = tally if j == 0 else type(tally)()  # both columns show the same points: they are counted once
            count += draw_against(grid[i][j], sweep, abscissa, value_of, counter, y_log=y_log)
            if hollow:
                count += draw_against(grid[i][j], sweep, abscissa, hollow[i], counter, hollow=True, line=False, y_log=y_log)
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    for i, (label, _) in enumerate(rows):
        for j, abscissa in enumerate(columns):
            finish_against(grid[i][j], sweep, abscissa, label if j == 0 else None)
    key_below(figure, columns, sweep, tally, extra=extra)
    return figure, grid


def why_nothing(tally):
    return "; ".join(f"{places[0]}{' and others' if len(places) > 1 else ''}: {reason.rstrip('.')}" for reason, places in tally.missing.items()) or "there is no run"


class Family:
    """Runs that differ in one number: for panels with a curve of each."""

    def __init__(self, title, runs, looks, value_of):
        self.title, self.runs, self.looks, self._value_of = title, runs, looks, value_of

    def look(self, run):
        return self.looks.look(self._value_of(run))

    def text(self, run):
        return self.looks.text(self._value_of(run))


def families(sweep):
    """The volume fractions at the capillary number that has most of them (the largest of these), and the same the other way round."""
    found, looks = [], palettes(sweep)
    ca = max(sweep.cas, key=lambda c: (len({r.phi_group for r in sweep.of(ca=c)}), c))
    phi = max(sweep.phis, key=lambda p: (len({r.ca_group for r in sweep.of(phi=p)}), p))
    if len(sweep.phis) > 1 or len(sweep.cas) == 1:
        runs = {r.phi_group: r for r in sweep.of(ca=ca)}  # one of each
        found.append(Family(looks["ca"].text(ca), [runs[p] for p in sorted(runs)], looks["phi"], lambda r: r.phi_group))
    if len(sweep.cas) > 1:
        runs = {r.ca_group: r for r in sweep.of(phi=phi)}
        found.append(Family(looks["phi"].text(phi), [runs[c] for c in sorted(runs)], looks["ca"], lambda r: r.ca_group))
    return found


def decayed(curves):
    """Lag that shows all decays: 2.5 times the one at which the slowest curve is below 0.1, or all lags where one never is."""
    ends, longest = [], 0.0
    for curve in curves:
        if curve.exists():
            below = np.flatnonzero(curve.value < 0.1)
            ends.append(2.5 * curve.x[below[0]] if len(below) else math.inf)
            longest = max(longest, curve.x[-1])
    return min(max(ends), longest) if ends else 1.0


def power_law(xs, values):
    """Exponent and prefactor of a weighted straight line through the logarithms of converged positive points, as Values; None with fewer than three."""
    kept = [(x, v) for x, v in zip(xs, values) if v.converged and v.value > 0 and x > 0]
    if len({x for x, _ in kept}) < 3:
        return None
    x, y = np.log([x for x, _ in kept]), np.log([v.value for _, v in kept])
    error = np.array([v.error / v.value if math.isfinite(v.error) and v.error > 0 else math.nan for _, v in kept])
    known = np.isfinite(error).all()
    weight = 1 / error if known else np.ones(len(x))
    # With errors of the points the covariance is theirs, but widened where the points scatter by more: the law holds only roughly.
    design = np.stack([x, np.ones(len(x))], axis=1) * weight[:, None]
    solution, *_ = np.linalg.lstsq(design, y * weight, rcond=None)
    chi2 = np.sum((design @ solution - y * weight) ** 2) / (len(x) - 2)
    covariance = np.linalg.inv(design.T @ design) * (max(chi2, 1.0) if known else chi2)
    exponent = Value({"value": solution[0], "error": math.sqrt(covariance[0, 0]), "converged": True})
    prefactor = Value({"value": math.exp(solution[1]), "error": math.exp(solution[1]) * math.sqrt(covariance[1, 1]), "converged": True})
    return exponent, prefactor


def value_range(values):
    """(smallest, largest) of what is finite, or None."""
    finite = [v.value for v in values if v.exists()]
    return (min(finite), max(finite)) if finite else None
