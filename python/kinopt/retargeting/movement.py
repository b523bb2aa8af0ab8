"""The report of a retargeted motion, and its clips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._kinopt import Trajectory
from .._kinopt.animation import Clip
from .._kinopt.retargeting import Capture, FigureTarget
from ..types import Floats
from .score_report import MotionScore
from .targets import TargetLike, read_target


@dataclass(frozen=True)
class LimitMet:
    """An active limit of a joint over a span of frames."""

    joint: str
    """Name of the joint."""
    bound: str
    """"lower" or "upper", "speed down" or "speed up"."""
    first: int
    """First frame of the span."""
    end: int
    """Frame after the last one."""


@dataclass(frozen=True)
class Touching:
    """Two links in contact in a frame, in spite of collision avoidance."""

    frame: int
    """Index of the frame."""
    first: str
    """First link."""
    second: str
    """Second link."""
    distance: float
    """Distance, metres; negative for penetration."""


@dataclass(frozen=True)
class LostContact:
    """A contact that was lost, because limits have priority."""

    frame: int
    """First frame with a drift of more than a millimetre; the contact ends there."""
    contact_frame: str
    """Frame of the target, as in ``contact_frames``."""


@dataclass(frozen=True, eq=False, repr=False)
class RetargetReport:
    """Errors, contacts and collisions of a retargeted motion."""

    fps: float
    """Frame rate, in frames a second."""
    contacts: NDArray[np.bool_]
    """True for each frame of motion and target frame in contact, shape (T, S)."""
    contact_frames: list[str]
    """The S frames of the target that are in contact at some time."""
    contact_points: Floats
    """Contact point of each, in its coordinates, shape (S, 3), metres."""
    score: MotionScore
    """Figures next to the person: direction errors of the limbs, position errors of hands and feet, and more."""
    limb_angles: Floats
    """Angle between each limb of the subject and of the target, shape (T, L), degrees."""
    limbs: list[str]
    """The L limbs, the columns of ``limb_angles``."""
    slip: float
    """Largest drift of a contact from its initial position, metres."""
    ground_penetration: float
    """Largest penetration of the ground by a foot with a shape, metres; 0 without one."""
    stride: float
    """Ratio of the step length to that of the subject."""
    limits: list[LimitMet]
    """Active limits, by joint and then by frame."""
    lost_contacts: list[LostContact]
    """Contacts that were lost before the subject ended them."""
    touching: list[Touching]
    """Frames in contact in spite of ``keep_clear``, each with its nearest pair."""
    map: dict[str, Any]
    """The map in use."""
    notes: list[str]
    """Notes on a guessed map, for review, and on an upward axis of the target other than z."""
    object_poses: Floats
    """Pose of the held object in each frame, shape (T, 7): metres, quaternion w, x, y, z; shape (0, 7) without one."""
    capture: Capture
    """The capture."""

    def __repr__(self) -> str:
        return (
            f"RetargetReport({self.fps:g} fps, mean direction error {self.mean_angle:.2f}°, slip={self.slip:.2g}, "
            f"{len(self.notes)} notes)"
        )

    @property
    def mean_angle(self) -> float:
        """Mean direction error of all limbs, degrees; 0 without limbs."""
        return float(self.limb_angles.mean()) if self.limb_angles.size else 0.0

    def missed(self, degrees: float) -> dict[str, NDArray[np.intp]]:
        """Frames in which the direction of a limb differs from the subject's by more than ``degrees``, by limb."""
        is_missed = self.limb_angles > degrees
        return {name: np.flatnonzero(is_missed[:, k]) for k, name in enumerate(self.limbs) if is_missed[:, k].any()}


def to_clip(motion: Trajectory[RetargetReport], target: TargetLike, name: str = "retargeted") -> Clip:
    """The motion as a clip of ``target``'s armature, in the axes of its file. ``target`` is the rig, skeleton, scene,
    motion capture or ``FigureTarget`` of the retargeting, or its file.

    ``SceneFile.add_clip`` adds it to the file of a scene.

    Raises ``InvalidValueError`` for another target, or one without an armature.
    """
    figure = read_target(target)
    if not isinstance(figure, FigureTarget):
        figure = FigureTarget(figure)
    return figure.clip(motion.q, motion.report.fps, name)


__all__ = ["LostContact", "LimitMet", "RetargetReport", "Touching", "to_clip"]
