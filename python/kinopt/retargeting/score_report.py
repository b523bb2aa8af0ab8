"""Figures of a scored motion."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Spread:
    """Mean, 95th percentile and maximum over samples."""

    mean: float
    """Mean."""
    p95: float
    """95th percentile."""
    max: float
    """Largest sample."""


@dataclass(frozen=True)
class FootMotion:
    """Motion of the feet during contact."""

    of_subject: bool
    """True if the contacts are those of the subject; else a point near its lowest height is in contact."""
    contacts: int
    """Number of contacts."""
    sliding: Spread
    """Largest horizontal distance from the touchdown position, over the contacts, metres."""
    sliding_speed: Spread
    """Horizontal speed over the samples in contact, m/s."""
    lost_contacts: list[tuple[int, str]]
    """Contacts of the subject that the robot does not hold: first frame, and captured joint."""


@dataclass(frozen=True)
class LimitExcess:
    """Joint positions and velocities outside their limits."""

    share: float
    """Share of the samples with a joint outside its position or velocity limits."""
    position_share: float
    """Share of the samples with a joint outside its position limits."""
    position: float
    """Largest distance outside the position limits, radians or metres."""
    velocity_share: float
    """Share of the samples with a joint faster than its velocity limit."""
    velocity_ratio: float
    """Largest ratio of a joint's velocity to its limit; 0 if no joint has a velocity limit."""
    joints: list[str]
    """Names of the joints outside their limits."""


@dataclass(frozen=True)
class ScoreTerm:
    """Term of a total score."""

    name: str
    """Name of the term, a key of ``weights``."""
    value: float
    """Measured value."""
    unit: str
    """Unit of the value."""
    weight: float
    """Points per unit."""
    points: float
    """Value times weight."""


@dataclass(frozen=True)
class MotionScore:
    """Figures of a motion. The total is the sum of the terms' points: less is better."""

    frames: int
    """Number of scored samples."""
    frame_rate: float
    """Samples per second."""
    total: float
    """Weighted sum of the terms."""
    terms: list[ScoreTerm]
    """Terms of the total, with their weights."""
    heading: float
    """Rotation about the vertical from the capture to the motion, degrees."""
    limbs: dict[str, Spread]
    """Angle between each limb of the subject and of the robot, degrees. Empty without a subject."""
    ends: dict[str, Spread]
    """Position error of hands and feet, relative to the length of the limb. Empty without a subject."""
    feet: FootMotion | None
    """Feet during contact; None if the robot has no known feet."""
    penetration: Spread
    """Depth of the lowest point below the ground, metres."""
    penetration_share: float
    """Share of the samples deeper than 1 mm."""
    joint_jerk: Spread
    """Jerk of the joint angles without the base, rad/s³."""
    end_jerk: Spread
    """Jerk of head, hands and ankles, m/s³."""
    subject_end_jerk: Spread | None
    """Jerk of the subject's head, hands and ankles, scaled to the robot's legs, m/s³."""
    limits: LimitExcess
    """Joint positions and velocities outside their limits."""
    collision_share: float | None
    """Share of the samples in collision; None without ``collisions``."""
    collision_depth: float | None
    """Largest penetration depth of two links, metres; None without ``collisions``."""


def score_of_json(text: str) -> MotionScore:
    """A score from its JSON document."""
    document = json.loads(text)

    def spread(of: Mapping[str, float]) -> Spread:
        return Spread(of["mean"], of["p95"], of["max"])

    feet, collisions, jerk = document["feet"], document["collisions"], document["jerk"]
    return MotionScore(
        frames=document["frames"],
        frame_rate=document["frame_rate"],
        total=document["total"],
        terms=[ScoreTerm(**term) for term in document["terms"]],
        heading=document["heading"],
        limbs={limb["limb"]: spread(limb["angle"]) for limb in document["limbs"]},
        ends={end["end"]: spread(end["error"]) for end in document["ends"]},
        feet=None
        if feet is None
        else FootMotion(
            of_subject=feet["of_subject"],
            contacts=feet["contacts"],
            sliding=spread(feet["sliding"]),
            sliding_speed=spread(feet["sliding_speed"]),
            lost_contacts=[(lost["frame"], lost["joint"]) for lost in feet["lost_contacts"]],
        ),
        penetration=spread(document["penetration"]["depth"]),
        penetration_share=document["penetration"]["share"],
        joint_jerk=spread(jerk["joints"]),
        end_jerk=spread(jerk["ends"]),
        subject_end_jerk=None if jerk["subject_ends"] is None else spread(jerk["subject_ends"]),
        limits=LimitExcess(**document["limits"]),
        collision_share=None if collisions is None else collisions["share"],
        collision_depth=None if collisions is None else collisions["depth"],
    )


__all__ = ["FootMotion", "LimitExcess", "MotionScore", "ScoreTerm", "Spread", "score_of_json"]
