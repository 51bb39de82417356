#!/bin/bash
# Bad input given to the real program: exit code 2, one line "error: ..." on stderr that names what is wrong, and no output directory.
# Arguments: program, python (unused), source folder. The unit test test_scene_bad.cpp has the complete list of bad scenes.
set -u
program=$1
source=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# check NAME PATTERN ARGUMENTS...: the program with these arguments must refuse, with PATTERN (extended regular expression) in its message.
check() {
  local name=$1 pattern=$2
  shift 2
  timeout 60 "$program" "$@" >"$work/stdout" 2>"$work/stderr" </dev/null
  local code=$? problem=""
  [ "$code" -eq 2 ] || problem="$problem exit code $code instead of 2;"
  [ "$(wc -l <"$work/stderr")" -eq 1 ] || problem="$problem $(wc -l <"$work/stderr") lines on stderr instead of 1;"
  grep -q '^error: ' "$work/stderr" || problem="$problem no line 'error: ...';"
  grep -Eq -- "$pattern" "$work/stderr" || problem="$problem the message lacks /$pattern/;"
  [ ! -e "$work/out" ] || problem="$problem the output directory was created;"
  rm -rf "$work/out"
  if [ -n "$problem" ]; then
    failures=$((failures + 1))
    echo "FAILED $name:$problem"
    sed 's/^/    /' "$work/stderr"
  fi
}

# scene NAME PATTERN [ARGUMENTS...] with the scene on stdin.
scene() {
  local name=$1 pattern=$2
  shift 2
  cat >"$work/$name.toml"
  check "$name" "$pattern" run "$work/$name.toml" --output "$work/out" "$@"
}

box='[box]
size = [6, 6, 6]'
flow='[flow]
capillary_number = 0.1'
cells='[[cells]]
count = 2'

# The file as such
check missing_scene 'no_such.toml.*no such' run "$work/no_such.toml" --output "$work/out"
check directory_as_scene 'directory' run "$work" --output "$work/out"
scene empty 'empty' </dev/null
head -c 4096 "$program" | scene binary 'text file'
printf '[box]\nsize = [6, 6' | scene truncated 'truncated.toml:2: .*TOML'
printf '%s\nwalls = true\nwalls = false\n' "$box" | scene duplicate_key 'walls'
printf '%s\n[run]\nseed = 123456789012345678901234567890\n' "$box" | scene huge_integer 'huge_integer.toml:4'

# Keys and types
printf '%s\n[flow]\ncapilary_number = 0.1\n%s\n' "$box" "$cells" | scene unknown_key 'flow.capilary_number.*flow.capillary_number'
printf '%s\n[fluid]\nkind = 1\n' "$box" | scene unknown_table 'fluid.*nearest'
printf '[box]\nsize = "big"\n' | scene string_for_numbers 'box.size = "big".*3 numbers'
printf '%s\n[accuracy]\nradius = "8"\n' "$box" | scene string_for_number 'accuracy.radius = "8".*number'
printf '%s\n%s\n[cells]\ncount = 2\n' "$box" "$flow" | scene cells_table '\[\[cells\]\]'
printf '%s\n%s\n[[cells]]\ncount = 2.5\n' "$box" "$flow" | scene fractional_count 'cells.0.count = 2.5.*whole number'

