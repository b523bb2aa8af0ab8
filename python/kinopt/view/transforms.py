"""Placements in viser's form: quaternions (w, x, y, z) and positions, for several parts at once."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

import kinopt
from kinopt._kinopt import tasks

Array = NDArray[np.float64]


def _quaternion_products() -> tuple[Array, Array]:
    """Linear map from the nine numbers of a rotation matrix to 4 q qᵀ of its quaternion, and the constant part."""
    products = np.zeros((4, 4, 3, 3))
    diagonal = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    for i, signs in enumerate(diagonal):
        for axis, sign in enumerate(signs):
            products[i, i, axis, axis] = sign
    for a, b, c in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]:
        products[0, a + 1, c, b] = products[a + 1, 0, c, b] = 1.0
        products[0, a + 1, b, c] = products[a + 1, 0, b, c] = -1.0
        products[a + 1, b + 1, a, b] = products[b + 1, a + 1, a, b] = 1.0
        products[a + 1, b + 1, b, a] = products[b + 1, a + 1, b, a] = 1.0
    return np.ascontiguousarray(products.reshape(16, 9).T), np.eye(4).reshape(16)


_PRODUCTS, _ONES = _quaternion_products()


def wxyz_of(rotations: Array) -> Array:
    """Unit quaternions (w, x, y, z), shape (N, 4), of rotation matrices, shape (N, 3, 3)."""
    count = len(rotations)
    products = rotations.reshape(count, 9) @ _PRODUCTS
    products += _ONES
    # The row of the largest component has no cancellation, even near half turns.
    largest = products[:, ::5].argmax(axis=1)
    rows: Array = products.reshape(count, 4, 4)[np.arange(count), largest]
    rows /= np.sqrt(np.einsum("ij,ij->i", rows, rows))[:, None]
    return rows


def matrix_of(wxyz: Array, position: Array) -> Array:
    """The placement, shape (4, 4), of a quaternion (w, x, y, z) of any length and a position."""
    w, x, y, z = np.asarray(wxyz, dtype=float) / np.linalg.norm(wxyz)
    placement = np.eye(4)
    placement[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    placement[:3, 3] = position
    return placement


def placement_of(value: object, name: str = "placement") -> Array:
    """A 4 x 4 array from a placement in any form of `kinopt.types.PlacementLike`.

    Raises `InvalidValueError` for other values, and for numbers that are not finite.
    """
    placement = np.array(tasks.placement(cast(Any, value), name))
    if not np.isfinite(placement).all():
        raise kinopt.InvalidValueError(f"{name} holds numbers that are not finite")
    return placement


def inverse(placement: Array) -> Array:
    """The inverse of a rigid placement, shape (4, 4)."""
    turned = placement[:3, :3].T
    result = np.eye(4)
    result[:3, :3] = turned
    result[:3, 3] = -turned @ placement[:3, 3]
    return result


def between(first: Array, second: Array, share: float) -> Array:
    """Interpolates placements: positions linearly, rotations along the shortest arc."""
    if share >= 1.0:
        return second
    a, b = wxyz_of(np.stack([first[:3, :3], second[:3, :3]]))
    cosine = float(a @ b)
    if cosine < 0.0:
        b, cosine = -b, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-6:
        turned = (1.0 - share) * a + share * b
    else:
        turned = np.sin((1.0 - share) * angle) * a + np.sin(share * angle) * b
    position = (1.0 - share) * first[:3, 3] + share * second[:3, 3]
    return matrix_of(turned, position)


def hull_2d(points: Array, inner: Array, tolerance: float = 0.0) -> tuple[list[int], bool]:
    """Indices of the convex hull of points, shape (N, 2), counter-clockwise; true if `inner` is in it.

    A point that is at most `tolerance` outside an edge counts as inside.
    """

    def turn(a: Array, b: Array, c: Array) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    hull: list[int] = []
    for half in (order, order[::-1]):
        start = len(hull)
        for i in half:
            while len(hull) > start + 1 and turn(points[hull[-2]], points[hull[-1]], points[i]) <= 0.0:
                hull.pop()
            hull.append(i)
        del hull[-1:]
    edges = [(points[a], points[b]) for a, b in zip(hull, hull[1:] + hull[:1], strict=True)]
    inside = all(turn(a, b, inner) >= -tolerance * float(np.linalg.norm(b - a)) for a, b in edges)
    return hull, len(hull) > 2 and inside
