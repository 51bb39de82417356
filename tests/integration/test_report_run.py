"""report/report.py on a run that the program made: analysed first, pictures rendered where a renderer is at hand: PROGRAM SOURCE-FOLDER."""
import pathlib
import re
import subprocess
import sys
import tempfile

from expectations import expect, finish

SCENE = """
[box]
size = [6, 6, 6]
[flow]
capillary_number = 0.1
[[cells]]
shape = "sphere"
count = 3
[accuracy]
radius = 4
[run]
strain = 0.6
[output]
series_every = 0.01
snapshot_every = 0.2
"""


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.toml").write_text(SCENE)
        run = folder / "run"
        made = subprocess.run([program, "run", str(folder / "scene.toml"), "--output", str(run)], capture_output=True, text=True)
        expect(made.returncode == 0, f"the run ends with {made.returncode}: {made.stderr}")
        done = subprocess.run([sys.executable, str(source / "report/report.py"), str(run), "--program", program, "--dpi", "60", "--no-pdf"], capture_output=True, text=True)
        expect(done.returncode == 0, f"the report ends with {done.returncode}: {done.stderr}")
        expect("analysing first" in done.stderr and (run / "analysis.json").exists(), "the run is analysed first")
        page = (run / "report/index.html").read_text()
        expect("<code>relative_viscosity</code>" in page and "not converged" in page, "so short a run has numbers that are not converged")
        expect(page.count('id="series"') == 1 and (run / "report/series.png").exists(), "the series are drawn")
        if "the renderer ended with" in page:
            print("no renderer here:", re.search("the renderer ended with [^<]*", page).group())
        else:
            for stem, kind in (("figure_1a", "png"), ("snapshots", "png"), ("motion", "gif")):
                expect((run / f"report/{stem}.{kind}").stat().st_size > 3000 and f'id="{stem}"' in page, f"{stem} is drawn and in the page")
            expect("data:image/gif;base64," in page, "the animation is embedded")
    finish()


if __name__ == "__main__":
    main()
