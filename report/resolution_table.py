#!/usr/bin/env python3
"""Writes physics/resolution_table.cpp from the studies of suspensions in docs/accuracy/: what plan and summary.json know about the error of the viscosity.

Where studies share a volume fraction, all of them are compared with the limit that is known best; a setting that several of them have counts with the viscosity that is.

    python report/resolution_table.py [--check]

--check: writes nothing, exit code 1 when the file isn't what the studies say.
"""
import json
import math
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
STUDIES = {0.2: ["phi20"], 0.449: ["phi45", "diffusion"]}
KNOBS = ("accuracy.radius", "accuracy.delta_kernel", "size", "accuracy.counted_shell")
TARGET = ROOT / "physics/resolution_table.cpp"
HEAD = """// Written by report/resolution_table.py from docs/accuracy/phi20.json, phi45.json and diffusion.json: do not change by hand.
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


def studies():
    """(phi, data of all its studies)."""
    for phi, names in STUDIES.items():
        yield phi, [json.loads((ROOT / f"docs/accuracy/{name}.json").read_text()) for name in names]


def viscosities(data):
    """((way to count, points of the kernel, radius), viscosity, error) of the settings that differ in nothing else from the scene of a study."""
    for point in data["points"]:
        settings, found = point["settings"], point["observed"]["relative_viscosity"]
        if point["state"] != "finished" or found["value"] is None or any(settings[k] != data["base"][k] for k in data["knobs"] if k not in KNOBS):
            continue
        counted = settings.get("size", "effective")
        if counted == "effective":
            counted = settings.get("accuracy.counted_shell", "drag") + "_shell"
        yield (counted, int(settings["accuracy.delta_kernel"]), float(settings["accuracy.radius"])), found["value"], found["error"]


def rows():
    for phi, of_phi in studies():
        limit = min((data["reference"]["relative_viscosity"] for data in of_phi), key=lambda reference: reference["error"])
        best = {}
        for data in of_phi:
            for setting, value, error in viscosities(data):
                if setting not in best or error < best[setting][1]:
                    best[setting] = value, error
        for setting, (value, error) in best.items():
            ratio = value / limit["value"]
            yield phi, *setting, ratio - 1, ratio * math.hypot(error / value, limit["error"] / limit["value"])


def main():
    lines = [f"      {{{phi:g}, {size}, {kernel}, {radius:g}, {value:.4f}, {error:.4f}}},\n" for phi, size, kernel, radius, value, error in sorted(rows())]
    text = HEAD + "".join(lines) + TAIL
    if "--check" in sys.argv[1:]:
        sys.exit(0 if TARGET.read_text() == text else f"{TARGET} isn't what the studies say: python report/resolution_table.py")
    TARGET.write_text(text)


if __name__ == "__main__":
    main()
