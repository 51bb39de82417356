"""Statements of Gross, Krüger & Varnik (EPL 2014) against an analysed sweep: each gives the numbers found and says whether it holds. The rules are stated with each."""
import math

import numpy as np

from analysis_data import combined
from figures_velocity import balance_of, radius_fit, total_variance
from style import in_words, value_text

HOLDS, PARTLY, FAILS, UNTESTED = "holds", "holds partly", "does not hold", "not tested"


def text(value):
    return value_text(value.value, value.error) + ("" if value.converged else "*")


def mean_yz(run, name):
    """Of the two directions without mean flow: they are equivalent in the paper's figures."""
    return combined(lambda y, z: 0.5 * (y + z), [run.estimate(f"{name}_y"), run.estimate(f"{name}_z")])


def judged(checks):
    """A verdict from yes/no answers: all, some or none of them."""
    checks = list(checks)
    if not checks:
        return UNTESTED
    return HOLDS if all(checks) else PARTLY if any(checks) else FAILS


def by_phi(values):
    """"0.12: ...; 0.24: ..." from pairs."""
    return "; ".join(f"{phi:.2f}: {words}" for phi, words in values)


def columns(sweep, value_of):
    """(Ca, [(phi, value)]) for each capillary number with three volume fractions or more."""
    found = [(ca, sorted(sweep.of(ca=ca), key=lambda r: r.phi)) for ca in sweep.cas]
    return [(ca, [(r.phi_group, value_of(r)) for r in runs]) for ca, runs in found if len(runs) >= 3]


def columns_text(found):
    return ". ".join(f"Ca = {ca:g}: " + by_phi([(phi, text(v)) for phi, v in pairs]) for ca, pairs in found)


def rising_with_falling_ca(sweep, value_of):
    return [rises for phi in sweep.phis for rises in rising([(r.ca, value_of(r)) for r in sorted(sweep.of(phi=phi), key=lambda r: -r.ca)])]


def exponents(sweep):
    """(phi, fitted q of b Ca^-q) of all volume fractions with a fit."""
    found = [(phi, sweep.flow_curve(phi)[0]["exponent"]) for phi in sweep.phis]
    return [(phi, q) for phi, q in found if q.exists()]


def newtonian(sweep):
    found = exponents(sweep)
    low = [q for phi, q in found if phi < 0.15]
    return "q of η ~ Ca^−q at φ: " + by_phi([(phi, text(q)) for phi, q in found if phi < 0.3]), judged(q.value < 0.1 for q in low)


def stiff_exponent(sweep, phi):
    """q between the two smallest Ca: in the whole range a plateau at large Ca takes part in the fit."""
    stiff, soft = sorted(sweep.of(phi=phi), key=lambda r: r.ca)[:2]
    lever = math.log(soft.ca / stiff.ca)
    return combined(lambda a, b: math.log(a / b) / lever, [r.estimate("relative_viscosity") for r in (stiff, soft)])


def thinning(sweep):
    found = [(phi, q) for phi, q in exponents(sweep) if phi > 0.4]
    words = "q at φ: " + by_phi([(phi, text(q)) for phi, q in found])
    words += "; between the two smallest Ca: " + by_phi([(phi, text(stiff_exponent(sweep, phi))) for phi, _ in found])
    return words, judged(abs(q.value - 0.5) < 0.15 for phi, q in found if phi > 0.6)


def yield_stress(sweep):
    found = [(phi, sweep.flow_curve(phi)[1]) for phi in sweep.phis]
    shown = [(phi, fit["yield_stress"], fit["exponent"]) for phi, fit in found if fit["yield_stress"].exists()]
    words = "σ_y in η₀γ̇ Ca at φ: " + by_phi([(phi, f"{text(s)} (q = {text(q)})") for phi, s, q in shown]) if shown else "no fit: " + found[0][1].reason
    words += f"; φ_c = {text(sweep.critical)}" if sweep.critical.exists() else f"; no φ_c: {sweep.critical.reason}"
    present = lambda s: s.value > 2 * s.error
    below, above = [not present(s) for phi, s, q in shown if phi < 0.6], [present(s) for phi, s, q in shown if phi > 0.7]
    near = [abs(sweep.critical.value - 0.66) < 0.05] if sweep.critical.exists() else []
    return words, judged(below + above + near) if below and above else UNTESTED


