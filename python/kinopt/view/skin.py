"""Skinned meshes on the page: uploaded once, then moved by bone transforms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .canvas import Canvas
from .look import Color
from .parts import Parts
from .solids import Solid, Triangles, capsule_between, joined

Array = NDArray[np.float64]

#: Number of influences of a vertex that the page blends.
MAX_INFLUENCES = 4
#: Thickness of a bone without a mesh, relative to the skeleton's size, and its largest ratio to the bone's length.
BONE_THICKNESS = 0.014
MAX_THICKNESS_RATIO = 0.16


@dataclass(frozen=True)
class Skin:
    """A mesh at rest with dense skin weights, shape (V, bones)."""

    vertices: Array
    triangles: Triangles
    weights: Array

    def posed(self, skinning_transforms: Array) -> Array:
        """Vertices, shape (V, 3), by linear blend with all influences; transforms of shape (bones, 4, 4)."""
        blended = (self.weights @ skinning_transforms[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
        posed: Array = np.einsum("vij,vj->vi", blended[:, :, :3], self.vertices) + blended[:, :, 3]
        return posed


class SkinOnPage:
    """A skin on the page. `move` sets the transforms of its bones."""

    def __init__(self, scene: Canvas, name: str, skin: Skin, color: Color, **looks: Any) -> None:
        weights, cut = fewer_influences(skin.weights)
        self.cut: float = cut
        self._used = np.nonzero(weights.any(axis=0))[0]
        count = len(self._used)
        self._handle = scene.server.scene.add_mesh_skinned(
            f"/{name}",
            vertices=(skin.vertices * scene.drawn).astype(np.float32),
            faces=skin.triangles,
            # All bones are at the identity at rest, so the sent transforms are the skinning transforms.
            bone_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            bone_positions=np.zeros((count, 3)),
            skin_weights=weights[:, self._used],
            color=color,
            **looks,
        )
        self._parts = Parts(scene.server, self._handle.bones, scene.drawn)

    def move(self, world_from_rest: Array) -> None:
        """Skinning transforms, shape (bones, 4, 4): from the model at rest to the world. They must not scale."""
        self._parts.send(world_from_rest[self._used])

    def remove(self) -> None:
        """Removes it from the page."""
        self._handle.remove()


def fewer_influences(weights: Array) -> tuple[Array, float]:
    """Weights with at most four influences for each vertex, and the largest omitted weight of a vertex; rows sum to
    1."""
    count = int(np.count_nonzero(weights, axis=1).max(initial=0))
    if count <= MAX_INFLUENCES:
        return weights, 0.0
    full = kinopt.skinning.SkinWeights.from_table(weights)
    pruned, _ = full.pruned(MAX_INFLUENCES)
    pruned_weights = np.asarray(pruned.to_table())
    strongest = np.sort(weights, axis=1)[:, -MAX_INFLUENCES:].sum(axis=1)
    return pruned_weights, float((1.0 - strongest / weights.sum(axis=1)).max())


def bone_skin(skeleton: Any) -> Skin:
    """Bodies for bones without a mesh: a thin capsule from a bone's tail to those of its children."""
    bones = skeleton.bones
    names = {bone.name: i for i, bone in enumerate(bones)}
    thick = BONE_THICKNESS * skeleton.size
    ends: list[list[Array]] = [[] for _ in bones]
    for i, bone in enumerate(bones):
        if bone.length > 0.0:
            ends[i].append(bone.rest_tip)
        if bone.parent is not None:
            ends[names[bone.parent]].append(bone.rest_tail)
    solids, owners = [], []
    for i, bone in enumerate(bones):
        limb_ends: list[Array] = []
        for end in ends[i]:
            clear = all(np.linalg.norm(end - other) > 0.1 * thick for other in limb_ends)
            if clear and np.linalg.norm(end - bone.rest_tail) > 0.1 * thick:
                limb_ends.append(end)
        parts = [_limb(bone.rest_tail, end, thick) for end in limb_ends]
        parts.append(capsule_between(bone.rest_tail, bone.rest_tail, (1.25 if limb_ends else 0.8) * thick))
        solid = joined(parts)
        solids.append(solid)
        owners += [i] * len(solid.vertices)
    body = joined(solids)
    weights = np.zeros((len(body.vertices), len(bones)))
    weights[np.arange(len(owners)), owners] = 1.0
    return Skin(body.vertices, body.triangles, weights)


def _limb(start: Array, end: Array, thick: float) -> Solid:
    length = float(np.linalg.norm(end - start))
    return capsule_between(start, end, min(thick, MAX_THICKNESS_RATIO * length))


def nearest_bones(skeleton: Any, vertices: Array) -> Array:
    """Weights for a mesh without weights: each vertex follows the nearest bone."""
    tails = np.array([bone.rest_tail for bone in skeleton.bones])
    tips = np.array([bone.rest_tip for bone in skeleton.bones])
    along = tips - tails
    lengths = np.maximum(np.einsum("bi,bi->b", along, along), 1e-300)
    from_tails = vertices[:, None] - tails
    share = np.clip(np.einsum("vbi,bi->vb", from_tails, along) / lengths, 0.0, 1.0)
    distances = np.linalg.norm(from_tails - share[:, :, None] * along, axis=2)
    weights = np.zeros(distances.shape)
    weights[np.arange(len(vertices)), distances.argmin(axis=1)] = 1.0
    return weights
