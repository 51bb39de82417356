"""Peak memory of whole runs against what `corpuscle plan` says before: within 10 %. Arguments: PROGRAM SOURCE-FOLDER."""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

program = sys.argv[1]

# Some 100 MiB each, so that the program itself (20 MiB) decides nothing; few steps, so that packing and output count too.
SCENES = {
    "fluid with snapshots of its velocity": """
        [box]
        size = [10, 10, 10]
        [accuracy]
        radius = 10.6
        [run]
        steps = 4
        [output]
        fluid = true
        snapshot_every = 1e-4
    """,
    "cells packed to 20 %, contacts, snapshots": """
        [box]
        size = [10, 10, 10]
        [flow]
        capillary_number = 0.1
        [[cells]]
        volume_fraction = 0.2
        [accuracy]
        radius = 8
        [run]
        steps = 4
        [output]
        snapshot_every = 1e-4
    """,
    "dilute, double, chebyshev steps, no contact": """
        [box]
        size = [10, 10, 10]
        [flow]
        capillary_number = 0.1
        [contact]
        enabled = false
        [[cells]]
        volume_fraction = 0.05
        [accuracy]
        radius = 8
        precision = "double"
        vertex_update = "chebyshev"
        [run]
        steps = 4
    """,
}

failed = False
for name, scene in SCENES.items():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "scene.toml")
        path.write_text(scene)
        plan = json.loads(subprocess.run([program, "plan", path, "--json"], capture_output=True, text=True, check=True).stdout)
        subprocess.run([program, "run", path, "--output", Path(folder, "out")], capture_output=True, text=True, check=True)
        measured = json.loads(Path(folder, "out", "summary.json").read_text())["bytes_peak"]  # of this process, from the operating system
        predicted = plan["predicted_bytes_peak"]
    good = abs(predicted / measured - 1) < 0.1
    failed |= not good
    print(f"{'ok' if good else 'FAILED'}: {name}: {predicted / 2**20:.1f} MiB predicted, {measured / 2**20:.1f} MiB measured")
sys.exit(failed)
