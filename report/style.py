"""How the figures of ./dev report look: sizes, colours, symbols, numbers as text, points and curves with errors.

Sizes are those of a journal: a column of 8.6 cm, a page of 17.8 cm, text of 8 points. Capillary numbers take their colour from viridis by their
logarithm, volume fractions from plasma by their rank, directions from Okabe and Ito's palette; every colour comes with a symbol of its own.
"""
import logging
import math
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    from matplotlib.lines import Line2D
except ImportError as error:
    sys.exit(f"{error}. The report scripts need: pip install numpy h5py matplotlib 'vtk>=9.4'")

COLUMN, PAGE = 8.6 / 2.54, 17.8 / 2.54  # inches
INK, GREY = "#222222", "#777777"
SYMBOLS = "os^DvPX<>*"
COMPONENTS = {"x": ("#D55E00", "s"), "y": ("#0072B2", "o"), "z": ("#009E73", "^")}  # Okabe and Ito
PALE = 0.55  # opacity of what is not converged
PHI_TICKS = [0.1, 0.2, 0.3, 0.5, 0.7, 0.9]


def use_style(dpi=300):
    """Sets matplotlib up; call before anything is drawn. `dpi`: resolution of PNGs."""
    logging.getLogger("fontTools").setLevel(logging.ERROR)  # it remarks on the dates in font files
    plt.rcParams.update({
        "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7, "legend.fontsize": 6.8,
        "legend.frameon": False, "legend.handlelength": 1.6, "legend.columnspacing": 1.0, "legend.handletextpad": 0.5, "lines.linewidth": 1.0,
        "lines.markersize": 4, "errorbar.capsize": 1.5, "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6,
        "xtick.minor.width": 0.4, "ytick.minor.width": 0.4, "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
        "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK, "xtick.color": INK, "ytick.color": INK, "savefig.dpi": dpi,
        "pdf.fonttype": 42, "axes.axisbelow": True, "figure.constrained_layout.use": True, "axes.grid": True, "grid.color": "#E6E6E6", "grid.linewidth": 0.4,
    })


# ---- Numbers as text -------------------------------------------------------------------------------------------------

def number_text(value, digits=2):
    """A number for a legend as mathtext: 0.081, 1.4, $4.2\\times10^{-5}$."""
    if value is None or not math.isfinite(value):
        return "?"
    if value == 0 or 1e-2 <= abs(value) < 1e4:
        return f"{value:.{digits}g}" if abs(value) < 100 else f"{value:.0f}"
    power = math.floor(math.log10(abs(value)))
    mantissa = f"{value / 10 ** power:.{digits}g}"
    if float(mantissa) == 10:
        mantissa, power = "1", power + 1
    return f"${mantissa}\\times10^{{{power}}}$"


def value_text(value, error=math.nan):
    """A value and its error with two digits of the error, in plain Unicode: 4.690 ± 0.046, (1.20 ± 0.15)·10⁻⁵; – for NaN."""
    if value is None or not math.isfinite(value):
        return "–"
    has_error = error is not None and math.isfinite(error) and error > 0
    largest = max(abs(value), error if has_error else 0)
    power = math.floor(math.log10(largest)) if largest > 0 else 0
    shift = power if power < -3 or power > 4 else 0
    scaled = value / 10 ** shift
    if has_error:
        decimals = max(0, 1 - math.floor(math.log10(error / 10 ** shift)))
        if decimals > 12:  # an error that is nothing beside the value
            return f"{value:.6g}"
        text = f"{scaled:.{decimals}f} ± {error / 10 ** shift:.{decimals}f}"
    else:
        text = f"{scaled:.4g}"
    if shift:
        digits = str(shift).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        text = (f"({text})" if has_error else text) + f"·10{digits}"
    return text.replace("-", "−")


def in_words(items):
    """a, b and c."""
    items = list(items)
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1]


# ---- Colours and symbols ---------------------------------------------------------------------------------------------

