"""Figures 4 and 5 of Gross, Krüger & Varnik (EPL 2014) from an analysed sweep: velocity autocorrelation, relaxation times, displacements, diffusivities."""
import math

from analysis_data import combined
from panels import Drawn, Missing, abscissas, decayed, draw_against, families, finish_against, grid_against, palettes, power_law, value_range, why_nothing
from style import GREY, INK, PAGE, PALE, draw_curve, draw_points, key, log_ticks, np, number_text, pale_key, plt, value_text


def stretched(t, fit):
    """A exp[-(t/tau)^b] of a fit."""
    return fit["amplitude"].value * np.exp(-(t / fit["time"].value) ** fit["exponent"].value)


def stretched_formula(fit):
    """Legend text: tau and b."""
    return rf"$\tau_v\dot\gamma$ = {number_text(fit['time'].value)}, $b$ = {fit['exponent'].value:.2f}" + ("" if fit.converged else " (not converged)")


def fit_range(curve, fit):
    """Lags that the fit was made with: up to one strain where the file does not say."""
    end = fit.end if math.isfinite(fit.end) else 1.0
    return min(end, np.nanmax(curve.x))


def draw_decay(axes, log_axes, curve, fit, look, tally, name, until):
    """A normalised correlation with its stretched exponential: C against t, and -ln C against t on logarithmic axes, where it is a straight line."""
    end = fit_range(curve, fit) if fit.exists() and curve.exists() else 0
    if draw_curve(axes, curve, look, tally, name, line=not fit.exists(), until=until) is None:
        return False
    amplitude = fit["amplitude"].value if fit.exists() else 1.0

    def decay(x, v, e):
        inside = (v > 0) & (v < amplitude)
        with np.errstate(divide="ignore", invalid="ignore"):
            return x, np.where(inside, -np.log(v / amplitude), math.nan), np.where(inside, e / v, math.nan)

    early = type(curve)({"x": list(curve.x), "value": list(curve.value), "error": list(curve.error), "converged": curve.converged,
                         "trusted_until": min(curve.trusted_until, 1.5 * fit_range(curve, fit))})
    draw_curve(log_axes, early, look, type(tally)(), name, transform=decay, line=False, symbols=12)
    if fit.exists():
        t = np.geomspace(max(np.min(curve.x[curve.x > 0]), 1e-3 * end), end, 100)
        style = "-" if fit.converged else "--"
        axes.plot(t, stretched(t, fit), color=look[0], linewidth=0.9, linestyle=style, zorder=2)
        axes.plot(curve.x[curve.x >= end], curve.value[curve.x >= end], color=look[0], linewidth=0.6, alpha=PALE, zorder=1)
        log_axes.plot(t, (t / fit["time"].value) ** fit["exponent"].value, color=look[0], linewidth=0.8, linestyle=style, zorder=1)
    return True


def correlations(component):
    def draw(sweep, tally):
        groups = families(sweep)
        figure, grid = plt.subplots(len(groups), 2, figsize=(PAGE, (6.0 * len(groups) + 0.4) / 2.54), squeeze=False, sharex="col", sharey="col")
        count = 0
        until = decayed([run.curve(f"vacf_{component}") for family in groups for run in family.runs])
        for row, family in zip(grid, groups):
            row[1].set(xscale="log", yscale="log")
            row[0].axhline(0, color=GREY, linewidth=0.5)
            keys = []
            for run in family.runs:
                curve, fit = run.curve(f"vacf_{component}"), run.fit(f"vacf_{component}_stretched_exponential")
                if draw_decay(row[0], row[1], curve, fit, family.look(run), tally, run.name, until):
                    count += 1
                    keys.append(key(*family.look(run), hollow=not curve.converged, label=family.text(run) + (":\n" + stretched_formula(fit) if fit.exists() else ": no fit")))
            log_ticks(row[1].xaxis)
            row[1].legend(handles=keys[::-1], loc="upper left", bbox_to_anchor=(1.02, 1.02), borderaxespad=0, title=family.title, title_fontsize=7, alignment="left",
                          labelspacing=0.35)
            row[0].set_ylabel(rf"$C_{{v,{component}}}(t)/C_{{v,{component}}}(0)$")
            row[1].set_ylabel(rf"$-\ln[C_{{v,{component}}}(t)/A]$")
        if not count:
            plt.close(figure)
            raise Missing(why_nothing(tally))
        grid[0][0].set(xlim=(-0.02 * until, until), ylim=(-0.2, 1.06))
        for axes in grid[-1]:
            axes.set_xlabel(r"$\dot\gamma t$")
        exponents = value_range([r.fit(f"vacf_{component}_stretched_exponential")["exponent"] for r in sweep.runs])
        seen = ["Lines: A exp[−(t/τ_v)^b] where it was fitted, a straight line of slope b at the right; thin beyond, without a fit."]
        if exponents:
            seen.append(f"b from {exponents[0]:.2f} to {exponents[1]:.2f} over all runs.")
        return Drawn(figure, "C_v(t) = ⟨δu²⟩ exp[−(t/τ_v)^b] for γ̇t ≲ 1; later an overshoot to negative values may follow.", seen)
    return draw


