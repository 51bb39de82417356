#!/usr/bin/env python3
"""Validation of corpuscle against theory, experiment and other methods: runs the simulations, prints one table.

    python tests/validation/validate.py --program build/release/app/corpuscle [CASE ...] [--document docs/validation.md]

A case is a module in tests/validation/cases/. Results are kept in the work folder, so an interrupted validation goes on
where it stopped, and the document can be written again without a run.
Needs: pip install numpy h5py matplotlib. Exit code 1: a row failed or a case did not finish.
"""

import argparse
import concurrent.futures
import importlib
import os
import pathlib
import sys
import time
import traceback

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here))
sys.path.insert(0, str(here / "cases"))

from document import write_document  # noqa: E402
from rows import Row, print_table  # noqa: E402
from simulations import Simulations  # noqa: E402


def case_names():
    """All cases, the expensive ones first: a case may say `COST` in core minutes."""
    names = [path.stem for path in sorted((here / "cases").glob("*.py"))]
    return sorted(names, key=lambda name: -getattr(importlib.import_module(name), "COST", 1))


def rows_of(name, run):
    try:
        return importlib.import_module(name).rows(run)
    except Exception as error:  # a case that breaks must not hide the others
        traceback.print_exc()
        return [Row(name, f"did not finish: {type(error).__name__}", float("nan"), float("nan"), str(error)[:120])]


def main():
    source = here.parent.parent
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help="cases to run (default: all): " + ", ".join(case_names()))
    parser.add_argument("--program", default=source / "build/release/app/corpuscle", help="the program to validate")
    parser.add_argument("--work", default=source / "build/validation", help="where results are kept")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    parser.add_argument("--jobs", type=int, default=cores, help="simulations at a time, one thread each")
    parser.add_argument("--document", metavar="FILE", help="also write this Markdown file, and its plots into figures/ beside it")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.cases if name not in case_names()]
    if unknown:
        parser.error(f"no case called {unknown[0]}; there are: {', '.join(case_names())}")
    if not pathlib.Path(arguments.program).exists():
        parser.error(f"--program {arguments.program} does not exist; build it, or say where it is")

    run = Simulations(arguments.program, source, arguments.work, arguments.jobs, lambda text: print(text, flush=True))
    begin = time.monotonic()
    names = [name for name in case_names() if not arguments.cases or name in arguments.cases]
    with concurrent.futures.ThreadPoolExecutor(len(names)) as threads:  # a thread a case: they share the pool of simulations
        try:
            rows = [row for part in threads.map(lambda name: rows_of(name, run), names) for row in part]
        except KeyboardInterrupt:
            run.stop()
            sys.exit(130)
    if arguments.document:
        write_document(pathlib.Path(arguments.document), names, rows, run)
    print()
    print_table(rows)
    failed = sum(not row.passed for row in rows)
    print(f"\n{len(rows) - failed} of {len(rows)} rows pass; {time.monotonic() - begin:.0f} s")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