def rising(pairs):
    """Shares of neighbouring values that rise by more than their errors allow to doubt, or do not fall."""
    values = [v for _, v in pairs if v.exists()]
    return [b.value > a.value - 2 * math.hypot(a.error, b.error) and b.value > a.value for a, b in zip(values, values[1:])]


def variances(sweep):
    found = columns(sweep, total_variance)
    checks = [rises for _, pairs in found for rises in rising(pairs)] + rising_with_falling_ca(sweep, total_variance)
    return "Σ⟨δu²⟩/(γ̇r)² at φ: " + columns_text(found), judged(checks)


def tails(sweep):
    """Where the tails are exponential, a Gaussian with the width of the core has far fewer samples beyond two standard deviations than there are."""
    found = []
    for run in sweep.runs:
        share = run.fit("pdf_velocity_z_core_and_tails")["gaussian_tail"]
        if share.exists():
            found.append((run, share.value))
    if not found:
        return "no fit", UNTESTED
    dense = [v for r, v in found if r.phi_group > 0.4]
    dilute = [v for r, v in found if r.phi_group < 0.3]
    words = f"the core's Gaussian explains {min(dense):.2f} to {max(dense):.2f} of the samples beyond 2σ at φ > 0.4" if dense else ""
    if dilute:
        words += f"; {min(dilute):.2f} to {max(dilute):.2f} at φ < 0.3"
    return words + " (δu_z; 1: no tails)", judged([v < 0.8 for v in dense])


def gap_radius(sweep):
    slope, fitted = sweep.gap_radius["slope"], radius_fit(sweep)
    if fitted is None:
        return sweep.gap_radius.reason, UNTESTED
    words = f"r′ = {text(slope)} lattice units = {text(fitted)} r (the paper's 2 at r = 9: 0.22 r)"
    return words, HOLDS if abs(fitted.value / 0.222 - 1) < 0.2 else PARTLY if abs(fitted.value / 0.222 - 1) < 0.5 else FAILS


def balance(sweep):
    fitted = radius_fit(sweep)
    if fitted is None:
        return "no r′", UNTESTED
    ratios = []
    for run in sweep.runs:
        right, left = balance_of(run, fitted.value)
        if run.phi_group >= 0.2 and right.exists() and left.exists() and right.value > 0:
            ratios.append(left.value / right.value)
    spread = float(np.exp(np.std(np.log(ratios))))
    return f"left over right side between {min(ratios):.2f} and {max(ratios):.2f} for φ ≥ 0.2, spread by a factor of {spread:.2f}, while the left side itself varies by a factor of "\
           f"{variance_span(sweep):.0f}", HOLDS if spread < 1.25 else PARTLY if spread < 1.7 else FAILS


def variance_span(sweep):
    values = [total_variance(r).value for r in sweep.runs if r.phi_group >= 0.2]
    return max(values) / min(values)


def stretched(sweep):
    found = [(r, r.fit("vacf_z_stretched_exponential")) for r in sweep.runs]
    undetermined = sum(1 for _, f in found if f["exponent"].exists() and not f["exponent"].error < f["exponent"].value)
    found = [(r, f["exponent"], f["time"]) for r, f in found if f["exponent"].exists() and f["exponent"].error < f["exponent"].value]
    if not found:
        return "no fit", UNTESTED
    rows = [f"φ = {phi:.2f}: " + ", ".join(text(b) for r, b, _ in sorted(found, key=lambda e: -e[0].ca) if r.phi_group == phi) for phi in sweep.phis if any(r.phi_group == phi for r, _, _ in found)]
    more = f"; not determined in {undetermined} runs" if undetermined else ""
    return "b (δu_z; Ca falling from left to right): " + "; ".join(rows) + more, judged([b.error < 0.2 * b.value for _, b, _ in found] + [False] * undetermined)


def relaxation(sweep):
    found = columns(sweep, lambda r: mean_yz(r, "relaxation_time"))
    return "γ̇τ_v (mean of y and z) at φ: " + columns_text(found), judged(0.1 < v.value < 2 for _, pairs in found for _, v in pairs if v.exists())


def diffusion_trend(sweep):
    found = columns(sweep, lambda r: mean_yz(r, "diffusivity_vacf"))
    checks = []
    for ca, pairs in found:
        values = [(phi, v.value) for phi, v in pairs if v.exists()]
        if values:
            largest = max(values, key=lambda e: e[1])[0]
            checks.append(0.55 < largest < 0.8 if ca == found[0][0] else largest > 0.6)
    return "D/(γ̇r²) from the VACF (mean of y and z) at φ: " + columns_text(found), judged(checks)


