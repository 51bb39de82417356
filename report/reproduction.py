"""Writes a page that holds the statements of Gross, Krüger & Varnik (EPL 2014) against an analysed sweep: a verdict for each with the numbers, a table of all runs, and the figures.

reproduction.py SWEEP_DIR --document docs/reproduction.md [--prose FILE]: the page, figures beside it in figures/reproduction/, the numbers of all runs in reproduction.csv.
The text between the tables is that of the file given with --prose (sections by their headings); what is measured stands in the tables only.
"""
import argparse
import csv
import pathlib
import sys

from analysis_data import BadAnalysis, Sweep, load
from report import SWEEP_FIGURES, Report
from statements import STATEMENTS, mean_yz, text
from style import use_style

COLUMNS = [
    ("η/η₀", lambda r: r.estimate("relative_viscosity")),
    ("N₁", lambda r: r.estimate("normal_stress_difference_1")),
    ("⟨δu_x²⟩", lambda r: r.estimate("velocity_variance_x")),
    ("⟨δu_y²⟩", lambda r: r.estimate("velocity_variance_y")),
    ("⟨δu_z²⟩", lambda r: r.estimate("velocity_variance_z")),
    ("γ̇τ_v", lambda r: mean_yz(r, "relaxation_time")),
    ("D_y (VACF)", lambda r: r.estimate("diffusivity_vacf_y")),
    ("D_z (VACF)", lambda r: r.estimate("diffusivity_vacf_z")),
    ("l/r", lambda r: r.estimate("gap_size")),
    ("RMS(σ)/⟨σ⟩", lambda r: r.estimate("stress_fluctuation")),
    ("deformation", lambda r: r.estimate("deformation")),
    ("inclination", lambda r: r.estimate("inclination")),
]


def runs_table(sweep):
    lines = ["| φ_eff | Ca (walls) | Ca | cells | strain, of which used | " + " | ".join(name for name, _ in COLUMNS) + " |", "|" + "---|" * (5 + len(COLUMNS))]
    for run in sorted(sweep.runs, key=lambda r: (r.phi, -r.ca)):
        strain = float(run.info.get("strain") or 0)
        used = strain - float(run.settings.get("discarded_strain") or 0)
        lines.append(f"| {run.phi:.3f} | {run.nominal_ca:.3g} | {run.ca:.2g} | {run.info.get('cell_count')} | {strain:.1f}, {used:.1f} | " + " | ".join(text(value(run)) for _, value in COLUMNS) + " |")
    return "\n".join(lines)


def statements_table(sweep):
    lines = ["| the paper | here | verdict |", "|---|---|---|"]
    for statement, rule, judge in STATEMENTS:
        numbers, verdict = judge(sweep)
        lines.append(f"| {statement} | {numbers} | **{verdict}** ({rule}) |")
    return "\n".join(lines)


def write_csv(sweep, path):
    """Every estimate of every run."""
    names = sorted({name for run in sweep.runs for name in run.estimates})
    with open(path, "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["run", "phi_effective", "phi_geometric", "capillary_number", "estimate", "value", "error", "converged"])
        for run in sweep.runs:
            for name in names:
                value = run.estimate(name)
                if value.exists():
                    rows.writerow([run.name, f"{run.phi:.6g}", f"{run.info.get('phi_geometric'):.6g}", f"{run.ca:.6g}", name, f"{value.value:.6g}", f"{value.error:.3g}", int(value.converged)])


def figures(sweep, folder, wanted):
    if not wanted:
        return "Not drawn (--no-figures)."
    folder.mkdir(parents=True, exist_ok=True)
    report = Report(folder, pdf=False)
    lines = []
    for name, title, function in SWEEP_FIGURES:
        entry = report.draw(name, title, lambda tally: function(sweep, tally), f"figure_{name}")
        lines.append(f"### {name}: {title}\n")
        if entry.path is None:
            lines.append(f"Not drawn: {entry.absent}.\n")
            continue
        lines.append(f"![{title}](figures/{folder.name}/{entry.path.name})\n\nPaper: {entry.paper}\n\nHere: {' '.join(list(entry.seen) + list(entry.notes))}\n")
    if report.failures:
        sys.exit(f"{report.failures} figures failed, see above")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of an analysed sweep")
    parser.add_argument("--document", type=pathlib.Path, required=True)
    parser.add_argument("--prose", type=pathlib.Path, default=pathlib.Path(__file__).with_name("reproduction_prose.md"))
    parser.add_argument("--no-figures", action="store_true", help="tables only")
    parser.add_argument("--dpi", type=int, default=150, help="of the figures (default: 150)")
    options = parser.parse_args()
    try:
        sweep = load(options.folder)
    except BadAnalysis as error:
        sys.exit(str(error))
    if not isinstance(sweep, Sweep):
        sys.exit(f"{options.folder} is a single run; statements are held against a sweep.")
    use_style(dpi=options.dpi)
    folder = options.document.parent / "figures" / "reproduction"
    write_csv(sweep, options.document.with_suffix(".csv"))
    parts = {"{{statements}}": statements_table(sweep), "{{runs}}": runs_table(sweep), "{{figures}}": figures(sweep, folder, not options.no_figures), "{{revision}}": ", ".join(sorted({r.git_revision for r in sweep.runs}))}
    page = options.prose.read_text()
    for mark, words in parts.items():
        if mark not in page:
            sys.exit(f"{options.prose} lacks the mark {mark}")
        page = page.replace(mark, words)
    options.document.write_text(page)
    print(f"{options.document} and {folder}")


if __name__ == "__main__":
    main()
