"""Placements from positions and rotations in several representations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .errors import InvalidValueError
from .types import Floats

#: Largest deviation of a given matrix from a rotation: the rounding error of numbers with two digits.
_ROTATION_TOLERANCE = 0.02


def placement(
    position: ArrayLike = (0.0, 0.0, 0.0),
    *,
    wxyz: ArrayLike | None = None,
    xyzw: ArrayLike | None = None,
    rpy: ArrayLike | None = None,
    matrix: ArrayLike | None = None,
) -> Floats:
    """A placement of shape (4, 4), or N placements of shape (N, 4, 4): targets for arms, tools, poses.

    ``position`` has shape (3,) or (N, 3), metres. The rotation is a quaternion ``wxyz`` (scalar first) or ``xyzw``
    (scalar last), shape (4,) or (N, 4), of any length but 0. Or it is ``rpy``, shape (3,) or (N, 3): roll, pitch and yaw in
    radians about the fixed axes x, y and z, as in URDF. Or it is a ``matrix``, shape (3, 3) or (N, 3, 3), which is
    projected to the nearest rotation, so rounded numbers are accepted. A (4, 4) matrix is accepted too, with its
    position. The default is the identity.

    Raises ``InvalidValueError``: wrong shapes, numbers that are not finite, quaternions of length 0, matrices that
    mirror or deviate by more than 0.02 from a rotation, more than one rotation.
    """
    rotations = {"wxyz": wxyz, "xyzw": xyzw, "rpy": rpy, "matrix": matrix}
    rotations = {name: value for name, value in rotations.items() if value is not None}
    if len(rotations) > 1:
        raise InvalidValueError(f"a placement has one rotation, not {' and '.join(rotations)}")
    translation = _numbers(position, "position")
    if wxyz is not None:
        rotation = _of_quaternion(_numbers(wxyz, "wxyz"), "wxyz")
    elif xyzw is not None:
        rotation = _of_quaternion(np.roll(_numbers(xyzw, "xyzw"), 1, axis=-1), "xyzw")
    elif rpy is not None:
        rotation = _of_rpy(_numbers(rpy, "rpy"))
    elif matrix is not None:
        full_matrix = _numbers(matrix, "matrix")
        if full_matrix.shape[-2:] == (4, 4):
            translation = translation + full_matrix[..., :3, 3]
            full_matrix = full_matrix[..., :3, :3]
        rotation = _nearest_rotation(full_matrix)
    else:
        rotation = np.eye(3)
    if translation.shape[-1:] != (3,) or translation.ndim > 2:
        raise InvalidValueError(f"position has shape {translation.shape}, expected (3,) or (N, 3)")
    try:
        batch_shape = np.broadcast_shapes(translation.shape[:-1], rotation.shape[:-2])
    except ValueError:
        shapes = f"{translation.shape[:-1]} positions, {rotation.shape[:-2]} rotations"
        raise InvalidValueError(f"expected equal numbers, or one of either: {shapes}") from None
    placed = np.zeros((*batch_shape, 4, 4))
    placed[..., :3, :3] = rotation
    placed[..., :3, 3] = translation
    placed[..., 3, 3] = 1.0
    return placed


def _numbers(value: ArrayLike, name: str) -> Floats:
    try:
        numbers = np.asarray(value)
        if numbers.dtype.kind == "c":
            raise TypeError("they are complex")
        numbers = np.array(numbers, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValueError(f"{name} holds no numbers: {error}") from None
    if not np.isfinite(numbers).all():
        raise InvalidValueError(f"{name} holds numbers that are not finite")
    return numbers


def _of_quaternion(wxyz: Floats, name: str) -> Floats:
    if wxyz.shape[-1:] != (4,) or wxyz.ndim > 2:
        raise InvalidValueError(f"{name} has shape {wxyz.shape}, expected (4,) or (N, 4)")
    length = np.linalg.norm(wxyz, axis=-1, keepdims=True)
    if not (length > 0).all():
        raise InvalidValueError(f"{name} is a quaternion of length 0, which is no rotation")
    w, x, y, z = np.moveaxis(wxyz / length, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _of_rpy(rpy: Floats) -> Floats:
    if rpy.shape[-1:] != (3,) or rpy.ndim > 2:
        raise InvalidValueError(f"rpy has shape {rpy.shape}, expected (3,) or (N, 3)")
    half_angles, axes = rpy[..., ::-1] / 2, np.eye(3)[::-1]
    yaw, pitch, roll = (
        _of_quaternion(np.concatenate([np.cos(half)[..., None], np.sin(half)[..., None] * axis], axis=-1), "rpy")
        for half, axis in zip(np.moveaxis(half_angles, -1, 0), axes)
    )
    return yaw @ pitch @ roll


def _nearest_rotation(matrix: Floats) -> Floats:
    """Nearest rotation: U Vᵀ of the singular value decomposition (Schönemann 1966)."""
    if matrix.shape[-2:] != (3, 3) or matrix.ndim > 3:
        raise InvalidValueError(f"matrix has shape {matrix.shape}, expected (3, 3), (4, 4) or N of them")
    left, _, right = np.linalg.svd(matrix)
    nearest = np.asarray(left @ right)
    off = float(np.abs(nearest - matrix).max(initial=0.0))
    if off > _ROTATION_TOLERANCE or (np.linalg.det(nearest) < 0).any():
        raise InvalidValueError(f"matrix is no rotation: it is {off:.2g} from the nearest, or mirrors")
    return nearest


__all__ = ["placement"]
