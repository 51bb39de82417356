#!/usr/bin/env python3
"""Figures and tables of the benchmarks.

    python report/performance.py BENCH.JSON [--document PAGE]

BENCH.JSON is written by ./dev bench. Without --document the figures performance_*.png are put beside it; with --document docs/performance.md they go to
docs/figures/ and the page's tables between `<!-- bench: NAME -->` and `<!-- end -->` are made anew from the file; README.md has one such table too. Sections
that the file lacks stay as they are.
Needs: pip install numpy matplotlib.
"""

import argparse
import json
import pathlib
import re
import sys

sys.dont_write_bytecode = True

from performance_figures import draw_all  # noqa: E402
from performance_tables import TABLES  # noqa: E402

BLOCK = re.compile(r"^<!-- bench: (\w+) -->\n(.*?)^<!-- end -->$", re.MULTILINE | re.DOTALL)


def fill(page, result):
    """The page with every block that the result has numbers for made anew; says which it has none for."""

    def block(match):
        name = match[1]
        if name not in TABLES:
            sys.exit(f"No table is called {name}; there are {', '.join(TABLES)}.")
        try:
            return f"<!-- bench: {name} -->\n{TABLES[name](result)}\n<!-- end -->"
        except KeyError as missing:
            print(f"{name}: left as it is, the result file has no {missing}", file=sys.stderr)
            return match[0]

    return BLOCK.sub(block, page)


def main():
    parser = argparse.ArgumentParser(description="Figures and tables of the benchmarks.")
    parser.add_argument("result", metavar="BENCH.JSON", type=pathlib.Path)
    parser.add_argument(
        "--document", metavar="PAGE", type=pathlib.Path, help="fill the tables of this page, and put the figures that it shows into figures/ beside it"
    )
    arguments = parser.parse_args()
    try:
        result = json.loads(arguments.result.read_text(encoding="utf-8"))
        sections = result["sections"]
    except (OSError, ValueError, KeyError, TypeError):
        sys.exit(f"{arguments.result} is no result file of ./dev bench.")
    folder = arguments.result.parent if arguments.document is None else arguments.document.parent / "figures"
    stem = arguments.result.stem + "_" if arguments.document is None else "performance_"
    page = arguments.document.read_text(encoding="utf-8") if arguments.document else ""
    if arguments.document is None or "figures/performance_" in page:
        folder.mkdir(parents=True, exist_ok=True)
        for path in draw_all(sections, folder, stem):
            print(path)
    if arguments.document is not None:
        arguments.document.write_text(fill(page, result), encoding="utf-8")
        print(arguments.document)


if __name__ == "__main__":
    main()
