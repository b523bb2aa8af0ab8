"""Meshes of collision shapes, for obstacles and robots."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import kinopt

from . import solids
from .solids import Solid

Array = NDArray[np.float64]

#: Thickness of a plane, relative to its length.
RELATIVE_PLANE_THICKNESS = 0.002


def solid_of(obstacle: kinopt.Obstacle, plane: float) -> Solid:
    """Surface of an obstacle in its own frame; a plane is a square of side `plane`."""
    measures = obstacle.measures
    match obstacle.kind:
        case "box":
            return solids.box(measures["size"])
        case "sphere":
            return solids.sphere(measures["radius"])
        case "cylinder":
            return solids.cylinder(measures["length"], measures["radius"])
        case "capsule":
            return solids.capsule(measures["length"], measures["radius"])
        case "plane":
            thin = RELATIVE_PLANE_THICKNESS * plane
            return solids.box([plane, plane, thin]).moved(_raised(-thin / 2))
        case "convex":
            return solids.creased(Solid(measures["points"], measures["triangles"]))
        case "mesh":
            return solids.creased(Solid(measures["vertices"], measures["triangles"]))
        case "height field":
            return _field(measures["heights"], measures["spacing"])
    raise kinopt.InvalidValueError(f"{obstacle.name}: obstacles of kind `{obstacle.kind}` are not drawn")


def _raised(z: float) -> Array:
    placement = np.eye(4)
    placement[2, 3] = z
    return placement


def _field(heights: Array, spacing: Array) -> Solid:
    """Surface over a grid centred on the origin; rows go along y, columns along x."""
    rows, columns = heights.shape
    x = (np.arange(columns) - (columns - 1) / 2) * spacing[0]
    y = (np.arange(rows) - (rows - 1) / 2) * spacing[1]
    grid = np.stack([*np.meshgrid(x, y), heights], axis=-1).reshape(-1, 3)
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + columns + 1], axis=1)
    upper = np.stack([corner, corner + columns + 1, corner + columns], axis=1)
    return solids.creased(Solid(grid, np.concatenate([lower, upper]).astype(np.uint32)))
