"""A mesh of a scene on the page, moved by bone transforms or, where these do not suffice, by vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .body import Body, Piece
from .look import Color
from .skin import Skin, SkinOnPage
from .solids import Solid, Triangles
from .textures import Colors, palette

Array = NDArray[np.float64]

#: Relative difference of scales that count as equal.
SCALE_TOLERANCE = 2e-3


class MeshOnBones:
    """A mesh that follows joints of an armature, in parts of one colour.

    Bones of the page rotate and translate, but do not scale. A constant uniform scale of all joints is applied to the
    mesh once. Meshes with other scales of joints, or with morph targets, send their vertices.
    """

    def __init__(
        self,
        body: Body,
        name: str,
        skin: Skin,
        joints: Array,
        joint_from_mesh: Array,
        moments: Array,
        color: Color,
        opacity: float | None = None,
        morphs: tuple[Any, int] | None = None,
        colors: Colors | None = None,
    ) -> None:
        """`joints` are bone indices of the armature, `moments` model_from_bone at several times, (N, bones, 4, 4).

        `colors` are those of its triangles, shape (T, 3), `color` otherwise.
        """
        self.name: str = name
        self._skin = skin
        self._joints, self._joint_from_mesh, self._morphs = joints, joint_from_mesh, morphs
        self._drawn = body.scene.drawn
        #: Differences of the drawing from the file, one line each.
        self.notes: list[str] = []
        table = np.array([color], dtype=np.uint8)
        labels = np.zeros(len(skin.triangles), dtype=np.intp)
        if colors is not None:
            table, labels = palette(colors)
            if len(table) > 1:
                self.notes.append(f"{name} has one colour a triangle, {len(table)} colours in all")
        #: Parts: colour, vertices and their triangles.
        self._parts: list[tuple[Color, Triangles, Triangles]] = []
        for label, (red, green, blue) in enumerate(table.tolist()):
            vertices, corners = np.unique(skin.triangles[labels == label], return_inverse=True)
            self._parts.append(((red, green, blue), vertices, corners.reshape(-1, 3).astype(np.uint32)))
        scale = None if morphs else steady_scale(moments[:, joints] @ joint_from_mesh)
        self._scale = 1.0 if scale is None else scale
        self._by_bones: list[SkinOnPage] = []
        self._by_vertices: list[Any] = []
        if scale is None:
            self.notes.append(f"{name} has scaled bones or morph targets: its vertices are sent instead of bone transforms")
        for i, (part_color, vertices, triangles) in enumerate(self._parts):
            node = f"{name}/{i}"
            if scale is None:
                first = (skin.vertices[vertices] * self._drawn).astype(np.float32)
                self._by_vertices.append(
                    body.scene.server.scene.add_mesh_simple(
                        f"/{node}", vertices=first, faces=triangles, color=part_color, opacity=opacity
                    )
                )
                continue
            part = Skin(skin.vertices[vertices] * scale, triangles, skin.weights[vertices])
            self._by_bones.append(SkinOnPage(body.scene, node, part, part_color, opacity=opacity))
        cut = max((part.cut for part in self._by_bones), default=0.0)
        if cut > 0.0:
            self.notes.append(f"{name} is drawn with four influences per vertex: up to {cut:.0%} of a vertex's weight is omitted")

    @classmethod
    def of_scene(
        cls, body: Any, name: str, mesh: Any, moments: Array, color: Color, opacity: float | None, colors: Colors | None
    ) -> MeshOnBones:
        """A mesh of a glTF scene."""
        names = body.armature.names
        vertices = np.asarray(mesh.mesh.positions, dtype=float)
        if mesh.skin is None:
            joints, joint_from_mesh = np.array([names.index(mesh.bone)]), np.eye(4)[None]
            weights = np.ones((len(vertices), 1))
        else:
            joints = np.array([names.index(joint) for joint in mesh.skin.joints])
            joint_from_mesh = np.asarray(mesh.skin.joint_from_mesh, dtype=float)
            weights = mesh.skin.weights.to_table()
        targets = mesh.morph_targets
        morphs = (targets, mesh.first_morph_weight) if targets.names else None
        skin = Skin(vertices, mesh.mesh.triangles, weights)
        skin = skin if morphs else welded(skin)
        return cls(body, name, skin, joints, joint_from_mesh, moments, color, opacity, morphs, colors)

    def move(self, world_from_bone: Array, pose: Any) -> None:
        """Moves it with the armature's bones, shape (bones, 4, 4)."""
        if self._by_bones:
            transforms = world_from_bone[self._joints] @ self._joint_from_mesh
            transforms[:, :3, :3] /= self._scale
            for part in self._by_bones:
                part.move(transforms)
            return
        positions = (self._posed(world_from_bone, pose) * self._drawn).astype(np.float32)
        for handle, (_, vertices, _) in zip(self._by_vertices, self._parts):
            handle.vertices = positions[vertices]

    def pieces(self, world_from_bone: Array, pose: Any) -> list[Piece]:
        """Its parts in the world, with all influences and morph targets."""
        positions = self._posed(world_from_bone, pose)
        return [
            Piece(self.name, Solid(positions[vertices], triangles), color) for color, vertices, triangles in self._parts
        ]

    def _posed(self, world_from_bone: Array, pose: Any) -> Array:
        """Its vertices in the world, shape (V, 3)."""
        transforms = world_from_bone[self._joints] @ self._joint_from_mesh
        if self._morphs is None:
            return self._skin.posed(transforms)
        targets, first = self._morphs
        vertices = self._skin.vertices.copy()
        for target, weight in zip(targets.targets, pose.morph_weights[first:], strict=False):
            vertices[target.vertices] += float(weight) * np.asarray(target.position_deltas, dtype=float)
        return Skin(vertices, self._skin.triangles, self._skin.weights).posed(transforms)

    def remove(self) -> None:
        """Removes it from the page."""
        for part in [*self._by_bones, *self._by_vertices]:
            part.remove()


def steady_scale(transforms: Array) -> float | None:
    """Common uniform scale of all transforms, shape (..., 4, 4); None without one."""
    linear = transforms[..., :3, :3]
    squares = np.swapaxes(linear, -1, -2) @ linear
    square = float(np.trace(squares, axis1=-2, axis2=-1).mean()) / 3.0
    if square <= 0.0 or np.abs(squares / square - np.eye(3)).max() > 2.0 * SCALE_TOLERANCE:
        return None
    # A bone of the page cannot mirror.
    return float(np.sqrt(square)) if (np.linalg.det(linear) > 0.0).all() else None


def welded(skin: Skin) -> Skin:
    """The skin with coincident vertices of equal weights merged: normals become smooth."""
    keys = np.concatenate([np.round(skin.vertices, 9), np.round(skin.weights, 6)], axis=1)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    triangles = inverse.reshape(-1)[skin.triangles].astype(np.uint32)
    return Skin(skin.vertices[first], triangles, skin.weights[first])
