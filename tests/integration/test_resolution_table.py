"""The table of the expected error is what the studies in docs/accuracy say: PROGRAM SOURCE-FOLDER."""
import pathlib
import subprocess
import sys

sys.exit(subprocess.run([sys.executable, pathlib.Path(sys.argv[2]) / "report/resolution_table.py", "--check"]).returncode)
