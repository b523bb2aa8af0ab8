"""Rigs and skeletons: a skinned mesh, or capsules for bones without one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import look
from .body import Body, Clip, Piece
from .canvas import Canvas
from .curves import MAX_SAMPLES, Curves, curves_of
from .figure import Figure
from .look import Color
from .skin import Skin, SkinOnPage, bone_skin, nearest_bones
from .solids import Solid


Array = NDArray[np.float64]


class CharacterBody(Figure):
    """A rig or a skeleton in a scene: its mesh if it has one, or its bones. Assigning `q` moves it.

    The page blends four influences for each vertex, linearly: `cut` is the largest weight of a vertex that this omits.
    Saved files have all influences.
    """

    def __init__(
        self,
        scene: Canvas,
        thing: Any,
        name: str,
        at: Array,
        *,
        color: Color | None = None,
        opacity: float | None = None,
    ) -> None:
        """Arguments are as in `Scene.add`."""
        super().__init__(scene, thing, name, at)
        mesh, weights = getattr(thing, "mesh", None), getattr(thing, "weights", None)
        if mesh is None:
            self._skin = bone_skin(self.skeleton)
        else:
            vertices = np.asarray(mesh.positions, dtype=float)
            table = nearest_bones(self.skeleton, vertices) if weights is None else weights.to_table()
            self._skin = Skin(vertices, mesh.triangles, table)
        self._color = color or (look.BONE if mesh is None else look.SKIN)
        self._shown = SkinOnPage(scene, name, self._skin, self._color, opacity=opacity)
        self.cut: float = self._shown.cut
        if self.cut > 0.0:
            self.missing.append(
                f"drawn with four influences per vertex: up to {self.cut:.0%} of a vertex's weight is omitted "
                "(not in saved files)"
            )
        self._place(self._q)

    def _draw(self, q: Array, world_from_frames: Array) -> None:
        self._shown.move(self.at @ self.skeleton.skinning_transforms(q))

    def pieces(self) -> list[Piece]:
        """Its mesh in the current pose, in the world, with all influences of each vertex."""
        posed = self._skin.posed(self.skeleton.skinning_transforms(self._q))
        return [Piece(self.name, Solid(posed, self._skin.triangles).moved(self.at), self._color)]

    def remove(self) -> None:
        """Removes it from the scene."""
        self._shown.remove()
        self.scene.forget(self)

    @property
    def pinned_first(self) -> list[str]:
        """Tips that its file pins."""
        return [self.skeleton.tip(bone) for bone in getattr(self.thing, "constrained", [])]

    @property
    def clips(self) -> list[Clip]:
        """Keyframes of the rig."""
        clip = getattr(self.thing, "clip", None)
        return [] if clip is None or clip.is_empty else [Keyframes(self, clip)]


class Keyframes:
    """Keyframes of a rig on a time line."""

    name = "keyframes"

    def __init__(self, body: Body, clip: Any) -> None:
        self._body, self._clip = body, clip
        self.span: tuple[float, float] = clip.time_span

    def show(self, seconds: float) -> None:
        """Sets the pose of the keyframes at that time."""
        q = np.asarray(self._clip.sample(seconds), dtype=float).reshape(-1)
        self._body.q = np.clip(q, self._body.model.lower, self._body.model.upper)

    @property
    def curves(self) -> Curves:
        """Joints of the rig over time."""
        times = np.linspace(*self.span, MAX_SAMPLES)
        return curves_of(self._body, times, np.asarray(self._clip.sample(times), dtype=float))
