"""perf/compare.py: what got slower, what only one file has, files that don't fit, files that are none.

PROGRAM SOURCE-FOLDER.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[2])


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


BASE = {
    "corpuscle_benchmarks": 1,
    "quick": False,
    "machine": {"cpu": "A processor", "cores": 2},
    "threads": 2,
    "busy": False,
    "build": {"compiler": "GNU 12.2.0", "backend": "OpenMP"},
    "sections": {
        "fluid": {
            "better": {"MLUPS": "higher"},
            "rows": [{"case": "float", "MLUPS": 300.0, "fraction": 0.9}, {"case": "double", "MLUPS": 150.0, "fraction": 0.9}],
        },
        "step": {
            "better": {"MLUPS": "higher", "spread_ms": "lower", "motion_ms": "lower"},
            "rows": [{"case": "dense", "MLUPS": 40.0, "step_ms": 50.0, "spread_ms": 20.0, "motion_ms": 0.3}],
        },
    },
}


def changed(edit):
    result = copy.deepcopy(BASE)
    edit(result)
    return result


def row(result, section, index):
    return result["sections"][section]["rows"][index]


with tempfile.TemporaryDirectory() as folder:
    old_file, new_file = pathlib.Path(folder) / "old.json", pathlib.Path(folder) / "new.json"
    old_file.write_text(json.dumps(BASE))

    def compare(new, *options):
        new_file.write_text(new if isinstance(new, str) else json.dumps(new))
        done = subprocess.run([sys.executable, str(source / "perf/compare.py"), str(old_file), str(new_file), *options], capture_output=True, text=True)
        check("Traceback" not in done.stderr, f"no traceback:\n{done.stderr}")
        return done

    same = compare(BASE)
    check(same.returncode == 0 and "4 numbers compared, 0 slower" in same.stdout and not same.stderr, f"the same is not slower:\n{same.stdout}{same.stderr}")

    within = compare(changed(lambda r: row(r, "fluid", 0).update(MLUPS=280.0)))
    check(within.returncode == 0 and "Slower" not in within.stdout, "7 % is within the tolerance")
    strict = compare(changed(lambda r: row(r, "fluid", 0).update(MLUPS=280.0)), "--tolerance", "0.05")
    check(strict.returncode == 1 and "slower by 7 %" in strict.stdout, "but not within 5 %")

    slower = compare(changed(lambda r: row(r, "step", 0).update(spread_ms=30.0, MLUPS=30.0)))
    check(slower.returncode == 1, "slower: exit code 1")
    check("step: dense: spread_ms 20 -> 30 (slower by 50 %)" in slower.stdout, f"a time that grew:\n{slower.stdout}")
    check("step: dense: MLUPS 40 -> 30 (slower by 33 %)" in slower.stdout, f"a rate that fell:\n{slower.stdout}")
    check(slower.stdout.index("spread_ms") < slower.stdout.index("MLUPS"), "the largest change comes first")

    faster = compare(changed(lambda r: row(r, "step", 0).update(spread_ms=10.0, MLUPS=60.0)))
    check(faster.returncode == 0 and "Faster" in faster.stdout and "Slower" not in faster.stdout, "faster is no failure")

    small = compare(changed(lambda r: row(r, "step", 0).update(motion_ms=0.6)))
    check(small.returncode == 0, "an operator of less than 2 % of a step doesn't count")
    derived = compare(changed(lambda r: row(r, "fluid", 0).update(fraction=0.1)))
    check(derived.returncode == 0, "columns that aren't judged don't count")

    def fewer(r):
        del r["sections"]["step"]
        r["sections"]["fluid"]["rows"].pop()
        r["sections"]["fluid"]["rows"].append({"case": "TRT", "MLUPS": 1.0})
        r["sections"]["memory"] = {"better": {"MiB": "lower"}, "rows": [{"case": "all", "MiB": 3.0}]}

    missing = compare(changed(fewer))
    check(missing.returncode == 0, "missing cases are told, not judged")
    for text in ("Only in the old file", "step: dense", "fluid: double", "Only in the new file", "fluid: TRT", "memory: all", "1 numbers compared"):
        check(text in missing.stdout, f"{text} in\n{missing.stdout}")

    def elsewhere(r):
        r["machine"]["cpu"] = "Another"
        r["threads"] = 4
        r["busy"] = True

    other = compare(changed(elsewhere))
    check(
        other.returncode == 0 and "differ in processor (A processor, then Another)" in other.stderr and "differ in threads (2, then 4)" in other.stderr,
        f"another machine:\n{other.stderr}",
    )
    check("the new file was measured while other processes" in other.stderr, "a busy machine is told")

    broken = compare('{"sections": ')
    check(broken.returncode == 2 and "new.json is no JSON" in broken.stderr, f"half a file:\n{broken.stderr}")
    foreign = compare({"command": "corpuscle stability", "cases": []})
    check(foreign.returncode == 2 and "no result file of ./dev bench" in foreign.stderr, f"another file:\n{foreign.stderr}")
    check(compare([1, 2]).returncode == 2, "a list")
    odd = compare(changed(lambda r: r["sections"].update(fluid={"rows": 3})))
    check(odd.returncode == 2 and "a section is not as" in odd.stderr, f"a broken section:\n{odd.stderr}")
    nothing = compare(changed(lambda r: r.update(sections={})))
    check(nothing.returncode == 2 and "no case in common" in nothing.stderr, "nothing in common is no success")
    new_file.unlink()
    absent = subprocess.run([sys.executable, str(source / "perf/compare.py"), str(old_file), str(new_file)], capture_output=True, text=True)
    check(absent.returncode == 2 and "can't be read" in absent.stderr, f"no file:\n{absent.stderr}")
print("ok")
