"""Figures 2 and 3 of Gross, Krüger & Varnik (EPL 2014) from an analysed sweep: velocity fluctuations, their densities, gap size and dissipation balance."""
import math

from analysis_data import Value, combined
from panels import Drawn, Missing, abscissas, draw_against, families, finish_against, palettes, power_law, value_range, why_nothing
from style import COLUMN, INK, PAGE, draw_curve, draw_points, key, log_ticks, np, pale_key, plt, value_text

SQUARE = {"x": r"$\langle\delta u_x^2\rangle/(\dot\gamma r)^2$", "y": r"$\langle\delta u_y^2\rangle/(\dot\gamma r)^2$", "z": r"$\langle\delta u_z^2\rangle/(\dot\gamma r)^2$"}
DIRECTIONS = {"x": "flow", "y": "vorticity", "z": "gradient"}


def variances(sweep, tally):
    rows = abscissas(sweep)
    figure, grid = plt.subplots(len(rows), 3, figsize=(PAGE, (5.4 * len(rows) + 0.6) / 2.54), squeeze=False, sharey=True, sharex="row")
    looks, count = palettes(sweep), 0
    for i, abscissa in enumerate(rows):
        for axes, name in zip(grid[i], "xyz"):
            counter = tally if i == 0 else type(tally)()
            count += draw_against(axes, sweep, abscissa, lambda r, n=name: r.estimate(f"velocity_variance_{n}"), counter)
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    for i, abscissa in enumerate(rows):
        for axes, name in zip(grid[i], "xyz"):
            finish_against(axes, sweep, abscissa)
            if i == 0:
                axes.set_title(f"{name}, {DIRECTIONS[name]}: {SQUARE[name]}")
        grid[i][0].set_ylabel(r"variance $\langle\delta u^2\rangle/(\dot\gamma r)^2$")
        keys = looks["ca" if abscissa == "phi" else "phi"].keys() + ([pale_key()] if tally.pale and i == 0 else [])
        grid[i][-1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.03, 1.0), borderaxespad=0)
    seen = []
    ratio = [r.estimate("velocity_variance_x").value / r.estimate("velocity_variance_z").value for r in sweep.runs
             if r.estimate("velocity_variance_x").exists() and r.estimate("velocity_variance_z").value > 0]
    if ratio:
        seen.append(f"x over z: {min(ratio):.2f} to {max(ratio):.2f}.")
    for phi in sweep.phis[-1:] if "ca" in rows else []:
        fit = power_law([r.ca for r in sweep.of(phi=phi)], [r.estimate("velocity_variance_z") for r in sweep.of(phi=phi)])
        if fit:
            seen.append(f"At φ = {phi:.2f} the variance along z goes as Ca^{value_text(fit[0].value, fit[0].error)}.")
    return Drawn(figure, "Variances of the cells' velocities about the mean flow in units of (γ̇r)², against φ and Ca.", seen)


def core_and_tails_line(x, fit):
    """Density of the fit at x (same unit as the fit): Gaussian between the tails' starts, exponentials beyond; NaN where a part is unknown."""
    p = {name: value.value for name, value in fit.parameters.items()}
    get = lambda name: p.get(name, math.nan)
    density = get("core_height") * np.exp(-(x - get("core_centre")) ** 2 / (2 * get("core_width") ** 2))
    low, high = get("lower_start"), get("upper_start")
    core = np.where((x > low if math.isfinite(low) else True) & (x < high if math.isfinite(high) else True), density, math.nan)
    lower = np.where(x <= low, get("lower_height") * np.exp(-np.abs(x - low) / get("lower_decay")), math.nan)
    upper = np.where(x >= high, get("upper_height") * np.exp(-np.abs(x - high) / get("upper_decay")), math.nan)
    return core, lower, upper


