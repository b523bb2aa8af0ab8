"""Robots drawn by mesh files, by the simple shapes of the file, or by capsules."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import kinopt

from kinopt import tasks

from . import balance, look, solids
from .body import Body, Piece
from .canvas import Canvas
from .holding import BALANCE, Holding
from .look import Color
from .mesh_files import MeshFiles
from .parts import Parts
from .shapes import solid_of
from .solids import Solid


Array = NDArray[np.float64]
Style = Literal["auto", "file", "capsules", "collision"]


class RobotBody(Body):
    """A robot in a scene, or any other object with a model, as rigid parts. Assigning `q` moves it."""

    def __init__(
        self,
        scene: Canvas,
        thing: Any,
        name: str,
        at: Array,
        *,
        style: Style = "auto",
        color: Color | None = None,
        opacity: float | None = None,
        beside: str | Path | None = None,
        packages: Mapping[str, str | Path] | Iterable[str | Path] = (),
    ) -> None:
        """Arguments are as in `Scene.add`."""
        super().__init__(scene, thing, name, at)
        confine = bool(getattr(thing, "confined", False))
        files = MeshFiles(None if beside is None else Path(beside), packages, confine)
        if style == "auto" and _says_how_links_lie(thing):
            style = "capsules"
        match style:
            case "capsules":
                self._pieces: list[Piece] = []
            case "collision":
                self._pieces = list(self._of_collision_shapes(color))
            case _:
                self._pieces = list(self._of_shapes(files, color))
        if not self._pieces:
            self._pieces = self._of_capsules(color)
        #: Meshes that could not be drawn, one line each; capsules replace them.
        self.missing: list[str] = files.missing
        self._of_frames = np.array([self._index[piece.name] for piece in self._pieces], dtype=int)
        self._handles = [
            scene.server.scene.add_mesh_simple(
                f"/{name}/{i}",
                vertices=(piece.solid.vertices * scene.drawn).astype(np.float32),
                faces=piece.solid.triangles,
                color=piece.color,
                opacity=opacity,
            )
            for i, piece in enumerate(self._pieces)
        ]
        self._parts = Parts(scene.server, self._handles, scene.drawn)
        self._place(self._q)

    def _draw(self, q: Array, world_from_frames: Array) -> None:
        self._parts.send(world_from_frames[self._of_frames])

    @property
    def stands(self) -> bool:
        """True for a free base."""
        return bool(self.model.free_joints)

    @property
    def can_hold(self) -> bool:
        """True if its pinned feet can carry it: it has a free base and masses."""
        return self.stands and balance.has_masses(self.thing, self._q)

    def holding(
        self, dragged: list[str], q: Array, reference: Array | None, pinned: Sequence[str] = ()
    ) -> Holding | None:
        """Keeps the centre of mass over the feet, the lowest pinned frames."""
        if not self.can_hold:
            return None
        feet = balance.feet(self.model, pinned, q)
        if not feet:
            return None
        soles = {foot: self.thing.sole(foot) for foot in feet}
        return Holding([tasks.SupportPolygon(on=soles, name="balance", level=BALANCE)])

    def pieces(self) -> list[Piece]:
        """Its meshes in the current pose, in the world."""
        placements = (self.at @ self._kinematics.place(self._q))[self._of_frames]
        pairs = zip(self._pieces, placements, strict=True)
        return [Piece(piece.name, piece.solid.moved(placement), piece.color) for piece, placement in pairs]

    def remove(self) -> None:
        """Removes it from the scene."""
        for handle in self._handles:
            handle.remove()
        self.scene.forget(self)

    def _of_shapes(self, files: MeshFiles, color: Color | None) -> Iterable[Piece]:
        """Shapes of the links, each named after its link; capsules for missing meshes."""
        if not isinstance(self.thing, kinopt.Robot):
            return
        piece_count = 0
        bare: set[str | None] = set()
        joint_of = {frame.name: frame.joint for frame in self.model.frames}
        for link in self.thing.frame_names:
            for shape in self.thing.shapes(link):
                parts = _solids(shape, files)
                if parts is None:
                    bare.add(joint_of[link])
                    continue
                for solid, file_color in parts:
                    piece_count += 1
                    yield Piece(link, solid.moved(shape.link_from_shape), color or file_color or look.LIGHT)
        if piece_count and bare:
            yield from self._of_capsules(color, bare)

    def _of_collision_shapes(self, color: Color | None) -> Iterable[Piece]:
        """Collision shapes."""
        if not isinstance(self.thing, kinopt.Robot):
            return
        model = self.thing.collision_model(leave_out_missing=True)
        carried = [shape for shape in model.shapes if shape.attached is not None]
        joint_of = {frame.name: frame.joint for frame in self.model.frames}
        shades = {joint: (look.LIGHT, look.DARK)[k % 2] for k, joint in enumerate(dict.fromkeys(joint_of.values()))}
        for shape in carried:
            link = str(shape.attached)
            solid = solid_of(shape, 1.0).moved(shape.placement)
            yield Piece(link, solid, color or shades[joint_of[link]])

    def _of_capsules(self, color: Color | None, only: set[str | None] | None = None) -> list[Piece]:
        """Capsules for the children of each joint, or of `only` those joints, each named after its frame."""
        bodies = look.capsules(self.model, self.size())
        drawn = (body for body in bodies if only is None or body.joint in only)
        named = self._kinematics.frame_of_joint
        return [Piece(named[body.joint], body.solid, color or body.color) for body in drawn]


def has_meshes(robot: Any) -> bool:
    """True if a robot's file has meshes of links."""
    return any(shape.kind == "mesh" for link in robot.frame_names for shape in robot.shapes(link))


def _says_how_links_lie(robot: Any) -> bool:
    """True if a robot's file has only cylinders, from joint to joint: capsules then look better."""
    if not isinstance(robot, kinopt.Robot):
        return True
    return all(shape.kind == "cylinder" for link in robot.frame_names for shape in robot.shapes(link))


def _solids(shape: Any, files: MeshFiles) -> list[tuple[Solid, Color | None]] | None:
    """Meshes of a shape in its own frame, with colours; None for a missing mesh file."""
    measures = shape.measures
    match shape.kind:
        case "box":
            return [(solids.box(measures["size"]), None)]
        case "cylinder":
            return [(solids.cylinder(measures["length"], measures["radius"]), None)]
        case "capsule":
            return [(solids.capsule(measures["length"], measures["radius"]), None)]
        case "sphere":
            return [(solids.sphere(measures["radius"]), None)]
        case "ellipsoid":
            return [(solids.sphere(1.0).scaled(measures["radii"]), None)]
        case "mesh":
            read = files.read(measures["file"])
            if read is None:
                return None
            scale = measures["scale"]
            return [(solids.creased(solid.scaled(scale)), color) for solid, color in read]
    return []
