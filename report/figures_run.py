"""Figures of a single run for ./dev report: series with the discarded start, profiles, densities, correlations, displacements, structure, orientation."""
import math

from analysis_data import Value
from figures_dynamics import add_guides, draw_decay, stretched_formula
from figures_velocity import draw_density
from panels import Drawn, Missing, decayed, why_nothing
from style import COMPONENTS, GREY, PAGE, PALE, draw_curve, draw_points, key, log_ticks, np, plt, value_text

BLUE, ORANGE, GREEN, PINK = "#0072B2", "#D55E00", "#009E73", "#CC79A7"  # Okabe and Ito
SERIES = [
    (r"relative viscosity $\eta/\eta_0$", [("bulk_relative_viscosity", BLUE, "-", "bulk", "relative_viscosity"),
                                           ("wall_relative_viscosity", ORANGE, (0, (4, 1.5)), "walls", "wall_relative_viscosity")]),
    ("normal stress\n" + r"$/(\eta_0\dot\gamma)$", [("normal_stress_difference_1", BLUE, "-", "$N_1$", None), ("normal_stress_difference_2", ORANGE, (0, (4, 1.5)), "$N_2$", None),
                                              ("particle_pressure", GREEN, (0, (1, 1)), "particle pressure", None)]),
    ("deformation $D$", [("mean_deformation", GREEN, "-", "", "deformation")]),
    ("largest drift", [("area_drift_max", BLUE, "-", "area", None), ("volume_drift_max", ORANGE, (0, (4, 1.5)), "volume", None)]),
]


