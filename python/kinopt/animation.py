"""Motion over time: keyframes, what is between them, poses, and what goes over them.

- Bones: an ``Armature``, made of bones or of a skeleton, and its ``Pose``.
- Between keys: ``KeyedCurve``, ``RotationCurve``, ``EulerCurve``.
- Over time: a ``Clip``; a ``Playhead`` says where playback is and which events it passes.
- Together: ``Pose.cross_fade``, ``blend_poses``, ``Layer`` under a ``BoneMask``, and a ``StateMachine``, which each
  character runs by its own ``StateMachineRun``.
- Over the pose: ``Limb`` and ``Aim`` in closed form, ``ReachLayer`` by the optimiser. Over a clip: ``Clip.with_ik`` of a
  ``Reach``, and feet that stand.
- Many of them: a ``Crowd``. A skeleton's stacked angles: an ``EulerClip``, ``PoseAngles``.
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
    EditedClip,
    EulerClip,
    EulerCurve,
    KeyedCurve,
    Layer,
    Led,
    Limb,
    LimbGoal,
    Passage,
    Playhead,
    PlayingClip,
    Pose,
    PoseAngles,
    Poses,
    ReachLayer,
    RootMotion,
    RotationCurve,
    Stance,
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
    "EditedClip",
    "EulerClip",
    "EulerCurve",
    "KeyedCurve",
    "Layer",
    "Led",
    "Limb",
    "LimbGoal",
    "Passage",
    "Playhead",
    "PlayingClip",
    "Pose",
    "PoseAngles",
    "Poses",
    "Reach",
    "ReachLayer",
    "RootMotion",
    "RotationCurve",
    "Stance",
    "StateMachine",
    "StateMachineRun",
    "blend_poses",
    "easing",
]


@dataclass(frozen=True)
class Reach:
    """A bone whose origin, of a rig's its tip, goes to a point over a span of a clip: of `Clip.with_ik`.

    `target` is a point in the model, shape (3,), or a curve through points, shape (N, 3), at `times` in seconds of the clip, or
    without them evenly over the span. `span` is (from, to) in seconds, the whole clip unless set. Over `fade` seconds
    at either end the bone is led there and back: 0.2, or half of a shorter span, unless set.
    """

    bone: str
    target: ArrayLike
    span: tuple[float, float] | None = None
    fade: float | None = None
    times: Sequence[float] | ArrayLike | None = None
