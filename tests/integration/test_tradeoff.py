"""corpuscle tradeoff as a user meets it: a study runs, goes on where it was stopped, says what can't be run, and its front is the one that its numbers give.
Arguments: PROGRAM SOURCE-FOLDER."""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

from expectations import expect, finish

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = None

BASE = """
[box]
size = [4, 4, 4]
[flow]
capillary_number = 0.1
reynolds_number_max = 0.5
[[cells]]
shape = "sphere"
count = 1
position = [2, 2, 2]
[contact]
enabled = false
[accuracy]
radius = 4
relaxation_time = 1.0
delta_kernel = 2
[run]
strain = 1.5
[output]
series_every = 0.05
snapshot_every = 0
"""
STUDY = """
scene = "base.toml"
[study]
observables = ["deformation", "intrinsic_viscosity"]
wall_layer = 0
discard = 0.5
[study.reference]
extrapolate = "accuracy.radius"
same_limit = ["accuracy.delta_kernel"]
[[axis]]
key = "accuracy.radius"
values = [3, 4, 5]
[[axis]]
key = "accuracy.delta_kernel"
values = [2, 3]
[[also]]
"accuracy.shear_modulus" = 5.0
"""


def tradeoff(study, *options, check=0):
    done = subprocess.run([program, "tradeoff", study, "--output", work / "out", *map(str, options)], capture_output=True, text=True, timeout=500)
    expect(done.returncode == check, f"{options}: exit code {done.returncode} instead of {check}: {done.stdout}{done.stderr}")
    return done


def test_study():
    (work / "base.toml").write_text(BASE)
    study = work / "study.toml"
    study.write_text(STUDY)
    dry = tradeoff(study, "--dry-run").stdout
    expect("radius3-delta_kernel3" in dry and "can't be run" in dry, f"a dry run lists the points and what can't be run: {dry}")
    expect(not (work / "out").exists(), "a dry run writes nothing")
    expect("leave --no-run out" in tradeoff(study, "--no-run", check=2).stderr, "nothing there to compare")

    page = tradeoff(study).stdout
    data = json.loads((work / "out/tradeoff.json").read_text())
    points = {(p["settings"]["accuracy.radius"], p["settings"]["accuracy.delta_kernel"]): p for p in data["points"] if p["state"] == "finished"}
    expect(len(points) == 6, f"six points are finished: {sorted(points)}")
    refused = [p for p in data["points"] if p["state"] == "refused"]
    expect(len(refused) == 1 and "accuracy.shear_modulus" in refused[0]["message"], f"an unstable membrane is refused with its reason: {refused}")
    expect((work / "out/tradeoff.md").read_text() in page, "the page is printed and kept")

    # Finer meshes and narrower kernels make the cell less too large: [eta] falls.
    eta = {k: p["observed"]["intrinsic_viscosity"]["value"] for k, p in points.items()}
    for kernel in ("2", "3"):
        expect(eta["3", kernel] > eta["4", kernel] > eta["5", kernel] > 2, f"[eta] falls with the radius: {eta}")
    for radius in "345":
        expect(eta[radius, "2"] < eta[radius, "3"], f"[eta] is larger with the wider kernel: {eta}")

    # Deviations and the front, computed again.
    for p in points.values():
        worst = 0
        for name, observed in p["observed"].items():
            reference = data["reference"][name]
            expect(math.isclose(observed["deviation"]["value"], observed["value"] / reference["value"] - 1, abs_tol=1e-12), f"{p['name']}: deviation of {name}")
            if reference["converged"] or not any(r["converged"] for r in data["reference"].values()):
                worst = max(worst, abs(observed["deviation"]["value"]))
        expect(math.isclose(worst, p["deviation"]["value"]), f"{p['name']}: the largest deviation")
        steps, nodes = p["steps_per_strain"], p["nodes"]
        radius = int(p["settings"]["accuracy.radius"])
        expect(nodes == (4 * radius) ** 3 and math.isclose(steps, radius ** 2 * 12, rel_tol=1e-6), f"{p['name']}: {nodes} nodes, {steps} steps a strain")
        expect(p["core_seconds_per_strain"]["predicted"] > 0 and p["core_seconds_per_strain"]["measured"] > 0, f"{p['name']}: costs")
    cost = {p["name"]: (p["core_seconds_per_strain"]["predicted"], p["deviation"]["value"]) for p in points.values()}
    front = [n for n, (c, d) in cost.items() if not any((o[0] <= c and o[1] <= d and o != (c, d)) for o in cost.values())]
    expect(sorted(front) == sorted(data["front"]), f"the front: {front}, {data['front']}")
    expect(all(p["on_front"] == (p["name"] in front) for p in points.values()), "on_front")
    rows = list(csv.DictReader((work / "out/tradeoff.csv").open()))
    expect(len(rows) == 7 and {r["name"] for r in rows if r["on_front"] == "1"} == set(front), "the table has the same front")

    drawn = subprocess.run([sys.executable, source / "report/report.py", work / "out", "--dpi", "60", "--no-pdf"], capture_output=True, text=True)
    expect(drawn.returncode == 0, f"the report ends with {drawn.returncode}: {drawn.stderr}")
    html = (work / "out/report/index.html").read_text()
    for name in ("front", "convergence"):
        expect((work / f"out/report/{name}.png").stat().st_size > 3000 and f'id="{name}"' in html, f"{name} is drawn and in the page")

    # The same command finds everything done; a value that is added is run alone.
    before = {name: (work / "out" / name / "run.h5").stat().st_mtime_ns for name in cost}
    expect("all 6 points are through" in tradeoff(study).stdout, "nothing is left")
    study.write_text(STUDY.replace("[3, 4, 5]", "[3, 4, 5, 6]").replace('same_limit = ["accuracy.delta_kernel"]', ""))
    expect("8 points, 2 left" in tradeoff(study).stdout, "two points more")
    expect(all((work / "out" / name / "run.h5").stat().st_mtime_ns == before[name] for name in cost), "finished runs are left alone")
    again = json.loads((work / "out/tradeoff.json").read_text())
    # Without same_limit the kernel of the base scene alone makes the reference.
    expect(len(again["reference"]["deformation"]["families"]) == 1, "one family")

    # Published values as the reference, and one of the points.
    text = study.read_text()
    begin, end = text.index("[study.reference]"), text.index("[[axis]]")
    study.write_text(text[:begin] + "[study.reference]\nvalues = { deformation = 0.3, intrinsic_viscosity = [2.4, 0.1] }\n" + text[end:])
    tradeoff(study, "--no-run")
    given = json.loads((work / "out/tradeoff.json").read_text())
    expect(given["reference"]["deformation"]["value"] == 0.3, "the value of the study")
    study.write_text(text[:begin] + '[study.reference]\npoint = { "accuracy.radius" = 6, "accuracy.delta_kernel" = 3 }\n' + text[end:])
    tradeoff(study, "--no-run")
    finest = json.loads((work / "out/tradeoff.json").read_text())
    own = next(p for p in finest["points"] if p["settings"] == {**p["settings"], "accuracy.radius": "6", "accuracy.delta_kernel": "3"} and p["state"] == "finished")
    expect(own["deviation"]["value"] == 0 and own["on_front"], "the reference deviates from itself by nothing")

    # What is no study is never replaced.
    (work / "out/tradeoff.json").write_text("{}")
    expect("tradeoff.json" in tradeoff(study, "--no-run", check=2).stderr and (work / "out/tradeoff.json").read_text() == "{}", "a file of something else stays")


with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    test_study()
finish()