def series(run, data, tally):
    """Series of run.h5 (`data`: RunData) against strain; the discarded start is shaded, means with errors are bands over the rest."""
    strain = data.series.get("strain", np.array([]))
    if len(strain) < 2 or not np.any(strain):
        raise Missing("run.h5 is not there, or holds no series against strain")
    discarded = run.settings.get("discarded_strain")
    figure, grid = plt.subplots(len(SERIES), 1, figsize=(PAGE, 13.5 / 2.54), sharex=True, height_ratios=(1.6, 1, 1, 0.8))
    for axes, (label, parts) in zip(grid, SERIES):
        shown = []
        for name, colour, style, text, estimate in parts:
            values = data.series.get(name)
            if values is None or not np.isfinite(values).any():
                tally.miss(name, "not in run.h5, or without meaning in this flow")
                continue
            shown.append(values[len(values) // 20:])
            mean = run.estimate(estimate) if estimate else Value()
            if mean.exists():
                error = mean.error if math.isfinite(mean.error) else 0
                span = (discarded or 0, strain[-1])
                shown.append(np.array([mean.value]))
                axes.fill_between(span, mean.value - error, mean.value + error, color=colour, alpha=0.25, linewidth=0, zorder=3)
                axes.plot(span, [mean.value] * 2, color=colour, linewidth=1.3, zorder=4, alpha=1 if mean.converged else PALE)
                text = f"{text}{': ' if text else ''}{value_text(mean.value, mean.error)}" + ("" if mean.converged else " (not converged)")
            axes.plot(strain, values, color=colour, linestyle=style, linewidth=0.7, alpha=0.85, label=text or None)
        axes.set_ylabel(label)
        if not shown:
            continue
        every = np.concatenate(shown)
        low, high = np.nanmin(every), np.nanmax(every)
        axes.set_ylim(low - 0.08 * (high - low) - 1e-9, high + 0.3 * (high - low) + 1e-9)
        if any(line.get_label()[0] != "_" for line in axes.get_lines()):
            axes.legend(loc="upper right", ncols=3)
        if discarded:
            axes.axvspan(0, discarded, color="#8899AA", alpha=0.22, linewidth=0)
    if discarded:
        grid[0].annotate("discarded", (discarded / 2, 0.04), xycoords=("data", "axes fraction"), ha="center", fontsize=7, color="#445566")
    grid[-1].set_xlabel(r"strain $\dot\gamma t$")
    grid[-1].set_xlim(strain[0], strain[-1])
    figure.align_ylabels()
    start, steady = run.equilibration.get("strain"), run.equilibration.get("converged")
    seen = [f"The first {discarded:.3g} strains are left out." if discarded else "Nothing is left out."]
    if start is not None and not steady:
        seen.append(f"The start-up is not known to be over: {(run.equilibration.get('reason') or 'no reason given').rstrip('.')}.")
    return Drawn(figure, None, seen)


def profiles(run, tally):
    wanted = [("profile_velocity",), ("profile_phi",), ("profile_stress_xz",), ("profile_variance_x", "profile_variance_y", "profile_variance_z"), ("profile_deformation",)]
    figure, grid = plt.subplots(1, len(wanted), figsize=(PAGE, 6.4 / 2.54), sharey=True)
    layer, count = run.settings.get("wall_layer"), 0
    box = run.info.get("box")
    height = box[2] / run.radius if box and run.radius > 0 else None
    for axes, names in zip(grid, wanted):
        for name in names:
            curve = run.curve(name)
            if not curve.exists():
                tally.miss(name, curve.reason)
                continue
            colour, symbol = COMPONENTS[name[-1]] if len(names) > 1 else (BLUE, "o")
            error = np.nan_to_num(curve.error)
            axes.errorbar(curve.value, curve.x, xerr=error, color=colour, marker=symbol, markersize=2.4, linewidth=0.7, elinewidth=0.6, capsize=0,
                          markerfacecolor=colour if curve.converged else "white", alpha=1 if curve.converged else PALE, label=name[-1] if len(names) > 1 else None)
            axes.set_xlabel(r"$\langle\delta u^2\rangle/(\dot\gamma r)^2$" if len(names) > 1 else curve.label)
            count += 1
            tally.drawn += 1
            tally.pale += not curve.converged
        if len(names) > 1 and axes.has_data():
            axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, columnspacing=0.6, handlelength=1, borderaxespad=0.1)
        axes.xaxis.set_major_locator(plt.MaxNLocator(3))
        if layer and height:
            axes.axhspan(0, layer, color="#8899AA", alpha=0.22, linewidth=0)
            axes.axhspan(height - layer, height, color="#8899AA", alpha=0.22, linewidth=0)
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    if height:
        grid[0].set_ylim(0, height)
    grid[0].set_ylabel("$z/r$")
    return Drawn(figure, None, ["Means over time in layers across the gap." + (f" Shaded: {layer:g} radii at each wall that are no bulk." if layer else "")])


def velocities(run, tally):
    figure, grid = plt.subplots(1, 3, figsize=(PAGE, 6.8 / 2.54), sharey=True)
    count, lowest = 0, 1e-3
    for axes, name in zip(grid, "xyz"):
        axes.set_yscale("log")
        found = draw_density(axes, run, name, COMPONENTS[name], tally)
        axes.set_xlabel(rf"$\delta u_{name}/\langle\delta u_{name}^2\rangle^{{1/2}}$")
        if found:
            count += 1
            lowest = min(lowest, found[2])
            axes.set_title(f"$w$ = {found[0]:.2f}, $d$ = {found[1]:.2f}" if math.isfinite(found[0]) else "no fit")
    if not count:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    grid[0].set_ylabel(r"$p(\delta u)\,\langle\delta u^2\rangle^{1/2}$")
    grid[0].set_ylim(max(lowest / 3, 1e-7), 1.5)
    return Drawn(figure, "Figures 2b, c: Gaussian cores and exponential tails.",
                 ["Lines: Gaussian core h exp[−(x−c)²/(2w²)] within 1 and exponential tails exp(−|x|/d) beyond 2 standard deviations; w, d in standard deviations."])


def correlations(run, tally):
    figure, (axes, log_axes) = plt.subplots(1, 2, figsize=(PAGE, 6.6 / 2.54))
    log_axes.set(xscale="log", yscale="log", xlabel=r"$\dot\gamma t$", ylabel=r"$-\ln[C_v(t)/A]$")
    axes.axhline(0, color=GREY, linewidth=0.5)
    until, keys = decayed([run.curve(f"vacf_{n}") for n in "xyz"]), []
    for name in "xyz":
        fit = run.fit(f"vacf_{name}_stretched_exponential")
        if draw_decay(axes, log_axes, run.curve(f"vacf_{name}"), fit, COMPONENTS[name], tally, f"vacf_{name}", until):
            keys.append(key(*COMPONENTS[name], hollow=not run.curve(f"vacf_{name}").converged, label=name + (": " + stretched_formula(fit) if fit.exists() else ", not fitted")))
    if not keys:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    axes.set(xlim=(-0.02 * until, until), ylim=(-0.3, 1.06), xlabel=r"$\dot\gamma t$", ylabel=r"$C_v(t)/C_v(0)$")
    log_ticks(log_axes.xaxis)
    axes.legend(handles=keys, loc="best")
    return Drawn(figure, "Figures 4a, b: C_v(t) = ⟨δu²⟩ exp[−(t/τ_v)^b] for γ̇t ≲ 1.", ["Right: a straight line of slope b where the stretched exponential holds."])


def displacements(run, tally):
    figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE, 6.8 / 2.54))
    left.set(xscale="log", yscale="log", xlabel=r"$\dot\gamma t$", ylabel=r"MSD$/r^2$")
    right.set(xscale="log", xlabel=r"$\dot\gamma t$", ylabel=r"$\mathrm{d}\,\ln\,\mathrm{MSD}/\mathrm{d}\,\ln t$")
    drawn, keys = [], []
    for name in "yz":
        drawn.append(draw_curve(left, run.curve(f"msd_{name}"), COMPONENTS[name], tally, f"msd_{name}"))
        draw_curve(right, run.curve(f"msd_exponent_{name}"), COMPONENTS[name], tally, f"msd_exponent_{name}")
        d = run.estimate(f"diffusivity_msd_{name}")
        if drawn[-1] is not None:
            keys.append(key(*COMPONENTS[name], hollow=not run.curve(f"msd_{name}").converged,
                            label=f"{name}: $D/(\\dot\\gamma r^2)$ = {value_text(d.value, d.error)}" + ("" if d.converged else " (not converged)")))
    if not keys:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    add_guides(left, drawn)
    for axis in (left.xaxis, right.xaxis):
        log_ticks(axis)
    for expected in (1, 2):
        right.axhline(expected, color=GREY, linewidth=0.6, linestyle=":")
    left.legend(handles=keys, loc="lower right")
    return Drawn(figure, "Figure 5a: slope 2 at short, 1 at long times.", ["Left: mean square displacements along y and z; right: their local exponents."])


