#!/usr/bin/env python3
"""The page of a run or of a sweep: DIR/report/index.html with the figures of Gross, Krüger & Varnik (EPL 2014), PNG and PDF beside it (docs/report.md).

    python report/report.py DIR [--run NAME ...] [--frames N] [--no-pictures] [--program CORPUSCLE | --no-analyse]

DIR is the output folder of `corpuscle run` or `corpuscle sweep`. Where analysis.json is missing or older than a run, PROGRAM analyses first.
Needs: pip install numpy h5py matplotlib 'vtk>=9.4' (pillow comes with matplotlib).
"""
import argparse
import pathlib
import subprocess
import sys
import traceback

import figures_dynamics
import figures_rheology
import figures_run
import figures_study
import figures_velocity
from analysis_data import BadAnalysis, Run, load, read_json
from page import Entry, estimates_table, fits_table, run_facts, runs_table, warnings_list, write_page
from panels import Missing
from run_data import RunData
from style import Tally, plt, use_style

SWEEP_FIGURES = figures_rheology.FIGURES + figures_velocity.FIGURES + figures_dynamics.FIGURES + figures_rheology.STRESS_FIGURES
NEEDS_ANALYSIS = 3  # exit code of --check


def runs_of(folder):
    """Folders of the runs of a sweep that hold a run.h5; the folder itself when it is a run."""
    if (folder / "run.h5").exists():
        return [folder]
    if not (folder / "sweep.json").exists():
        return []
    sweep = read_json(folder / "sweep.json")
    entries = sweep.get("runs") if isinstance(sweep, dict) else None
    if not isinstance(entries, list):
        raise BadAnalysis(f"{folder / 'sweep.json'} lists no runs. It should be the output folder of `corpuscle sweep`.")
    places = [folder / str(entry.get("directory") or entry.get("name")) for entry in entries]
    return [place for place in places if (place / "run.h5").exists()]


def check_folder(folder):
    if not folder.is_dir():
        raise BadAnalysis(f"{folder} is no folder. Give the output folder of `corpuscle run` or `corpuscle sweep`.")
    if not any((folder / name).exists() for name in ("run.h5", "sweep.json", "analysis.json")):
        raise BadAnalysis(f"{folder} holds no run.h5, sweep.json or analysis.json. Give the output folder of `corpuscle run` or `corpuscle sweep`.")


def why_analyse(folder):
    """Why `corpuscle analyse` has to run first; empty when it need not."""
    runs = runs_of(folder)
    result = folder / "analysis.json"
    if not result.exists():
        if not runs:
            raise BadAnalysis(f"No run of {folder} has written anything yet. Start them with `corpuscle sweep`.")
        return f"{result} does not exist"
    for run in runs:
        written = (run / "run.h5").stat().st_mtime
        own = run / "analysis.json"
        for analysis in (own, result):
            if not analysis.exists() or analysis.stat().st_mtime < written:
                return f"{analysis} is older than {run / 'run.h5'}" if analysis.exists() else f"{analysis} does not exist"
    return ""


