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


@dataclass(frozen=True)
class Humanoid:
    """Frames of a humanoid body."""

    feet: list[str]
    #: Feet, hands, pelvis and head.
    frames: list[str]


def humanoid(robot: kinopt.Robot) -> Humanoid | None:
    """Frames of a robot with two arms and two legs, by their names; None for other bodies."""
    joints = skeleton_joints(SKELETON, JOINTS) or []
    # The guess uses names; positions only serve its notes.
    positions = np.random.default_rng(0).uniform(0.0, 1.0, (1, JOINTS, 3))
    try:
        text, *_ = map_guessed(Capture(positions, joints, 30.0, "z"), robot)
    except kinopt.KinoptError:
        return None
    drives = {part: drive if isinstance(drive, str) else drive["frame"] for part, drive in json.loads(text)["drives"].items()}
    if not {"pelvis", *HANDS, *FEET} <= drives.keys():
        return None
    carriers = moved_by(robot.model)

    def best(part: str, word: str) -> str:
        """Frame of a part; of the frames that the same joint moves, the one named by this word."""
        carrier = carriers.get(drives[part])
        named = [frame for frame in carriers if word in frame.lower() and carriers[frame] == carrier]
        return min(named, key=len, default=str(drives[part]))

    feet, hands = [best(foot, "sole") for foot in FEET], [best(hand, "hand") for hand in HANDS]
    head = drives["head"] if "head" in drives else highest_frame(robot.model)
    return Humanoid(feet, [*feet, *hands, drives["pelvis"], head])


def highest_frame(model: Any) -> str:
    """The highest frame of a robot at rest: a sensor of its head."""
    heights = kinopt.ForwardKinematics(model).place(model.neutral())[:, 2, 3]
    return str(model.frame_names[int(heights.argmax())])
