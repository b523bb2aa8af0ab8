"""What a body stands on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .transforms import inverse

Array = NDArray[np.float64]

#: Frames that are pinned this much higher than the lowest one are no feet, as a share of the model's height over it.
HIGHER = 0.15


def has_masses(thing: Any, q: Array) -> bool:
    """Whether a robot's file says what its links weigh."""
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
    near = lowest + HIGHER * (float(every.max()) - lowest)
    return [frame for frame in pinned if heights[frame] <= near]


def sole(thing: Any, foot: str) -> Array:
    """Points of what is fixed to a foot, in its coordinates, shape (N, 3): links' origins, and their shapes' corners."""
    frames = {frame.name: frame for frame in thing.model.frames}
    own = frames[foot]
    rest = thing.model.neutral()
    foot_from_world = inverse(kinopt.frame_placement(thing, foot, rest))
    points = []
    for name, frame in frames.items():
        if frame.joint != own.joint:
            continue
        foot_from_link = foot_from_world @ kinopt.frame_placement(thing, name, rest)
        corners = [np.zeros(3)]
        for shape in thing.shapes(name, collision=True):
            corners += [shape.link_from_shape[:3, :3] @ at + shape.link_from_shape[:3, 3] for at in _corners(shape)]
        points += [foot_from_link[:3, :3] @ at + foot_from_link[:3, 3] for at in corners]
    return np.array(points)


def _corners(shape: Any) -> list[Array]:
    measures = shape.measures
    match shape.kind:
        case "box":
            half = np.asarray(measures["size"]) / 2
        case "cylinder":
            # The square within its rim.
            half = np.array([measures["radius"] / np.sqrt(2)] * 2 + [measures["length"] / 2])
        case "sphere" | "ellipsoid":
            half = np.zeros(3)
        case _:
            return []
    return [half * signs for signs in np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T]
