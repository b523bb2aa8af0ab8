"""Targets that are dragged with the mouse."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from .canvas import Canvas
from .loop import FRAME_TIME
from .transforms import between, matrix_of, placement_of, wxyz_of


Array = NDArray[np.float64]
Moved = Callable[[Array], Any]

#: viser's page sends the pose of a gizmo 20 times a second; poses between are interpolated.
MESSAGE_INTERVAL = 0.05


class Target:
    """A pose that is dragged on the page; `on_move` callbacks receive it frame by frame.

    The page sends twenty poses a second. The target interpolates between them, so that its followers move at the
    screen's rate.
    """

    def __init__(self, scene: Canvas, name: str, placement: Array, size: float, turns: bool) -> None:
        self.scene = scene
        #: Name in the scene.
        self.name = name
        #: Length of its arrows, in the model's unit.
        self.size = size
        self._heard: list[Moved] = []
        self._grabbed: list[Moved] = []
        self._released: list[Moved] = []
        self._now = self._from = self._to = placement.copy()
        self._began = -np.inf
        #: True while the mouse holds it.
        self.held: bool = False
        #: Time when the current pose was received or interpolated, `time.perf_counter()`.
        self.asked: float = 0.0
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
            moved_placement = matrix_of(event.target.wxyz, event.target.position / scene.drawn)
            phase = event.phase
            scene.loop.post(lambda: self._hear(moved_placement, phase, arrived))

    @property
    def placement(self) -> Array:
        """Current pose: world_from_target, shape (4, 4); assigning it moves the target, without calling `on_move`.

        Raises `InvalidValueError` for an invalid placement.
        """
        return self._now.copy()

    @placement.setter
    def placement(self, placement: object) -> None:
        self._now = self._from = self._to = placement_of(placement).copy()
        self._began = -np.inf
        self._gizmo.position, self._gizmo.wxyz = self._shown(self._now)

    @property
    def turns(self) -> bool:
        """True if it can be rotated."""
        return not self._gizmo.disable_rotations

    @turns.setter
    def turns(self, turns: bool) -> None:
        self._gizmo.disable_rotations = not turns

    @property
    def visible(self) -> bool:
        """True if its gizmo is shown."""
        return bool(self._gizmo.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._gizmo.visible = visible

    def on_move(self, moved: Moved) -> Moved:
        """Calls `moved` with the placement, shape (4, 4), in every frame of a drag."""
        self._heard.append(moved)
        return moved

    def on_grab(self, grabbed: Moved) -> Moved:
        """Calls `grabbed` with the placement, shape (4, 4), when a drag starts."""
        self._grabbed.append(grabbed)
        return grabbed

    def on_release(self, released: Moved) -> Moved:
        """Calls `released` with the placement, shape (4, 4), when a drag ends."""
        self._released.append(released)
        return released

    def remove(self) -> None:
        """Removes it from the scene."""
        for callbacks in (self._grabbed, self._heard, self._released):
            callbacks.clear()
        self._gizmo.remove()
        self.scene.forget(self)

    def __repr__(self) -> str:
        x, y, z = self._now[:3, 3]
        return f"Target({self.name!r} at {x:.4g}, {y:.4g}, {z:.4g})"

    def _shown(self, placement: Array) -> tuple[Any, Any]:
        return placement[:3, 3] * self.scene.drawn, wxyz_of(placement[None, :3, :3])[0]

    def _hear(self, placement: Array, phase: str, arrived: float | None = None) -> None:
        """Handles a message of the page, on the loop's thread."""
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
        """One frame of interpolation."""
        self.asked = now
        return self._go_on(now)

    def _go_on(self, now: float) -> bool:
        """Moves towards the last received pose; returns true until it is reached."""
        share = min((now - self._began + FRAME_TIME) / MESSAGE_INTERVAL, 1.0)
        self._now = between(self._from, self._to, share)
        for moved in list(self._heard):
            moved(self._now)
        return share < 1.0
