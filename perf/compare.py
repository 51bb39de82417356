#!/usr/bin/env python3
"""What got slower between two result files of ./dev bench.

    python perf/compare.py OLD.json NEW.json [--tolerance 0.10]

Rows are matched by section and case; each section says which of its columns count and whether more or less of them is better.
Prints what changed by more than the tolerance.
Exit code: 0 nothing got slower, 1 something did, 2 a file is no result file. Needs the standard library only.
"""

import argparse
import json
import pathlib
import sys

MOST = 0.02  # operators that take less than this share of the old step are too short to judge


def read(path):
    """A result file. Ends the program with a sentence when it is something else."""
    try:
        result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        fail(f"{path} can't be read ({error.strerror}).")
    except ValueError:
        fail(f"{path} is no JSON: it must be a result file of ./dev bench.")
    if not isinstance(result, dict) or "corpuscle_benchmarks" not in result or not isinstance(result.get("sections"), dict):
        fail(f'{path} is no result file of ./dev bench: "corpuscle_benchmarks" and "sections" are missing.')
    return result


def fail(message):
    print(f"compare: {message}", file=sys.stderr)
    sys.exit(2)


def differences(old, new):
    """Why timings of the two files can't be compared as they are."""
    said = []
    for name, a, b in [
        ("processor", old.get("machine", {}).get("cpu"), new.get("machine", {}).get("cpu")),
        ("cores", old.get("machine", {}).get("cores"), new.get("machine", {}).get("cores")),
        ("threads", old.get("threads"), new.get("threads")),
        ("quick", old.get("quick"), new.get("quick")),
        ("compiler", (old.get("build") or {}).get("compiler"), (new.get("build") or {}).get("compiler")),
        ("backend", (old.get("build") or {}).get("backend"), (new.get("build") or {}).get("backend")),
    ]:
        if a != b:
            said.append(f"the files differ in {name} ({a}, then {b})")
    for which, result in (("old", old), ("new", new)):
        if result.get("busy"):
            said.append(f"the {which} file was measured while other processes used the machine")
    return said


def number(row, key):
    value = row.get(key)
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0 else None


def changes(old, new):
    """(slowdown, section, case, column, old value, new value) of all matching numbers, and the cases that only one file has.

    slowdown 1.25: takes 1.25 times as long."""
    found, lost, gained = [], [], []
    for name in dict.fromkeys([*old["sections"], *new["sections"]]):
        a, b = (r["sections"].get(name, {"rows": [], "better": {}}) for r in (old, new))
        before, after = ({row["case"]: row for row in s["rows"]} for s in (a, b))
        lost += [f"{name}: {case}" for case in before if case not in after]
        gained += [f"{name}: {case}" for case in after if case not in before]
        for case, row in before.items():
            if case not in after:
                continue
            whole = number(row, "step_ms")
            for key, better in a["better"].items():
                x, y = number(row, key), number(after[case], key)
                if x is None or y is None or (whole and key.endswith("_ms") and x < MOST * whole):
                    continue
                found.append((y / x if better == "lower" else x / y, name, case, key, x, y))
    return found, lost, gained


def listing(title, rows):
    if not rows:
        return
    print(f"{title}:")
    for factor, section, case, key, x, y in rows:
        print(f"  {section}: {case}: {key} {x:g} -> {y:g} ({'slower' if factor > 1 else 'faster'} by {100 * (max(factor, 1 / factor) - 1):.0f} %)")


def main():
    parser = argparse.ArgumentParser(description="What got slower between two result files of ./dev bench.")
    parser.add_argument("old", metavar="OLD.json")
    parser.add_argument("new", metavar="NEW.json")
    parser.add_argument("--tolerance", type=float, default=0.10, help="relative change that counts (default: 0.10)")
    arguments = parser.parse_args()
    old, new = read(arguments.old), read(arguments.new)
    for text in differences(old, new):
        print(f"warning: {text}", file=sys.stderr)
    try:
        found, lost, gained = changes(old, new)
    except (KeyError, TypeError, AttributeError) as error:
        fail(f"a section is not as ./dev bench writes it ({error!r}).")
    limit = 1 + arguments.tolerance
    slower = sorted((c for c in found if c[0] > limit), reverse=True)
    listing("Slower", slower)
    listing("Faster", sorted(c for c in found if c[0] < 1 / limit))
    for title, cases in (("Only in the old file", lost), ("Only in the new file", gained)):
        if cases:
            print(f"{title}:")
            for case in cases:
                print(f"  {case}")
    print(f"{len(found)} numbers compared, {len(slower)} slower by more than {100 * arguments.tolerance:g} %.")
    if not found:
        fail("the files have no case in common.")
    sys.exit(1 if slower else 0)


if __name__ == "__main__":
    main()
