#!/usr/bin/env python3
"""Makes docs/accuracy.md from studies: the prose, each study's front, what each knob buys, its extrapolation and its figures.

    python report/accuracy.py RESULTS --docs DOCS

RESULTS holds the studies' directories (capsule, red_cell, phi20, phi45, diffusion, diffusion_wide), as `corpuscle tradeoff scenes/accuracy/NAME_study.toml --output RESULTS/NAME` makes them. Writes DOCS/accuracy.md,
DOCS/accuracy/NAME.json and .md (all points), DOCS/figures/accuracy/NAME_*.png. The prose is accuracy_prose.md, in which {{NAME}} stands for a study.
Needs: pip install numpy matplotlib.
"""
import argparse
import pathlib
import re
import shutil
import sys

import figures_study
from analysis_data import BadAnalysis
from panels import Missing
from style import Tally, plt, use_style

PROSE = pathlib.Path(__file__).with_name("accuracy_prose.md")
SECTIONS = ("The front", "What each knob buys", "Extrapolation")


def sections_of(page):
    """Heading: text of a page that corpuscle tradeoff wrote."""
    parts = re.split(r"^## (.+)$", page, flags=re.MULTILINE)
    return dict(zip(parts[1::2], (text.strip() for text in parts[2::2])))


def without_equal_columns(table):
    """A table of Markdown without the columns that say the same in every row: knobs that the front doesn't vary."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    keep = [i for i in range(len(rows[0])) if len(rows) <= 3 or len({row[i] for row in rows[2:]}) > 1 or not rows[0][i].count(".")]
    return "\n".join("| " + " | ".join(row[i] for i in keep) + " |" for row in rows)


def study_part(folder, docs):
    study = figures_study.Study(folder)
    name = folder.name
    page = (folder / "tradeoff.md").read_text()
    found = sections_of(page)
    head = [line for line in page.split("\n## ")[0].splitlines() if line.startswith("|")]
    lines = ["\n".join(head)]
    for title in SECTIONS:
        if title not in found:
            continue
        text = found[title]
        if title == "The front":
            before, _, table = text.partition("\n\n|")
            text = f"{before}\n\n" + without_equal_columns("|" + table)
        lines.append(f"**{title}.** {text}")
    figures = docs / "figures/accuracy"
    figures.mkdir(parents=True, exist_ok=True)
    for title, caption, draw in figures_study.FIGURES:
        try:
            drawn = draw(study, Tally())
        except Missing:
            continue
        drawn.figure.savefig(figures / f"{name}_{title}.png")
        plt.close("all")
        lines.append(f"![{caption}](figures/accuracy/{name}_{title}.png)\n\n{' '.join(drawn.seen)}")
    (docs / "accuracy").mkdir(exist_ok=True)
    shutil.copy(folder / "tradeoff.json", docs / f"accuracy/{name}.json")
    shutil.copy(folder / "tradeoff.md", docs / f"accuracy/{name}.md")
    runs = len([p for p in study.points if p["state"] == "finished"])
    lines.append(f"{runs} of {len(study.points)} settings have finished; all of them, and why others did not: [accuracy/{name}.md](accuracy/{name}.md). Revision {study.git_revision}, costs for {study.data['machine']}.")
    return "\n\n".join(lines)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("results", type=pathlib.Path)
    options.add_argument("--docs", type=pathlib.Path, required=True)
    options = options.parse_args()
    use_style(130)
    try:
        page = re.sub(r"\{\{(\w+)\}\}", lambda match: study_part(options.results / match[1], options.docs), PROSE.read_text())
    except BadAnalysis as error:
        sys.exit(f"accuracy: {error}")
    (options.docs / "accuracy.md").write_text(page)


if __name__ == "__main__":
    main()
