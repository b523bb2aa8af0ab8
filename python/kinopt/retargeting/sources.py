"""Captures from arrays, clips and files."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, Literal, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from .._kinopt import MotionCapture, Scene
from .._kinopt.animation import Clip
from .._kinopt.retargeting import Capture, skeleton_joints, skeleton_names
from ..errors import FileError, InvalidFileError, InvalidValueError

Source: TypeAlias = Union[Capture, MotionCapture, Clip, str, "os.PathLike[str]", ArrayLike]
"""Source of a motion capture."""

# Default frame rates: of arrays, and of clips, whose keys may have any times.
ARRAY_FPS = 120.0
CLIP_FPS = 60.0
#: Largest size of an array file, bytes.
MAX_BYTES = 1 << 30
_FILES = ".npz, .npy, .c3d, .bvh, .glb, .gltf or .vrm"


def read_capture(
    source: Source,
    *,
    joints: Sequence[str] | None = None,
    skeleton: str | None = None,
    fps: float | None = None,
    up: Literal["y", "z"] | None = None,
    clip: str | None = None,
) -> Capture:
    """Creates a ``Capture`` of a motion.

    ``source``: an array (T, J, 3) whose joints ``joints`` names, or those of a known ``skeleton`` ("cmu", "lafan1" or
    "smpl") in its order. It may also be a ``MotionCapture``, a clip, or the path of a .npz (SMPL, as of AMASS), .npy,
    .c3d (markers), .bvh, .glb, .gltf or .vrm file. A .npz without rest joints gets a default skeleton: see
    ``MotionCapture.read_smpl``. ``clip`` names one of a file's clips (None: the first). ``fps``: the frame rate of an
    array (None: 120), or the sampling rate of any other source (None: the file's own, of clips 60). ``up``: the upward axis. None selects the
    axis from the ankles to the pelvis of an upright subject, else z for arrays and y for animation files.

    Raises ``FileError`` and ``InvalidFileError`` for a file, ``UnknownNameError`` for an unknown clip or skeleton.
    Raises ``InvalidValueError`` for other shapes, for no frames and for numbers that are not finite, with their frame
    and joint.
    """
    if isinstance(source, Capture):
        return source
    if isinstance(source, MotionCapture):
        return Capture.of_clip(source.clip, 1.0 / source.frame_time if fps is None else fps, up)
    if isinstance(source, Clip):
        return Capture.of_clip(source, CLIP_FPS if fps is None else fps, up)
    if isinstance(source, (str, os.PathLike)):
        path = Path(source)
        if path.suffix.lower() == ".c3d":
            return Capture.of_c3d(path, up)
        held = _held_by(path, clip)
        try:
            return read_capture(held, joints=joints, skeleton=skeleton, fps=fps, up=up)
        except InvalidValueError as error:
            # Adds the name of the file to the message.
            raise type(error)(f"{path}: {error}") from None
    array: Any = np.asarray(source)
    names = list(joints) if joints is not None else _joints_of(array, skeleton)
    return Capture(array, names, ARRAY_FPS if fps is None else fps, up)


def _held_by(path: Path, clip: str | None) -> Any:
    """Content of a file: a capture, a clip or an array."""
    kind = path.suffix.lower()
    if kind == ".bvh":
        return MotionCapture.read(path)
    if kind == ".npz":
        return MotionCapture.read_smpl(path)
    if kind in (".glb", ".gltf", ".vrm"):
        return _clip(path, clip)
    if kind != ".npy":
        raise InvalidValueError(f"{path}: unsupported motion, expected {_FILES}")
    return _array(path)


def _clip(path: Path, name: str | None) -> Clip:
    clips = Scene.read(path).clips
    if not clips:
        raise InvalidFileError(f"{path}: has no clip")
    return clips[0] if name is None else Clip.named(clips, name)


def _array(path: Path) -> Any:
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InvalidFileError(f"{path}: is larger than {MAX_BYTES} bytes")
        with path.open("rb") as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return _numbers(file, size)
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error}") from None
    except InvalidFileError:
        raise
    except Exception:  # noqa: BLE001 - NumPy parses the header as Python, which raises what it likes of damaged text
        # NumPy's own message advises to unpickle the file.
        raise InvalidFileError(f"{path}: not a valid NumPy array") from None


def _numbers(file: BinaryIO, size: int) -> Any:
    """Reads the array of an open file after a check of the size in its header."""
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(file)
    if dtype.hasobject or math.prod(shape) * dtype.itemsize > size:
        raise ValueError("no plain numbers, or fewer than announced")
    file.seek(0)
    return np.load(file, allow_pickle=False)


def _joints_of(array: Any, skeleton: str | None) -> list[str]:
    """Names of an array's joints, by its known skeleton."""
    shape = np.shape(array)
    if len(shape) != 3 or shape[2] != 3:
        raise InvalidValueError(f"positions has shape {shape}, expected (frames, joints, 3)")
    if skeleton is not None:
        known = skeleton_joints(skeleton, shape[1])
        if known is None:
            raise InvalidValueError(f"an array of {shape[1]} joints is not of the skeleton {skeleton!r}")
        return known
    raise InvalidValueError(
        f"the {shape[1]} joints have no names: set joints=[...], a map's \"joints\", or a map of a skeleton: "
        + ", ".join(skeleton_names())
    )


__all__ = ["Source", "read_capture"]
