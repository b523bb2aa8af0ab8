"""Targets that are dragged with the mouse."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from .canvas import Canvas
from .loop import FRAME
from .transforms import between, matrix_of, placement_of, wxyz_of


Array = NDArray[np.float64]
Moved = Callable[[Array], Any]

#: viser's page tells where a gizmo is 20 times a second; what lies between is filled in.
BETWEEN_MESSAGES = 0.05


class Target:
    """A place that is dragged on the page; whoever asked for `on_move` hears of it frame by frame.

    The page sends twenty places a second; on the way from one to the next the target glides, so that what
    follows it moves at the screen's rate.
    """

    def __init__(self, scene: Canvas, name: str, placement: Array, size: float, turns: bool) -> None:
        self.scene = scene
        #: Its name in the scene.
        self.name = name
        #: How long its arrows are, in the model's unit.
        self.size = size
        self._heard: list[Moved] = []
        self._grabbed: list[Moved] = []
        self._released: list[Moved] = []
        self._now = self._from = self._to = placement.copy()
        self._began = -np.inf
        #: Whether a mouse holds it.
        self.held = False
        #: When the place that is answered now was heard of, or came up on the way there, `time.perf_counter()`.
        self.asked = 0.0
        position, wxyz = self._shown(placement)
        self._gizmo = scene.server.scene.add_transform_controls(
            f"/{name}",
            scale=size * scene.drawn,
            line_width=2.2,
            disable_rotations=not turns,
            depth_test=False,
            position=position,
            wxyz=wxyz,
        )

        @self._gizmo.on_update
        async def _(event: viser.TransformControlsEvent) -> None:
            arrived = time.perf_counter()
            place = matrix_of(event.target.wxyz, event.target.position / scene.drawn)
            phase = event.phase
            scene.loop.post(lambda: self._hear(place, phase, arrived))

    @property
    def placement(self) -> Array:
        """Where it is: world_from_target, shape (4, 4); assigning moves it, without calling `on_move`.

        What is no placement raises `InvalidValueError`.
        """
        return self._now.copy()

    @placement.setter
    def placement(self, placement: object) -> None:
        self._now = self._from = self._to = placement_of(placement).copy()
        self._began = -np.inf
        self._gizmo.position, self._gizmo.wxyz = self._shown(self._now)

    @property
    def turns(self) -> bool:
        """Whether it can be turned."""
        return not self._gizmo.disable_rotations

    @turns.setter
    def turns(self, turns: bool) -> None:
        self._gizmo.disable_rotations = not turns

    @property
    def visible(self) -> bool:
        """Whether its gizmo is shown."""
        return bool(self._gizmo.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._gizmo.visible = visible

    def on_move(self, moved: Moved) -> Moved:
        """Has `moved` called with the placement, shape (4, 4), for every frame in which it is dragged."""
        self._heard.append(moved)
        return moved

    def on_grab(self, grabbed: Moved) -> Moved:
        """Has `grabbed` called with the placement, shape (4, 4), when the mouse takes hold."""
        self._grabbed.append(grabbed)
        return grabbed

    def on_release(self, released: Moved) -> Moved:
        """Has `released` called with the placement, shape (4, 4), when the mouse lets go."""
        self._released.append(released)
        return released

    def remove(self) -> None:
        """Takes it out of the scene."""
        for heard in (self._grabbed, self._heard, self._released):
            heard.clear()
        self._gizmo.remove()
        self.scene.forget(self)

    def __repr__(self) -> str:
        x, y, z = self._now[:3, 3]
        return f"Target({self.name!r} at {x:.4g}, {y:.4g}, {z:.4g})"

    def _shown(self, placement: Array) -> tuple[Any, Any]:
        return placement[:3, 3] * self.scene.drawn, wxyz_of(placement[None, :3, :3])[0]

    def _hear(self, placement: Array, phase: str, arrived: float | None = None) -> None:
        """A message of the page's, on the loop's thread."""
        if arrived is not None:
            self.asked = arrived
        self.held = phase != "end"
        if phase == "start":
            for grabbed in list(self._grabbed):
                grabbed(self._now)
            return
        now = time.perf_counter()
        self._from, self._to = self._now, placement
        self._began = -np.inf if phase == "end" else now
        if self._go_on(now):
            self.scene.loop.tick(self._glide)
        if phase == "end":
            for released in list(self._released):
                released(self._now)

    def _glide(self, now: float) -> bool:
        """One more frame on the way."""
        self.asked = now
        return self._go_on(now)

    def _go_on(self, now: float) -> bool:
        """Goes on towards the last place heard of; whether there is more to go."""
        share = min((now - self._began + FRAME) / BETWEEN_MESSAGES, 1.0)
        self._now = between(self._from, self._to, share)
        for moved in list(self._heard):
            moved(self._now)
        return share < 1.0
