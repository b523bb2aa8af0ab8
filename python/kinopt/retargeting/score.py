"""Scores of robot motions from any program."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, Union

from numpy.typing import ArrayLike

from .._kinopt import Trajectory
from .._kinopt.retargeting import motion_scored
from .maps import MapLike, naming
from .retarget import retarget_request
from .score_report import MotionScore, score_of_json
from .sources import Source
from .targets import TargetLike, read_target

Motion: TypeAlias = Union["Trajectory[Any]", str, "os.PathLike[str]", ArrayLike]
"""A trajectory, the path of a motion file, or an array of configurations."""


def score(
    motion: Motion,
    target: TargetLike,
    subject: Source | None = None,
    map: MapLike = None,
    *,
    fps: float | None = None,
    quaternion: Literal["xyzw", "wxyz"] | None = None,
    joints: Sequence[str] | None = None,
    subject_fps: float | None = None,
    up: Literal["y", "z"] | None = None,
    clip: str | None = None,
    start: float = 0.0,
    heading: float | Literal["fit"] | None = None,
    ground: float = 0.0,
    collisions: bool = False,
    weights: Mapping[str, float] | None = None,
    contact_speed: float | None = None,
    contact_height: float | None = None,
) -> MotionScore:
    """Scores the motion of a robot, from any program.

    ``motion``: a ``Trajectory``, an array of configurations (T, nq) whose base has the quaternion w, x, y, z, or the path
    of a .csv, .npz, .json, .glb or .gltf file. Rows of a .csv file without names have the quaternion x, y, z, w, as of
    Unitree's LAFAN1; ``quaternion`` changes that. ``fps``: frames per second of the motion. None takes those of the
    trajectory or file, else those of the subject, else 30. ``target`` is the robot or its file.

    ``subject``: the capture of the person as in ``retarget``, with ``map``, ``joints``, ``up``, ``clip`` and
    ``subject_fps`` as its ``fps``. Limb directions, hands and feet are compared with it. Without a subject only the
    figures that need none are measured. ``start``: time of the capture at which the motion begins, seconds.
    ``heading``: rotation about the vertical from the capture to the motion, degrees. None selects the multiple of 90°
    that fits best, and "fit" the angle that fits best.

    ``ground``: its height, metres. ``collisions``: check self-collisions. ``weights``: points per unit of the terms
    "limbs", "ends", "sliding", "penetration", "lost_contacts", "jerk", "limits" and "collisions". ``contact_speed`` and
    ``contact_height`` are the thresholds of the subject's foot contacts.

    Raises ``UnknownNameError`` for names of the map and of weights, ``InvalidValueError`` for invalid arrays and options,
    ``FileError`` and ``InvalidFileError`` for files.
    """
    options: dict[str, Any] = {
        "fps": fps,
        "quaternion": quaternion,
        "start": float(start),
        "heading": heading,
        "ground": float(ground),
        "collisions": collisions,
        "weights": None if weights is None else [(name, float(weight)) for name, weight in weights.items()],
        "contact_speed": contact_speed,
        "contact_height": contact_height,
    }
    configurations: Any = motion
    if isinstance(motion, Trajectory):
        configurations = motion.q
        if fps is None and len(motion) > 1:
            options["fps"] = (len(motion) - 1) / motion.duration
    elif isinstance(motion, (str, os.PathLike)):
        configurations = os.fspath(motion)
    if subject is None:
        return score_of_json(motion_scored(configurations, read_target(target), None, None, options))
    request = retarget_request(subject, target, map, joints=joints, fps=subject_fps, up=up, clip=clip)
    with naming(map):
        text = motion_scored(configurations, request.target, request.capture, json.dumps(request.map), options)
    return score_of_json(text)


__all__ = ["Motion", "score"]
