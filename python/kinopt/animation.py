"""Motion over time: keyframes, what is between them, poses, and what goes over them.

- Bones: an ``Armature``, made of bones or of a skeleton, and its ``Pose``.
- Between keys: ``KeyedCurve``, ``RotationCurve``, ``EulerCurve``.
- Over time: a ``Clip``; a ``Playhead`` says where playback is and which events it passes.
- Together: ``Pose.cross_fade``, ``blend_poses``, ``Layer`` under a ``BoneMask``, and a ``StateMachine``, which each
  character runs by its own ``StateMachineRun``.
- Over the pose: ``Limb`` and ``Aim`` in closed form, ``ReachLayer`` by the optimiser.
- Many of them: a ``Crowd``. A skeleton's stacked angles: an ``EulerClip``, ``PoseAngles``.
"""

from ._kinopt.animation import (
    Aim,
    AimGoal,
    Armature,
    BoneMask,
    Clip,
    ClipBuilder,
    Crowd,
    EulerClip,
    EulerCurve,
    KeyedCurve,
    Layer,
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
    "EulerClip",
    "EulerCurve",
    "KeyedCurve",
    "Layer",
    "Limb",
    "LimbGoal",
    "Passage",
    "Playhead",
    "PlayingClip",
    "Pose",
    "PoseAngles",
    "Poses",
    "ReachLayer",
    "RootMotion",
    "RotationCurve",
    "StateMachine",
    "StateMachineRun",
    "blend_poses",
    "easing",
]
