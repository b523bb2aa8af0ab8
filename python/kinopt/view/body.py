"""Common interface of everything in a scene that has a configuration."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

import kinopt

from .canvas import Canvas
from .closing import closed
from .balance import Holding
from .look import Color, DrawnKinematics, extent
from .solids import Solid

Array = NDArray[np.float64]


class Clip(Protocol):
    """Something that a body plays."""

    #: Name of the clip.
    name: str
    #: Start and end time, seconds.
    span: tuple[float, float]

    def show(self, seconds: float) -> None:
        """Sets the pose of the body at that time."""


@dataclass(frozen=True)
class Piece:
    """A mesh and its colour: on a frame of a body, or in the world for saving; in the model's unit."""

    name: str
    solid: Solid
    color: Color


class Body(ABC):
    """An object with a configuration in a scene: a robot, a skeleton, a character."""

    def __init__(self, scene: Canvas, thing: Any, name: str, at: Array) -> None:
        self.scene = scene
        #: The drawn object, as given: a robot, rig, skeleton or model.
        self.thing = thing
        #: Name in the scene.
        self.name = name
        #: world_from_model, shape (4, 4).
        self.at = at
        #: Parts that are not drawn as in the file, one line each.
        self.missing: list[str] = []
        #: Callbacks after each motion.
        self.on_move: list[Callable[[], Any]] = []
        #: Joints, limits and frames.
        self.model: Any = getattr(thing, "model", thing)
        self._kinematics = DrawnKinematics(self.model)
        self._index = self._kinematics.index
        neutral = self.model.neutral()
        standing = closed(thing, neutral)
        self._q: Array = neutral if standing is None else standing

    @property
    def frame_names(self) -> list[str]:
        """Names of its frames."""
        return [frame.name for frame in self.model.frames]

    @property
    def q(self) -> Array:
        """Current configuration, shape (nq,), radians and metres; assigning it moves the drawing.

        Raises `InvalidValueError` for a wrong length or a number that is not finite.
        """
        return self._q.copy()

    @q.setter
    def q(self, q: ArrayLike) -> None:
        self._place(np.array(q, dtype=float))

    def frame(self, name: str) -> Array:
        """Current pose of a frame: world_from_frame, shape (4, 4). Raises `UnknownNameError` for an unknown name."""
        if name not in self._index:
            # Raises the error of the library, with the valid names.
            kinopt.frame_placement(self.model, name, self._q)
        placements: Array = self._kinematics.place(self._q)
        placement: Array = self.at @ placements[self._index[name]]
        return placement

    def _place(self, q: Array) -> None:
        placements: Array = self._kinematics.place(q)
        self._q = q
        self._draw(q, self.at @ placements)
        self._tell_moved()

    def _tell_moved(self) -> None:
        for moved in self.on_move:
            moved()

    @abstractmethod
    def _draw(self, q: Array, world_from_frames: Array) -> None:
        """Moves the drawing."""

    @abstractmethod
    def pieces(self) -> list[Piece]:
        """Its meshes in the current pose, in the world."""

    @property
    def unit(self) -> str:
        """Unit of its lengths: "m", or "units" of its own."""
        return str(self.model.length_unit)

    @property
    def clips(self) -> list[Clip]:
        """Clips that it can play."""
        return []

    @property
    def tips(self) -> list[str]:
        """Names of the frames that have gizmos at first: hands, tools, feet."""
        return list(getattr(self.thing, "tips", self.frame_names[-1:]))

    @property
    def pinned_first(self) -> list[str]:
        """Frames that are pinned when a page opens."""
        return []

    def standing(self) -> None:
        """Called before a solve: the angles of the model may be relative to the current pose."""

    @property
    def can_hold(self) -> bool:
        """True if `holding` returns something."""
        return False

    def group(self, joint: str) -> str:
        """Group of a joint, for its slider and its curve."""
        return self.name

    def short(self, joint: str) -> str:
        """Name of a joint within its group."""
        return joint

    @property
    def stands(self) -> bool:
        """True for a free base, whose pinned frames are feet."""
        return False

    def holding(
        self, dragged: list[str], q: Array, reference: Array | None, pinned: Sequence[str] = ()
    ) -> Holding | None:
        """Tasks and locks that hold the body while frames of it are dragged from `q`, with a nominal posture.

        Frames of `dragged` that are also `pinned` stay too.
        """
        return None

    @abstractmethod
    def remove(self) -> None:
        """Removes it from the scene."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {len(self._q)} joints)"

    def size(self) -> float:
        """Extent of its joints and frames in the current pose, in the model's unit."""
        return extent(self._kinematics.place(self._q))

    def region(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the box that the camera views, in the model's unit."""
        return self.box()

    def box(self) -> tuple[Array, Array]:
        """Lowest and highest corner of its bounding box in the current pose, in the model's unit."""
        points = [piece.solid.vertices for piece in self.pieces() if len(piece.solid.vertices)]
        if not points:
            placements: Array = self.at @ self._kinematics.place(self._q)
            points = [placements[:, :3, 3]]
        every = np.concatenate(points)
        return every.min(axis=0), every.max(axis=0)


def moved_by(model: Any) -> dict[str, str | None]:
    """Joint that moves each frame of a model; None for a frame fixed in the world."""
    joints = {joint.name: joint for joint in model.joints}
    carriers = {}
    for frame in model.frames:
        joint = joints.get(frame.joint or "")
        while joint is not None and joint.kind == "fixed":
            joint = joints.get(joint.parent or "")
        carriers[frame.name] = None if joint is None else joint.name
    return carriers


def joints_to(model: Any, frame: str) -> list[str]:
    """Moving joints from the world to a frame."""
    parents = {joint.name: joint.parent for joint in model.joints}
    joint, chain = moved_by(model)[frame], []
    while joint is not None:
        chain.append(joint)
        joint = parents[joint]
    return chain
