"""Contacts over a span of a trajectory."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Contact:
    """Points of a frame that are locked in place from sample `start` up to, not including, `stop` of a `MotionProblem`.

    `at` are the points in the frame's coordinates, metres, shape (N, 3): three that are not collinear lock its pose.
    The solver determines their positions in the world; a task can set a target for them.
    """

    frame: str
    start: int
    stop: int
    at: ArrayLike = ((0.0, 0.0, 0.0),)
