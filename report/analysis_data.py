"""Reads analysis.json of a run or of a sweep (docs/analysis.md): estimates, curves and fits by name, null as NaN, missing ones with a reason."""
import json
import math
import pathlib

import numpy as np

RUN_FORMAT, SWEEP_FORMAT = "corpuscle-analysis-1", "corpuscle-sweep-analysis-1"


class BadAnalysis(Exception):
    """A file that is not there or not what it should be; the text names it and says what to do."""


def number(value):
    return math.nan if value is None else float(value)


class Value:
    """An estimate or a parameter: value, standard error, whether both can be trusted, and why not."""

    def __init__(self, entry=None, reason="not in the analysis"):
        entry = entry or {"reason": reason}
        self.value, self.error = number(entry.get("value")), number(entry.get("error"))
        self.converged = bool(entry.get("converged", False))
        self.reason = entry.get("reason") or ""
        self.unit, self.description = entry.get("unit", ""), entry.get("description", "")
        self.correlation_time, self.effective_samples = number(entry.get("correlation_time")), number(entry.get("effective_samples"))

    def exists(self):
        return math.isfinite(self.value)

    def scaled(self, factor):
        """The same times a number known without error."""
        result = Value({"value": self.value * factor, "error": self.error * abs(factor), "converged": self.converged, "reason": self.reason})
        return result


def combined(function, values):
    """A Value from others: errors propagated as independent, by the change of `function` with each value by its error."""
    missing = next((v for v in values if not v.exists()), None)
    if missing is not None:
        return Value({"reason": missing.reason})
    centre = [v.value for v in values]
    try:
        result, square = function(*centre), 0.0
        for i, value in enumerate(values):
            if math.isfinite(value.error):
                square += (function(*centre[:i], centre[i] + value.error, *centre[i + 1:]) - result) ** 2
    except (ValueError, ZeroDivisionError, OverflowError):
        return Value({"reason": "its parts give no finite number"})
    doubted = next((v for v in values if not v.converged), None)
    return Value({"value": result, "error": math.sqrt(square), "converged": doubted is None, "reason": doubted.reason if doubted else ""})


class Curve:
    """x, value, error: arrays of one length; labels for axes; see Value for the rest."""

    def __init__(self, entry=None, reason="not in the analysis"):
        entry = entry or {"reason": reason}
        arrays = [np.array([number(v) for v in entry.get(name) or ()]) for name in ("x", "value", "error")]
        if not len(arrays[2]):
            arrays[2] = np.full(len(arrays[1]), math.nan)
        if len({len(a) for a in arrays}) != 1:
            raise BadAnalysis(f"a curve has {len(arrays[0])} x, {len(arrays[1])} values and {len(arrays[2])} errors")
        self.x, self.value, self.error = arrays
        until = entry.get("trusted_until")
        self.trusted_until = math.inf if until is None else float(until)
        self.converged = bool(entry.get("converged", False))
        self.reason = entry.get("reason") or ""
        self.x_label, self.label = entry.get("x_label", ""), entry.get("label", "")
        self.description = entry.get("description", "")

    def exists(self):
        return bool(np.isfinite(self.value).any())


class Fit:
    """Parameters by name as Values; they are trusted when the whole fit is."""

    def __init__(self, entry=None, reason="not in the analysis"):
        entry = entry or {"reason": reason}
        self.model, self.reason = entry.get("model", ""), entry.get("reason") or ""
        self.converged = bool(entry.get("converged", False))
        self.start, self.end = number(entry.get("from")), number(entry.get("to"))
        self.parameters = {name: Value({**parameter, "converged": self.converged, "reason": self.reason})
                           for name, parameter in (entry.get("parameters") or {}).items()}

    def exists(self):
        return bool(self.parameters) and all(p.exists() for name, p in self.parameters.items() if not name.startswith("gaussian"))

    def __getitem__(self, name):
        return self.parameters.get(name) or Value({"reason": self.reason or f"the fit has no {name}"})


class Run:
    """One analysed run. phi is the effective volume fraction, ca the capillary number; NaN where they mean nothing."""

    def __init__(self, data, name, folder=None, why_no_curves="not in the analysis"):
        self.name, self.folder = name, folder
        self.info = data.get("run") or {}
        self.settings, self.equilibration = data.get("settings") or {}, data.get("equilibration") or {}
        self.estimates = {key: Value(entry) for key, entry in (data.get("estimates") or {}).items()}
        self.fits = {key: Fit(entry) for key, entry in (data.get("fits") or {}).items()}
        self.curves, self.tensors = {}, data.get("tensors") or {}
        for key, entry in (data.get("curves") or {}).items():
            try:
                self.curves[key] = curve = Curve(entry)
                # A curve is not converged already when errors at its longest lags are too small; up to there it may be.
                if curve.reason.startswith("errors beyond x") and np.isfinite(curve.trusted_until) and self.equilibration.get("converged"):
                    curve.converged = True
            except BadAnalysis as error:
                raise BadAnalysis(f"{name}: {key}: {error}") from None
        self.warnings = list(data.get("warnings") or [])
        self.version, self.git_revision = data.get("version", ""), data.get("git_revision", "")
        self.phi, self.ca = number(self.info.get("phi_effective")), number(self.info.get("capillary_number"))
        factor = number(self.info.get("rate_factor", 1))  # of the bulk's shear rate over that of the walls, where the analysis is referred to it
        self.nominal_ca = self.ca / factor if factor > 0 else self.ca
        self.radius = number(self.info.get("radius"))
        self._why_no_curves = why_no_curves

    def estimate(self, name):
        return self.estimates.get(name) or Value(reason=f"{name} is not in the analysis")

    def curve(self, name):
        return self.curves.get(name) or Curve(reason=self._why_no_curves)

    def fit(self, name):
        return self.fits.get(name) or Fit(reason=f"{name} is not in the analysis")

    def phi_bulk(self):
        """Volume fraction of the bulk where it was measured, else that of the box."""
        measured = self.estimate("phi_bulk").value
        return measured if math.isfinite(measured) else self.phi


