"""Worlds of obstacles in a scene, fixed or attached to a body; obstacles in contact are red."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from . import stage
from .body import Body
from .canvas import Canvas
from .look import Color
from .shapes import solid_of
from .transforms import wxyz_of

Array = NDArray[np.float64]

#: Colours of obstacles, and of those in contact.
COLOR: Color = (176, 160, 132)
TOUCHED: Color = (214, 58, 58)
#: Side length of the square that represents a plane, relative to the size of the objects on it.
PLANE_SIZE = 3.0


class Obstacles:
    """A drawn world. `refresh` updates it."""

    def __init__(self, scene: Canvas, world: kinopt.World, name: str, body: Body | None) -> None:
        self.scene = scene
        #: The drawn world.
        self.world = world
        #: Name in the scene.
        self.name = name
        self._body = body
        self._handles: dict[str, Any] = {}
        self._drawn: dict[str, kinopt.Obstacle] = {}
        self._revision = -1
        self._marked: frozenset[str] = frozenset()
        self.refresh()
        if body is not None:
            body.on_move.append(self.follow)

    def refresh(self) -> None:
        """Draws added, moved and attached obstacles, and removes removed ones."""
        if self.world.revision == self._revision:
            return
        self._revision = self.world.revision
        for handle in self._handles.values():
            handle.remove()
        self._drawn = {name: self.world[name] for name in self.world.names}
        self._handles = {name: self._draw(obstacle) for name, obstacle in self._drawn.items()}
        self._marked = frozenset()
        self.follow()

    def follow(self) -> None:
        """Moves attached obstacles to the current poses of their frames."""
        body_placement = np.eye(4) if self._body is None else self._body.at
        for name, obstacle in self._drawn.items():
            handle = self._handles[name]
            if obstacle.attached is None:
                placement = body_placement @ obstacle.placement
            elif self._body is None:
                handle.visible = False
                continue
            else:
                placement = self._body.frame(obstacle.attached) @ obstacle.placement
            handle.position = placement[:3, 3] * self.scene.drawn
            handle.wxyz = wxyz_of(placement[None, :3, :3])[0]

    def mark(self, touched: Iterable[str]) -> None:
        """Draws these obstacles red, and all others in their colour."""
        marked = frozenset(touched) & self._handles.keys()
        for name in marked ^ self._marked:
            handle = self._handles[name]
            if hasattr(handle, "color"):
                handle.color = TOUCHED if name in marked else COLOR
        self._marked = marked

    def remove(self) -> None:
        """Removes it from the scene."""
        if self._body is not None:
            self._body.on_move.remove(self.follow)
        for handle in self._handles.values():
            handle.remove()
        self._handles = {}
        self._drawn = {}
        self.scene.forget(self)

    def _draw(self, obstacle: kinopt.Obstacle) -> Any:
        node, measures = f"/{self.name}/{obstacle.name}", obstacle.measures
        if obstacle.kind == "points":
            shown = self.scene.points(node[1:], measures["positions"], COLOR, size=2.0 * measures["radius"])
            return shown
        solid = solid_of(obstacle, PLANE_SIZE * stage.DRAWN / self.scene.drawn)
        return self.scene.server.scene.add_mesh_simple(
            node,
            vertices=(solid.vertices * self.scene.drawn).astype(np.float32),
            faces=solid.triangles,
            color=COLOR,
            side="double" if obstacle.kind in ("mesh", "height field") else "front",
        )
