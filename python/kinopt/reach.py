"""Files and pages of reach maps; ``ReachMap.save``, ``load`` and ``page`` call them."""

from __future__ import annotations

import base64
import json
import os
import zipfile
from typing import Any

import numpy as np

from ._kinopt import ReachMap
from .errors import FileError, InvalidFileError, InvalidValueError
from .extras import load
from .types import Floats

#: Version of the arrays in files.
_VERSION = 1
_ENDINGS = (".npz", ".arrow")


def save(reach_map: ReachMap, path: str | os.PathLike[str]) -> None:
    """Writes a map to a .npz or .arrow file."""
    arrays = reach_map.arrays()
    try:
        if _ending(path) == ".npz":
            contents: dict[str, Any] = {"version": np.array([_VERSION]), **arrays}
            np.savez_compressed(path, **contents)
            return
        pa = load("pyarrow", "tables", "save()")
        load("pyarrow.ipc", "tables", "save()")
        # One row, with a list for each array: the arrays differ in length.
        columns = {name: _list_of(pa, values) for name, values in arrays.items()}
        table = pa.table(columns).replace_schema_metadata({"kinopt reach map": str(_VERSION)})
        with pa.OSFile(os.fspath(path), "wb") as sink, pa.ipc.new_file(sink, table.schema) as writer:
            writer.write_table(table)
    except OSError as error:
        raise FileError(f"{os.fspath(path)}: {error}") from error


def _list_of(pa: Any, values: Any) -> Any:
    """An Arrow array with one list, the values."""
    return pa.LargeListArray.from_arrays(pa.array([0, len(values)], pa.int64()), pa.array(values))


def load_map(path: str | os.PathLike[str]) -> ReachMap:
    """Reads a map from a .npz or .arrow file of ``save``."""
    name = os.fspath(path)
    try:
        if _ending(path) == ".npz":
            with np.load(path, allow_pickle=False) as file:
                return _of_arrays(name, dict(file), file["version"][0] if "version" in file else None)
        pa = load("pyarrow", "tables", "load()")
        load("pyarrow.ipc", "tables", "load()")
        with pa.memory_map(name) as source:
            table = pa.ipc.open_file(source).read_all().combine_chunks()
            version = (table.schema.metadata or {}).get(b"kinopt reach map")
            arrays = {
                column: np.array(table[column].chunk(0).values.to_numpy(zero_copy_only=False)) for column in table.column_names
            }
            return _of_arrays(name, arrays, int(version) if version else None)
    except (ValueError, zipfile.BadZipFile, KeyError, AttributeError) as error:
        if isinstance(error, (InvalidFileError, InvalidValueError)):
            raise
        raise InvalidFileError(f"{name}: no reach map: {error}") from error
    except OSError as error:
        raise FileError(f"{name}: {error}") from error


def _of_arrays(name: str, arrays: dict[str, Any], version: Any) -> ReachMap:
    if version != _VERSION:
        raise InvalidFileError(f"{name}: no reach map of version {_VERSION}")
    try:
        return ReachMap.from_arrays(arrays)
    except InvalidValueError as error:
        raise InvalidFileError(f"{name}: {error}") from error


def _ending(path: str | os.PathLike[str]) -> str:
    ending = os.path.splitext(os.fspath(path))[1].lower()
    if ending not in _ENDINGS:
        raise InvalidValueError(f"a reach map is saved as {' or '.join(_ENDINGS)}, not {ending!r}")
    return ending


def cube_centres(reach_map: ReachMap) -> tuple[Floats, Floats, Floats]:
    """Coordinates of the centres of the cubes along x, y and z, metres."""
    count = reach_map.cubes_per_axis
    offsets = reach_map.position_step * (np.arange(count) - 0.5 * (count - 1))
    x, y, z = (centre + offsets for centre in reach_map.centre)
    return x, y, z


def write_page(reach_map: ReachMap, path: str | os.PathLike[str]) -> None:
    """Writes an HTML page with a slider through the planes of a map."""
    x, y, z = cube_centres(reach_map)
    positions = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    shares = np.round(255 * reach_map.orientation_shares(positions)).astype(np.uint8)
    data = {
        "count": reach_map.cubes_per_axis,
        "step": reach_map.position_step,
        "centre": [float(value) for value in reach_map.centre],
        "title": repr(reach_map),
        "shares": base64.b64encode(shares.tobytes()).decode(),
    }
    text = _PAGE.replace("DATA", json.dumps(data).replace("<", "\\u003c"))
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise FileError(f"{os.fspath(path)}: {error}") from error


_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Reach map</title>
<style>
body { font: 15px system-ui, sans-serif; margin: 2em auto; max-width: 46em; color: #222 }
canvas { width: 100%; image-rendering: pixelated; border: 1px solid #ccc }
label { margin-right: 1.5em } input[type=range] { width: 100% }
#bar { height: 12px; background: linear-gradient(to right, #fff, #0072B2) }
</style></head><body>
<h1>Reach map</h1><p id="title"></p>
<p><label>Plane <select id="plane"><option>xz<option>xy<option>yz</select></label>
<label><input id="proofs" type="checkbox"> share of orientations proven unreachable</label></p>
<input id="slider" type="range" min="0" aria-label="position of the plane"><p id="at"></p>
<canvas id="canvas"></canvas><p id="cell">Point at a cell.</p>
<div id="bar"></div><p>0 % to 100 % of the orientations</p>
<script>
const map = DATA, n = map.count, $ = id => document.getElementById(id);
const shares = Uint8Array.from(atob(map.shares), c => c.charCodeAt(0));
const axes = { xz: [0, 2, 1], xy: [0, 1, 2], yz: [1, 2, 0] };
const metres = (axis, k) => map.centre[axis] + map.step * (k - (n - 1) / 2);
const canvas = $("canvas"), slider = $("slider"), paint = canvas.getContext("2d");
canvas.width = canvas.height = n; slider.max = n - 1; slider.value = (n - 1) / 2; $("title").textContent = map.title;
const cell = (column, row) => {
  const index = [0, 0, 0], [across, up, third] = axes[$("plane").value];
  index[across] = column; index[up] = n - 1 - row; index[third] = +slider.value;
  return [index, 2 * ((index[0] * n + index[1]) * n + index[2])];
};
function draw() {
  const image = paint.createImageData(n, n), offset = $("proofs").checked ? 1 : 0;
  for (let row = 0; row < n; row++) for (let column = 0; column < n; column++) {
    const share = shares[cell(column, row)[1] + offset] / 255, at = 4 * (row * n + column);
    image.data.set([255 - 255 * share, 255 - 141 * share, 255 - 77 * share, 255], at);
  }
  paint.putImageData(image, 0, 0);
  const third = axes[$("plane").value][2];
  $("at").textContent = `${"xyz"[third]} = ${metres(third, +slider.value).toFixed(3)} m`;
}
for (const id of ["plane", "proofs", "slider"]) $(id).addEventListener("input", draw);
canvas.addEventListener("mousemove", event => {
  const box = canvas.getBoundingClientRect(), limit = k => Math.min(n - 1, Math.max(0, Math.floor(k)));
  const [index, at] = cell(limit((event.clientX - box.left) / box.width * n), limit((event.clientY - box.top) / box.height * n));
  const position = index.map((k, axis) => metres(axis, k).toFixed(3)).join(", ");
  const percent = k => `${Math.round(shares[at + k] / 2.55)} %`;
  $("cell").textContent = `(${position}) m: ${percent(0)} reached, ${percent(1)} proven unreachable`;
});
draw();
</script></body></html>
"""

__all__ = ["cube_centres", "load_map", "save", "write_page"]
