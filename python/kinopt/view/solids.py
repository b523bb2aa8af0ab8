"""Meshes of simple solids: boxes, cylinders, spheres, capsules, hulls; sharp edges have separate vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import kinopt

Array = NDArray[np.float64]
Triangles = NDArray[np.uint32]

#: Points around a solid of revolution.
POINTS_AROUND = 40
#: Points of the outline of a half circle.
HALF_CIRCLE_POINTS = 24


@dataclass(frozen=True)
class Solid:
    """A triangle mesh: `vertices` (V, 3) in the model's unit, `triangles` (T, 3) counter-clockwise from outside."""

    vertices: Array
    triangles: Triangles

    def moved(self, placement: Array) -> Solid:
        """The mesh transformed by `placement`, 4 x 4."""
        vertices = self.vertices @ placement[:3, :3].T + placement[:3, 3]
        return Solid(vertices, self.triangles)

    def scaled(self, factors: object) -> Solid:
        """The mesh with its axes scaled; mirrored triangles are reversed."""
        factors = np.broadcast_to(np.asarray(factors, dtype=float), (3,))
        triangles = self.triangles[:, ::-1] if np.prod(factors) < 0.0 else self.triangles
        return Solid(self.vertices * factors, np.ascontiguousarray(triangles))


def joined(solids: list[Solid]) -> Solid:
    """Merges several meshes."""
    starts = np.cumsum([0] + [len(solid.vertices) for solid in solids])
    vertices = [solid.vertices for solid in solids]
    triangles = [solid.triangles + np.uint32(start) for solid, start in zip(solids, starts, strict=False)]
    if not solids:
        return Solid(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint32))
    return Solid(np.concatenate(vertices), np.concatenate(triangles).astype(np.uint32))


def _revolved(outline: Array, around: int = POINTS_AROUND) -> Solid:
    """Revolves an outline of (radius, z) points, from the bottom up, about z; equal points make a sharp edge."""
    angles = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = outline[:, None, :1] * circle[None]
    heights = np.broadcast_to(outline[:, None, 1:], (*rings.shape[:2], 1))
    vertices = np.concatenate([rings, heights], axis=2).reshape(-1, 3)
    triangles = []
    step = np.arange(around)
    following = (step + 1) % around
    for ring in range(len(outline) - 1):
        if np.array_equal(outline[ring], outline[ring + 1]):
            continue
        low, high = ring * around, (ring + 1) * around
        if outline[ring, 0] > 0.0:
            triangles.append(np.stack([low + step, low + following, high + following], axis=1))
        if outline[ring + 1, 0] > 0.0:
            triangles.append(np.stack([low + step, high + following, high + step], axis=1))
    return Solid(vertices, np.concatenate(triangles).astype(np.uint32))


