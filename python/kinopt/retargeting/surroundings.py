"""Terrain under a retargeted motion, and objects in the hands of its subject."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Union

import numpy as np

TerrainLike = Union[dict[str, Any], str, "os.PathLike[str]"]
"""A terrain: a dict with ``patches``, or a .json file."""
HeldObjectLike = Union[dict[str, Any], str, "os.PathLike[str]"]
"""A held object: a dict with ``shape`` and ``poses``, or a .json file."""


def terrain_json(terrain: TerrainLike | None) -> str | None:
    """JSON of a terrain."""
    return None if terrain is None else _json(terrain)


def held_object_json(held_object: HeldObjectLike | None) -> str | None:
    """JSON of a held object; ``poses`` may be an array."""
    if isinstance(held_object, dict) and "poses" in held_object:
        held_object = {**held_object, "poses": np.asarray(held_object["poses"], dtype=float).tolist()}
    return None if held_object is None else _json(held_object)


def _json(given: dict[str, Any] | str | os.PathLike[str]) -> str:
    return json.dumps(given) if isinstance(given, dict) else Path(given).read_text(encoding="utf-8")
