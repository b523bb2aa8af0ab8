"""Whether a residual's own Jacobian is the derivative of its function."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._kinopt import ForwardKinematics, Model
from .errors import InvalidValueError
from .types import HasModel

Array = NDArray[np.float64]

#: Radians and metres of each step; central differences err by its square.
STEP = 1e-5


def check(residual: Any, model: Model | HasModel, q: ArrayLike, tolerance: float) -> None:
    """As ``tasks.Residual.check_jacobian``, of the ``tasks.Residual`` given."""
    if residual.jacobian is None:
        raise InvalidValueError("the residual has no Jacobian of its own: differences stand in for it")
    own = model if isinstance(model, Model) else model.model
    places = ForwardKinematics(own, residual.frames).place(q) if residual.frames else np.zeros((0, 4, 4))
    joints = own.joint_names if residual.joints == "all" else residual.joints
    values = _values(own, joints, np.asarray(q, dtype=float)) if residual.joints else np.zeros(0)

    def called(function: Any, places: Array, values: Array) -> Array:
        given = [some for some, read in ((places, residual.frames), (values, residual.joints)) if read]
        return np.asarray(function(*given), dtype=float)

    rows = sum(residual.rows.values())
    columns = 6 * len(residual.frames) + len(joints)
    claimed = called(residual.jacobian, places, values)
    if claimed.shape != (rows, columns):
        raise InvalidValueError(
            f"what the residual's jacobian returned has shape {claimed.shape}, expected ({rows}, {columns})"
        )
    true = np.empty((rows, columns))
    for column in range(columns):
        ahead, behind = (
            called(residual.function, *_moved(places, values, column, step)).reshape(rows)
            for step in (STEP, -STEP)
        )
        true[:, column] = (ahead - behind) / (2 * STEP)
    # A row's largest derivative says what is small in it; NaN is never small.
    off = np.abs(claimed - true) / np.maximum(1.0, np.abs(true).max(axis=1, initial=0.0))[:, None]
    wrong = np.argwhere(~(off <= tolerance))
    if len(wrong):
        row, column = wrong[np.argmax(np.nan_to_num(off, nan=np.inf)[tuple(wrong.T)])]
        raise InvalidValueError(
            f"the jacobian of {residual.name or 'the residual'} is wrong in {len(wrong)} of {claimed.size} "
            f"entries, most in row {row} by {_of(residual.frames, joints, int(column))}: it says "
            f"{claimed[row, column]:.6g}, differences say {true[row, column]:.6g}"
        )


def _values(model: Model, joints: Sequence[str], q: Array) -> Array:
    """What the residual reads of the joints."""
    names = model.joint_names
    if q.shape != (len(names),):
        raise InvalidValueError(f"q has shape {q.shape}, expected ({len(names)},)")
    missing = [joint for joint in joints if joint not in names]
    if missing:
        raise InvalidValueError(f"{missing[0]} is no moving joint of the model: {', '.join(names)}")
    return np.array([q[names.index(joint)] for joint in joints])


def _moved(places: Array, values: Array, column: int, step: float) -> tuple[Array, Array]:
    """What the residual reads after a small motion along one column."""
    places, values = places.copy(), values.copy()
    frame, way = divmod(column, 6)
    if frame >= len(places):
        values[column - 6 * len(places)] += step
    elif way < 3:
        places[frame, way, 3] += step
    else:
        a, b = (way - 2) % 3, (way - 1) % 3
        turn = np.eye(3)
        turn[a, a] = turn[b, b] = np.cos(step)
        turn[b, a], turn[a, b] = np.sin(step), -np.sin(step)
        places[frame, :3, :3] = turn @ places[frame, :3, :3]
    return places, values


def _of(frames: Sequence[str], joints: Sequence[str], column: int) -> str:
    """What a column is the derivative by, in words."""
    frame, way = divmod(column, 6)
    if frame >= len(frames):
        return f"the joint {joints[column - 6 * len(frames)]!r}"
    kind = "velocity along" if way < 3 else "angular velocity about"
    return f"the {kind} {'xyz'[way % 3]} of the frame {frames[frame]!r}"
