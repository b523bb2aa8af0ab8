"""Maps from capture joints to frames."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, Union

from .._kinopt.retargeting import Capture, map_completed, map_guessed, map_of_skeleton, skeleton_joints, unfinished
from ..errors import FileError, InvalidFileError, InvalidValueError
from .targets import Target

MapLike: TypeAlias = Union[Mapping[str, Any], str, "os.PathLike[str]", None]
"""A map as a dict, the path of its file, the name of a skeleton, or None for a guess."""


#: Largest size of a map file, bytes.
MAX_BYTES = 1 << 28


@dataclass(frozen=True)
class MapGuess:
    """A guessed map, with the recognised skeleton and body."""

    map: dict[str, Any]
    """The map, in the form of its file."""
    skeleton: str | None
    """Known skeleton with the joint names of the capture: "cmu", "lafan1", "mixamo" or "smpl"."""
    body: str | None
    """Known body with the frame names of the target: "g1", "h1", "humanoid" or "nao"."""
    notes: list[str]
    """Notes for review: parts that only one of both has, and implausible proportions."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the map as a file, which can be edited by hand.

        Raises ``FileError`` if it cannot be written.
        """
        try:
            # Written next to the target of a symbolic link, then renamed.
            real = Path(os.path.realpath(path))
            part = unfinished(real)
            part.write_text(json.dumps(self.map, indent=2) + "\n", encoding="utf-8")
            part.replace(real)
        except OSError as error:
            raise FileError(f"{path}: cannot be written: {error}") from None


def guess_map(capture: Capture, target: Target, skeleton: str | None = None) -> MapGuess:
    """Guesses which joint of a capture drives which frame of a robot or a rig.

    Known skeletons and bodies are recognised by their names; otherwise by the meaning of names such as ``LeftUpLeg``,
    ``l_thigh`` and ``left_hip_pitch_link``. ``skeleton`` names the known skeleton of the capture.

    Raises ``InvalidValueError`` for names without a recognisable body and for a capture of another skeleton,
    ``UnknownNameError`` for an unknown skeleton.
    """
    guessed = map_guessed(capture, target) if skeleton is None else map_of_skeleton(skeleton, capture, target)
    text, known, body, notes = guessed
    return MapGuess(json.loads(text), known, body, notes)


def completed(map: dict[str, Any], capture: Capture, target: Target) -> tuple[dict[str, Any], list[str]]:
    """A map, with guessed drives if it has none for the target, and notes for review.

    Raises the errors of ``guess_map`` if there are none, and ``InvalidValueError`` for an invalid map.
    """
    text, notes = map_completed(json.dumps(map), capture, target)
    return map if text is None else json.loads(text), notes


@contextmanager
def naming(map: MapLike) -> Iterator[None]:
    """Prefixes messages about the map with the name of its file."""
    try:
        yield
    except InvalidValueError as error:
        if isinstance(map, (str, os.PathLike)) and getattr(error, "_of_map", False):
            raise type(error)(f"{os.fspath(map)}: {error}") from None
        raise


def is_skeleton(map: MapLike) -> bool:
    """True if a map is the name of a skeleton: it has no file extension and no folder."""
    if not isinstance(map, str) or Path(map).suffix or os.sep in map:
        return False
    # Raises an error for an unknown skeleton.
    skeleton_joints(map, 0)
    return True


def read_map(map: MapLike) -> dict[str, Any] | None:
    """A map as a dict; None if it has to be guessed."""
    if map is None or is_skeleton(map):
        return None
    if isinstance(map, Mapping):
        return dict(map)
    try:
        path = Path(map)
        if path.stat().st_size > MAX_BYTES:
            raise InvalidFileError(f"{map}: is larger than {MAX_BYTES} bytes")
        read = json.loads(path.read_text(encoding="utf-8"))
    except RecursionError:
        raise InvalidFileError(f"{map}: is nested too deeply") from None
    except OSError as error:
        raise FileError(f"{map}: cannot be read: {error}") from None
    except ValueError as error:
        raise InvalidFileError(f"{map}: {error}") from None
    if not isinstance(read, dict):
        raise InvalidFileError(f"{map}: a map must be an object")
    return read


__all__ = ["MapGuess", "MapLike", "guess_map", "read_map"]