def fitted(component, parameter):
    return lambda run: run.fit(f"vacf_{component}_stretched_exponential")[parameter]


def relaxation_times(sweep, tally):
    rows = [(rf"{name}: $\tau_v\dot\gamma$", fitted(name, "time")) for name in "yz"]
    figure, _ = grid_against(sweep, rows, tally)
    seen = []
    for name, (_, value_of) in zip("yz", rows):
        span = value_range([value_of(r) for r in sweep.runs])
        if not span:
            continue
        text = f"{name}: τ_vγ̇ from {span[0]:.3g} to {span[1]:.3g}"
        fit = power_law([r.phi for r in sweep.runs], [value_of(r) for r in sweep.runs])
        seen.append(text + (f"; all Ca together ~ φ^{value_text(fit[0].value, fit[0].error)}." if fit else "."))
    return Drawn(figure, "Velocity relaxation time τ_v of the fits against φ and Ca, in units of 1/γ̇.", seen)


def exponents(sweep, tally):
    rows = [(rf"{name}: exponent $b$", fitted(name, "exponent")) for name in "yz"]
    figure, grid = grid_against(sweep, rows, tally, y_log=False)
    for axes in grid.flat:
        axes.axhline(1, color=GREY, linewidth=0.6, linestyle=":", zorder=1)
    span = value_range([value_of(r) for r in sweep.runs for _, value_of in rows])
    return Drawn(figure, "Exponent b of the stretched exponential against φ and Ca.", [f"b from {span[0]:.2f} to {span[1]:.2f}; dotted: a simple exponential."])


def kinetic_diffusivity(run, component):
    """<du^2> tau_v Gamma(1 + 1/b) in gamma_dot r^2."""
    fit = run.fit(f"vacf_{component}_stretched_exponential")
    parts = [run.estimate(f"velocity_variance_{component}"), fit["amplitude"], fit["time"], fit["exponent"]]
    return combined(lambda square, a, tau, b: square * a * tau * math.gamma(1 + 1 / b), parts)


def scaling(sweep, tally):
    looks = palettes(sweep)["ca"]
    figure, grid = plt.subplots(1, 2, figsize=(PAGE, 7.6 / 2.54), sharex=True, sharey=True)
    ratios, ends, count = {"y": [], "z": []}, [], 0
    for axes, name in zip(grid, "yz"):
        axes.set(xscale="log", yscale="log")
        for run in sweep.runs:
            kinetic, diffusivity = kinetic_diffusivity(run, name), run.estimate(f"diffusivity_msd_{name}")
            if not kinetic.exists() or kinetic.value <= 0:
                tally.miss(run.name, kinetic.reason)
                continue
            diffusivity = combined(lambda d, _k: d, [diffusivity, kinetic])
            drawn = draw_points(axes, [(kinetic.value, diffusivity, run.name)], looks.look(run.ca_group), tally)
            if drawn:
                count += 1
                error = kinetic.error if math.isfinite(kinetic.error) else 0
                axes.plot([max(kinetic.value - error, 0.1 * kinetic.value), kinetic.value + error], [diffusivity.value] * 2, color=looks.look(run.ca_group)[0],
                          linewidth=0.6, alpha=1 if diffusivity.converged else 0.45, zorder=2)
                ratios[name].append(diffusivity.value / kinetic.value)
                ends += [kinetic.value, diffusivity.value]
        axes.set_xlabel(rf"$\langle\delta u_{name}^2\rangle\,\tau_v\,\Gamma(1+1/b)\,/(\dot\gamma r^2)$")
        axes.set_title(f"{name}")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    limits = (0.6 * min(ends), 1.6 * max(ends))
    for axes in grid:
        axes.plot(limits, limits, color=INK, linewidth=0.8, zorder=1)
        axes.set(xlim=limits, ylim=limits)
        for axis in (axes.xaxis, axes.yaxis):
            log_ticks(axis)
    grid[0].set_ylabel(r"$D_{\mathrm{MSD}}/(\dot\gamma r^2)$")
    keys = looks.keys(line=False) + [key(INK, "", "both equal")] + ([pale_key()] if tally.pale else [])
    grid[-1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0)
    seen = [f"{name}: D over ⟨δu²⟩τ_vΓ(1+1/b) from {min(r):.2f} to {max(r):.2f}, median {np.median(r):.2f}." for name, r in ratios.items() if r]
    return Drawn(figure, "D = ⟨δu²⟩ τ_v Γ(1 + 1/b): variances and relaxation times explain the diffusivity.", seen)


