"""The HTML page of ./dev report: figures with captions, tables of estimates and runs. One file, images as data URIs, no script, nothing from elsewhere."""
import base64
import html
import math

from style import value_text

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 0 auto; padding: 1.5rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ccc; } h3 { margin-top: 2rem; }
nav { line-height: 1.9; } nav a { margin-right: .9em; white-space: nowrap; } a { color: #0072B2; }
figure { margin: 1.8rem 0; } figure img { max-width: 100%; height: auto; } figcaption { font-size: .92rem; max-width: 52rem; } figcaption p { margin: .3em 0; }
figcaption .title { font-weight: 600; } .absent { border-left: 4px solid #D55E00; padding: .4em .8em; background: #fdf3ec; }
.quiet { color: #666; } .doubt { color: #A04000; } table { border-collapse: collapse; font-size: .86rem; } .wide { overflow-x: auto; }
th, td { text-align: left; padding: .2em .7em; border-bottom: 1px solid #e2e2e2; vertical-align: top; } td.number { white-space: nowrap; font-variant-numeric: tabular-nums; }
@media print { nav { display: none; } figure { break-inside: avoid; } body { max-width: none; } }
"""


def text(value):
    return html.escape(str(value))


def data_uri(path):
    kind = {".png": "image/png", ".gif": "image/gif"}[path.suffix]
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode('ascii')}"


class Entry:
    """A figure of the page: drawn (path of the image), or absent with the reason."""

    def __init__(self, name, title, path=None, paper=None, seen=(), notes=(), absent=None):
        self.name, self.title, self.path, self.paper, self.seen, self.notes, self.absent = name, title, path, paper, list(seen), list(notes), absent

    def identity(self):
        return self.path.stem if self.path else f"absent_{self.name}"

    def html(self):
        number = f"Figure {self.name.split('_')[0]}: " if self.name[0].isdigit() else ""
        title = f'<p class="title">{text(number + self.title)}</p>'
        if self.absent:
            return f'<figure id="{text(self.identity())}"><figcaption class="absent">{title}<p>Not drawn: {text(self.absent)}</p></figcaption></figure>'
        parts = [title]
        if self.paper:
            parts.append(f"<p><b>Paper:</b> {text(self.paper)}</p>")
        if self.seen:
            parts.append(f"<p><b>Here:</b> {text(' '.join(self.seen))}</p>")
        if self.notes:
            parts.append(f'<p class="doubt">{text(" ".join(self.notes))}</p>')
        pdf = self.path.with_suffix(".pdf")
        if pdf.exists():
            parts.append(f'<p class="quiet">For print: <code>{text(pdf.name)}</code> beside this page.</p>')
        return (f'<figure id="{text(self.identity())}"><img alt="{text(number + self.title)}" src="{data_uri(self.path)}">'
                f"<figcaption>{''.join(parts)}</figcaption></figure>")


def verdict(value):
    """Cell of a table that says whether a Value can be trusted."""
    if value.converged:
        return "<td>yes</td>"
    return f'<td class="doubt">{"not converged" if value.exists() else "not known"}: {text(value.reason or "no reason given")}</td>'


def plain(value, digits=3):
    return f"{value:.{digits}g}" if math.isfinite(value) else "–"


def estimates_table(run):
    """All estimates of a run."""
    rows = []
    for name, value in run.estimates.items():
        unit = "" if value.unit in ("", "1") else f" {text(value.unit)}"
        rows.append(f'<tr><td title="{text(name)}"><code>{text(name)}</code><br><span class="quiet">{text(value.description)}</span></td>'
                    f'<td class="number">{text(value_text(value.value, value.error))}{unit}</td><td class="number">{plain(value.correlation_time)}</td>'
                    f'<td class="number">{plain(value.effective_samples)}</td>{verdict(value)}</tr>')
    head = "<tr><th>estimate</th><th>value ± standard error</th><th>correlation time (strain)</th><th>effective samples</th><th>converged</th></tr>"
    return f'<div class="wide"><table>{head}{"".join(rows)}</table></div>'


def fits_table(run):
    rows = []
    for name, fit in run.fits.items():
        numbers = ", ".join(f"{p} = {value_text(v.value, v.error)}" for p, v in fit.parameters.items() if v.exists())
        state = "<td>yes</td>" if fit.converged else f'<td class="doubt">{"not converged" if fit.exists() else "not known"}: {text(fit.reason or "no reason given")}</td>'
        rows.append(f'<tr><td><code>{text(name)}</code><br><span class="quiet">{text(fit.model)}</span></td><td>{text(numbers or "–")}</td>{state}</tr>')
    return f'<div class="wide"><table><tr><th>fit</th><th>parameters</th><th>converged</th></tr>{"".join(rows)}</table></div>'


COLUMNS = [("relative_viscosity", "η/η₀"), ("velocity_variance_y", "⟨δu_y²⟩/(γ̇r)²"), ("velocity_variance_z", "⟨δu_z²⟩/(γ̇r)²"), ("gap_size", "l/r"),
           ("diffusivity_msd_y", "D_y/(γ̇r²)"), ("diffusivity_msd_z", "D_z/(γ̇r²)"), ("stress_relaxation_time", "τ_σγ̇"), ("deformation", "D")]


def runs_table(runs):
    """The main numbers of every run; a dagger marks what is not converged, with the reasons below."""
    rows, reasons = [], {}
    for run in runs:
        cells = []
        for name, _ in COLUMNS:
            value = run.estimate(name)
            doubtful = not value.converged
            if doubtful:
                reasons.setdefault(value.reason or "no reason given", []).append(f"{run.name} {name}")
            cells.append(f'<td class="number{" doubt" if doubtful else ""}">{text(value_text(value.value, value.error))}{" †" if doubtful else ""}</td>')
        strain = run.info.get("strain")
        rows.append(f'<tr><td>{text(run.name)}</td><td class="number">{plain(run.phi)}</td><td class="number">{plain(run.ca)}</td>'
                    f'<td class="number">{"–" if strain is None else plain(float(strain))}</td>{"".join(cells)}</tr>')
    head = "<tr><th>run</th><th>φ</th><th>Ca</th><th>strain</th>" + "".join(f"<th>{text(label)}</th>" for _, label in COLUMNS) + "</tr>"
    table = f'<div class="wide"><table>{head}{"".join(rows)}</table></div>'
    if reasons:
        items = "".join(f"<li>{text(reason)}: {text(', '.join(places))}</li>" for reason, places in reasons.items())
        table += f'<details><summary class="doubt">† not converged, or not known: why</summary><ul>{items}</ul></details>'
    return table


def warnings_list(warnings):
    return f'<ul class="doubt">{"".join(f"<li>{text(w)}</li>" for w in warnings)}</ul>' if warnings else ""


def run_facts(run):
    """A line with what the run was and what of it was analysed."""
    info, settings = run.info, run.settings
    facts = [f"φ = {plain(run.phi)} (effective)", f"Ca = {plain(run.ca)}"]
    for key, label in (("phi_geometric", "φ of the meshes"), ("cell_count", "cells"), ("radius", "radius in lattice units"), ("strain", "strain"), ("samples", "samples")):
        if isinstance(info.get(key), (int, float)):
            facts.append(f"{label} {info[key]:.6g}")
    for key, label in (("discarded_strain", "discarded strain"), ("wall_layer", "wall layer in radii"), ("mean_flow", "mean flow"), ("longest_lag", "longest lag in strains")):
        if settings.get(key) is not None:
            facts.append(f"{label} {settings[key]:.4g}" if isinstance(settings[key], (int, float)) else f"{label} {settings[key]}")
    return f"<p>{text('; '.join(facts))}.</p>"


def write_page(path, title, subtitle, sections):
    """Writes the page. `sections`: (heading, list of Entry or HTML text)."""
    links, body = [], []
    for i, (heading, parts) in enumerate(sections):
        body.append(f'<h2 id="section{i}">{text(heading)}</h2>')
        links.append(f'<br><a href="#section{i}"><b>{text(heading)}</b></a>')
        for part in parts:
            if isinstance(part, Entry):
                body.append(part.html())
                short = part.name.replace("_", " ") if part.name[0].isdigit() else part.title
                links.append(f'<a href="#{text(part.identity())}">{text(short)}{" (not drawn)" if part.absent else ""}</a>')
            else:
                body.append(part)
    page = (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{text(title)}</title>'
            f"<style>{STYLE}</style></head><body><h1>{text(title)}</h1><p class=\"quiet\">{text(subtitle)}</p><nav>{''.join(links)}</nav>\n"
            + "\n".join(body) + "\n</body></html>\n")
    unfinished = path.with_suffix(".tmp")
    unfinished.write_text(page, encoding="utf-8")
    unfinished.replace(path)
