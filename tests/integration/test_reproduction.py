"""report/reproduction.py on a made-up sweep: verdicts follow the data, not a wish: PROGRAM SOURCE-FOLDER."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from expectations import expect, finish
from synthetic_analysis import write, write_sweep

SOURCE = pathlib.Path(sys.argv[2])


def verdicts(folder, document, *options):
    """{statement: verdict} of the page that is written."""
    done = subprocess.run([sys.executable, str(SOURCE / "report/reproduction.py"), str(folder), "--document", str(document), *options], capture_output=True, text=True)
    expect(done.returncode == 0, f"reproduction.py ends with {done.returncode}: {done.stderr}")
    page = document.read_text()
    return {row[0]: row[2] for row in re.findall(r"^\| ([^|]+) \| (.+) \| \*\*([a-z ]+)\*\*", page, re.M)}, page


def is_now(found, start, verdict):
    statement = next((s for s in found if s.startswith(start)), None)
    expect(statement is not None and found[statement] == verdict, f"{start}: {found.get(statement)}, {verdict} expected")


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sweep, document = folder / "sweep", folder / "docs/reproduction.md"
        document.parent.mkdir()
        write_sweep(sweep)
        found, page = verdicts(sweep, document, "--dpi", "60")
        expect(len(found) == 14, f"14 statements have a verdict: {sorted(found)}")
        # What the made-up data were made of.
        for start in ("Newtonian", "Yield stress", "VACF", "Gap l"):
            is_now(found, start, "holds")
        is_now(found, "D/(γ̇r²)", "not tested")  # no such point
        images = re.findall(r"\]\((figures/reproduction/[^)]+)\)", page)
        expect(len(images) >= 9 and all((document.parent / image).stat().st_size > 3000 for image in images), f"figures: {images}")
        expect("{{" not in page, "no mark is left")
        table = document.with_suffix(".csv").read_text().splitlines()
        expect(table[0].startswith("run,phi_effective") and len(table) > 28 * 10, f"{len(table)} rows of estimates")

        # The opposite: no thinning, thick tails of a Gaussian, another gap.
        data = json.loads((sweep / "analysis.json").read_text())
        for curve in data["flow_curves"]:
            curve["shear_thinning"]["parameters"]["exponent"]["value"] = 0.2
            curve["yield_stress"]["parameters"]["yield_stress"].update(value=1e-6, error=1e-3)
        data["gap_radius"]["parameters"]["slope"]["value"] *= 3
        write(sweep / "analysis.json", data)
        found, _ = verdicts(sweep, document, "--no-figures")
        is_now(found, "Newtonian", "does not hold")
        is_now(found, "Shear thinning", "does not hold")
        is_now(found, "Gap l", "does not hold")
        is_now(found, "Yield stress", "holds partly")  # rightly none at low fractions

        done = subprocess.run([sys.executable, str(SOURCE / "report/reproduction.py"), str(folder), "--document", str(document)], capture_output=True, text=True)
        expect(done.returncode != 0 and "corpuscle analyse" in done.stderr, f"a folder without an analysis is refused: {done.stderr}")
    finish()


if __name__ == "__main__":
    main()
