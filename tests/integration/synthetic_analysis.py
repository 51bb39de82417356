"""A sweep as `corpuscle analyse` leaves it, made of the laws of Gross, Krüger & Varnik (EPL 2014) with noise: 7 volume fractions x 4 capillary numbers.

    python tests/integration/synthetic_analysis.py DIR

writes DIR/sweep.json, DIR/analysis.json and a folder for each run with analysis.json, run.h5 and, for one of them, cells.vtkhdf.
"""
import json
import math
import pathlib
import sys

import numpy as np

PHIS = (0.12, 0.24, 0.35, 0.45, 0.55, 0.75, 0.90)
CAS = (0.081, 0.028, 2.8e-3, 2.8e-4)
CRITICAL, GAP_RADIUS, RADIUS = 0.66, 2.0, 9.0  # gap radius r' and radius in lattice units


def plain(value):
    """NaN as null, arrays as lists."""
    if isinstance(value, dict):
        return {key: plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return value


def write(path, data):
    path.write_text(json.dumps(plain(data)))


def yield_stress(phi):
    return 0.15 * max(phi - CRITICAL, 0) ** 1.2


def viscosity(phi, ca):
    """Newtonian, then shear thinning, then with a yield stress."""
    dilute = 1 + 2.2 * phi + 4 * phi ** 2
    return dilute + 1.3 * phi ** 4 * ca ** -0.5 + yield_stress(phi) / ca


def gap_radii(phi):
    return 2 * GAP_RADIUS / RADIUS * (phi ** (-1 / 3) - 1)


class Noise:
    """Estimates and curves with the noise that their errors say."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)

    def estimate(self, value, relative, unit="1", description="", doubt=""):
        error = abs(value) * relative
        return {"value": value + error * self.random.normal(), "error": error, "unit": unit, "correlation_time": 0.5, "effective_samples": 40, "converged": not doubt,
                "reason": doubt, "description": description}

    def curve(self, x, value, error, x_label="", label="", trusted_until=None):
        error = np.broadcast_to(error, np.shape(value))
        return {"x": x, "value": value + error * self.random.normal(size=len(x)), "error": error, "x_unit": "", "unit": "", "x_label": x_label, "label": label,
                "trusted_until": trusted_until, "converged": True, "reason": "", "description": ""}


def fit(model, parameters, curve, converged=True, reason=""):
    return {"model": model, "parameters": {name: {"value": v, "error": e} for name, (v, e) in parameters.items()}, "chi2": 10.0, "degrees_of_freedom": 10,
            "probability": 0.4, "converged": converged, "reason": reason, "curve": curve}


def density(x, deviation):
    """Gaussian core, exponential tails beyond two standard deviations: (p, parameters)."""
    width, decay, start = 0.8 * deviation, 0.5 * deviation, 2 * deviation
    core = np.exp(-x ** 2 / (2 * width ** 2))
    foot = math.exp(-start ** 2 / (2 * width ** 2))
    p = np.where(np.abs(x) < start, core, foot * np.exp(-(np.abs(x) - start) / decay))
    norm = np.sum(p) * (x[1] - x[0])
    parameters = {"core_height": (1 / norm, 0.01 / norm), "core_centre": (0.0, 0.01), "core_width": (width, 0.01 * width)}
    for side, place in (("lower", -start), ("upper", start)):
        parameters |= {f"{side}_height": (foot / norm, 0.1 * foot / norm), f"{side}_decay": (decay, 0.05 * decay), f"{side}_start": (place, math.nan)}
    return p / norm, parameters


def run_analysis(phi, ca, seed):
    """analysis.json of one run."""
    noise = Noise(seed)
    doubt = "the steady part is only 12 correlation times long; 20 are needed" if phi > 0.8 and ca < 1e-3 else ""
    eta = viscosity(phi, ca)
    bracket = (eta - 1) / (1 - phi) - 1
    total = bracket * gap_radii(phi) ** 2 if bracket > 0.3 else 0.05 * phi
    shares = {"x": 0.46, "y": 0.24, "z": 0.30}
    b, tau = 1.6 - 0.6 * phi, 0.25 * phi ** -0.4
    estimates = {"relative_viscosity": noise.estimate(eta, 0.02, description="1 + particle stress xz of the bulk / (eta_0 imposed shear rate)", doubt=doubt),
                 "whole_relative_viscosity": noise.estimate(eta, 0.02), "wall_relative_viscosity": noise.estimate(eta, 0.02),
                 "phi_bulk": noise.estimate(phi * 1.02, 0.001),
                 "gap_size": noise.estimate(gap_radii(phi), 0.03, "r") if bracket > 0.3 else
                 {"value": None, "error": None, "unit": "r", "converged": False, "reason": "the bracket of the balance is not positive: no gap to speak of", "description": ""},
                 "stress_fluctuation": noise.estimate(0.5 + 0.8 * phi ** 2 * ca ** -0.15, 0.03), "bulk_stress_fluctuation": noise.estimate(0.02 + 0.05 * phi * ca ** -0.1, 0.05),
                 "stress_relaxation_time": noise.estimate(0.4 * phi ** -0.5, 0.1, "strain", doubt=doubt), "stresslet_relaxation_time": noise.estimate(0.3 * phi ** -0.5, 0.05, "strain"),
                 "deformation": noise.estimate(0.45, 0.01), "order_parameter": noise.estimate(0.4, 0.03), "inclination": noise.estimate(0.3, 0.05, "rad")}
    curves, fits = {}, {}
    t = np.concatenate([[0], np.geomspace(0.02, 40, 80)])
    late = {"trusted_until": 20.0}
    for name, share in shares.items():
        square = share * total
        estimates[f"velocity_variance_{name}"] = noise.estimate(square, 0.02, "(gamma_dot r)^2", f"variance of the cells' velocities along {name}", doubt)
        estimates[f"velocity_kurtosis_{name}"] = noise.estimate(1.2, 0.1)
        deviation = math.sqrt(square)
        x = np.linspace(-6, 6, 61) * deviation
        p, parameters = density(x, deviation)
        curves[f"pdf_velocity_{name}"] = noise.curve(x, p, 0.03 * p + 1e-5 / deviation, rf"$\delta u_{name}/(\dot\gamma r)$", "$p$")
        fits[f"pdf_velocity_{name}_core_and_tails"] = fit("core_height exp[...]", parameters, f"pdf_velocity_{name}")
        vacf = np.exp(-(t / tau) ** b) - 0.03 * np.exp(-((t - 5 * tau) / (2 * tau)) ** 2) * (t > 0)
        curves[f"vacf_{name}"] = noise.curve(t, vacf, 0.004 * (t > 0), r"$\dot\gamma t$", r"$C_v(t)/C_v(0)$", **late)
        if name == "x":
            continue
        fits[f"vacf_{name}_stretched_exponential"] = fit("amplitude exp[-(t/time)^exponent]", {"amplitude": (1.0, 0.01), "time": (tau * (1 + 0.02 * noise.random.normal()), 0.02 * tau),
                                                         "exponent": (b * (1 + 0.02 * noise.random.normal()), 0.02 * b)}, f"vacf_{name}", not doubt, doubt)
        diffusivity = square * tau * math.gamma(1 + 1 / b)
        for kind in ("msd", "vacf", "gamma"):
            estimates[f"diffusivity_{kind}_{name}"] = noise.estimate(diffusivity, 0.06, "gamma_dot r^2", f"{kind} along {name}", doubt)
        early, msd_t = (2.0 if phi < 0.8 else 1.7), t[1:]
        scale = 2 * diffusivity / square / 0.9
        msd = square * msd_t ** early / (1 + (msd_t / scale) ** 2) ** ((early - 1) / 2) * scale ** (2 - early)
        curves[f"msd_{name}"] = noise.curve(msd_t, msd, 0.03 * msd, r"$\dot\gamma t$", rf"$\langle\Delta {name}^2\rangle/r^2$", **late)
        fits[f"msd_{name}_line"] = fit("intercept + slope t", {"intercept": (0.0, 0.01), "slope": (msd[-1] / msd_t[-1], 0.05 * diffusivity)}, f"msd_{name}")
        estimates[f"msd_exponent_{name}_early"] = noise.estimate(early, 0.01)
        estimates[f"msd_exponent_{name}_late"] = noise.estimate(1.0, 0.05)
        exponent = 1 + (early - 1) / (1 + (msd_t / scale) ** 2)
        curves[f"msd_exponent_{name}"] = noise.curve(msd_t, exponent, 0.04, r"$\dot\gamma t$", r"$\mathrm{d}\ln\,\mathrm{MSD}/\mathrm{d}\ln t$", **late)
        curves[f"displacement_acf_{name}"] = noise.curve(t, vacf, 0.01)
    for name, time in (("stress_autocorrelation", 0.4), ("stresslet_autocorrelation", 0.3)):
        curves[name] = noise.curve(t, np.exp(-t / (time * phi ** -0.5)), 0.02 * (t > 0), r"$\dot\gamma t$", r"$C_\sigma(t)/C_\sigma(0)$", **late)
    z, distance = np.linspace(0.5, 39.5, 40), np.linspace(0.05, 8, 80)
    wall = 1 - np.exp(-np.minimum(z, 40 - z) / 1.5)
    curves |= {"profile_phi": noise.curve(z, phi * wall, 0.01, "$z/r$", r"$\phi$"), "profile_velocity": noise.curve(z, z - 20, 0.05, "$z/r$", r"$u_x/(\dot\gamma r)$"),
               "profile_stress_xz": noise.curve(z, (eta - 1) * wall, 0.03 * eta, "$z/r$", r"$\sigma_{xz}/(\eta_0\dot\gamma)$"),
               "profile_deformation": noise.curve(z, 0.45 + 0 * z, 0.01, "$z/r$", "$D$"), "pdf_stresslet": noise.curve(np.linspace(-1, 4, 50), np.exp(-(np.linspace(-1, 4, 50) - 1) ** 2), 0.01,
               r"$S_{xz}/\langle S_{xz}\rangle$", "$p$"),
               "pair_distribution": noise.curve(distance, (1 + 1.2 * np.exp(-(distance - 1.6) ** 2 / 0.2)) / (1 + np.exp(-(distance - 1) / 0.12)), 0.02, "distance$/r$", "$g$")}
    for name, share in shares.items():
        curves[f"profile_variance_{name}"] = noise.curve(z, share * total * wall, 0.03 * share * total, "$z/r$", rf"$\langle\delta u_{name}^2\rangle/(\dot\gamma r)^2$")
    return {"format": "corpuscle-analysis-1", "version": "0.0", "git_revision": "0000000",
            "run": {"directory": "", "capillary_number": ca, "phi_geometric": phi * 0.83, "phi_effective": phi, "cell_count": int(8540 * phi), "radius": RADIUS, "effective_radius": 9.3,
                    "viscosity": 1 / 6, "shear_rate": 1e-5, "box": [180, 180, 360], "strain": 60.0, "samples": 6001, "sample_interval": 0.01},
            "settings": {"wall_layer": 4, "mean_flow": "measured", "discarded_strain": 12.0, "longest_lag": 40.0}, "equilibration": {"strain": 12.0, "converged": not doubt, "reason": doubt},
            "estimates": estimates, "curves": curves, "fits": fits,
            "tensors": {"orientation": {"value": [[0.25, 0, -0.15], [0, 0.2, 0], [-0.15, 0, 0.55]], "error": [[0.01] * 3] * 3}}, "warnings": [doubt] if doubt else []}


def flow_curves(runs):
    """The fits of the sweep, as they come out of data without bias."""
    found = []
    for phi in PHIS:
        own = [r for r in runs if r["run"]["phi_effective"] == phi]
        if not own:
            continue
        slope = np.polyfit([math.log(r["run"]["capillary_number"]) for r in own], [math.log(r["estimates"]["relative_viscosity"]["value"]) for r in own], 1)
        stress = yield_stress(phi)
        # What is left of the law above without its yield stress isn't quite a power law either.
        ca = np.array([r["run"]["capillary_number"] for r in own])
        rest = np.polyfit(np.log(ca), np.log([viscosity(phi, c) - stress / c for c in ca]), 1)
        found.append({"phi_effective": phi, "phi_geometric": 0.83 * phi, "runs": [r["directory"] for r in own],
                      "shear_thinning": fit("prefactor Ca^-exponent", {"prefactor": (math.exp(slope[1]), 0.02), "exponent": (-slope[0], 0.01)}, ""),
                      "yield_stress": fit("yield_stress/Ca + prefactor Ca^-exponent", {"yield_stress": (stress, 1e-4 + 0.02 * stress), "prefactor": (math.exp(rest[1]), 0.05),
                                          "exponent": (-rest[0], 0.02)}, "")})
    return found


def write_sweep(folder, phis=PHIS, cas=CAS):
    """Writes the whole; returns the folders of the runs."""
    folder = pathlib.Path(folder)
    entries, places = [], []
    for phi in phis:
        for ca in cas:
            name = f"phi{phi:g}-Ca{ca:g}"
            place = folder / name
            place.mkdir(parents=True, exist_ok=True)
            analysis = run_analysis(phi, ca, len(places) + 1)
            write_series(place / "run.h5", phi, ca, analysis)
            write(place / "analysis.json", analysis)
            entries.append({"directory": name} | {key: analysis[key] for key in ("run", "estimates", "fits")})
            places.append(place)
    write(folder / "sweep.json", {"format": "corpuscle-sweep-1", "scene": "scene.toml", "runs": [
        {"name": e["directory"], "directory": e["directory"], "overrides": {}, "state": "finished", "exit_code": 0, "message": ""} for e in entries]})
    write(folder / "analysis.json", {"format": "corpuscle-sweep-analysis-1", "runs": entries, "flow_curves": flow_curves(entries),
          "critical_volume_fraction": {"value": 0.664, "error": 0.008, "converged": True, "reason": "", "description": ""},
          "gap_radius": fit("l = 2 slope (phi^(-1/3) - 1)", {"slope": (1.98, 0.05)}, ""), "warnings": []})
    return places


def write_series(path, phi, ca, analysis):
    """A run.h5 with the attributes and series that a report reads."""
    import h5py
    random = np.random.default_rng(1)
    strain = np.arange(0, 60.01, 0.1)
    rise = 1 - np.exp(-strain / 3)
    eta, mean = analysis["estimates"]["relative_viscosity"]["value"], 0.45
    wobble = np.convolve(random.normal(size=len(strain)), np.ones(10) / 10, "same")
    with h5py.File(path, "w") as file:
        file.create_group("lattice").attrs.update({"phi_geometric": 0.83 * phi, "phi_effective": phi, "capillary_number": ca, "shear_rate": 1e-5, "radius": RADIUS, "wall_velocity": 1.8e-3})
        values = {"step": (1000 * strain).astype(int), "strain": strain, "relative_viscosity": 1 + (eta - 1) * rise * (1 + 0.1 * wobble),
                  "bulk_relative_viscosity": 1 + (eta - 1) * rise * (1 + 0.12 * wobble), "wall_relative_viscosity": 1 + (eta - 1) * rise * (1 - 0.1 * wobble),
                  "normal_stress_difference_1": 0.1 * rise * (eta - 1) * (1 + wobble), "normal_stress_difference_2": -0.1 * rise * (eta - 1) * (1 + wobble),
                  "particle_pressure": 0.2 * rise * (eta - 1) * (1 + wobble), "mean_deformation": mean + 0.05 * rise + 0.005 * wobble, "area_drift_max": 0.01 * rise,
                  "volume_drift_max": 0.002 * rise}
        for name, data in values.items():
            file[f"series/{name}"] = data


if __name__ == "__main__":
    write_sweep(sys.argv[1])
