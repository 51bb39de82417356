#!/usr/bin/env bash
# What stiff membranes cost and what they change: 12 red cells at Ca = 4.2e-5 (r = 6, 3 points, phi_eff about 0.45), the same packing sheared with larger and larger time steps.
# The capillary number ties kappa_S to the shear rate: ten times the stiffness is a tenth of the steps. Prints steps per strain unit, seconds per strain unit, and the viscosity.
# usage: perf/stiff_membranes.sh [PROGRAM] [STRAIN, default 0.5]; two minutes on two idle cores
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
program=${1:-$root/build/release/app/corpuscle}
strain=${2:-0.5}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/scene.toml" <<'SCENE'
[box]
size = [3.5, 3.5, 4.2]
[flow]
capillary_number = 4.2e-5
reynolds_number_max = 0.2
[[cells]]
count = 12
[accuracy]
radius = 6
delta_kernel = 3
collision = "bgk"
allow_unstable = true
[output]
series_every = 0.002
snapshot_every = 0
SCENE
"$program" run "$work/scene.toml" --output "$work/pack" --set accuracy.shear_modulus=0.2 --set run.steps=1 >/dev/null 2>&1
printf '%-10s %-10s %-14s %-13s %-13s %-10s %s\n' update membrane kappa_S/eta_0 steps/strain s/strain Re 'relative viscosity'
while read -r update precision kappa; do
  "$program" run "$work/scene.toml" --output "$work/case" --overwrite --set run.packing="$work/pack/packing.h5" --set run.strain="$strain" --set accuracy.vertex_update="$update" \
    --set accuracy.shear_modulus="$kappa" --set accuracy.membrane_precision="$precision" >/dev/null 2>"$work/log" || { printf '%-10s %-14s %s\n' "$update" "$kappa" "$(tail -1 "$work/log")"; continue; }
  python3 - "$work/case/summary.json" "$update" "$precision" "$kappa" "$strain" <<'PRINT'
import json, sys
s = json.load(open(sys.argv[1]))
strain = float(sys.argv[5])
print(f"{sys.argv[2]:<10} {sys.argv[3]:<10} {float(sys.argv[4]) * 6:<14.3g} {s['steps'] / strain:<13.0f} {s['wall_seconds'] / strain:<13.1f} {s['reynolds_number']:<10.2g} "
      f"{s['relative_viscosity']:.2f} +- {s['relative_viscosity_error'] or 0:.2f}")
PRINT
done <<'CASES'
averaged double 0.2
averaged double 0.8
averaged single 0.8
chebyshev double 0.8
chebyshev double 2
chebyshev double 4
chebyshev double 8
chebyshev single 4
chebyshev single 8
CASES
