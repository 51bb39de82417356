#!/usr/bin/env bash
# What accuracy.cell_size = "hydrodynamic" buys: deformation and intrinsic viscosity of a neo-Hookean capsule in shear against boundary elements in unbounded shear
# (docs/theory/hydrodynamic_radius.md has the table), for each radius, kernel and size of the box.
# usage: perf/capsule_size.sh [PROGRAM] [CASES] ; CASES: lines "Ca_G radius points box cell_size" from this file, default: those below.
# On one core about 5 s a case at r = 4, 1 min at r = 6, 4 min at r = 8. Threads: as corpuscle takes them, or OMP_NUM_THREADS.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
program=${1:-$root/build/release/app/corpuscle}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

default_cases() {
  for ca in 0.0375 0.15; do
    for box in 8 12 16; do for size in mesh hydrodynamic; do echo "$ca 4 3 $box $size"; done; done
    for points in 2 4; do for size in mesh hydrodynamic; do echo "$ca 4 $points 8 $size"; done; done
    for points in 2 3 4; do for size in mesh hydrodynamic; do echo "$ca 6 $points 8 $size"; done; done
    for points in 2 3 4; do for size in mesh hydrodynamic; do echo "$ca 8 $points 8 $size"; done; done
  done
}

number() { grep -o "\"$1\": [-0-9.e]*" "$work/case/summary.json" | cut -d' ' -f2; }

printf '%-8s %-6s %-6s %-5s %-13s %-8s %-8s %s\n' Ca_G r points box/r cell_size D [eta] A/A0
if [ $# -gt 1 ]; then cat "$2"; else default_cases; fi | while read -r ca radius points box size; do
  half=$((box / 2))
  "$program" run "$root/scenes/single_capsule.toml" --output "$work/case" --overwrite --set flow.capillary_number_G="$ca" --set flow.reynolds_number_max=0.05 \
    --set "box.size=[$box,$box,$box]" --set "cells.0.position=[$half,$half,$half]" --set accuracy.radius="$radius" --set accuracy.delta_kernel="$points" \
    --set accuracy.cell_size="$size" --set accuracy.relaxation_time=2 --set run.strain=3.5 --set run.discard=0.85 --set output.snapshot_every=0 >"$work/log" 2>&1 </dev/null ||
    { tail -1 "$work/log"; continue; }
  printf '%-8s %-6s %-6s %-5s %-13s %-8.4f %-8.3f %.4f\n' "$ca" "$radius" "$points" "$box" "$size" "$(number deformation)" "$(number intrinsic_viscosity)" "$(number area_ratio)"
done
