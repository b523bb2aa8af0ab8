"""Balance of a body: holds during a drag, and the drawn centre of mass over the support polygon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .look import Color
from .transforms import hull_2d

if TYPE_CHECKING:
    from .body import Body
    from .canvas import Canvas

Array = NDArray[np.float64]

#: Strict priority levels of a standing body: foot locks and balance have priority over an unreachable hand.
PINNED, BALANCE, DRAGGED = 0, 1, 2
#: Pinned frames higher than this above the lowest one are no feet, relative to the height of the model above it.
MAX_FOOT_HEIGHT = 0.15
#: Height of a sole above the lowest one up to which it carries the body, relative to the body's size.
MAX_SOLE_HEIGHT = 0.02
#: Distance of the centre of mass outside the support polygon that counts as balance, relative to the body's size: a
#: solved pose may be on an edge, within the tolerance of its tasks.
TOLERANCE = 1e-4
#: Colours of a body in balance, and of one that tips over.
BALANCED: Color = (47, 158, 96)
UNBALANCED: Color = (214, 58, 58)
#: Radius of the drawn centre of mass, relative to the body's size.
RADIUS = 0.02


@dataclass
class Holding:
    """Tasks that keep frames in place, and joints with little motion."""

    tasks: list[Any] = field(default_factory=list)
    #: The problem's `ParameterMap`; None if all joints are free.
    parameters: Any = None
    #: True if the tasks include a posture.
    has_posture: bool = False


class Balance:
    """Drawn centre of mass of a robot, its projection onto the ground, and the support polygon of its feet.

    They are green in balance, red otherwise. They follow the robot.
    """

    def __init__(self, body: Body, feet: Sequence[str], name: str) -> None:
        self.scene: Canvas = body.scene
        self.body: Body = body
        #: Name in the scene.
        self.name = name
        self._soles = {foot: np.asarray(body.thing.sole(foot), dtype=float) for foot in feet}
        self._size = body.size()
        scene = body.scene.server.scene
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        radius = RADIUS * self._size * body.scene.drawn
        self._ball: Any = scene.add_icosphere(f"/{name}/centre of mass", radius, color=BALANCED)
        self._shadow: Any = scene.add_icosphere(f"/{name}/below it", radius / 2, color=BALANCED)
        self._lines: Any = scene.add_line_segments(
            f"/{name}/support polygon", points=nothing, colors=BALANCED, thickness=4.0, thickness_units="screen"
        )
        body.on_move.append(self.refresh)
        self.refresh()

    @property
    def visible(self) -> bool:
        """True if it is shown."""
        return bool(self._ball.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._ball.visible = self._shadow.visible = self._lines.visible = visible

    def refresh(self) -> None:
        """Updates the drawing to the body."""
        body, up = self.body, 2 if self.scene.up == "+z" else 1
        level = [axis for axis in range(3) if axis != up]
        centre = (body.at @ [*body.thing.center_of_mass(body.q), 1.0])[:3]
        soles = [body.frame(foot) @ np.c_[sole, np.ones(len(sole))].T for foot, sole in self._soles.items()]
        ground = min((float(sole[up].min()) for sole in soles), default=0.0)
        carrying = [sole[:3].T for sole in soles if sole[up].min() < ground + MAX_SOLE_HEIGHT * self._size]
        corners = np.concatenate(carrying) if carrying else np.zeros((0, 3))
        order, inside = hull_2d(corners[:, level], centre[level], TOLERANCE * self._size)
        polygon = corners[order]
        polygon[:, up] = below = ground + 1e-3 * self._size
        foot = centre.copy()
        foot[up] = below
        segments = [[a, b] for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)] + [[centre, foot]]
        self._ball.position, self._shadow.position = centre * self.scene.drawn, foot * self.scene.drawn
        self._lines.points = (np.array(segments) * self.scene.drawn).astype(np.float32)
        color = BALANCED if inside else UNBALANCED
        if tuple(self._ball.color) != color:
            self._ball.color = self._shadow.color = color
            self._lines.colors = np.array(color, dtype=np.uint8)

    def remove(self) -> None:
        """Removes it from the scene."""
        self.body.on_move.remove(self.refresh)
        for handle in (self._ball, self._shadow, self._lines):
            handle.remove()
        self.scene.forget(self)


def has_masses(thing: Any, q: Array) -> bool:
    """True if the file of a robot has masses."""
    try:
        thing.center_of_mass(q)
    except (kinopt.KinoptError, AttributeError):
        return False
    return True


def feet(model: Any, pinned: Sequence[str], q: Array) -> list[str]:
    """The lowest of the pinned frames."""
    if not pinned:
        return []
    heights = {frame: float(kinopt.frame_placement(model, frame, q)[2, 3]) for frame in pinned}
    every = kinopt.ForwardKinematics(model).place(q)[:, 2, 3]
    lowest = min(heights.values())
    near = lowest + MAX_FOOT_HEIGHT * (float(every.max()) - lowest)
    return [frame for frame in pinned if heights[frame] <= near]
