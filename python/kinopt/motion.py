"""What stands still over a span of a motion."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Contact:
    """Points of a frame that stand still from frame `start` up to, not including, `stop` of a `MotionProblem`.

    `at` are the points in the frame's coordinates, metres, shape (N, 3): three that are on no line hold its pose. Where they
    stand is found with the motion; where they should, a task says.
    """

    frame: str
    start: int
    stop: int
    at: ArrayLike = ((0.0, 0.0, 0.0),)
