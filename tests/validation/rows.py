"""A row of the validation table, the printed table and its Markdown form."""

import math
from dataclasses import dataclass


@dataclass
class Row:
    """One number of ours beside one that is not ours.

    `tolerance` is relative to the reference, `reason` says from which error analysis it comes. `test` is "equal"
    (|ours/reference - 1| <= tolerance), "below" or "above" (the reference is a bound, give or take the tolerance).
    """

    case: str
    quantity: str
    ours: float
    reference: float
    source: str
    tolerance: float = 0.0
    reason: str = ""
    error: float = math.nan  # statistical and extrapolation error of ours
    settings: str = ""
    seconds: float = 0.0  # core seconds of the simulations behind it
    test: str = "equal"
    note: str = ""

    @property
    def relative_error(self):
        return self.ours / self.reference - 1 if self.reference else math.nan

    @property
    def passed(self):
        if not math.isfinite(self.ours):
            return False
        if self.test == "below":
            return self.ours <= self.reference * (1 + self.tolerance)
        if self.test == "above":
            return self.ours >= self.reference * (1 - self.tolerance)
        return abs(self.relative_error) <= self.tolerance


def _number(value):
    return "" if value is None or math.isnan(value) else f"{value:.4g}"


def _ours(row):
    return _number(row.ours) + (f" ± {row.error:.1g}" if math.isfinite(row.error) else "")


def _reference(row):
    return {"equal": "", "below": "≤ ", "above": "≥ "}[row.test] + _number(row.reference)


def _error(row):
    return f"{100 * row.relative_error:+.1f} %" if row.test == "equal" else ""


def _tolerance(row):
    return f"{100 * row.tolerance:.2g} %" if row.tolerance else "bound"


def print_table(rows):
    head = ("case", "quantity", "ours", "reference", "error", "tolerance", "", "source")
    lines = [(r.case, r.quantity, _ours(r), _reference(r), _error(r), _tolerance(r), "pass" if r.passed else "FAIL", r.source) for r in rows]
    widths = [max(len(line[i]) for line in [head] + lines) for i in range(len(head))]
    for line in [head] + lines:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths)).rstrip())


def markdown_table(rows):
    """Rows of one case; what all of them share (source, settings, reason) stands once, below."""
    out = ["| quantity | ours | reference | error | tolerance | | resolution, settings | core s |", "|---|---|---|---|---|---|---|---|"]
    for r in rows:
        cells = (r.quantity, _ours(r), _reference(r), _error(r), _tolerance(r), "pass" if r.passed else "**fail**", r.settings, f"{r.seconds:.0f}")
        out.append("| " + " | ".join(cells) + " |")
    for title, texts in (("References", [r.source for r in rows]), ("Tolerances", [r.reason for r in rows]), ("Notes", [r.note for r in rows])):
        unique = [text for text in dict.fromkeys(texts) if text]
        if unique:
            out += ["", f"{title}: " + "; ".join(unique) + "."]
    return "\n".join(out)
