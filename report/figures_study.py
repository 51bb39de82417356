"""Figures of a study of error against cost (`corpuscle tradeoff`, docs/tradeoff.md): the front, and the observables against the resolution with their limit."""
import math

from analysis_data import BadAnalysis, number, read_json
from panels import Drawn, Missing
from style import COLUMN, GREY, INK, PAGE, key, log_ticks, np, plt

STUDY_FORMAT = "corpuscle-tradeoff-1"
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]  # Okabe and Ito
SYMBOLS = "os^DvP"


def short(knob):
    return {"accuracy.radius": "r", "flow.reynolds_number_max": "Re", "accuracy.relaxation_time": "τ"}.get(knob, knob.split(".")[-1].replace("_", " "))


class Study:
    """tradeoff.json with what the figures need of it."""

    def __init__(self, folder):
        data = read_json(folder / "tradeoff.json")
        if not isinstance(data, dict) or data.get("format") != STUDY_FORMAT:
            raise BadAnalysis(f"{folder / 'tradeoff.json'} is no study ({STUDY_FORMAT}). Make it anew with: corpuscle tradeoff STUDY.toml --output {folder} --no-run")
        self.folder, self.data = folder, data
        self.version, self.git_revision = data.get("version", "?"), data.get("git_revision", "?")
        self.knobs, self.observables, self.base = data["knobs"], data["observables"], data["base"]
        self.points = data["points"]
        self.warnings = list(data.get("warnings") or [])
        # The knob of the resolution labels the points; others give colour and symbol, those with most settings first.
        numbers = [k for k in self.knobs if all(is_number(p["settings"][k]) for p in self.points)]
        extrapolated = [k for k in numbers if any(k not in f["settings"] for r in data["reference"].values() for f in r.get("families", []))]
        many = [k for k in numbers if len({p["settings"][k] for p in self.points}) > 3]
        self.along = (extrapolated or many or [None])[0]
        rest = [k for k in self.knobs if k != self.along]
        # Those that more points change first: a knob of [[also]] is changed by few.
        rest.sort(key=lambda k: -sum(p["settings"][k] != self.base[k] for p in self.points))
        self.by_colour = rest[0] if rest else None
        self.by_symbol = rest[1] if len(rest) > 1 else None
        self.colours = self.looks(self.by_colour, COLOURS)
        self.symbols = self.looks(self.by_symbol, SYMBOLS)

    def looks(self, knob, choices):
        if knob is None:
            return {}
        settings = sorted({p["settings"][knob] for p in self.points}, key=lambda s: (number_of(s), s))
        return {setting: choices[i % len(choices)] for i, setting in enumerate(settings)}

    def look(self, settings):
        return self.colours.get(settings.get(self.by_colour), COLOURS[0]), self.symbols.get(settings.get(self.by_symbol), "o")

    def is_otherwise_base(self, settings):
        """Whether all knobs but those of label, colour and symbol are those of the base scene."""
        return all(settings.get(k) == self.base[k] for k in self.knobs if k not in (self.along, self.by_colour, self.by_symbol))

    def keys(self):
        keys = [key(colour, "o", f"{short(self.by_colour)} {setting}", line=False) for setting, colour in self.colours.items()]
        return keys + [key(GREY, symbol, f"{short(self.by_symbol)} {setting}", line=False) for setting, symbol in self.symbols.items() if len(self.symbols) > 1]


def is_number(text):
    return math.isfinite(number_of(text))


def number_of(text):
    try:
        return float(text)
    except ValueError:
        return math.inf


def cost_of(point):
    return number(point["core_seconds_per_strain"]["predicted"])


