#!/usr/bin/python3
"""Runs the code cells of notebooks, each notebook in a folder of its own that has cases/ as the repository has.

usage: run_notebooks.py NOTEBOOK...

A line that ends with `# test: CODE` is replaced by CODE, so that a notebook that takes minutes is tested in seconds.
"""

import json
import os
import pathlib
import re
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]
failed = False
for name in [str(pathlib.Path(given).resolve()) for given in sys.argv[1:]]:
    notebook = json.loads(pathlib.Path(name).read_text())
    names = {"__name__": "__main__"}
    with tempfile.TemporaryDirectory(prefix="talus_notebook_") as folder:
        os.symlink(root / "cases", pathlib.Path(folder) / "cases")
        os.chdir(folder)
        for number, cell in enumerate(notebook["cells"], 1):
            if cell["cell_type"] != "code":
                continue
            code = re.sub(r"^(\s*).*# test: (.*)$", r"\1\2", "".join(cell["source"]), flags=re.M)
            try:
                exec(compile(code, f"{pathlib.Path(name).name}, cell {number}", "exec"), names)
            except Exception:
                import traceback

                traceback.print_exc()
                failed = True
                break
        os.chdir(root)
sys.exit(failed)