class Palette:
    """Colour, symbol and legend text of each value of a quantity, "phi" or "ca"."""

    def __init__(self, quantity, values):
        self.quantity = quantity
        self.values = sorted(values)
        positive = [v for v in self.values if v > 0]
        span = math.log(positive[-1] / positive[0]) if len(positive) > 1 else 0
        self._looks = {}
        for i, value in enumerate(self.values):
            if quantity == "ca":
                place = 0.84 * (math.log(value / positive[0]) / span if span > 0 and value > 0 else 0.35)
                colour = matplotlib.colormaps["viridis"](place)
            else:
                place = 0.82 * (i / (len(self.values) - 1) if len(self.values) > 1 else 0.4)
                colour = matplotlib.colormaps["plasma"](place)
            self._looks[value] = (matplotlib.colors.to_hex(colour), SYMBOLS[i % len(SYMBOLS)])

    def look(self, value):
        """(colour, symbol) of a value that the palette was made with."""
        return self._looks[value]

    def text(self, value):
        return f"Ca = {number_text(value)}" if self.quantity == "ca" else f"$\\phi$ = {value:.2f}"

    def keys(self, line=True):
        """Legend entries of all values, the largest first."""
        return [key(*self.look(value), self.text(value), line=line) for value in reversed(self.values)]


def key(colour, symbol, label, line=True, hollow=False, style="-"):
    """One entry of a legend."""
    return Line2D([], [], color=colour, marker=symbol, linestyle=style if line else "none", markerfacecolor="white" if hollow else colour,
                  markeredgecolor=colour, label=label)


def pale_key():
    return Line2D([], [], color=GREY, marker="o", linestyle="none", markerfacecolor="white", markeredgecolor=GREY, alpha=PALE, label="not converged")


# ---- Points and curves -----------------------------------------------------------------------------------------------

class Tally:
    """Counts what a figure shows, so that its caption can say it."""

    def __init__(self):
        self.drawn = self.pale = 0
        self.missing = {}  # reason: names of the runs

    def miss(self, where, reason):
        self.missing.setdefault(reason or "the analysis gives no reason", []).append(where)

    def sentences(self):
        """What the caption says of points that are not converged or not there."""
        found = []
        if self.pale:
            found.append(f"Pale and hollow: not converged ({self.pale} of {self.drawn}).")
        for reason, places in self.missing.items():
            shown = in_words(dict.fromkeys(places)) if len(set(places)) <= 4 else f"{len(set(places))} runs ({places[0]}, …)"
            found.append(f"Not shown: {shown}: {reason.rstrip('.')}.")
        return found


def draw_points(axes, points, look, tally, line=True, hollow=False):
    """Points (x, Value, name) with error bars in one colour and symbol. Those that are not converged are pale and hollow; NaN, and on a logarithmic
    axis what is not positive, is left out and told to the tally. `hollow`: the series as such is drawn with open symbols."""
    colour, symbol = look
    logarithmic = axes.get_yscale() == "log"
    good = []
    for x, value, name in points:
        if not (math.isfinite(value.value) and math.isfinite(x)):
            tally.miss(name, value.reason)
        elif logarithmic and value.value <= 0:
            tally.miss(name, "not positive, so not on a logarithmic axis")
        else:
            good.append((x, value))
    good.sort(key=lambda point: point[0])
    if line and len(good) > 1:
        axes.plot([x for x, _ in good], [v.value for _, v in good], color=colour, linewidth=0.6, alpha=0.4, zorder=2)
    for converged in (True, False):
        some = [(x, v) for x, v in good if v.converged == converged]
        if not some:
            continue
        height = np.array([v.value for _, v in some])
        error = np.nan_to_num([v.error for _, v in some])
        below = np.minimum(error, 0.9 * height) if logarithmic else error
        axes.errorbar([x for x, _ in some], height, yerr=[below, error], color=colour, marker=symbol, markerfacecolor=colour if converged and not hollow else "white",
                      markeredgecolor=colour, markeredgewidth=0.8, alpha=1.0 if converged else PALE, linestyle="none", elinewidth=0.7, zorder=3)
        tally.drawn += len(some)
        tally.pale += 0 if converged else len(some)
    return len(good)