def front(study, tally):
    """Deviation of each observable, and the largest of them, against cost."""
    panels = study.observables + (["largest of all"] if len(study.observables) > 1 else [])
    figure, grid = plt.subplots(1, len(panels), figsize=(min(PAGE, COLUMN * len(panels)) if len(panels) > 1 else COLUMN, 8.2 / 2.54), squeeze=False, sharey=True)
    drawn = 0
    for axes, panel in zip(grid[0], panels):
        rows = []
        for point in study.points:
            found = point["deviation"] if panel == "largest of all" else point["observed"][panel]["deviation"]
            size, error, cost = abs(number(found["value"])), abs(number(found["error"])), cost_of(point)
            if not (math.isfinite(size) and math.isfinite(cost) and cost > 0):
                tally.miss(point["name"], point["message"] or point["state"])
                continue
            rows.append((cost, 100 * size, 100 * error, point))
        for cost, size, error, point in rows:
            colour, symbol = study.look(point["settings"])
            hollow = not study.is_otherwise_base(point["settings"])
            axes.errorbar(cost, max(size, 0.04), yerr=[[min(error, 0.95 * max(size, 0.04))], [error]], color=colour, marker=symbol, linestyle="none", markersize=4, elinewidth=0.5,
                          markerfacecolor="white" if hollow else colour, zorder=3)
            label = point["settings"].get(study.along) if study.along and not hollow else None  # those of other knobs lie too close: the tables have them
            if label:
                axes.annotate(label, (cost, max(size, 0.04)), textcoords="offset points", xytext=(3, 2), fontsize=5, color=GREY)
        drawn += len(rows)
        best = []
        for cost, size, _, point in sorted(rows, key=lambda row: row[:2]):
            if not best or size < best[-1][1]:
                best.append((cost, max(size, 0.04)))
        if best:
            axes.step([b[0] for b in best] + [max(row[0] for row in rows)], [b[1] for b in best] + [best[-1][1]], where="post", color=INK, linewidth=0.8, zorder=1)
        for target in (15, 5, 2):
            axes.axhline(target, color=GREY, linewidth=0.5, linestyle=":")
        axes.set(xscale="log", yscale="log", title=panel.replace("_", " "))
        log_ticks(axes.xaxis)
    if not drawn:
        plt.close(figure)
        raise Missing("no point has both a deviation and a cost")
    grid[0][0].set_ylabel("deviation from the reference (%)")
    grid[0][len(panels) // 2].set_xlabel("core seconds per strain")  # once: panels are too narrow for one each
    grid[0][0].set_ylim(bottom=0.03)
    figure.legend(handles=study.keys(), loc="outside lower center", ncols=6)
    reference = ", ".join(f"{name} {number(r['value']):.4g} ± {number(r['error']):.2g}" for name, r in study.data["reference"].items())
    labels = f" Labels: {short(study.along)}." if study.along else ""
    return Drawn(figure, None, [f"Each point is a setting; the line is the front. Dotted: 15, 5 and 2 %.{labels} Hollow: another knob differs from the base scene. Reference: {reference}."])


def in_family(settings, reference):
    """Whether a point is one of an extrapolated family: these have all knobs but the resolution."""
    return any(all(settings.get(knob) == setting for knob, setting in family["settings"].items()) for family in reference.get("families", []))


def convergence(study, tally):
    """Each observable against 1/resolution, by family, with the extrapolation."""
    if study.along is None or not any("families" in r for r in study.data["reference"].values()):
        raise Missing("the reference of this study is no extrapolation")
    figure, grid = plt.subplots(1, len(study.observables), figsize=(PAGE if len(study.observables) > 1 else 1.3 * COLUMN, 8.2 / 2.54), squeeze=False)
    for axes, name in zip(grid[0], study.observables):
        reference = study.data["reference"][name]
        low = high = math.nan
        for point in study.points:
            observed = point["observed"][name]
            value, error = number(observed["value"]), number(observed["error"])
            base = study.is_otherwise_base(point["settings"])
            if not math.isfinite(value) or not (base or in_family(point["settings"], reference)):
                continue
            colour, symbol = study.look(point["settings"])
            axes.errorbar(1 / number_of(point["settings"][study.along]), value, yerr=error if math.isfinite(error) else 0, color=colour, marker=symbol, linestyle="none", elinewidth=0.6,
                          markerfacecolor=colour if base else "white", zorder=3)
            low, high = np.nanmin([low, value]), np.nanmax([high, value])
        for family in reference.get("families", []):
            if not math.isfinite(number(family["limit"])):
                continue
            colour, _ = study.look(family["settings"])
            x = np.linspace(0, 1 / number(family["from_resolution"]), 60)
            axes.plot(x, number(family["limit"]) + number(family["first"]) * x + number(family["second"]) * x * x, color=colour, linewidth=0.7,
                      linestyle="-" if study.is_otherwise_base(family["settings"]) else "--", zorder=2)
        value, error = number(reference["value"]), number(reference["error"])
        if math.isfinite(value):
            axes.axhspan(value - error, value + error, color=GREY, alpha=0.25, linewidth=0)
            axes.axhline(value, color=INK, linewidth=0.7)
            room = 0.08 * (max(high, value) - min(low, value)) or 0.1 * abs(value)
            axes.set_ylim(min(low, value - error) - room, max(high, value + error) + room)
        axes.set(xlim=(0, None), xlabel=f"1/{short(study.along)}", ylabel=name.replace("_", " "))
    figure.legend(handles=study.keys(), loc="outside lower center", ncols=6)
    others = any(not study.is_otherwise_base(family["settings"]) for reference in study.data["reference"].values() for family in reference.get("families", []))
    return Drawn(figure, None, ["Lines: extrapolation of each family; band: their weighted mean and its error." + (" Hollow, dashed: another knob differs from the base scene." if others else "")])


FIGURES = [("front", "Error against cost", front), ("convergence", "Convergence", convergence)]
