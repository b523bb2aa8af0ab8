"""The programs of examples/python run, fit on a page, and list their dependencies for `uv run`."""

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "python"
# A job for a cluster, which test_ray.py runs.
PROGRAMS = sorted(path for path in FOLDER.glob("*.py") if path.name != "reachability.py")
MODULES = {"kinopt[plot]": "matplotlib", "kinopt[tables]": "pyarrow", "kinopt[torch]": "torch", "kinopt[view]": "viser"}
# The window of the viewer closes at once.
VIEWER = "import runpy, kinopt.view as view; view.Scene.wait = view.Scene.close; runpy.run_path({!r})"


def dependencies(program):
    block = re.match(r'# /// script\n# dependencies = \[(.*)\]\n# tool\.uv\.sources\.kinopt = .*\n# ///\n"""', program.read_text())
    assert block, f"{program.name} begins with its dependencies and a docstring"
    return re.findall(r'"([^"]+)"', block[1])


def test_examples_are_a_dozen():
    assert len(PROGRAMS) >= 12


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_example_runs(program, tmp_path):
    assert len(program.read_text().splitlines()) <= 40
    names = dependencies(program)
    assert names[0].startswith("kinopt")
    missing = [name for name in names if find_spec(MODULES.get(name, name.split("[")[0])) is None]
    if missing:
        pytest.skip(f"pip install {' '.join(missing)}")
    arguments = ["-c", VIEWER.format(str(program))] if program.stem == "viewer" else [str(program)]
    environment = {**os.environ, "BROWSER": "true", "MPLBACKEND": "Agg"}
    result = subprocess.run([sys.executable, *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
