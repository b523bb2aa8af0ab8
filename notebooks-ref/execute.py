"""Executes notebooks without display, in place or only for their output files.

    python execute.py [--keep] NOTEBOOK …    --keep leaves the notebook files unchanged
"""

import os
import pathlib
import sys
import time

import nbclient
import nbformat

HERE = pathlib.Path(__file__).resolve().parent


def execute(name, keep):
    path = HERE / name
    notebook = nbformat.read(path, as_version=4)
    os.environ.pop("MPLBACKEND", None)  # figures go into the notebook by its own backend
    begun = time.monotonic()
    client = nbclient.NotebookClient(notebook, timeout=900, kernel_name="python3", resources={"metadata": {"path": str(HERE)}},
                                     extra_arguments=["--log-level=ERROR"])
    client.execute()
    print(f"{name}: {time.monotonic() - begun:.0f} s", flush=True)
    if not keep:
        for cell in notebook.cells:
            cell.metadata.pop("execution", None)  # times of day would change with every run
        notebook.metadata.get("language_info", {}).pop("version", None)
        nbformat.write(notebook, path)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    for name in arguments:
        if name != "--keep":
            execute(name, "--keep" in arguments)
