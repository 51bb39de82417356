"""What `corpuscle plan` says of models that a scene can do without is what docs/model_effects.json holds: never less than measured, at most a fifth more. Arguments: PROGRAM SOURCE-FOLDER."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
measured = json.loads((source / "docs/model_effects.json").read_text(encoding="utf-8"))
PHI, CA, SHAPE = "cells.0.effective_volume_fraction", "flow.capillary_number", "cells.0.shape"
SCENE = """
[box]
size = [6, 6, 6]
[flow]
capillary_number = {ca}
reynolds_number_max = 0.2
[accuracy]
radius = 5
[[cells]]
shape = "{shape}"
effective_volume_fraction = {phi}
[run]
strain = 1
"""


def plan(phi, ca, shape):
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder, "scene.toml")
        scene.write_text(SCENE.format(phi=phi, ca=ca, shape=shape))
        json_text = subprocess.run([program, "plan", scene, "--json"], capture_output=True, text=True, check=True).stdout
        text = subprocess.run([program, "plan", scene], capture_output=True, text=True, check=True).stdout
    return {model["left_out_by"]: model for model in json.loads(json_text)["not_needed"]}, text


def bound(row, name):
    return abs(row[f"{name}_change"]) + 2 * (row[f"{name}_change_error"] if math.isfinite(row[f"{name}_change_error"]) else 0)


def row_of(study, phi, ca, shape):
    return next(row for row in measured[study] if row.get(PHI, 0.3) == phi and row.get(CA, 0.08) == ca and row.get(SHAPE, "red_cell") == shape)


failures = 0
for study, phi, ca, shape, key, needed in (
    ("contact", 0.1, 0.08, "red_cell", "contact.enabled=false", False),
    ("contact", 0.45, 0.01, "red_cell", "contact.enabled=false", True),
    ("precision", 0.3, 0.08, "red_cell", "accuracy.membrane_precision=single", False),
):
    said, text = plan(phi, ca, shape)
    row = row_of(study, phi, ca, shape)
    good = (key in said) != needed and (key in text) != needed
    if good and not needed:
        for name in ("viscosity", "deformation"):
            least = bound(row, name)
            good = good and least <= said[key][f"{name}_change"] <= max(1.2 * least, 0.0011)
    failures += not good
    print(f"{'ok' if good else 'FAILED'}: {study} at phi_eff = {phi}, Ca = {ca}: measured {bound(row, 'viscosity'):.2g}, {bound(row, 'deformation'):.2g}; plan says {said.get(key)}")
sys.exit(failures > 0)
