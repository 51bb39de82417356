#!/usr/bin/env python3
"""Runs the benchmarks and merges their sections into one result file.

    python perf/run_benchmarks.py PROGRAMS [SECTION ...] [--quick] [--output FILE]

PROGRAMS is the folder of the programs bench_SECTION. Prints a table for each section and writes one JSON file: machine, build, date, load, sections.
Needs the standard library only.
`./dev bench` builds the programs, runs this and draws the figures (report/performance.py); perf/compare.py compares two result files.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

SECTIONS = ["bandwidth", "fluid", "coupling", "membrane", "contact", "step", "scaling", "growth", "memory", "models"]
BUSY = 0.05  # share of the cores that other processes may use before timings say little


def first_line(path, key=None):
    """The first line of a file, or what follows `key :` in it; empty when there is none."""
    try:
        for line in pathlib.Path(path).read_text().splitlines():
            if key is None:
                return line.strip()
            if line.startswith(key):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return ""


def machine():
    caches = {}
    for index in sorted(pathlib.Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        if first_line(index / "type") != "Instruction":
            caches["L" + first_line(index / "level")] = first_line(index / "size")
    memory = first_line("/proc/meminfo", "MemTotal").split()
    return {
        "cpu": first_line("/proc/cpuinfo", "model name") or platform.processor(),
        "cores": len(os.sched_getaffinity(0)),
        "caches": caches,
        "memory_GiB": round(int(memory[0]) / 2**20, 1) if memory else None,
        "system": platform.platform(),
    }


def core_seconds():
    """(used by all processes, used by the benchmarks so far); the first is None where the system doesn't say."""
    times = os.times()
    own = times.user + times.system + times.children_user + times.children_system
    try:
        user, nice, system = map(int, pathlib.Path("/proc/stat").read_text().split()[1:4])
    except (OSError, ValueError):
        return None, own
    return (user + nice + system) / os.sysconf("SC_CLK_TCK"), own


def foreign_load(before, after, seconds, cores):
    """Share of the cores that other processes used between two calls of core_seconds; 0 where it isn't known."""
    if before[0] is None or after[0] is None or seconds <= 0:
        return 0.0
    return min(1.0, max(0.0, (after[0] - before[0]) - (after[1] - before[1])) / (seconds * cores))


def busy_warning(share):
    if share <= BUSY:
        return None
    return f"the machine is not idle (other processes use {100 * share:.0f} % of its cores): timings are too long, and ratios uncertain"


def present_load(cores):
    """Sampled, as the load average remembers the compilation of the benchmarks for minutes."""
    before = core_seconds()
    time.sleep(1)
    return foreign_load(before, core_seconds(), 1, cores)


def run_section(programs, name, quick, environment=None):
    program = programs / f"bench_{name}"
    if not program.is_file():
        sys.exit(f"{program} does not exist: build it first, with ./dev bench or the target bench_{name}.")
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "section.json"
        started, before = time.monotonic(), core_seconds()
        done = subprocess.run([str(program), "--output", str(output)] + (["--quick"] if quick else []), env={**os.environ, **(environment or {})})
        if done.returncode != 0:
            sys.exit(f"bench_{name} stopped with exit code {done.returncode}.")
        section = json.loads(output.read_text())
    seconds = time.monotonic() - started
    section["seconds"] = round(seconds, 1)
    section["foreign_load"] = round(foreign_load(before, core_seconds(), seconds, len(os.sched_getaffinity(0))), 3)
    return section


def amdahl(section):
    """For each operator its speedup and the serial share that would explain it: 1/S = s + (1 - s)/n."""
    rows = sorted(section["rows"], key=lambda row: row["threads"])
    one, table = rows[0], []
    for row in rows[1:]:
        n = row["threads"] / one["threads"]
        for key in [k for k in row if k.endswith("_ms")]:
            if one[key] < 0.002 * one["step_ms"] or row[key] <= 0:
                continue  # too short to tell
            speedup = one[key] / row[key]
            table.append(
                {
                    "case": f"{key[:-3]}, {row['threads']} threads",
                    "operator": key[:-3],
                    "threads": row["threads"],
                    "share": round(one[key] / one["step_ms"], 4),
                    "speedup": round(speedup, 3),
                    "serial_share": round(min(1.0, max(0.0, (n / speedup - 1) / (n - 1))), 4),
                }
            )
    return table


