"""Writes fixtures and compares regenerated ones with those that are committed."""

import datetime
import json
import os
import pathlib

import numpy as np

from models import REPOSITORY

COMMITTED = REPOSITORY / "tests" / "reference"
FOLDER = pathlib.Path(os.environ.get("KINOPT_FIXTURES", COMMITTED))


def write(name, tool, version, seed, source, units, **parts):
    """Writes one line per list entry, for readable differences. `source` is the notebook or script that calls it."""
    kind = "notebook" if source.endswith(".ipynb") else "script"
    provenance = {"tool": tool, "version": version, "date": datetime.date.today().isoformat(), "seed": seed,
                  kind: f"notebooks-ref/{source}", "units": units}
    dump = lambda value: json.dumps(value, separators=(",", ":"))
    lines = ['{"provenance":' + dump(provenance)]
    for key, value in parts.items():
        if isinstance(value, list):
            entries = ",\n".join(dump(entry) for entry in value)
            lines.append(f',\n"{key}":[\n{entries}\n]')
        else:
            lines.append(f',\n"{key}":{dump(value)}')
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / name
    path.write_text("".join(lines) + "}\n")
    return path


def read(folder, name):
    return json.loads((folder / name).read_text())


def differences(old, new, within, at=""):
    """Differences of two documents: numbers by more than `within`, and any difference of other values."""
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        for key in old:
            if (at, key) != ("", "provenance"):
                yield from differences(old[key], new[key], within, f"{at}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, within, f"{at}[{k}]")
    elif isinstance(old, float | int) and isinstance(new, float | int) and not isinstance(old, bool):
        if not abs(old - new) <= within * max(1.0, abs(old)):
            yield f"{at}: {old!r} has become {new!r}"
    elif old != new:
        yield f"{at}: {str(old)[:60]} has become {str(new)[:60]}"