def draw_density(axes, run, component, look, tally, label=None):
    """A density over its standard deviation, and its fit. Returns (width, decay, lowest density): of core and tails in standard deviations, NaN without
    a fit; None where there is no density."""
    curve, fit = run.curve(f"pdf_velocity_{component}"), run.fit(f"pdf_velocity_{component}_core_and_tails")
    variance = run.estimate(f"velocity_variance_{component}").value
    if not variance > 0:
        tally.miss(run.name, "the variance is not known")
        return None
    deviation = math.sqrt(variance)
    drawn = draw_curve(axes, curve, look, tally, run.name, transform=lambda x, v, e: (x / deviation, v * deviation, e * deviation), symbols=26, line=False, label=label)
    if drawn is None:
        return None
    if not fit.parameters:
        return math.nan, math.nan, drawn[1].min()
    x = np.linspace(drawn[0].min(), drawn[0].max(), 400)
    for part in core_and_tails_line(x * deviation, fit):
        axes.plot(x, np.where(part > 0, part, math.nan) * deviation, color=look[0], linewidth=0.8, linestyle="-" if fit.converged else "--", zorder=2)
    decays = [fit[name].value / deviation for name in ("lower_decay", "upper_decay") if fit[name].exists()]
    return fit["core_width"].value / deviation, float(np.mean(decays)) if decays else math.nan, drawn[1].min()


def widths_text(pairs):
    """Legend text with w and d of both directions, y | z."""
    texts = []
    for symbol, values in zip("wd", zip(*pairs)):
        texts.append(f"${symbol}$ = " + " | ".join(f"{v:.2f}" if math.isfinite(v) else "?" for v in values))
    return ", ".join(texts)


def densities(sweep, tally):
    groups = families(sweep)
    figure, grid = plt.subplots(len(groups), 2, figsize=(PAGE, (6.2 * len(groups) + 0.4) / 2.54), squeeze=False, sharex=True, sharey=True)
    count, lowest = 0, 1e-3
    for row, family in zip(grid, groups):
        keys = []
        for run in family.runs:
            pairs = []
            for axes, component in zip(row, "yz"):
                axes.set_yscale("log")
                found = draw_density(axes, run, component, family.look(run), tally)
                pairs.append(found[:2] if found else (math.nan, math.nan))
                if found:
                    count += 1
                    lowest = min(lowest, found[2])
            keys.append(key(*family.look(run), family.text(run) + ":\n" + widths_text(pairs)))
        row[-1].legend(handles=keys[::-1], loc="upper left", bbox_to_anchor=(1.02, 1.02), borderaxespad=0, title=family.title + "   ($y$ | $z$)", title_fontsize=7, alignment="left",
                       labelspacing=0.35)
        row[0].set_ylabel(r"$p(\delta u)\,\langle\delta u^2\rangle^{1/2}$")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    grid[0][0].set_ylim(max(lowest / 3, 1e-7), 1.5)
    for axes, component in zip(grid[-1], "yz"):
        axes.set_xlabel(rf"$\delta u_{component}/\langle\delta u_{component}^2\rangle^{{1/2}}$")
    seen = ["Lines: Gaussian core h exp[−(x−c)²/(2w²)] within 1 and exponential tails exp(−|x|/d) beyond 2 standard deviations; w and d in standard deviations."]
    for component in "yz":
        kurtosis = value_range([r.estimate(f"velocity_kurtosis_{component}") for r in sweep.runs])
        if kurtosis:
            seen.append(f"Excess kurtosis along {component}: {kurtosis[0]:.2g} to {kurtosis[1]:.2g} (Gaussian: 0, exponential throughout: 3).")
    return Drawn(figure, "Gaussian cores and exponential tails.", seen)


def gap_theory(phi):
    return 2 * (phi ** (-1 / 3) - 1)


def radius_fit(sweep):
    """r' over r with its error, or None. The fit is in lattice units."""
    slope = sweep.gap_radius["slope"]
    radii = [r.radius for r in sweep.runs if r.radius > 0]
    if not slope.exists() or not radii:
        return None
    return slope.scaled(1 / radii[0])


