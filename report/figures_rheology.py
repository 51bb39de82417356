"""Figures 1b and 6 of Gross, Krüger & Varnik (EPL 2014) from an analysed sweep: viscosity with its fits, yield stress, stress fluctuations and their relaxation."""
import math

from panels import Drawn, Missing, abscissas, decayed, draw_against, families, finish_against, grid_against, palettes, power_law, value_range, why_nothing
from style import COLUMN, GREY, PAGE, draw_curve, draw_points, key, np, number_text, pale_key, plt, value_text


def chosen_law(thinning, yielding):
    """(kind, function of Ca, formula) of the fit that is drawn: with a yield stress where it is positive by more than two errors, else the power law.
    Those of viscosities that are not converged are drawn too, and the formula says so."""
    stress, b, q = yielding["yield_stress"], yielding["prefactor"], yielding["exponent"]
    if yielding.exists() and stress.value > 2 * stress.error:
        formula = f"{number_text(stress.value)} Ca$^{{-1}}$ + {number_text(b.value)} Ca$^{{{-q.value:.2f}}}$"
        return "yield", lambda ca: stress.value / ca + b.value * ca ** -q.value, formula + doubt(yielding)
    b, q = thinning["prefactor"], thinning["exponent"]
    if thinning.exists():
        return "thinning", lambda ca: b.value * ca ** -q.value, f"{number_text(b.value)} Ca$^{{{-q.value:.2f}}}$" + doubt(thinning)
    return None


def doubt(fit):
    return "" if fit.converged else "\n(not converged)"


def viscosity(sweep, tally):
    columns = abscissas(sweep)
    figure, grid = plt.subplots(1, len(columns), figsize=(PAGE if len(columns) > 1 else 1.4 * COLUMN, 8.6 / 2.54), squeeze=False, sharey=True)
    viscosity_of = lambda run: run.estimate("relative_viscosity")
    seen, keys, looks = [], [], palettes(sweep)
    for j, abscissa in enumerate(columns):
        axes = grid[0][j]
        if not draw_against(axes, sweep, abscissa, viscosity_of, tally if j == 0 else type(tally)(), line=abscissa == "phi"):
            plt.close(figure)
            raise Missing(why_nothing(tally))
        finish_against(axes, sweep, abscissa, r"relative viscosity $\eta/\eta_0$" if j == 0 else None)
        if abscissa == "phi":
            continue
        ca = np.geomspace(sweep.ca_range()[0] / 1.4, sweep.ca_range()[1] * 1.4, 100)
        for phi in reversed(sweep.phis):
            law = chosen_law(*sweep.flow_curve(phi))
            if law:
                axes.plot(ca, law[1](ca), color=looks["phi"].look(phi)[0], linewidth=0.9, linestyle="-" if law[0] == "yield" else "--", zorder=1)
            keys.append(key(*looks["phi"].look(phi), f"{looks['phi'].text(phi)}" + (f": {law[2]}" if law else ""), line=law is not None,
                            style="-" if law and law[0] == "yield" else "--"))
    if "phi" in columns:
        pale = [pale_key()] if tally.pale else []
        grid[0][0].legend(handles=looks["ca"].keys() + pale, loc="upper left")
    if keys:
        axes = grid[0][-1]
        axes.legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0, title="fits: $b\\,$Ca$^{-q}$ (dashed),\n$\\sigma_y/$Ca$\\,+\\,b\\,$Ca$^{-q}$ (solid)",
                    title_fontsize=6.8, alignment="left", labelspacing=0.8)
        seen += exponents_seen(sweep)
    span = value_range([viscosity_of(r) for r in sweep.runs])
    seen.insert(0, f"η/η₀ from {span[0]:.3g} to {span[1]:.3g}.")
    missing = [fit for phi in sweep.phis if "ca" in columns for fit in sweep.flow_curve(phi)[:1] if not fit.converged and fit.reason]
    if missing:
        seen.append(f"Without a fitted line: {len(missing)} of {len(sweep.phis)} volume fractions ({missing[0].reason.rstrip('.')}).")
    return Drawn(figure, "Newtonian at low φ; shear thinning η ~ Ca^−½ at intermediate φ; above φ_c ≈ 0.66 a yield stress, η/η₀ = σ_y/Ca + b Ca^−q with q ≈ ½.", seen)


def exponents_seen(sweep):
    found = []
    for phi in sweep.phis:
        thinning, yielding = sweep.flow_curve(phi)
        law = chosen_law(thinning, yielding)
        if law:
            q = (yielding if law[0] == "yield" else thinning)["exponent"]
            found.append((phi, law[0], q))
    lines = []
    for kind, text in (("thinning", "Power law"), ("yield", "With a yield stress")):
        some = [f"q = {value_text(q.value, q.error)} at φ = {phi:.2f}" for phi, k, q in found if k == kind]
        if some:
            lines.append(f"{text}: {', '.join(some)}.")
    return lines