def grouped(values, tolerance=0.02):
    """Each value's group: values within `tolerance` of the one before, relatively, are one, called by its mean."""
    order = sorted({v for v in values if math.isfinite(v) and v > 0})
    groups = []
    for value in order:
        if groups and value <= groups[-1][-1] * (1 + tolerance):
            groups[-1].append(value)
        else:
            groups.append([value])
    return {value: sum(group) / len(group) for group in groups for value in group}


class Sweep:
    """The analysed runs of a sweep, and what is fitted over them. A run of its own is a sweep of one."""

    def __init__(self, runs, data=None, folder=None):
        data = data or {}
        self.folder = folder
        phis, cas = grouped(r.phi for r in runs), grouped(r.nominal_ca for r in runs)
        self.runs = [r for r in runs if r.phi in phis and r.nominal_ca in cas]
        self.outside = [r for r in runs if r not in self.runs]
        for run in self.runs:
            run.phi_group, run.ca_group = phis[run.phi], cas[run.nominal_ca]
        self.phis, self.cas = sorted({r.phi_group for r in self.runs}), sorted({r.ca_group for r in self.runs})
        self.warnings = list(data.get("warnings") or [])
        self.critical = Value(data.get("critical_volume_fraction"), "the sweep has not been analysed for it")
        self.gap_radius = Fit(data.get("gap_radius"), "the sweep has not been analysed for it")
        self.flow_curves = [(number(entry.get("phi_effective")), Fit(entry.get("shear_thinning")), Fit(entry.get("yield_stress")))
                            for entry in data.get("flow_curves") or []]

    def ca_range(self):
        """(smallest, largest) capillary number of the runs: beyond those of the groups where it is referred to the bulk's shear rate."""
        found = [r.ca for r in self.runs] + self.cas
        return min(found), max(found)

    def flow_curve(self, phi):
        """(shear thinning, yield stress) fitted at a volume fraction of the sweep."""
        near = [entry for entry in self.flow_curves if abs(entry[0] / phi - 1) < 0.02]
        return near[0][1:] if near else (Fit(), Fit())

    def of(self, phi=None, ca=None):
        return [r for r in self.runs if phi in (None, r.phi_group) and ca in (None, r.ca_group)]


def read_json(path):
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        raise BadAnalysis(f"{path} does not exist. Make it with: corpuscle analyse {path.parent}") from None
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise BadAnalysis(f"{path} cannot be read ({error}). Make it anew with: corpuscle analyse {path.parent}") from None


def read_run(folder, name=None):
    data = read_json(folder / "analysis.json")
    if not isinstance(data, dict) or data.get("format") != RUN_FORMAT:
        raise BadAnalysis(f"{folder / 'analysis.json'} is no analysis of a run ({RUN_FORMAT}). Make it anew with: corpuscle analyse {folder}")
    return Run(data, name or folder.name, folder)


def load(folder):
    """A Run or a Sweep from a folder with analysis.json; BadAnalysis says what is wrong."""
    folder = pathlib.Path(folder)
    data = read_json(folder / "analysis.json")
    kind = data.get("format") if isinstance(data, dict) else None
    if kind == RUN_FORMAT:
        return read_run(folder, folder.resolve().name)
    if kind != SWEEP_FORMAT:
        raise BadAnalysis(f"{folder / 'analysis.json'} is of the format {kind!r}, not {RUN_FORMAT} or {SWEEP_FORMAT}. Make it anew with: corpuscle analyse {folder}")
    runs = []
    warnings = []
    for entry in data.get("runs") or []:
        place = folder / entry["directory"]
        try:
            runs.append(read_run(place, entry["directory"]))
        except BadAnalysis as error:  # the sweep's own file still has the numbers, without the curves
            runs.append(Run(entry, entry["directory"], place, f"its own analysis.json cannot be read: {place.name}"))
            warnings.append(str(error))
    if not runs:
        raise BadAnalysis(f"{folder / 'analysis.json'} holds no analysed run. Let a run of the sweep go on, then: corpuscle analyse {folder}")
    sweep = Sweep(runs, data, folder)
    sweep.warnings += warnings
    return sweep
