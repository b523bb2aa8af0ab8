"""Frames of hands, feet, head and pelvis, by the body maps of retargeting."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

import kinopt
from kinopt._kinopt.retargeting import Capture, map_guessed, skeleton_joints

from .body import moved_by

#: Skeleton whose joints name the parts of a body.
SKELETON, JOINTS = "smpl", 24
HANDS, FEET = ("left_wrist", "right_wrist"), ("left_foot", "right_foot")
#: Words of frames that are preferred to the frame of the map if the same joint moves them.
WORDS = {"left_wrist": "hand", "right_wrist": "hand", "left_foot": "sole", "right_foot": "sole"}


@dataclass(frozen=True)
class Humanoid:
    """Frames of a humanoid body."""

    feet: list[str]
    hands: list[str]
    #: The pelvis and the head.
    trunk: list[str]

    @property
    def frames(self) -> list[str]:
        """Frames of hands, feet and trunk."""
        return [*self.feet, *self.hands, *self.trunk]


def humanoid(thing: Any) -> Humanoid | None:
    """Frames of a robot, skeleton or scene with two arms and two legs, by their names; None for other bodies."""
    joints = skeleton_joints(SKELETON, JOINTS) or []
    # The guess uses names; positions only serve its notes.
    positions = np.random.default_rng(0).uniform(0.0, 1.0, (1, JOINTS, 3))
    try:
        text, *_ = map_guessed(Capture(positions, joints, 30.0, "z"), thing)
    except (kinopt.KinoptError, TypeError):
        return None
    drives = {part: drive if isinstance(drive, str) else drive["frame"] for part, drive in json.loads(text)["drives"].items()}
    if not {"pelvis", *HANDS, *FEET} <= drives.keys():
        return None
    model = getattr(thing, "model", thing)
    carriers = moved_by(model)

    def best(part: str) -> str:
        frame = drives[part]
        word = WORDS.get(part)
        named = [
            other for other, carrier in carriers.items() if word and word in other.lower() and carrier == carriers.get(frame)
        ]
        return min(named, key=len, default=frame)

    trunk = [best("pelvis"), best("head") if "head" in drives else highest_frame(model)]
    return Humanoid([best(foot) for foot in FEET], [best(hand) for hand in HANDS], trunk)


def highest_frame(model: Any) -> str:
    """The highest frame of a robot at rest: a sensor of its head."""
    heights = kinopt.ForwardKinematics(model).place(model.neutral())[:, 2, 3]
    return str(model.frame_names[int(heights.argmax())])