def spread_indices(x, count, logarithmic):
    """Indices of about `count` points, evenly spread over the axis."""
    if len(x) <= count:
        return np.arange(len(x))
    scale = np.log(x) if logarithmic else x
    wanted = np.linspace(scale[0], scale[-1], count)
    return np.unique([np.abs(scale - w).argmin() for w in wanted])


def draw_curve(axes, curve, look, tally, name, transform=None, label=None, symbols=14, line=True, until=math.inf):
    """A Curve as a line with its error as a band and some symbols with error bars; pale beyond `trusted_until`, hollow and dashed where not converged.
    `transform` maps (x, value, error) to what is drawn; symbols are spread up to `until`. Returns the drawn arrays, or None."""
    if not curve.exists():
        tally.miss(name, curve.reason)
        return None
    x, value, error = curve.x, curve.value, np.nan_to_num(curve.error)
    if transform:
        x, value, error = transform(x, value, error)
    keep = np.isfinite(x) & np.isfinite(value)
    if axes.get_xscale() == "log":
        keep &= x > 0
    if axes.get_yscale() == "log":
        keep &= value > 0
    trusted = (curve.x <= curve.trusted_until)[keep]
    x, value, error = x[keep], value[keep], error[keep]
    if not len(x):
        tally.miss(name, "no point that could be drawn on these axes")
        return None
    colour, symbol = look
    low = np.maximum(value - error, 0.1 * value) if axes.get_yscale() == "log" else value - error
    face = colour if curve.converged else "white"
    if line:
        axes.plot(x[trusted], value[trusted], color=colour, linewidth=0.8, linestyle="-" if curve.converged else "--",
                  alpha=1 if curve.converged else PALE, zorder=2)
        last = max(np.count_nonzero(trusted) - 1, 0)
        axes.plot(x[last:], value[last:], color=colour, linewidth=0.8, linestyle=":", alpha=PALE, zorder=2)
        axes.fill_between(x, low, value + error, color=colour, alpha=0.18, linewidth=0, zorder=1)
    shown = np.flatnonzero(trusted & (x <= until)) if (trusted & (x <= until)).any() else np.arange(len(x))
    shown = shown[spread_indices(x[shown], symbols, axes.get_xscale() == "log")]
    axes.errorbar(x[shown], value[shown], yerr=[(value - low)[shown], error[shown]], color=colour, marker=symbol, markerfacecolor=face, markeredgecolor=colour,
                  markeredgewidth=0.7, markersize=3.2, linestyle="none", elinewidth=0.6, alpha=1 if curve.converged else PALE, label=label, zorder=3)
    tally.drawn += 1
    tally.pale += not curve.converged
    return x, value, error


def phi_axis(axes, label=r"volume fraction $\phi$"):
    """A logarithmic axis of volume fractions with plain numbers."""
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    ticks = [t for t in PHI_TICKS if low <= t <= high]
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_xlabel(label)


def log_ticks(axis):
    """Plain numbers on a logarithmic axis that spans less than two decades, so that it has more than one number on it."""
    low, high = sorted(axis.get_view_interval())
    if not (0 < low < high) or high / low > 60:
        return
    steps = (1, 1.5, 2, 3, 4, 5, 6, 8) if high / low < 4 else (1, 2, 3, 5, 7) if high / low < 8 else (1, 2, 5)
    ticks = [s * 10.0 ** p for p in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1) for s in steps]
    ticks = [t for t in ticks if low <= t <= high]
    if len(ticks) < 2:
        axis.set_major_locator(matplotlib.ticker.MaxNLocator(4))
        axis.set_major_formatter(matplotlib.ticker.ScalarFormatter())
    else:
        axis.set_major_locator(matplotlib.ticker.FixedLocator(ticks))
        axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda t, _: f"{t:g}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())
