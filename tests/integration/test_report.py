"""report/report.py on a made-up sweep: all figures, one page without anything from elsewhere, what is missing or not converged is said: PROGRAM SOURCE-FOLDER."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from expectations import expect, finish
from synthetic_analysis import run_analysis, write, write_sweep

SOURCE = pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "report"))
from analysis_data import BadAnalysis, load  # noqa: E402
from report import SWEEP_FIGURES, Report, arguments_of, write_report  # noqa: E402
from style import use_style  # noqa: E402

RUN_FIGURES = ("series", "profiles", "velocities", "correlations", "displacements", "stress", "structure")


def report(folder, *options):
    return subprocess.run([sys.executable, str(SOURCE / "report/report.py"), str(folder), "--dpi", "60", *options], capture_output=True, text=True)


def refused(folder, words, *options):
    """The report refuses, in a sentence that holds `words`."""
    try:
        write_report(arguments_of([str(folder), *options]))
        expect(False, f"{folder} is refused")
    except BadAnalysis as error:
        expect(words in str(error), f"{folder}: {words}: {error}")


def needs_analysis(folder, *options):
    return write_report(arguments_of([str(folder), "--check", *options])) == 3


def check_sweep(folder):
    """The whole of a complete sweep."""
    done = report(folder, "--no-pdf", "--no-pictures", "--run", "phi0.9-Ca0.00028")
    expect(done.returncode == 0, f"the report ends with {done.returncode}: {done.stderr}")
    page = (folder / "report/index.html").read_text()
    for stem in [f"figure_{name}" for name, *_ in SWEEP_FIGURES] + list(RUN_FIGURES):
        image = folder / f"report/{stem}.png"
        expect(image.exists() and image.stat().st_size > 3000, f"{stem}.png is drawn")
        expect(f'id="{stem}"' in page, f"{stem} is in the page")
    expect(page.count('src="data:image/png;base64,') == len(SWEEP_FIGURES) + len(RUN_FIGURES), "every figure is embedded")
    expect(not re.search(r'(src|href)="(?!data:|#)', page) and "<script" not in page and "http" not in re.sub(r"base64,[^\"]*", "", page), "nothing comes from elsewhere")
    expect("switched off by --no-pictures" in page, "pictures that are left out are told")
    expect("not converged: the steady part is only 12 correlation times long" in page, "the table says what is not converged and why")
    expect("Pale and hollow: not converged (1 of 28)." in page, "the caption of the viscosity counts what is not converged")
    expect("7 runs (phi0.12-Ca0.00028, …): the bracket of the balance is not positive" in page, "gaps that don't exist are told")
    numbers = json.loads((folder / "phi0.9-Ca0.00028/analysis.json").read_text())["estimates"]["relative_viscosity"]
    expect(f"{numbers['value']:.1f} ± {numbers['error']:.1f}" in page, "value and error of the viscosity are in the page")


def check_run(folder):
    """A single run with PDFs, a broken file of snapshots and no stress curves."""
    analysis = json.loads((folder / "analysis.json").read_text())
    for name in ("stress_autocorrelation", "stresslet_autocorrelation", "pdf_stresslet"):
        analysis["curves"][name] = {"x": [], "value": [], "error": [], "converged": False, "reason": "no stresslets were written"}
    write(folder / "analysis.json", analysis)
    (folder / "cells.vtkhdf").write_text("no HDF5 file")
    done = report(folder)
    expect(done.returncode == 0 and "no pictures of" in done.stderr, f"a report without pictures: {done.returncode}, {done.stderr}")
    page = (folder / "report/index.html").read_text()
    for stem in RUN_FIGURES:
        drawn = [(folder / f"report/{stem}.{kind}").exists() for kind in ("png", "pdf")]
        expect(drawn == [stem != "stress"] * 2, f"{stem}: png and pdf {drawn}")
    expect("no stresslets were written" in page and "the renderer ended with" in page, "what is not drawn is said with its reason")
    for name in analysis["estimates"]:
        expect(f"<code>{name}</code>" in page, f"{name} is in the table of estimates")
    expect(not list((folder / "report").glob("*.tmp")), "no unfinished page is left")


def check_missing(folder):
    """Curves and fits that runs lack: the others are drawn, the captions tell."""
    place = folder / "phi0.45-Ca0.081"
    analysis = json.loads((place / "analysis.json").read_text())
    del analysis["curves"]["vacf_y"], analysis["fits"]["vacf_y_stretched_exponential"]
    analysis["estimates"]["relative_viscosity"] = {"value": None, "error": None, "converged": False, "reason": "no stresslets were written"}
    write(place / "analysis.json", analysis)
    (folder / "phi0.24-Ca0.081/analysis.json").write_text("{ half a file")
    sweep = load(folder)
    for run in sweep.runs:
        run.curves = {name: curve for name, curve in run.curves.items() if not name.startswith("msd_y") and not name.startswith("msd_z")}
    expect(any("cannot be read" in w and "phi0.24" in w for w in sweep.warnings), "a run whose analysis cannot be read is told")
    (folder / "some").mkdir()
    use_style(60)
    some = Report(folder / "some", pdf=False)
    entries = {name: some.draw(name, title, lambda tally, f=function: f(sweep, tally), f"figure_{name}")
               for name, title, function in SWEEP_FIGURES if name in ("1b", "4a", "4c", "5a")}
    expect(some.failures == 0, "nothing fails")
    expect(entries["5a"].absent and "not in the analysis" in entries["5a"].absent and not (folder / "some/figure_5a.png").exists(), "a figure without curves says so")
    for name, words in (("1b", "Not shown: phi0.45-Ca0.081: no stresslets were written."), ("4a", "phi0.45-Ca0.081"), ("4a", "its own analysis.json cannot be read"),
                        ("4c", "vacf_y_stretched_exponential is not in the analysis")):
        expect((folder / f"some/figure_{name}.png").exists() and any(words in note for note in entries[name].notes), f"{name}: {words}: {entries[name].notes}")


def check_analysis_first(folder):
    """Which states of a folder ask for `corpuscle analyse`, and that it is asked."""
    program = folder / "program"
    source = folder / "analysis.json"
    program.write_text(f'#!/bin/sh\ncp "{source}" "$2/analysis.json" && echo "$@" >> "{folder}/asked"\n')
    program.chmod(0o755)
    write(source, run_analysis(0.45, 0.028, 3) | {"curves": {}})
    run = folder / "run"
    run.mkdir()
    (run / "run.h5").write_bytes(b"")
    expect(needs_analysis(run), "a run without analysis needs one")
    refused(run, "cannot be started", "--program", str(folder / "nothing"))
    broken = folder / "broken"
    broken.write_text("#!/bin/sh\necho 'run.h5 holds no sample' >&2\nexit 2\n")
    broken.chmod(0o755)
    refused(run, "ended with 2 and wrote no analysis.json: run.h5 holds no sample", "--program", str(broken))
    (run / "run.h5").unlink()
    shutil.copy(folder.parent / "sweep/phi0.45-Ca0.028/run.h5", run)
    done = report(run, "--program", str(program), "--no-pictures", "--no-pdf")
    expect(done.returncode == 0 and (folder / "asked").read_text().split() == ["analyse", str(run)] and (run / "report/index.html").exists(), f"analysed first: {done.stderr}")
    expect(not needs_analysis(run), "then it does not need one")
    os.utime(run / "analysis.json", (1, 1))
    expect(needs_analysis(run), "an analysis older than the run is not enough")
    expect(not needs_analysis(run, "--no-analyse"), "unless it is to be drawn as it is")


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        places = write_sweep(folder / "sweep")
        done = report(folder / "nowhere")
        expect(done.returncode == 1 and done.stderr.strip().endswith("nowhere is no folder. Give the output folder of `corpuscle run` or `corpuscle sweep`."), done.stderr)
        refused(folder, "holds no run.h5, sweep.json or analysis.json")
        refused(folder / "sweep", "there are: phi0.12-Ca0.00028", "--run", "phi7")
        write(folder / "analysis.json", {"format": "something"})
        refused(folder, "is of the format 'something'")
        (folder / "analysis.json").unlink()
        check_sweep(folder / "sweep")
        (folder / "first").mkdir()
        check_analysis_first(folder / "first")
        check_run(places[3])
        check_missing(folder / "sweep")
    finish()


if __name__ == "__main__":
    main()