def scaling(programs, quick, threads):
    """The same program for 1, 2, 4 ... all threads."""
    counts = sorted({n for n in (1, 2, 4, 8, 16, 32, 64, 128) if n < threads} | {threads})
    parts = [run_section(programs, "scaling", quick, {"OMP_NUM_THREADS": str(n)}) for n in counts]
    section = parts[-1]
    section["rows"] = [row for part in parts for row in part["rows"]]
    section["amdahl"] = amdahl(section)
    section["seconds"] = round(sum(part["seconds"] for part in parts), 1)
    section["foreign_load"] = max(part["foreign_load"] for part in parts)
    return section


def write(output, result):
    temporary = output.with_name(output.name + ".part")
    temporary.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    temporary.replace(output)


def text_table(rows):
    columns = []
    for row in rows:
        columns += [key for key in row if key not in columns]
    shown = [[str(c) for c in columns]]
    for row in rows:
        shown.append([" x ".join(map(str, row[c])) if isinstance(row.get(c), list) else str(row.get(c, "")) for c in columns])
    widths = [max(len(line[i]) for line in shown) for i in range(len(columns))]
    return "\n".join("  ".join(cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(line, widths))).rstrip() for line in shown)


def warn(text):
    if text:
        print(f"warning: {text}", file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(description="Runs the benchmarks and merges their sections into one result file.")
    parser.add_argument("programs", type=pathlib.Path, help="folder of the programs bench_SECTION")
    parser.add_argument("sections", nargs="*", metavar="SECTION", help="of " + ", ".join(SECTIONS) + "; none: all")
    parser.add_argument("--quick", action="store_true", help="tiny sizes: shows that everything runs, says nothing about speed")
    parser.add_argument("--output", type=pathlib.Path, help="default: results/bench/bench-DATE.json")
    arguments = parser.parse_args()
    for name in arguments.sections:
        if name not in SECTIONS:
            parser.error(f"no section called {name}; there are {', '.join(SECTIONS)}")
    now = datetime.datetime.now()
    output = arguments.output or pathlib.Path("results/bench") / f"bench-{now:%Y-%m-%d-%H%M%S}.json"
    output.parent.mkdir(parents=True, exist_ok=True)

    here = machine()
    warn(busy_warning(present_load(here["cores"])))
    result = {
        "corpuscle_benchmarks": 1,
        "date": now.isoformat(timespec="seconds"),
        "quick": arguments.quick,
        "machine": here,
        "load_average": round(os.getloadavg()[0], 2),
        "busy": False,
        "build": None,
        "threads": None,
        "environment": {k: v for k, v in sorted(os.environ.items()) if k.startswith(("OMP_", "KOKKOS_"))},
        "sections": {},
    }
    threads = int(os.environ.get("OMP_NUM_THREADS", str(here["cores"])).split(",")[0])
    for name in arguments.sections or SECTIONS:
        print(f"== {name}", file=sys.stderr, flush=True)
        section = scaling(arguments.programs, arguments.quick, threads) if name == "scaling" else run_section(arguments.programs, name, arguments.quick)
        build = section.pop("build")
        if result["build"] is None:
            result["build"], result["threads"] = build, build["threads"]
        elif (build["revision"], build["compiler"], build["flags"]) != tuple(result["build"][k] for k in ("revision", "compiler", "flags")):
            sys.exit(f"bench_{name} was built from another revision or with other flags than the sections before: build all of them again.")
        result["sections"][section.pop("section")] = section
        if section["seconds"] >= 1:  # processor time is counted in hundredths of a second
            result["busy"] = result["busy"] or section["foreign_load"] > BUSY
        print(f"\n{name}: {section['about']}\n{text_table(section['rows'])}")
        for note in section["notes"]:
            print(note)
        if "amdahl" in section:
            print(f"\nAmdahl: speedup and the serial share that follows\n{text_table(section['amdahl'])}")
        print(f"({section['seconds']} s, other processes used {100 * section['foreign_load']:.0f} % of the cores)\n", flush=True)
        write(output, result)  # at once: a section that fails loses nothing but itself
    warn(busy_warning(max((section["foreign_load"] for section in result["sections"].values()), default=0)) if result["busy"] else None)
    print(output)


if __name__ == "__main__":
    main()