# Values
printf '[box]\nsize = [6, -6, 6]\n' | scene negative_size 'box.size\[1\] = -6.*> 0'
printf '[box]\nsize = [6, nan, 6]\n' | scene nan_size 'box.size\[1\] = nan'
printf '[box]\nsize = [6, inf, 6]\n' | scene infinite_size 'box.size\[1\] = inf'
printf '[box]\nsize = [1e300, 6, 6]\n' | scene huge_size 'box.size\[0\] = 1e\+300'
printf '%s\n[flow]\ncapillary_number = -1\n%s\n' "$box" "$cells" | scene negative_ca 'flow.capillary_number = -1.*> 0'
printf '%s\n%s\n[[cells]]\ncount = 0\n' "$box" "$flow" | scene no_cells 'cells.0.count = 0.*>= 1'
printf '%s\n[run]\nseed = -3\n' "$box" | scene negative_seed 'run.seed = -3.*>= 0'
printf '%s\n[accuracy]\ndelta_kernel = 5\n' "$box" | scene delta_kernel 'accuracy.delta_kernel = 5.*nearest allowed value is 4'
printf '%s\n[accuracy]\nrelaxation_time = 0.5\n' "$box" | scene unstable_tau 'accuracy.relaxation_time = 0.5.*0.505'
printf '%s\n[accuracy]\nmach_max = 0.5\n' "$box" | scene fast 'accuracy.mach_max = 0.5.*0.3'
printf '%s\n[flow]\nkind = "sheer"\n' "$box" | scene unknown_flow 'flow.kind = "sheer".*shear, poiseuille, rest'
printf '%s\n[accuracy]\npreset = "fast"\n' "$box" | scene unknown_preset 'accuracy.preset = "fast".*draft, standard, reference'
printf '%s\n%s\n%s\nshape = "cube"\n' "$box" "$flow" "$cells" | scene unknown_shape 'cells.0.shape = "cube".*red_cell'
printf '%s\n%s\n%s\nmembrane = { law = "hooke" }\n' "$box" "$flow" "$cells" | scene unknown_law 'cells.0.membrane.law = "hooke".*skalak'

# Contradictions and limits
printf '%s\n%s\n%s\nvolume_fraction = 0.1\n' "$box" "$flow" "$cells" | scene two_amounts 'cells.0.volume_fraction = 0.1.*cells.0.count = 2'
printf '%s\n%s\ncapillary_number_G = 0.3\n%s\n' "$box" "$flow" "$cells" | scene two_ca 'capillary_number_G = 0.3'
printf '%s\n%s\n' "$box" "$cells" | scene no_ca 'flow.capillary_number is missing'
printf '[box]\nwalls = false\n' | scene shear_without_walls 'box.walls = false.*shear'
printf '%s\n[flow]\nkind = "rest"\n' "$box" | scene rest_without_steps 'run.steps is missing'
printf '[box]\nsize = [6, 1.5, 6]\n%s\n%s\n' "$flow" "$cells" | scene narrow_box 'box.size\[1\] = 1.5.*>= 2'
printf '%s\n%s\n[[cells]]\nvolume_fraction = 0.9\n' "$box" "$flow" | scene too_full 'cells.0.volume_fraction = 0.9.*0.78'
printf '%s\n%s\n[[cells]]\ncount = 130\n' "$box" "$flow" | scene too_many 'cells.0.count = 130.*pack'
printf '%s\n%s\n%s\n[accuracy]\nshear_modulus = 5\n' "$box" "$flow" "$cells" | scene unstable_membrane 'accuracy.shear_modulus = 5 .*must be <= '

# Files named in the scene
printf 'OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n' >"$work/open.off"
printf 'OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 0 1 4\n' >"$work/fin.off"
printf '%s\n%s\n%s\nfile = "none.off"\n' "$box" "$flow" "$cells" | scene missing_mesh 'none.off.*no such file'
printf '%s\n%s\n%s\nfile = "open.off"\n' "$box" "$flow" "$cells" | scene open_mesh 'open.off'
printf '%s\n%s\n%s\nfile = "fin.off"\n' "$box" "$flow" "$cells" | scene non_manifold_mesh 'fin.off'
printf '%s\n%s\n%s\n[run]\npacking = "none.h5"\n' "$box" "$flow" "$cells" | scene missing_packing 'none.h5.*no such file'

# Command line
good=$source/scenes/couette.toml
check override_key 'flow.reynolds_max.*flow.reynolds_number_max' run "$good" --output "$work/out" --set flow.reynolds_max=0.1
check override_value 'accuracy.radius = "huge"' run "$good" --output "$work/out" --set accuracy.radius=huge
check override_form 'key=value' run "$good" --output "$work/out" --set accuracy.radius
check override_cell 'cells' run "$good" --output "$work/out" --set cells.0.count=3
touch "$work/file"
check unwritable_output 'file' run "$good" --output "$work/file/out"  # a permission bit wouldn't stop root
check plan_missing 'no such' plan "$work/no_such.toml"

if [ "$failures" -gt 0 ]; then
  echo "$failures checks failed"
  exit 1
fi
echo "all bad inputs were refused"