def capsule(length: float, radius: float, end_radius: float | None = None) -> Solid:
    """Convex hull of two spheres with a distance of `length` along z; its middle is the origin.

    `end_radius` is the radius at the upper end, `radius` by default.
    """
    end_radius = radius if end_radius is None else end_radius
    # The common tangent touches both spheres at this latitude.
    tangent = np.arcsin(np.clip((radius - end_radius) / max(length, 1e-12), -1.0, 1.0))
    lower = np.linspace(-np.pi / 2, tangent, HALF_CIRCLE_POINTS // 2)
    upper = np.linspace(tangent, np.pi / 2, HALF_CIRCLE_POINTS // 2)
    bottom = radius * np.stack([np.cos(lower), np.sin(lower)], axis=1) - [0.0, length / 2]
    top = end_radius * np.stack([np.cos(upper), np.sin(upper)], axis=1) + [0.0, length / 2]
    outline = np.concatenate([bottom, top])
    outline[[0, -1], 0] = 0.0
    return _revolved(outline)


def hull(centres: Array, radii: Array) -> Solid:
    """Convex hull of spheres, given by their centres, (N, 3), and radii, (N,)."""
    ball = sphere(1.0).vertices[::7]
    world = kinopt.World()
    world.add_convex("hull", (centres[:, None] + radii[:, None, None] * ball).reshape(-1, 3))
    measures = world["hull"].measures
    return creased(Solid(measures["points"], measures["triangles"]))


def sphere(radius: float) -> Solid:
    """A sphere about the origin."""
    return capsule(0.0, radius)


def cylinder(length: float, radius: float) -> Solid:
    """A cylinder along z about the origin, with small bevels for highlights."""
    bevel = 0.08 * min(radius, length / 2)
    half, turn = length / 2, np.linspace(0.0, np.pi / 2, 5)
    edge = np.stack([radius - bevel + bevel * np.sin(turn), bevel * np.cos(turn) - bevel], axis=1)
    bottom = np.stack([edge[:, 0], -half - edge[:, 1]], axis=1)
    top = np.stack([edge[::-1, 0], half + edge[::-1, 1]], axis=1)
    corners = [[[0.0, -half], [radius - bevel, -half]], bottom, top, [[radius - bevel, half], [0.0, half]]]
    return _revolved(np.concatenate([np.asarray(part) for part in corners]))


def box(size: object) -> Solid:
    """A box about the origin; `size` is its full lengths along x, y and z."""
    vertices, triangles = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for a, b in [(-1, -1), (1, -1), (1, 1), (-1, 1)]:
                corner = np.zeros(3)
                corner[axis], corner[u], corner[v] = sign, a, b
                vertices.append(corner)
            start = len(vertices) - 4
            faces = [[0, 1, 2], [0, 2, 3]] if sign > 0.0 else [[0, 2, 1], [0, 3, 2]]
            triangles += [[start + i for i in face] for face in faces]
    halves = np.asarray(size, dtype=float) / 2
    return Solid(np.array(vertices) * halves, np.array(triangles, dtype=np.uint32))


def capsule_between(start: Array, end: Array, radius: float, end_radius: float | None = None) -> Solid:
    """A capsule from one point to another, with `end_radius` at the other one."""
    length = float(np.linalg.norm(end - start))
    if length < 1e-12:
        return sphere(radius).moved(along(np.eye(3)[2], start))
    return capsule(length, radius, end_radius).moved(along(end - start, (start + end) / 2))


def along(axis: Array, position: Array) -> Array:
    """A placement at a position, with its z axis along `axis`."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    placement = np.eye(4)
    placement[:3, :] = np.stack([x, np.cross(z, x), z, position], axis=1)
    return placement


def creased(solid: Solid, angle: float = 0.6) -> Solid:
    """The surface with separate vertices on either side of edges sharper than `angle`, radians.

    A page computes normals from shared vertices, which would smooth the edges of machined parts.
    """
    _, welded = np.unique(np.round(solid.vertices, 9), axis=0, return_inverse=True)
    corners = welded.reshape(-1)[solid.triangles].astype(np.int64)
    points = solid.vertices[solid.triangles]
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(lengths > 0.0, lengths, 1.0)
    face = np.repeat(np.arange(len(corners)), 3)
    starts, ends = corners.reshape(-1), corners[:, [1, 2, 0]].reshape(-1)
    edge = np.minimum(starts, ends) * (corners.max(initial=0) + 1) + np.maximum(starts, ends)
    order = np.argsort(edge, kind="stable")
    same = edge[order][1:] == edge[order][:-1]
    first, second = order[:-1][same], order[1:][same]
    smooth = np.einsum("ij,ij->i", normals[face[first]], normals[face[second]]) > np.cos(angle)
    first, second = first[smooth], second[smooth]
    # Corners at either end of a smooth edge share a label: labels propagate until they agree.
    label = np.arange(3 * len(corners))
    flat = corners.reshape(-1)
    after_first = 3 * (first // 3) + (first + 1) % 3
    after_second = 3 * (second // 3) + (second + 1) % 3
    first_corner = np.concatenate([first, after_first])
    opposite = np.concatenate([after_second, second])
    # If the neighbour has the opposite orientation, equal ends are equal corners.
    second_corner = np.where(flat[first_corner] == flat[opposite], opposite, np.concatenate([second, after_second]))
    while True:
        lowest = np.minimum(label[first_corner], label[second_corner])
        previous = label.copy()
        np.minimum.at(label, first_corner, lowest)
        np.minimum.at(label, second_corner, lowest)
        if np.array_equal(previous, label):
            break
    representatives, triangles = np.unique(label, return_inverse=True)
    return Solid(
        solid.vertices[solid.triangles.reshape(-1)[representatives]], triangles.reshape(-1, 3).astype(np.uint32)
    )
