"""Which joint of a capture drives which frame."""

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
"""A map as a dict, the path of its file, the name of a skeleton, or None where it is to be guessed."""


#: Size of the largest map that is read.
MAX_BYTES = 1 << 28


@dataclass(frozen=True)
class MapGuess:
    """A map that was guessed, and by what."""

    map: dict[str, Any]
    """The map, as its file has it."""
    skeleton: str | None
    """The known skeleton whose names the capture has: "cmu", "lafan1", "mixamo" or "smpl"."""
    body: str | None
    """The known body whose frames the target has: "g1", "h1", "humanoid" or "nao"."""
    notes: list[str]
    """What is to be looked at: parts that one of both has not, and proportions that are no body's."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the map as a file that can be corrected by hand.

        Raises ``FileError`` where it cannot be written.
        """
        try:
            # Beside the file that a link leads to, then renamed.
            real = Path(os.path.realpath(path))
            part = unfinished(real)
            part.write_text(json.dumps(self.map, indent=2) + "\n", encoding="utf-8")
            part.replace(real)
        except OSError as error:
            raise FileError(f"{path}: cannot be written: {error}") from None


def guess_map(capture: Capture, target: Target, skeleton: str | None = None) -> MapGuess:
    """Guesses which joint of a capture drives which frame of a robot or a rig.

    Known skeletons and bodies are told by their names; else it goes by what names tell, as ``LeftUpLeg``, ``l_thigh`` and
    ``left_hip_pitch_link`` do. ``skeleton`` says which known one the capture is of.

    Raises ``InvalidValueError`` for names that tell of no body and a capture of another skeleton, ``UnknownNameError``
    for a skeleton that there is not.
    """
    guessed = map_guessed(capture, target) if skeleton is None else map_of_skeleton(skeleton, capture, target)
    text, known, body, notes = guessed
    return MapGuess(json.loads(text), known, body, notes)


def completed(map: dict[str, Any], capture: Capture, target: Target) -> tuple[dict[str, Any], list[str]]:
    """A map, with drives by names where it has none of the target, and what is to be looked at.

    Raises what ``guess_map`` does where there are none, and ``InvalidValueError`` for what is wrong with the map.
    """
    text, notes = map_completed(json.dumps(map), capture, target)
    return map if text is None else json.loads(text), notes


@contextmanager
def naming(map: MapLike) -> Iterator[None]:
    """Puts the name of a map's file before messages about the map."""
    try:
        yield
    except InvalidValueError as error:
        if isinstance(map, (str, os.PathLike)) and getattr(error, "_of_map", False):
            raise type(error)(f"{os.fspath(map)}: {error}") from None
        raise


def is_skeleton(map: MapLike) -> bool:
    """Whether a map is the name of a skeleton: what ends as no file does."""
    if not isinstance(map, str) or Path(map).suffix or os.sep in map:
        return False
    # Which raises for one that there is not.
    skeleton_joints(map, 0)
    return True


def read_map(map: MapLike) -> dict[str, Any] | None:
    """A map as a dict; None where there is none yet."""
    if map is None or is_skeleton(map):
        return None
    if isinstance(map, Mapping):
        return dict(map)
    try:
        path = Path(map)
        if path.stat().st_size > MAX_BYTES:
            raise InvalidFileError(f"{map}: is longer than {MAX_BYTES} bytes")
        read = json.loads(path.read_text(encoding="utf-8"))
    except RecursionError:
        raise InvalidFileError(f"{map}: is nested too deep") from None
    except OSError as error:
        raise FileError(f"{map}: cannot be read: {error}") from None
    except ValueError as error:
        raise InvalidFileError(f"{map}: {error}") from None
    if not isinstance(read, dict):
        raise InvalidFileError(f"{map}: a map is an object")
    return read


__all__ = ["MapGuess", "MapLike", "guess_map", "read_map"]
