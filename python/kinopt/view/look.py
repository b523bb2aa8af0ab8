"""How robots without colours of their own look, and bodies where no mesh is at hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .solids import Solid, capsule_between, cylinder, joined, sphere

Array = NDArray[np.float64]
Color = tuple[int, int, int]

#: Links are white, as most arms are, and the hubs of their joints dark.
LIGHT: Color = (228, 232, 237)
DARK: Color = (72, 82, 97)
#: Skin of characters, bones of figures without one.
SKIN: Color = (206, 190, 176)
BONE: Color = (104, 133, 166)
#: How thick a capsule is, as a share of the model's size.
THICKNESS = 0.035


def with_joint_frames(model: Any) -> tuple[Any, dict[str | None, str]]:
    """The same model with a frame at every joint and at the world's origin, and those frames by joint."""
    taken = {frame.name for frame in model.frames}
    builder = kinopt.ModelBuilder(model.name)
    names: dict[str | None, str] = {}

    def name_frame(joint: str | None) -> None:
        name = "world" if joint is None else f"joint/{joint}"
        while name in taken:
            name += "'"
        taken.add(name)
        names[joint] = name

    name_frame(None)
    for joint in model.joints:
        kind, parent, place = joint.kind, joint.parent, joint.parent_from_joint
        builder.joint(joint.name, kind, parent, place, joint.axis, joint.lower, joint.upper)
        name_frame(joint.name)
    for frame in model.frames:
        builder.frame(frame.name, frame.joint, frame.joint_from_frame)
    for owner, name in names.items():
        builder.frame(name, owner)
    return builder.build(), names


def extent(placements: Array) -> float:
    """The diagonal of the box around placements, shape (N, 4, 4); 1 where there is no extent."""
    points = placements[:, :3, 3]
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    return diagonal if diagonal > 0.0 else 1.0


def extent_of(model: Any) -> float:
    """How large a model is at rest, in its own unit."""
    drawn, _ = with_joint_frames(model)
    return extent(kinopt.ForwardKinematics(drawn).place(model.neutral()))


@dataclass(frozen=True)
class JointBody:
    """What is drawn for what a joint carries, in the joint's frame (None: the world's)."""

    joint: str | None
    solid: Solid
    color: Color


def capsules(model: Any, size: float) -> Iterator[JointBody]:
    """Clean capsules from each joint to what hangs on it, and a hub about the axis of each that turns."""
    radius = THICKNESS * size
    ends: dict[str | None, list[Array]] = {None: [], **{joint.name: [] for joint in model.joints}}
    for joint in model.joints:
        ends[joint.parent].append(joint.parent_from_joint[:3, 3])
    for frame in model.frames:
        if not ends[frame.joint] and frame.joint is not None:
            ends[frame.joint].append(frame.joint_from_frame[:3, 3])
    for owner, points in ends.items():
        far: list[Array] = []
        for point in points:
            clear = all(np.linalg.norm(point - other) > 0.1 * radius for other in far)
            if np.linalg.norm(point) > 0.2 * radius and clear:
                far.append(point)
        limbs = [capsule_between(np.zeros(3), point, _slim(point, radius)) for point in far]
        if limbs:
            yield JointBody(owner, joined(limbs), LIGHT)
    for joint in model.joints:
        if joint.kind in ("revolute", "continuous"):
            hub = cylinder(2.3 * radius, 1.12 * radius).moved(_along(joint.axis))
            yield JointBody(joint.name, hub, DARK)
        elif joint.kind == "prismatic":
            yield JointBody(joint.name, sphere(0.8 * radius), DARK)


def _slim(point: Array, radius: float) -> float:
    """Short limbs are thinner, so that fingers are no balls."""
    return min(radius, max(0.4 * float(np.linalg.norm(point)), 0.3 * radius))


def _along(axis: object) -> Array:
    """A placement whose z axis lies along `axis`."""
    z = np.asarray(axis, dtype=float)
    z /= np.linalg.norm(z)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    placement = np.eye(4)
    placement[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    return placement
