"""The job script of docs/cluster.md with an sbatch of our own: the run comes to its end in several jobs. Arguments: PROGRAM SOURCE-FOLDER."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from kills import SCENE, command, differences


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    page = (source / "docs/cluster.md").read_text()
    script = page.split("```sh\n")[1].split("```")[0]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "job.sh").write_text(script)
        (folder / "sbatch").write_text('#!/bin/bash\necho "$@" >> "$FOLDER/submitted"\n')
        (folder / "sbatch").chmod(0o755)
        (folder / "scene.toml").write_text(SCENE.format(steps=1501, checkpoint_steps=1000))
        command(program, "run", folder / "scene.toml", "--output", folder / "reference", "--threads", 1)
        environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "FOLDER": str(folder), "CORPUSCLE": program, "SCENE": str(folder / "scene.toml"),
                       "OUTPUT": str(folder / "out"), "WALL_TIME": "00:00:02", "JOB": str(folder / "job.sh"), "SLURM_CPUS_PER_TASK": "2"}
        jobs = 0
        while True:
            jobs += 1
            (folder / "submitted").unlink(missing_ok=True)
            result = subprocess.run(["bash", folder / "job.sh"], env=environment, capture_output=True, text=True)
            if jobs == 1 and not list((folder / "out").glob("checkpoint-*.h5")):  # a slow machine was still packing
                environment["WALL_TIME"] = "00:00:30"
                continue
            assert result.returncode == 0, result.stderr
            assert jobs < 100
            if not (folder / "submitted").exists():
                break
            assert (folder / "submitted").read_text().split() == ["--export=ALL", str(folder / "job.sh")]
        assert json.loads((folder / "out/summary.json").read_text())["stopped_by"] == "end"
        different, compared = differences(folder / "reference", folder / "out")
        assert not different, different
        print(f"{jobs} jobs, {compared} datasets are equal bit for bit")


if __name__ == "__main__":
    main()
