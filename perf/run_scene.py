"""Runs the program on a scene for the scripts of this folder: one thread, in a folder of theirs."""

import os
import subprocess


def run_scene(program, folder, scene, settings=None):
    """Writes FOLDER/scene.toml, runs it into FOLDER/run, replacing what is there, with `settings` as --set; returns the ended process with what it printed."""
    path = os.path.join(folder, "scene.toml")
    with open(path, "w") as file:
        file.write(scene)
    command = [program, "run", path, "--output", os.path.join(folder, "run"), "--overwrite", "--threads", "1"]
    for key, value in (settings or {}).items():
        command += ["--set", f"{key}={value}"]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1", "OMP_PROC_BIND": "false"})
