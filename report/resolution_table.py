#!/usr/bin/env python3
"""Writes physics/resolution_table.cpp from the studies of suspensions in docs/accuracy/: what plan and summary.json know about the error of the viscosity.

    python report/resolution_table.py [--check]

--check: writes nothing, exit code 1 when the file isn't what the studies say.
"""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
STUDIES = {"phi20": 0.2, "phi45": 0.449}
TARGET = ROOT / "physics/resolution_table.cpp"
HEAD = """// Written by report/resolution_table.py from docs/accuracy/phi20.json and docs/accuracy/phi45.json: do not change by hand.
#include "physics/resolution_error.hpp"

namespace corpuscle {

std::span<const MeasuredDeviation> measured_deviations() {
  using enum CountedBy;
  // phi, counted by, points of the kernel, r, deviation, uncertainty
  static constexpr MeasuredDeviation table[] = {
"""
TAIL = """  };
  return table;
}

}  // namespace corpuscle
"""


def rows():
    for name, phi in STUDIES.items():
        data = json.loads((ROOT / f"docs/accuracy/{name}.json").read_text())
        for point in data["points"]:
            settings, found = point["settings"], point["observed"]["relative_viscosity"]["deviation"]
            if point["state"] != "finished" or found["value"] is None or any(settings[k] != data["base"][k] for k in data["knobs"] if k not in ("accuracy.radius", "accuracy.delta_kernel", "size")):
                continue
            yield phi, settings["size"], int(settings["accuracy.delta_kernel"]), float(settings["accuracy.radius"]), found["value"], abs(found["error"])


def main():
    lines = [f"      {{{phi:g}, {size}, {kernel}, {radius:g}, {value:.4f}, {error:.4f}}},\n" for phi, size, kernel, radius, value, error in sorted(rows())]
    text = HEAD + "".join(lines) + TAIL
    if "--check" in sys.argv[1:]:
        sys.exit(0 if TARGET.read_text() == text else f"{TARGET} isn't what the studies say: python report/resolution_table.py")
    TARGET.write_text(text)


if __name__ == "__main__":
    main()