def guide(axes, x, y, slope, until):
    """A thin line of a power law from (x, y) with its slope beside it."""
    axes.plot([x, until], [y, y * (until / x) ** slope], color=INK, linewidth=0.8, zorder=5)
    middle = math.sqrt(x * until)
    axes.annotate(f"{slope:g}", (middle, y * (middle / x) ** slope), xytext=(-4, 3), textcoords="offset points", ha="right", va="bottom", fontsize=7)


def add_guides(axes, curves):
    """Slopes 2 and 1 above the ends of the uppermost of the drawn (x, value, error)."""
    curves = [c for c in curves if c is not None and len(c[0]) > 5]
    if not curves:
        return
    x = curves[0][0]
    top = np.max([np.interp(x, c[0], c[1]) for c in curves], axis=0)
    for slope, start, end in ((2, 1.2 * x[0], min(8 * x[0], 0.2 * x[-1])), (1, x[-1] / 5, 0.9 * x[-1])):
        inside = (x >= start) & (x <= end)
        if inside.any() and end > 1.5 * start:
            guide(axes, start, 2.5 * np.max(top[inside] * (start / x[inside]) ** slope), slope, end)


def displacements(sweep, tally):
    groups = families(sweep)
    figure, grid = plt.subplots(len(groups), 2, figsize=(PAGE, (6.0 * len(groups) + 0.4) / 2.54), squeeze=False, sharex=True, sharey=True)
    count = 0
    for row, family in zip(grid, groups):
        for axes, name in zip(row, "yz"):
            axes.set(xscale="log", yscale="log")
            drawn = []
            for run in family.runs:
                drawn.append(draw_curve(axes, run.curve(f"msd_{name}"), family.look(run), tally, run.name, symbols=10))
                count += drawn[-1] is not None
                line = run.fit(f"msd_{name}_line")
                if line.exists() and run.curve(f"msd_{name}").exists():
                    x = np.linspace(0.3, 1, 20) * np.nanmax(run.curve(f"msd_{name}").x)
                    y = line["slope"].value * x + (line["intercept"].value if line["intercept"].exists() else 0)
                    axes.plot(x[y > 0], y[y > 0], color=INK, linewidth=0.5, linestyle="-" if line.converged else "--", zorder=4)
            add_guides(axes, drawn)
            log_ticks(axes.xaxis)
            row[0].set_ylabel(r"MSD$/r^2$")
        keys = [key(*family.look(r), family.text(r)) for r in reversed(family.runs)]
        keys += [key(INK, "", "fit: intercept + 2 $D\\,t$")] + ([pale_key()] if tally.pale else [])
        row[-1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0, title=family.title, title_fontsize=7, alignment="left")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    for axes, name in zip(grid[0], "yz"):
        axes.set_title(rf"$\langle\Delta {name}^2\rangle$")
    for axes in grid[-1]:
        axes.set_xlabel(r"$\dot\gamma t$")
    seen = []
    for when, text in (("early", "Local exponent below γ̇t = 0.3"), ("late", "In the last trusted factor of ten")):
        span = value_range([r.estimate(f"msd_exponent_{n}_{when}") for r in sweep.runs for n in "yz"])
        if span:
            seen.append(f"{text}: {span[0]:.2f} to {span[1]:.2f}.")
    return Drawn(figure, "Mean square displacements along vorticity and gradient: exponent 2 early (1.7 at φ = 0.9), 1 late.", seen)