def yield_stress(sweep, tally):
    points = []
    for phi in sweep.phis:
        stress = sweep.flow_curve(phi)[1]["yield_stress"]
        points.append((phi, stress, f"φ = {phi:.2f}"))
    figure, axes = plt.subplots(figsize=(COLUMN, 6.4 / 2.54))
    axes.axhline(0, color=GREY, linewidth=0.6)
    if not draw_points(axes, points, ("#0072B2", "o"), tally, line=False):
        plt.close(figure)
        raise Missing(why_nothing(tally))
    critical = sweep.critical
    keys = [key("#0072B2", "o", "fitted at each $\\phi$", line=False)]
    seen = []
    if critical.exists():
        if math.isfinite(critical.error):
            axes.axvspan(critical.value - critical.error, critical.value + critical.error, color="#D55E00", alpha=0.2 if critical.converged else 0.1, linewidth=0)
        axes.axvline(critical.value, color="#D55E00", linestyle="-" if critical.converged else ":")
        keys.append(key("#D55E00", "", f"$\\phi_c$ = {value_text(critical.value, critical.error)}"))
        seen.append(f"φ_c = {value_text(critical.value, critical.error)}" + ("." if critical.converged else f", not converged: {critical.reason.rstrip('.')}."))
    else:
        seen.append(f"φ_c is not known: {critical.reason.rstrip('.')}.")
    axes.set(xlabel=r"volume fraction $\phi$", ylabel=r"yield stress $\sigma_y\,r/\kappa_S$")
    axes.legend(handles=keys + ([pale_key()] if tally.pale else []), loc="upper left")
    return Drawn(figure, "A yield stress appears above φ_c ≈ 0.66.", seen)


def cells_and_bulk(sweep, tally, rows, quantity=""):
    """A grid of (name, label, value of a run) against Ca and phi, and the range of each in words."""
    figure, _ = grid_against(sweep, [(label, value_of) for _, label, value_of in rows], tally)
    spans = [(name, value_range([value_of(r) for r in sweep.runs])) for name, _, value_of in rows]
    return figure, [f"{name}: {quantity}{span[0]:.3g} to {span[1]:.3g}." for name, span in spans if span]


def stress_fluctuations(sweep, tally):
    figure, seen = cells_and_bulk(sweep, tally, [
        ("Cells", r"single cells: RMS$(\sigma)/\langle\sigma\rangle$", lambda r: r.estimate("stress_fluctuation")),
        ("Bulk", r"bulk: RMS$(\sigma)/\langle\sigma\rangle$", lambda r: r.estimate("bulk_stress_fluctuation"))])
    seen.append("The fluctuation of the bulk's average falls with the number of cells in it; that of single cells does not.")
    return Drawn(figure, "Relative fluctuations of the shear stress against Ca and φ.", seen)


def stress_correlations(sweep, tally):
    groups = families(sweep)
    figure, grid = plt.subplots(len(groups), 2, figsize=(PAGE, (5.4 * len(groups) + 0.6) / 2.54), squeeze=False, sharex=True, sharey=True)
    count, names = 0, ("stress_autocorrelation", "stresslet_autocorrelation")
    until = decayed([run.curve(name) for family in groups for run in family.runs for name in names])
    for row, family in zip(grid, groups):
        for axes, name in zip(row, names):
            axes.axhline(0, color=GREY, linewidth=0.5)
            for run in family.runs:
                count += draw_curve(axes, run.curve(name), family.look(run), tally, run.name, until=until) is not None
        keys = [key(*family.look(r), family.text(r)) for r in reversed(family.runs)]
        row[-1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0, title=family.title, title_fontsize=7, alignment="left")
        row[0].set_ylabel(r"$C_\sigma(t)/C_\sigma(0)$")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    grid[0][0].set_title("average over the bulk")
    grid[0][1].set_title("single cells")
    grid[0][0].set(xlim=(0, until), ylim=(-0.3, 1.05))
    for axes in grid[-1]:
        axes.set_xlabel(r"$\dot\gamma t$")
    return Drawn(figure, "Autocorrelation of the shear stress.",
                 ["Relaxation times are in figure 6c. Bands are standard errors; dotted where lags are too long for errors to be right."])


def stress_relaxation(sweep, tally):
    rows = [("Bulk", r"bulk: $\tau_\sigma\dot\gamma$", lambda r: r.estimate("stress_relaxation_time")),
            ("Single cells", r"single cells: $\tau_\sigma\dot\gamma$", lambda r: r.estimate("stresslet_relaxation_time"))]
    figure, seen = cells_and_bulk(sweep, tally, rows, "τ_σγ̇ from ")
    for name, _, value_of in rows:
        fit = power_law([r.phi for r in sweep.runs], [value_of(r) for r in sweep.runs]) if len(sweep.phis) > 2 else None
        if fit:
            seen.append(f"{name}, all Ca together: τ_σγ̇ ~ φ^{value_text(fit[0].value, fit[0].error)}.")
    return Drawn(figure, "Relaxation time of the stress in units of 1/γ̇, against φ and Ca.", seen)


FIGURES = [("1b", "Viscosity", viscosity), ("1b_yield_stress", "Yield stress", yield_stress)]
STRESS_FIGURES = [("6a", "Stress fluctuations", stress_fluctuations), ("6b", "Stress autocorrelation", stress_correlations),
                  ("6c", "Stress relaxation time", stress_relaxation)]
