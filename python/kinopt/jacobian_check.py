"""Comparison of a residual's Jacobian with finite differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._kinopt import ForwardKinematics, Model
from .errors import InvalidValueError
from .types import HasModel

Array = NDArray[np.float64]

#: Step of the central differences, radians and metres; their error is of second order in it.
STEP = 1e-5


def check(residual: Any, model: Model | HasModel, q: ArrayLike, tolerance: float) -> None:
    """Implements ``tasks.Residual.check_jacobian`` for a ``tasks.Residual``."""
    if residual.jacobian is None:
        raise InvalidValueError("the residual has no jacobian: finite differences replace it")
    inner_model = model if isinstance(model, Model) else model.model
    placements = ForwardKinematics(inner_model, residual.frames).place(q) if residual.frames else np.zeros((0, 4, 4))
    joints = inner_model.joint_names if residual.joints == "all" else residual.joints
    parts = _parts(inner_model, joints)
    values = _values(inner_model, parts, np.asarray(q, dtype=float))

    def called(function: Any, placements: Array, values: Array) -> Array:
        inputs = [value for value, read in ((placements, residual.frames), (values, residual.joints)) if read]
        return np.asarray(function(*inputs), dtype=float)

    rows = sum(residual.rows.values())
    columns = 6 * len(residual.frames) + len(values)
    claimed = called(residual.jacobian, placements, values)
    if claimed.shape != (rows, columns):
        raise InvalidValueError(
            f"what the residual's jacobian returned has shape {claimed.shape}, expected ({rows}, {columns})"
        )
    motions = _motions(len(residual.frames), parts, values)
    # One column for each motion; the four numbers of a ball's quaternion have three motions.
    returned = claimed @ np.array([motion.rate for motion in motions]).T
    true = np.empty_like(returned)
    for column, motion in enumerate(motions):
        ahead, behind = (
            called(residual.function, *motion.moved(placements, values, step)).reshape(rows) for step in (STEP, -STEP)
        )
        true[:, column] = (ahead - behind) / (2 * STEP)
    # Relative to the largest derivative of the row, at least 1. The negated test below fails for NaN.
    off = np.abs(returned - true) / np.maximum(1.0, np.abs(true).max(axis=1, initial=0.0))[:, None]
    failed = np.argwhere(~(off <= tolerance))
    if len(failed):
        row, column = failed[np.argmax(np.nan_to_num(off, nan=np.inf)[tuple(failed.T)])]
        raise InvalidValueError(
            f"the jacobian of {residual.name or 'the residual'} is wrong in {len(failed)} of {returned.size} "
            f"entries, most in row {row} by {motions[column].name(residual.frames)}: it returns "
            f"{returned[row, column]:.6g}, differences give {true[row, column]:.6g}"
        )


def _parts(model: Model, joints: Sequence[str]) -> list[tuple[str, int, int]]:
    """Name of each joint of the residual, with the range of its numbers in a configuration."""
    moving = {joint.name: joint for joint in model.joints if joint.coordinate is not None}
    missing = [joint for joint in joints if joint not in moving]
    if missing:
        raise InvalidValueError(f"{missing[0]} is no moving joint of the model: {', '.join(moving)}")
    ranges = [(name, int(moving[name].coordinate or 0), moving[name].kind == "ball") for name in joints]
    return [(name, first, first + (4 if is_ball else 1)) for name, first, is_ball in ranges]


def _values(model: Model, parts: Sequence[tuple[str, int, int]], q: Array) -> Array:
    """Joint inputs of the residual, with unit quaternions."""
    if q.shape != (model.configuration_len,):
        raise InvalidValueError(f"q has shape {q.shape}, expected ({model.configuration_len},)")
    read = [model.normalise(q)[first:end] for _, first, end in parts]
    return np.concatenate(read) if read else np.zeros(0)


@dataclass(frozen=True)
class _Motion:
    """A motion of the residual's inputs."""

    frame: int
    direction: int
    joint: str
    #: Range of the joint's numbers in the values.
    at: slice
    #: Rates of all columns.
    rate: Array

    def moved(self, placements: Array, values: Array, step: float) -> tuple[Array, Array]:
        """Inputs of the residual after a small motion."""
        placements, values = placements.copy(), values.copy()
        if self.joint:
            moved_values = values[self.at] + step * self.rate[6 * len(placements) :][self.at]
            values[self.at] = moved_values / np.linalg.norm(moved_values) if len(moved_values) == 4 else moved_values
        elif self.direction < 3:
            placements[self.frame, self.direction, 3] += step
        else:
            a, b = (self.direction - 2) % 3, (self.direction - 1) % 3
            turn = np.eye(3)
            turn[a, a] = turn[b, b] = np.cos(step)
            turn[b, a], turn[a, b] = np.sin(step), -np.sin(step)
            placements[self.frame, :3, :3] = turn @ placements[self.frame, :3, :3]
        return placements, values

    def name(self, frames: Sequence[str]) -> str:
        """Text for the variable of a derivative."""
        if self.joint and self.at.stop - self.at.start == 4:
            return f"the rotation about {'xyz'[self.direction]} of the joint {self.joint!r}"
        if self.joint:
            return f"the joint {self.joint!r}"
        kind = "velocity along" if self.direction < 3 else "angular velocity about"
        return f"the {kind} {'xyz'[self.direction % 3]} of the frame {frames[self.frame]!r}"


def _motions(frames: int, parts: Sequence[tuple[str, int, int]], values: Array) -> list[_Motion]:
    """All motions of the residual's inputs."""
    columns = 6 * frames + len(values)
    units = np.eye(columns)
    motions = [_Motion(k // 6, k % 6, "", slice(0, 0), units[k]) for k in range(6 * frames)]
    first = 0
    for name, begin, end in parts:
        joint_range = slice(first, first + end - begin)
        first = joint_range.stop
        if joint_range.stop - joint_range.start == 1:
            motions.append(_Motion(0, 0, name, joint_range, units[6 * frames + joint_range.start]))
            continue
        w, x, y, z = values[joint_range]
        # q times half of i, of j and of k.
        for direction, turn in enumerate([(-x, w, z, -y), (-y, -z, w, x), (-z, y, -x, w)]):
            rate = np.zeros(columns)
            rate[6 * frames + joint_range.start : 6 * frames + joint_range.stop] = 0.5 * np.array(turn)
            motions.append(_Motion(0, direction, name, joint_range, rate))
    return motions
