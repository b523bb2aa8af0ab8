"""Feet and masses of a body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

Array = NDArray[np.float64]

#: Pinned frames higher than this above the lowest one are no feet, relative to the height of the model above it.
MAX_FOOT_HEIGHT = 0.15


def has_masses(thing: Any, q: Array) -> bool:
    """True if the file of a robot has masses."""
    try:
        thing.center_of_mass(q)
    except (kinopt.KinoptError, AttributeError):
        return False
    return True


def feet(model: Any, pinned: Sequence[str], q: Array) -> list[str]:
    """The lowest of the pinned frames."""
    if not pinned:
        return []
    heights = {frame: float(kinopt.frame_placement(model, frame, q)[2, 3]) for frame in pinned}
    every = kinopt.ForwardKinematics(model).place(q)[:, 2, 3]
    lowest = min(heights.values())
    near = lowest + MAX_FOOT_HEIGHT * (float(every.max()) - lowest)
    return [frame for frame in pinned if heights[frame] <= near]
