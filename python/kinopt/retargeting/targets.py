"""Targets of retargeting."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeAlias, Union

from .._kinopt import Model, MotionCapture, Rig, Robot, Scene, SceneFile
from ..errors import InvalidFileError
from ..types import HasModel

Target: TypeAlias = Union[Model, HasModel, Scene, SceneFile, MotionCapture]
"""A robot with a free base, a skeleton (a rig, a skeleton, a scene, a motion capture), or a model."""

TargetLike: TypeAlias = Union[Target, str, "os.PathLike[str]"]
"""A target, or its file."""

_FILES = ".urdf, .xml, .mjcf, .glb, .gltf, .vrm, .bvh or .json"


def read_target(target: TargetLike) -> Target:
    """Returns the target, read from a file if it is a path."""
    if not isinstance(target, (str, os.PathLike)):
        return target
    path = Path(target)
    kind = path.suffix.lower()
    if kind == ".urdf":
        return Robot.from_urdf(path, base_joint="free")
    if kind in (".xml", ".mjcf"):
        return Robot.from_mjcf(path, base_joint="free")
    if kind in (".glb", ".gltf", ".vrm"):
        return SceneFile.read(path)
    if kind == ".bvh":
        return MotionCapture.read(path)
    if kind == ".json":
        return Rig.read(path)
    raise InvalidFileError(f"{path}: unsupported target, expected {_FILES}")


__all__ = ["Target", "TargetLike", "read_target"]
