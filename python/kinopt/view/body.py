"""What every thing in a scene that has a configuration can do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

import kinopt

from .canvas import Canvas
from .closing import closed
from .holding import Holding
from .look import Color, DrawnKinematics, extent
from .solids import Solid

Array = NDArray[np.float64]


class Clip(Protocol):
    """Something that a body plays."""

    #: What it is called.
    name: str
    #: From when to when it goes, seconds.
    span: tuple[float, float]

    def show(self, seconds: float) -> None:
        """Moves the body to where it is then."""


@dataclass(frozen=True)
class Piece:
    """A mesh and its colour: on a frame of a body, or in the world as it is saved; in the model's unit."""

    name: str
    solid: Solid
    color: Color


class Body(ABC):
    """Something with a configuration that is drawn in a scene: a robot, a figure, a character."""

    def __init__(self, scene: Canvas, thing: Any, name: str, at: Array) -> None:
        self.scene = scene
        #: What is drawn, as it was given: a robot, rig, skeleton or model.
        self.thing = thing
        #: Its name in the scene.
        self.name = name
        #: world_from_model, shape (4, 4).
        self.at = at
        #: What is not drawn as its file has it, one line each.
        self.missing: list[str] = []
        #: Its joints, limits and frames.
        self.model = getattr(thing, "model", thing)
        self._kinematics = DrawnKinematics(self.model)
        self._index = self._kinematics.index
        rest = self.model.neutral()
        standing = closed(thing, rest)
        self._q: Array = rest if standing is None else standing

    @property
    def frame_names(self) -> list[str]:
        """Names of its frames."""
        return [frame.name for frame in self.model.frames]

    @property
    def q(self) -> Array:
        """Its configuration, shape (dof,), radians and metres; assigning moves what is drawn.

        A wrong length or a number that is not finite is an `InvalidValueError`.
        """
        return self._q.copy()

    @q.setter
    def q(self, q: ArrayLike) -> None:
        self._place(np.array(q, dtype=float))

    def frame(self, name: str) -> Array:
        """Where a frame stands now: world_from_frame, shape (4, 4). An unknown name is an `UnknownNameError`."""
        if name not in self._index:
            # The library's own words, with the names that there are.
            kinopt.frame_placement(self.model, name, self._q)
        placements: Array = self._kinematics.place(self._q)
        place: Array = self.at @ placements[self._index[name]]
        return place

    def _place(self, q: Array) -> None:
        placements: Array = self._kinematics.place(q)
        self._q = q
        self._draw(q, self.at @ placements)

    @abstractmethod
    def _draw(self, q: Array, world_from_frames: Array) -> None:
        """Moves what is drawn."""

    @abstractmethod
    def pieces(self) -> list[Piece]:
        """Its meshes as they stand now, in the world."""

    @property
    def unit(self) -> str:
        """What its lengths are in: "m", or "units" of its own."""
        return str(self.model.length_unit)

    @property
    def clips(self) -> list[Clip]:
        """What it can play."""
        return []

    @property
    def tips(self) -> list[str]:
        """Names of the frames that are dragged first: hands, tools, feet."""
        return list(getattr(self.thing, "tips", self.frame_names[-1:]))

    @property
    def pinned_first(self) -> list[str]:
        """The frames that are pinned when a page opens."""
        return []

    def standing(self) -> None:
        """Called before a solve: the model's angles may count from where the body stands."""

    @property
    def can_hold(self) -> bool:
        """Whether `holding` has something to say."""
        return False

    def group(self, joint: str) -> str:
        """What a joint belongs to: its sliders stand together."""
        return self.name

    def short(self, joint: str) -> str:
        """What a joint is called within its group."""
        return joint

    @property
    def stands(self) -> bool:
        """Whether it moves as a whole, on a free base, so that what is pinned of it are its feet."""
        return False

    def holding(
        self, dragged: list[str], q: Array, reference: Array | None, pinned: Sequence[str] = ()
    ) -> Holding | None:
        """What should stay while frames of it are dragged from `q`, and what posture it leans to.

        Of the `dragged`, the `pinned` are to stay too.
        """
        return None

    @abstractmethod
    def remove(self) -> None:
        """Takes it out of the scene."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {len(self._q)} joints)"

    def size(self) -> float:
        """The longest way between its joints and frames as it stands, in the model's unit."""
        return extent(self._kinematics.place(self._q))

    def box(self) -> tuple[Array, Array]:
        """The lowest and the highest corner of the box around it as it stands, in the model's unit."""
        points = [piece.solid.vertices for piece in self.pieces() if len(piece.solid.vertices)]
        if not points:
            placements: Array = self.at @ self._kinematics.place(self._q)
            points = [placements[:, :3, 3]]
        every = np.concatenate(points)
        return every.min(axis=0), every.max(axis=0)
