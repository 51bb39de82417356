"""The benchmarks run, on tiny sizes, and write what the tools read: all sections, finite numbers, no statement about speed.

PROGRAM SOURCE-FOLDER. Exit 77: the Python modules for figures are missing.
"""

import importlib.util
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

program, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.dont_write_bytecode = True


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def load(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def numbers(value):
    if isinstance(value, bool) or isinstance(value, str):
        return []
    if isinstance(value, list):
        return [n for item in value for n in numbers(item)]
    return [value]


runner = load(source / "perf/run_benchmarks.py")
# Amdahl: half of the work serial, 1/S = 1/2 + 1/4 for two threads.
table = runner.amdahl(
    {"rows": [{"threads": 1, "step_ms": 10.0, "spread_ms": 8.0, "halo_ms": 2.0}, {"threads": 2, "step_ms": 7.0, "spread_ms": 6.0, "halo_ms": 1.0}]}
)
found = {row["operator"]: row for row in table}
check(abs(found["spread"]["speedup"] - 4 / 3) < 1e-3 and abs(found["spread"]["serial_share"] - 0.5) < 1e-3, "serial share of half the work")
check(found["halo"]["serial_share"] == 0 and found["halo"]["share"] == 0.2, "no serial share at the ideal speedup")
check(runner.busy_warning(0.01) is None and "not idle" in runner.busy_warning(0.5), "a busy machine is told")
# 10 s on 2 cores: 15 core seconds used, 11 of them by the benchmarks.
check(abs(runner.foreign_load((100.0, 1.0), (115.0, 12.0), 10, 2) - 0.2) < 1e-9, "what other processes used")

with tempfile.TemporaryDirectory() as folder:
    output = pathlib.Path(folder) / "bench.json"
    done = subprocess.run(
        [sys.executable, str(source / "perf/run_benchmarks.py"), str(program.parent.parent / "perf"), "--quick", "--output", str(output)],
        capture_output=True,
        text=True,
        env={**os.environ, "OMP_WAIT_POLICY": "passive"},
    )  # tests share their cores
    check(done.returncode == 0, f"the benchmarks run:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    check("belongs to no operator" not in done.stderr, f"every kernel of a step is counted:\n{done.stderr}")
    result = json.loads(output.read_text())
    check(list(result["sections"]) == runner.SECTIONS, f"all sections are there, not {list(result['sections'])}")
    check(result["quick"] and result["threads"] >= 1 and result["machine"]["cores"] >= 1, "the file says how it was made")
    for key in ("compiler", "flags", "revision", "kokkos_version", "backend", "kokkos_configuration"):
        check(result["build"][key], f"the file names {key}")
    for name, section in result["sections"].items():
        check(section["rows"] and section["better"], f"{name} has rows and says what is better")
        check(len({row["case"] for row in section["rows"]}) == len(section["rows"]), f"the cases of {name} have names of their own")
        for row in section["rows"]:
            check(set(row) & set(section["better"]), f"{name}: {row['case']} has a number that is judged")
            for key, value in row.items():
                check(all(math.isfinite(n) and n >= 0 for n in numbers(value)), f"{name}: {row['case']}: {key} is {value}")
        for metric in section["better"]:
            check(any(row.get(metric, 0) > 0 for row in section["rows"]), f"{name}: {metric} is measured somewhere")
    memory = result["sections"]["memory"]["rows"]
    check(all(row["bytes_per_node"] >= 76 for row in memory), "19 floats a node at least")
    again = subprocess.run([sys.executable, str(source / "perf/compare.py"), str(output), str(output)], capture_output=True, text=True)
    check(again.returncode == 0 and "0 slower" in again.stdout, f"a file is as fast as itself:\n{again.stdout}{again.stderr}")

    page = pathlib.Path(folder) / "performance.md"
    page.write_text((source / "docs/performance.md").read_text(encoding="utf-8"), encoding="utf-8")
    drawn = subprocess.run([sys.executable, str(source / "report/performance.py"), str(output), "--document", str(page)], capture_output=True, text=True)
    if "pip install" in drawn.stderr:
        print(f"skipped the figures: {drawn.stderr}")
        sys.exit(77)
    check(drawn.returncode == 0 and "left as it is" not in drawn.stderr, f"tables and figures are made:\n{drawn.stdout}{drawn.stderr}")
    for figure in ("roofline", "step", "scaling"):
        check((pathlib.Path(folder) / f"figures/performance_{figure}.png").stat().st_size > 10000, f"the figure {figure} is drawn")
    check("Tiny sizes" in page.read_text(encoding="utf-8"), "the page says that nothing was measured")
print("ok")