def diffusion_example(sweep):
    runs = [r for r in sweep.runs if abs(r.nominal_ca / 0.008 - 1) < 0.05 and abs(r.phi - 0.33) < 0.02]
    if not runs:
        return "the point is not in the sweep", UNTESTED
    run = runs[0]
    values = [mean_yz(run, f"diffusivity_{way}") for way in ("msd", "vacf", "gamma")]
    return f"D/(γ̇r²) at Ca = {run.ca:.2g} = {text(values[0])} (MSD), {text(values[1])} (∫C_v), {text(values[2])} (Γ formula)", judged([abs(v.value / 0.05 - 1) < 0.3 for v in values if v.exists()])


def msd_exponents(sweep):
    early = [(r, r.estimate("msd_exponent_z_early")) for r in sweep.runs]
    low = [v.value for r, v in early if v.exists() and r.phi_group < 0.8]
    dense = [(r, v) for r, v in early if v.exists() and r.phi_group > 0.85]
    if not low:
        return "no exponents", UNTESTED
    words = f"at lags below 0.3 strains, along z: {min(low):.2f} to {max(low):.2f} at φ < 0.8; at φ = 0.9: " + (in_words([f"{text(v)} (Ca = {r.ca:g})" for r, v in dense]) or "none")
    return words, judged([min(low) > 1.8] + [abs(v.value - 1.7) < 0.1 for _, v in dense])


def stress_fluctuations(sweep):
    value_of = lambda r: r.estimate("stress_fluctuation")
    return "RMS/mean of the stresslets σ_xz of single cells at φ: " + columns_text(columns(sweep, value_of)), judged(rising_with_falling_ca(sweep, value_of))


def stress_relaxation(sweep):
    found = columns(sweep, lambda r: r.estimate("stresslet_relaxation_time"))
    return "γ̇τ of single cells' stresslets at φ: " + columns_text(found), judged(v.value < 3 for _, pairs in found for _, v in pairs if v.exists())


# (statement of the paper, rule of the verdict, function)
STATEMENTS = [
    ("Newtonian at low φ", "holds: q < 0.1 at φ = 0.12", newtonian),
    ("Shear thinning with an exponent of about −½ at high φ", "holds: |q − 0.5| < 0.15 at every φ > 0.6", thinning),
    ("Yield stress above φ_c ≈ 0.66: η/η₀ = σ_y/Ca + b Ca^−q", "holds: σ_y > 2 errors at every φ > 0.7, at none below 0.6; φ_c within 0.05", yield_stress),
    ("Velocity variances grow with φ and with falling Ca", "holds: every neighbouring pair of values does", variances),
    ("Velocities have a Gaussian core and exponential tails", "holds: more than a quarter again as many samples beyond 2σ as the core's Gaussian has, at every φ > 0.4", tails),
    ("Gap l = 2r′(φ^−⅓ − 1) for φ ≳ 0.2 with r′ ≈ 2 lattice units at r = 9", "holds: r′ within 20 %, partly: within 50 %, relative to r", gap_radius),
    ("Dissipation balance: the data collapse", "holds: spread (1σ of the logarithm) below a factor of 1.25, partly: 1.7", balance),
    ("VACF: stretched exponential for γ̇t ≲ 1", "holds: the fit determines b to a fifth in every run", stretched),
    ("Velocities decorrelate within about a strain", "holds: 0.1 < γ̇τ_v < 2 in all runs", relaxation),
    ("D grows with φ; at small Ca it has a maximum near φ ≈ 0.66", "holds: the maximum lies between 0.55 and 0.8 at the smallest Ca, above 0.6 at the others", diffusion_trend),
    ("D/(γ̇r²) ≈ 0.05 at φ = 0.33, Ca = 0.008", "holds: within 30 %, three ways", diffusion_example),
    ("MSD exponent 2 at early times, 1.7 at φ = 0.9", "holds: above 1.8 at all φ < 0.8; 1.7 ± 0.1 at 0.9", msd_exponents),
    ("Stress fluctuations grow with falling Ca", "holds: every neighbouring pair of Ca at equal φ does", stress_fluctuations),
    ("Stress relaxes within about a strain", "holds: below 3 strains in all runs", stress_relaxation),
]
