"""Appearance of robots without colours, and of bodies without meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .solids import Solid, along, capsule_between, cylinder, hull, joined

Array = NDArray[np.float64]
Color = tuple[int, int, int]

#: Links are white, like most arms, and the hubs of their joints dark.
LIGHT: Color = (228, 232, 237)
DARK: Color = (84, 96, 114)
#: Links are alternately light and grey if only their collision shapes are known.
GREY: Color = (160, 172, 188)
#: Skin of characters, and bones without a mesh.
SKIN: Color = (201, 172, 148)
BONE: Color = (104, 133, 166)
#: Radius of a capsule, relative to the size of the model.
RELATIVE_THICKNESS = 0.035
#: Radius at a tip, relative to the radius at the root.
TIP_SHARE = 0.55
#: Ratio of length to radius from which a limb is light, and from which a frame off the limbs is drawn.
MIN_LIGHT, MIN_MAST = 1.8, 2.5


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
    """Capsules from each joint to its child, hulls about several children or frames, and hubs of joints.

    Radii decrease towards the tips. Fixed joints are parts of their parents.
    """
    children, frames = _rigid_parts(model)
    radii = _radii(children, frames, RELATIVE_THICKNESS * size)
    for owner, joints in children.items():
        thick = radii[owner]
        ends = _apart([position for _, position in joints], [np.zeros(3)], 0.2 * thick)
        end_radius = min(max([radii[joint] for joint, _ in joints], default=0.5 * thick), thick)
        if not joints:
            ends = _apart(frames[owner], [np.zeros(3)], 0.3 * thick)
        solids = [_limb(end, thick, end_radius) for end in ends]
        if len(ends) > 1:
            solids = [hull(np.array([np.zeros(3), *ends]), np.array([thick, *[end_radius] * len(ends)]))]
        # Sensors on a mast, or a head without a joint; frames of the world are no parts of the body.
        mast = _apart(frames[owner] if joints and owner is not None else [], [np.zeros(3), *ends], MIN_MAST * thick)
        if mast:
            top = max(mast, key=lambda point: float(np.linalg.norm(point)))
            middle = np.mean([np.zeros(3), *ends], axis=0)
            solids += [capsule_between(middle, top, 0.6 * thick), capsule_between(top, top, 1.2 * thick)]
        if solids:
            length = max((float(np.linalg.norm(end)) for end in ends), default=0.0)
            yield JointBody(owner, joined(solids), LIGHT if length > MIN_LIGHT * thick or len(ends) > 1 else DARK)
    for joint in model.joints:
        if joint.kind in ("revolute", "continuous"):
            radius = radii[joint.name]
            yield JointBody(joint.name, cylinder(2.2 * radius, 1.08 * radius).moved(along(np.asarray(joint.axis, dtype=float), np.zeros(3))), DARK)
        elif joint.kind == "prismatic":
            yield JointBody(joint.name, capsule_between(np.zeros(3), np.zeros(3), 0.8 * radii[joint.name]), DARK)


Children = dict[str | None, list[tuple[str, Array]]]
Points = dict[str | None, list[Array]]


def _rigid_parts(model: Any) -> tuple[Children, Points]:
    """Child joints and frames of each moving joint (None: of the world), with their positions in its frame."""
    carriers = {None: None} | {joint.name: joint.name for joint in model.joints}
    placements = {carrier: np.eye(4) for carrier in carriers}
    children: Children = {None: []}
    # Parents come before their children.
    for joint in model.joints:
        carrier, placement = carriers[joint.parent], placements[joint.parent] @ joint.parent_from_joint
        if joint.kind == "fixed":
            carriers[joint.name], placements[joint.name] = carrier, placement
        else:
            children[carrier].append((joint.name, placement[:3, 3]))
            children[joint.name] = []
    frames: Points = {carrier: [] for carrier in children}
    for frame in model.frames:
        frames[carriers[frame.joint]].append((placements[frame.joint] @ frame.joint_from_frame)[:3, 3])
    return children, frames


def _radii(children: Children, frames: Points, radius: float) -> dict[str | None, float]:
    """Radius of the limb at each joint; None is the world's. It grows with the length of the limb beyond the joint."""
    reach: dict[str | None, float] = {}
    for owner in reversed(children):
        lengths = [float(np.linalg.norm(point)) for point in frames[owner]]
        reach[owner] = max([*lengths, *(reach[joint] + float(np.linalg.norm(p)) for joint, p in children[owner])], default=0.0)
    longest = max([length for owner, length in reach.items() if owner is not None], default=0.0) or 1.0
    shares = {owner: min(length / longest, 1.0) for owner, length in reach.items()}
    return {owner: radius * (TIP_SHARE + (1.0 - TIP_SHARE) * share) for owner, share in shares.items()}


def _apart(points: list[Array], taken: list[Array], distance: float) -> list[Array]:
    """The points farther than `distance` from those of `taken` and from each other."""
    chosen: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > distance for other in [*taken, *chosen]):
            chosen.append(point)
    return chosen


def _limb(end: Array, radius: float, end_radius: float) -> Solid:
    """A capsule from a joint; short limbs are thinner, so that fingers do not look like balls."""
    longest = max(0.4 * float(np.linalg.norm(end)), 0.3 * radius)
    return capsule_between(np.zeros(3), end, min(radius, longest), min(end_radius, longest))
