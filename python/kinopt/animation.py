"""Animation: keyframes, interpolation, poses, blending, and inverse kinematics on poses and clips.

- Bones: an ``Armature``, made of bones or of a skeleton, and its ``Pose``.
- Interpolation: ``KeyedCurve``, ``RotationCurve``, ``EulerCurve``.
- Time: a ``Clip``; a ``Playhead`` has the playback time, and its passages give the events.
- Blending: ``Pose.cross_fade``, ``blend_poses``, ``Layer`` with a ``BoneMask``, and a ``StateMachine`` with one
  ``StateMachineRun`` for each character.
- IK on poses: analytic ``Limb`` and ``Aim``, numerical ``ReachLayer``. IK on clips: ``Clip.with_ik`` with ``Reach``,
  and planted feet.
- Crowds: a ``Crowd``. Stacked angles of a skeleton: an ``EulerClip``, ``EulerPoseMap``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from ._kinopt.animation import (
    Aim,
    AimGoal,
    Armature,
    BoneMask,
    Clip,
    ClipBuilder,
    Crowd,
    EditReport,
    EditedClip,
    EulerClip,
    EulerCurve,
    KeyedCurve,
    Layer,
    ReachResult,
    Limb,
    LimbGoal,
    Passage,
    Playhead,
    PlayingClip,
    Pose,
    EulerPoseMap,
    Poses,
    ReachLayer,
    RootMotion,
    RotationCurve,
    FootPlant,
    StateMachine,
    StateMachineRun,
    blend_poses,
    easing,
)

__all__ = [
    "Aim",
    "AimGoal",
    "Armature",
    "BoneMask",
    "Clip",
    "ClipBuilder",
    "Crowd",
    "EditReport",
    "EditedClip",
    "EulerClip",
    "EulerCurve",
    "KeyedCurve",
    "Layer",
    "ReachResult",
    "Limb",
    "LimbGoal",
    "Passage",
    "Playhead",
    "PlayingClip",
    "Pose",
    "EulerPoseMap",
    "Poses",
    "Reach",
    "ReachLayer",
    "RootMotion",
    "RotationCurve",
    "FootPlant",
    "StateMachine",
    "StateMachineRun",
    "blend_poses",
    "easing",
]


@dataclass(frozen=True)
class Reach:
    """A bone whose origin (for a rig, its tip) reaches a point over a span of a clip: for `Clip.with_ik`.

    `target` is a point in the model, shape (3,), or a curve through points, shape (N, 3), at `times` in seconds of the
    clip. By default the points are uniform over the span. `span` is (from, to) in seconds, by default the whole clip.
    `fade` is the duration of the blend at either end, in seconds: by default 0.2, or half of a shorter span.
    """

    bone: str
    target: ArrayLike
    span: tuple[float, float] | None = None
    fade: float | None = None
    times: Sequence[float] | ArrayLike | None = None