def analyse(folder, program, reason):
    """Lets the program analyse; BadAnalysis with its last words when nothing came of it."""
    print(f"analysing first: {reason}", file=sys.stderr)
    before = (folder / "analysis.json").stat().st_mtime_ns if (folder / "analysis.json").exists() else 0
    try:
        done = subprocess.run([program, "analyse", str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    except OSError as error:
        raise BadAnalysis(f"{program} cannot be started ({error.strerror}). Build it with `./dev build`, or draw what is there with --no-analyse.") from None
    after = (folder / "analysis.json").stat().st_mtime_ns if (folder / "analysis.json").exists() else 0
    if done.returncode == 0 and after > 0:
        return
    words = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
    if after > before:  # a sweep of which some runs could not be analysed
        print(f"`corpuscle analyse` ended with {done.returncode}: {words}", file=sys.stderr)
    else:
        raise BadAnalysis(f"`corpuscle analyse {folder}` ended with {done.returncode} and wrote no analysis.json: {words}")


class Report:
    """Draws figures into a folder and keeps what the page needs; a figure that fails leaves its reason and does not stop the others."""

    def __init__(self, output, pdf=True):
        self.output, self.pdf, self.failures = output, pdf, 0

    def draw(self, name, title, function, stem):
        """One figure: `function(tally)` returns a Drawn. Writes STEM.png and, if wanted, STEM.pdf."""
        path = self.output / f"{stem}.png"
        tally = Tally()
        try:
            drawn = function(tally)
            drawn.figure.savefig(path)
            if self.pdf:
                drawn.figure.set_layout_engine("none")  # it is laid out: the same in both files
                drawn.figure.savefig(path.with_suffix(".pdf"))
            else:
                path.with_suffix(".pdf").unlink(missing_ok=True)  # of an earlier report
            return Entry(name, title, path, drawn.paper, drawn.seen, tally.sentences())
        except Missing as missing:
            reason = str(missing)
        except Exception as error:  # a mistake of ours: the page still has the others, the exit code tells
            traceback.print_exc()
            self.failures += 1
            reason = f"drawing it failed ({type(error).__name__}: {error})"
        finally:
            plt.close("all")
        for old in (path, path.with_suffix(".pdf")):  # of an earlier report
            old.unlink(missing_ok=True)
        return Entry(name, title, absent=reason)

    def pictures(self, folder, prefix, frames, wanted):
        """Entries of figure 1a, of the strip and of the animation of a run."""
        names = [("1a", "Snapshot of the cells", "figure_1a.png"), ("strip", "The run in time", "snapshots.png"), ("motion", "The run in motion", "motion.gif")]
        reason = None
        for _, _, file in names:
            for old in (self.output / (prefix + file), (self.output / (prefix + file)).with_suffix(".pdf")):
                old.unlink(missing_ok=True)
        if not wanted:
            reason = "switched off by --no-pictures"
        elif folder is None or not (folder / "cells.vtkhdf").exists():
            reason = f"{folder}/cells.vtkhdf is not there; it is written with output.snapshot_every > 0"
        else:
            command = [sys.executable, str(pathlib.Path(__file__).with_name("snapshots.py")), str(folder), str(self.output), "--prefix", prefix, "--frames", str(frames)]
            done = subprocess.run(command, capture_output=True, text=True, errors="replace")
            if done.returncode != 0:
                words = (done.stderr.strip().splitlines() or ["no message"])[-1]
                reason = f"the renderer ended with {done.returncode}: {words}"
                print(f"no pictures of {folder}: {reason}", file=sys.stderr)
        captions = {"1a": ("A snapshot of the dense suspension.", ["The last snapshot, coloured by the velocity along the flow."]),
                    "strip": (None, ["Snapshots from the first to the last; a colour marks a cell. Cells that leave the box come in at the other side."]),
                    "motion": (None, ["Snapshots evenly spread over the whole run; a colour marks a cell."])}
        entries = []
        for name, title, file in names:
            path = self.output / (prefix + file)
            if path.exists():
                entries.append(Entry(name, title, path, *captions[name]))
            else:
                entries.append(Entry(name, title, absent=reason or "the run has too few snapshots"))
        return entries

    def run_part(self, run, prefix):
        """Entries and tables of a single run."""
        parts = [run_facts(run), warnings_list(run.warnings)]
        data = RunData(run.folder) if run.folder and (run.folder / "run.h5").exists() else None

        def series(tally):
            if data is None:
                raise Missing(f"{run.folder}/run.h5 is not there")
            return figures_run.series(run, data, tally)

        parts.append(self.draw("series", "Series", series, f"{prefix}series"))
        for name, title, function in figures_run.FIGURES:
            parts.append(self.draw(name, title, lambda tally, f=function: f(run, tally), f"{prefix}{name}"))
        parts += ["<h3>Estimates</h3>", estimates_table(run), "<h3>Fits</h3>", fits_table(run)]
        return parts


def chosen_runs(sweep, names):
    """Runs of a sweep that get a part of their own: those named, "all", or the densest at the largest Ca, one with snapshots first."""
    every = sweep.runs + sweep.outside
    if names == ["all"]:
        return every
    if names:
        known = {run.name: run for run in every}
        for name in names:
            if name not in known:
                raise BadAnalysis(f"--run {name}: the sweep has no analysed run of that name; there are: {', '.join(sorted(known))}, and `all`.")
        return [known[name] for name in names]
    return [max(every, key=lambda r: ((r.folder / "cells.vtkhdf").exists(), r in sweep.runs, r.phi if r.phi == r.phi else 0, r.ca if r.ca == r.ca else 0))]


def report_run(run, report, arguments):
    pictures = report.pictures(run.folder, "", arguments.frames, not arguments.no_pictures)
    return [("The run", pictures + report.run_part(run, ""))]


def report_sweep(sweep, report, arguments):
    chosen = chosen_runs(sweep, arguments.run)
    details, first = [], None
    for i, run in enumerate(chosen):
        prefix = "" if i == 0 else run.name.replace("/", "_") + "_"
        pictures = report.pictures(run.folder, prefix, arguments.frames, not arguments.no_pictures)
        first = first or pictures[0]
        details.append((f"Run {run.name}", (pictures[1:] if i == 0 else pictures) + report.run_part(run, prefix)))
    figures = [first]
    if sweep.runs:
        figures += [report.draw(name, title, lambda tally, f=function: f(sweep, tally), f"figure_{name}") for name, title, function in SWEEP_FIGURES]
    else:
        figures.append("<p>No run has both a volume fraction and a capillary number: there is nothing to draw against these.</p>")
    runs = [warnings_list(sweep.warnings), runs_table(sweep.runs + sweep.outside)]
    return [("Figures of Gross, Krüger & Varnik (EPL 2014)", figures), ("All runs", runs)] + details


def arguments_of(argv):
    parser = argparse.ArgumentParser(prog="report", description="Writes DIR/report/index.html with all figures of a run or of a sweep.")
    parser.add_argument("folder", metavar="DIR", help="output folder of `corpuscle run`, `corpuscle sweep` or `corpuscle tradeoff`")
    parser.add_argument("--run", action="append", default=[], metavar="NAME", help="run of a sweep to show in detail, or `all`; may be repeated (default: the densest)")
    parser.add_argument("--frames", type=int, default=24, metavar="N", help="most pictures of the animation; 0: none (default: 24)")
    parser.add_argument("--no-pictures", action="store_true", help="render no cells (which takes some seconds for each picture)")
    parser.add_argument("--no-pdf", action="store_true", help="write no PDFs, which takes half of the time")
    parser.add_argument("--dpi", type=int, default=300, metavar="N", help="resolution of the PNGs in dots per inch (default: 300)")
    parser.add_argument("--program", metavar="PATH", default="corpuscle", help="the corpuscle that analyses (default: the one in PATH)")
    parser.add_argument("--no-analyse", action="store_true", help="draw analysis.json as it is, even when a run is newer")
    parser.add_argument("--check", action="store_true", help=f"only tell whether `corpuscle analyse` has to run first: exit code {NEEDS_ANALYSIS} if so, else 0")
    return parser.parse_args(argv)


def write_study(folder, arguments):
    """The page of a study of error against cost: its own results are all that it needs."""
    if arguments.check:
        return 0
    study = figures_study.Study(folder)
    output = folder / "report"
    output.mkdir(exist_ok=True)
    report = Report(output, not arguments.no_pdf)
    use_style(arguments.dpi)
    figures = [report.draw(name, title, lambda tally, f=function: f(study, tally), name) for name, title, function in figures_study.FIGURES]
    subtitle = f"study of {len(study.points)} settings, corpuscle {study.version} ({study.git_revision}). All numbers: tradeoff.md, tradeoff.csv."
    write_page(output / "index.html", folder.resolve().name, subtitle, [("Error against cost", figures), ("Warnings", [warnings_list(study.warnings)])])
    print(output / "index.html")
    return 1 if report.failures else 0


def write_report(arguments):
    folder = pathlib.Path(arguments.folder)
    if (folder / "tradeoff.json").exists():
        return write_study(folder, arguments)
    check_folder(folder)
    reason = "" if arguments.no_analyse else why_analyse(folder)
    if arguments.check:
        return NEEDS_ANALYSIS if reason else 0
    if reason:
        analyse(folder, arguments.program, reason)
    data = load(folder)
    if isinstance(data, Run) and arguments.run:
        raise BadAnalysis(f"--run {arguments.run[0]}: {folder} is a single run, not a sweep. Leave --run out.")
    output = folder / "report"
    output.mkdir(exist_ok=True)
    report = Report(output, not arguments.no_pdf)
    use_style(arguments.dpi)
    sections = (report_run if isinstance(data, Run) else report_sweep)(data, report, arguments)
    sample = data if isinstance(data, Run) else (data.runs + data.outside)[0]
    kind = "run" if isinstance(data, Run) else f"sweep of {len(data.runs) + len(data.outside)} analysed runs"
    subtitle = f"{kind}, corpuscle {sample.version} ({sample.git_revision}). Lengths in radii r, times in strains, stresses in η₀γ̇. Errors are standard errors."
    write_page(output / "index.html", folder.resolve().name, subtitle, sections)
    print(output / "index.html")
    return 1 if report.failures else 0


def main():
    try:
        sys.exit(write_report(arguments_of(sys.argv[1:])))
    except BadAnalysis as error:
        sys.exit(f"report: {error}")
    except OSError as error:
        sys.exit(f"report: {error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
