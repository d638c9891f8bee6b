"""Runs the cells of python/notebooks, each notebook in a process of its own, and fails where one raises. Without matplotlib: skipped.

usage: PYTHONPATH=build/release/python notebooks_test.py FOLDER
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

try:
    import matplotlib  # noqa: F401
except ImportError:
    print("python3-matplotlib is not installed: skipped")
    sys.exit(77)

notebooks = sorted(pathlib.Path(sys.argv[1]).glob("*.ipynb"))
assert len(notebooks) >= 3, notebooks
failed = 0
for notebook in notebooks:
    cells = [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in cells), f"{notebook.name} holds outputs: clear them"
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder) / (notebook.stem + ".py")
        script.write_text("\n\n".join("".join(cell["source"]) for cell in cells))
        begun = time.monotonic()
        done = subprocess.run([sys.executable, script], cwd=folder, env=os.environ | {"MPLBACKEND": "Agg"}, capture_output=True, text=True)
    print(f"{notebook.name}: {'done' if done.returncode == 0 else 'FAILED'} in {time.monotonic() - begun:.1f} s\n{done.stdout}", end="")
    if done.returncode != 0:
        print(done.stderr)
        failed += 1
sys.exit(failed > 0)