def msd_exponents(sweep, tally):
    abscissa = abscissas(sweep)[0]
    figure, grid = plt.subplots(2, 2, figsize=(PAGE, 10.6 / 2.54), sharex=True, sharey="row")
    count = 0
    for row, when, expected in zip(grid, ("early", "late"), (2, 1)):
        for axes, name in zip(row, "yz"):
            count += draw_against(axes, sweep, abscissa, lambda r, n=name, w=when: r.estimate(f"msd_exponent_{n}_{w}"), tally, y_log=False)
            axes.axhline(expected, color=GREY, linewidth=0.6, linestyle=":", zorder=1)
            finish_against(axes, sweep, abscissa)
            axes.set_title(f"{name}, {when}")
        row[0].set_ylabel("exponent of the MSD")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    for axes in grid[0]:
        axes.set_xlabel("")
    keys = palettes(sweep)["ca" if abscissa == "phi" else "phi"].keys() + ([pale_key()] if tally.pale else [])
    grid[0][1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0)
    return Drawn(figure, "The exponent at short times is 2, and 1.7 at φ = 0.9; at long times 1.",
                 ["Early: lags below 0.3 strains; late: the last trusted factor of ten. Dotted: straight motion (2), diffusion (1)."])


def diffusivities(sweep, tally):
    columns = abscissas(sweep)
    figure, grid = plt.subplots(2, len(columns), figsize=(PAGE, 12.2 / 2.54), squeeze=False, sharey="row", sharex="col")
    seen, looks, count = [], palettes(sweep), 0
    both = [key(GREY, "o", "from the MSD", line=False), key(GREY, "o", "from the VACF", line=False, hollow=True)]
    for row, name in zip(grid, "yz"):
        msd = lambda r: r.estimate(f"diffusivity_msd_{name}")
        for axes, abscissa in zip(row, columns):
            counter = tally if abscissa == columns[0] else type(tally)()
            count += draw_against(axes, sweep, abscissa, msd, counter, line=abscissa == "ca")
            count += draw_against(axes, sweep, abscissa, lambda r: r.estimate(f"diffusivity_vacf_{name}"), counter, hollow=True, line=False)
            finish_against(axes, sweep, abscissa, rf"$D_{name}/(\dot\gamma r^2)$" if abscissa == columns[0] else None)
        if "phi" not in columns:
            row[-1].legend(handles=looks["phi"].keys() + both, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0)
            continue
        keys = []
        for ca in reversed(sweep.cas):
            below = [r for r in sweep.of(ca=ca) if r.phi_group < 0.7]
            fit = power_law([r.phi for r in below], [msd(r) for r in below])
            formula = ""
            if fit:
                x = np.array([min(r.phi for r in below), max(r.phi for r in below)])
                row[0].plot(x, fit[1].value * x ** fit[0].value, color=looks["ca"].look(ca)[0], linewidth=0.9, zorder=1)
                formula = f":\n{number_text(fit[1].value)} $\\phi^{{{fit[0].value:.2f}}}$"
                seen.append(f"{name}: exponent {value_text(fit[0].value, fit[0].error)} at Ca = {ca:.2g}.")
            keys.append(key(*looks["ca"].look(ca), looks["ca"].text(ca) + formula))
        keys += both + ([pale_key()] if tally.pale else [])
        row[-1].legend(handles=keys, loc="upper left", bbox_to_anchor=(1.02, 1.02), borderaxespad=0, labelspacing=0.4)
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    for axes in grid[0]:
        axes.set_xlabel("")
    if "ca" in columns:
        figure.legend(handles=looks["phi"].keys(), loc="outside lower center", ncols=len(sweep.phis) if len(sweep.phis) < 8 else 6)
    return Drawn(figure, "D/(γ̇r²) nearly linear in φ at large Ca, nearly quadratic at small Ca with a maximum at φ ≈ 0.66; from the MSD and from the VACF.",
                 ["Closed symbols: half the slope of the MSD; open ones: integral of the VACF; pale ones are not converged. Lines: power laws through D of the MSD at φ < 0.7."] + seen)


FIGURES = [("4a", "Velocity autocorrelation along y", correlations("y")), ("4b", "Velocity autocorrelation along z", correlations("z")),
           ("4c", "Velocity relaxation time", relaxation_times), ("4d", "Exponent of the decay", exponents), ("4e", "Scaling of the diffusivity", scaling),
           ("5a", "Mean square displacements", displacements), ("5a_exponents", "Exponents of the mean square displacements", msd_exponents),
           ("5b", "Diffusivities", diffusivities)]
