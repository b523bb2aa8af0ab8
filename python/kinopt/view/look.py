"""Appearance of robots without colours, and of bodies without meshes."""

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

#: Links are white, like most arms, and the hubs of their joints dark.
LIGHT: Color = (228, 232, 237)
DARK: Color = (84, 96, 114)
#: Skin of characters, and bones without a mesh.
SKIN: Color = (201, 172, 148)
BONE: Color = (104, 133, 166)
#: Radius of a capsule, relative to the size of the model.
RELATIVE_THICKNESS = 0.035


class DrawnKinematics:
    """Forward kinematics of a model's frames, and of its joints and the world's origin, which have no frames."""

    def __init__(self, model: Any) -> None:
        taken = {frame.name for frame in model.frames}
        builder = kinopt.ModelBuilder(model.name)
        #: Frames of joints, by joint; that of None is the world's.
        self.frame_of_joint: dict[str | None, str] = {None: _free("world", taken)}
        for joint in model.joints:
            kind, parent, placement = joint.kind, joint.parent, joint.parent_from_joint
            if kind == "ball":
                builder.ball(joint.name, parent, placement, joint.axis)
            else:
                builder.joint(joint.name, kind, parent, placement, joint.axis, joint.lower, joint.upper)
            self.frame_of_joint[joint.name] = _free(f"joint/{joint.name}", taken)
        for frame in model.frames:
            builder.frame(frame.name, frame.joint, frame.joint_from_frame)
        for owner, name in self.frame_of_joint.items():
            builder.frame(name, owner)
        drawn = builder.build()
        self._kinematics = kinopt.ForwardKinematics(drawn)
        # The angles of a skeleton have another order than its joints.
        names = model.coordinate_names
        self._order = [names.index(name) for name in drawn.coordinate_names]
        #: Indices of frames in the result of `place`, by name.
        self.index: dict[str, int] = {frame: i for i, frame in enumerate(self._kinematics.frame_names)}

    def place(self, q: Array) -> Array:
        """model_from_frame of every frame, shape (frames, 4, 4), for a configuration, shape (nq,).

        Raises `InvalidValueError` for a wrong length or a number that is not finite.
        """
        if q.shape == (len(self._order),):
            q = q[self._order]
        placements: Array = self._kinematics.place(q)
        return placements


def _free(name: str, taken: set[str]) -> str:
    """Returns a name that no frame has."""
    while name in taken:
        name += "'"
    taken.add(name)
    return name


def extent(placements: Array) -> float:
    """Diagonal of the bounding box of placements, shape (N, 4, 4); 1 for a zero diagonal."""
    points = placements[:, :3, 3]
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    return diagonal if diagonal > 0.0 else 1.0


def extent_of(model: Any) -> float:
    """Size of a model at rest, in its own unit."""
    return extent(DrawnKinematics(model).place(model.neutral()))


@dataclass(frozen=True)
class JointBody:
    """Drawn solid of a joint, in the joint's frame (None: the world's)."""

    joint: str | None
    solid: Solid
    color: Color


def capsules(model: Any, size: float) -> Iterator[JointBody]:
    """Capsules from each joint to its children, and a hub about the axis of each revolute joint."""
    radius = RELATIVE_THICKNESS * size
    ends: dict[str | None, list[Array]] = {None: [], **{joint.name: [] for joint in model.joints}}
    for joint in model.joints:
        ends[joint.parent].append(joint.parent_from_joint[:3, 3])
    for frame in model.frames:
        if not ends[frame.joint] and frame.joint is not None:
            ends[frame.joint].append(frame.joint_from_frame[:3, 3])
    for owner, points in ends.items():
        limb_ends: list[Array] = []
        for point in points:
            clear = all(np.linalg.norm(point - other) > 0.1 * radius for other in limb_ends)
            if np.linalg.norm(point) > 0.2 * radius and clear:
                limb_ends.append(point)
        limbs = [capsule_between(np.zeros(3), point, _slim(point, radius)) for point in limb_ends]
        if limbs:
            yield JointBody(owner, joined(limbs), LIGHT)
    for joint in model.joints:
        if joint.kind in ("revolute", "continuous"):
            hub = cylinder(2.3 * radius, 1.12 * radius).moved(_along(joint.axis))
            yield JointBody(joint.name, hub, DARK)
        elif joint.kind == "prismatic":
            yield JointBody(joint.name, sphere(0.8 * radius), DARK)


def _slim(point: Array, radius: float) -> float:
    """Radius of a limb: short limbs are thinner, so that fingers do not look like balls."""
    return min(radius, max(0.4 * float(np.linalg.norm(point)), 0.3 * radius))


def _along(axis: object) -> Array:
    """A placement with its z axis along `axis`."""
    z = np.asarray(axis, dtype=float)
    z /= np.linalg.norm(z)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    placement = np.eye(4)
    placement[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    return placement