def gap(sweep, tally):
    figure, axes = plt.subplots(figsize=(COLUMN, 7.4 / 2.54))
    axes.set(xscale="log", yscale="log")
    looks, count = palettes(sweep), 0
    for ca in sweep.cas:  # against the fraction that the balance is made with
        count += draw_points(axes, [(r.phi_bulk(), r.estimate("gap_size"), r.name) for r in sweep.of(ca=ca)], looks["ca"].look(ca), tally, line=False)
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    keys, seen = looks["ca"].keys(line=False), []
    fitted, lattice = radius_fit(sweep), sweep.gap_radius["slope"]
    phi = np.linspace(min(0.9 * sweep.phis[0], 0.2), min(1.05 * sweep.phis[-1], 0.99), 200)
    if fitted:
        axes.plot(phi, fitted.value * gap_theory(phi), color=INK, linestyle="-" if sweep.gap_radius.converged else "--", zorder=1)
        keys.append(key(INK, "", rf"$2r'(\phi^{{-1/3}}-1)$, $r'$ = {value_text(fitted.value, fitted.error)} $r$", style="-" if sweep.gap_radius.converged else "--"))
        seen.append(f"Fitted r′ = {value_text(lattice.value, lattice.error)} Δx = {value_text(fitted.value, fitted.error)} r (φ ≥ 0.2)."
                    + ("" if sweep.gap_radius.converged else f" The fit is not converged: {sweep.gap_radius.reason.rstrip('.')}."))
    else:
        seen.append(f"r′ is not fitted: {sweep.gap_radius.reason.rstrip('.')}.")
    finish_against(axes, sweep, "phi", r"gap $l/r$")
    axes.legend(handles=keys + ([pale_key()] if tally.pale else []), loc="lower left")
    return Drawn(figure, "Gap l between cells from the dissipation balance falls with φ as 2r′(φ^−⅓ − 1) for φ ≳ 0.2, with r′ ≈ 2 lattice units at r = 9.", seen)


def total_variance(run):
    return combined(lambda *v: sum(v), [run.estimate(f"velocity_variance_{n}") for n in "xyz"])


def balance_of(run, radius):
    """(right side, left side) of the balance in r²: [(η/η₀ − 1)/(1 − φ) − 1] l² with l = 2r′(φ^(−1/3) − 1), and Σ<δu²>/γ̇²."""
    phi = run.phi_bulk()
    left = total_variance(run)
    right = combined(lambda eta: ((eta - 1) / (1 - phi) - 1) * (radius * gap_theory(phi)) ** 2, [run.estimate("relative_viscosity")])
    return right, left


def balance(sweep, tally):
    fitted = radius_fit(sweep)
    radius = fitted.value if fitted else 2 / 9
    looks = palettes(sweep)["ca"]
    points, ratios = [], []
    for run in sweep.runs:
        right, left = balance_of(run, radius)
        if not (right.exists() and left.exists()):
            tally.miss(run.name, right.reason or left.reason)
        elif right.value <= 0 or left.value <= 0:
            tally.miss(run.name, "less particle stress than that of the displaced fluid: no gap to speak of")
        else:
            points.append((run, right, left))
            ratios.append(left.value / right.value)
    if not points:
        raise Missing(why_nothing(tally))
    figure, axes = plt.subplots(figsize=(1.25 * COLUMN, 7.4 / 2.54))
    axes.set(xscale="log", yscale="log")
    for run, right, left in points:
        value = Value({"value": left.value, "error": left.error, "converged": left.converged and right.converged})
        draw_points(axes, [(right.value, value, run.name)], looks.look(run.ca_group), tally)
        if math.isfinite(right.error):
            axes.plot([max(right.value - right.error, 0.1 * right.value), right.value + right.error], [left.value] * 2, color=looks.look(run.ca_group)[0], linewidth=0.6,
                      alpha=1 if value.converged else 0.45, zorder=2)
    ends = [v.value for _, right, left in points for v in (right, left)]
    limits = (0.6 * min(ends), 1.6 * max(ends))
    axes.plot(limits, limits, color=INK, linewidth=0.8, zorder=1)
    axes.set(xlim=limits, ylim=limits, xlabel=r"$[(\eta/\eta_0-1)/(1-\phi)-1]\;l^2/r^2$", ylabel=r"$\Sigma_\alpha\langle\delta u_\alpha^2\rangle/(\dot\gamma r)^2$")
    for axis in (axes.xaxis, axes.yaxis):
        log_ticks(axis)
    keys = looks.keys(line=False) + [key(INK, "", "both sides equal")] + ([pale_key()] if tally.pale else [])
    axes.legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0)
    seen = ["l = 2r′(φ^−⅓ − 1) with " + (f"the fitted r′ = {radius:.3g} r" if fitted else "the paper's r′ = 2/9 r, nothing being fitted")
            + f"; left over right side from {min(ratios):.2f} to {max(ratios):.2f}, median {np.median(ratios):.2f}."]
    return Drawn(figure, "All states collapse on the diagonal: velocity fluctuations carry the dissipation in the gaps.", seen)


FIGURES = [("2a", "Velocity variances", variances), ("2bc", "Probability density of the velocities", densities),
           ("3a", "Gap size", gap), ("3b", "Dissipation balance", balance)]
