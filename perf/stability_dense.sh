#!/usr/bin/env bash
# How stiff a membrane may be in a dense suspension (phi_eff = 0.45, 35 red cells, r = 9) for each delta kernel and vertex update:
# runs 1.2 strain units per case and prints whether it stayed stable and the largest vertex speed at the end.
# usage: perf/stability_dense.sh [PROGRAM] ; about two minutes a case on one core. The limits in physics/units.cpp come from this table.
# kappa_alpha/eta_0 = 6 * 0.003 * C. The program refuses C beyond its limits: raise them in stiffness_limits() to look further.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
program=${1:-$root/build/release/app/corpuscle}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '%-9s %-7s %-22s %s\n' update points kappa_alpha/eta_0 result
while read -r update points dilation; do
  result=stable
  "$program" run "$root/scenes/paper_phi45.toml" --set accuracy.radius=9 --set accuracy.shear_modulus=0.003 --set flow.reynolds_number_max=0.1 --output "$work/case" --overwrite --set cells.0.count=35 --set "box.size=[5,5,6]" \
    --set output.snapshot_every=0 --set output.series_every=0.01 --set run.strain=1.2 --set accuracy.vertex_update="$update" \
    --set accuracy.delta_kernel="$points" --set cells.0.membrane.area_dilation="$dilation" >"$work/log" 2>&1 ||
    result=$(grep -o 'before step [0-9]*' "$work/log" | sed 's/before/unstable before/' || tail -1 "$work/log")
  printf '%-9s %-7s %-22s %s\n' "$update" "$points" "$(awk -v c="$dilation" 'BEGIN { printf "%.2f", 6 * 0.003 * c }')" "$result"
done <<'CASES'
euler 2 5
euler 3 33
euler 4 222
averaged 2 333
averaged 3 333
averaged 4 333
CASES