def stresses(run, tally):
    figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE, 6.4 / 2.54))
    names = (("stress_autocorrelation", (BLUE, "o"), "bulk", "stress_relaxation_time"), ("stresslet_autocorrelation", (ORANGE, "s"), "single cells", "stresslet_relaxation_time"))
    until, keys = decayed([run.curve(n[0]) for n in names]), []
    left.axhline(0, color=GREY, linewidth=0.5)
    for name, look, text, time in names:
        if draw_curve(left, run.curve(name), look, tally, name, until=until) is not None:
            tau = run.estimate(time)
            keys.append(key(*look, hollow=not run.curve(name).converged,
                            label=f"{text}: $\\tau_\\sigma\\dot\\gamma$ = {value_text(tau.value, tau.error)}" + ("" if tau.converged else " (not converged)")))
    left.set(xlim=(0, until), ylim=(-0.4, 1.05), xlabel=r"$\dot\gamma t$", ylabel=r"$C_\sigma(t)/C_\sigma(0)$")
    left.legend(handles=keys, loc="best")
    right.set_yscale("log")
    density = draw_curve(right, run.curve("pdf_stresslet"), (ORANGE, "s"), tally, "pdf_stresslet", line=False, symbols=60)
    right.set(xlabel=r"$S_{xz}/\langle S_{xz}\rangle$", ylabel="probability density")
    if not keys and density is None:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    return Drawn(figure, "Figures 6b, c: stress autocorrelation and its relaxation time.", ["Left: autocorrelation of the shear stress; right: density of the cells' stresslets."])


def structure(run, tally):
    figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE, 6.4 / 2.54), width_ratios=(1.6, 1))
    left.axhline(1, color=GREY, linewidth=0.6, linestyle=":")
    pairs = draw_curve(left, run.curve("pair_distribution"), (BLUE, "o"), tally, "pair_distribution", symbols=25)
    left.set(xlabel="distance of centres $/r$", ylabel="$g$")
    contact = run.settings.get("contact_distance")
    if pairs is not None and contact:
        left.axvline(contact, color=ORANGE, linewidth=0.8, linestyle="--")
        left.annotate("contact", (contact, 0.02), xycoords=("data", "axes fraction"), xytext=(2, 2), textcoords="offset points", fontsize=7, color=ORANGE)
    tensor = (run.tensors.get("orientation") or {})
    rows = tensor.get("value")
    if rows is None or any(v is None for row in rows for v in row):
        tally.miss("orientation", tensor.get("reason") or "not in the analysis")
        right.set_axis_off()
    else:
        errors = [[0 if e is None else e for e in row] for row in tensor.get("error") or [[None] * 3] * 3]
        names = [("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xz", 0, 2)]
        converged = bool(tensor.get("converged", True))
        draw_points(right, [(k, Value({"value": rows[i][j], "error": errors[i][j], "converged": converged}), name) for k, (name, i, j) in enumerate(names)],
                    (GREEN, "o"), tally, line=False)
        right.axhline(1 / 3, color=GREY, linewidth=0.6, linestyle=":")
        right.axhline(0, color=GREY, linewidth=0.5)
        right.set_xticks(range(4), [rf"$\langle n_{a[0]}n_{a[1]}\rangle$" for a, _, _ in names])
        right.set(xlim=(-0.5, 3.5), title="orientation of the cells' axes")
        right.xaxis.set_minor_locator(plt.NullLocator())
    if pairs is None and not tally.drawn:
        plt.close(figure)
        raise Missing(why_nothing(tally))
    order = run.estimate("order_parameter")
    seen = ["Left: pair distribution of the cells' centres. Right: ⟨nn⟩ of the cells' shortest axes; dotted: a third, isotropic."]
    if order.exists():
        seen.append(f"Order parameter {value_text(order.value, order.error)} (0: isotropic, 1: aligned).")
    return Drawn(figure, None, seen)


FIGURES = [("profiles", "Profiles across the gap", profiles), ("velocities", "Probability density of the velocities", velocities),
           ("correlations", "Velocity autocorrelation", correlations), ("displacements", "Mean square displacements", displacements),
           ("stress", "Stress", stresses), ("structure", "Structure and orientation", structure)]
