"""Robots drawn by mesh files, by simple shapes or collision shapes of the file, or by capsules."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import kinopt

from kinopt import tasks

from . import balance, look, solids
from .body import Body, Piece, joints_to, moved_by
from .canvas import Canvas
from .balance import BALANCE, Holding
from .humanoid import Humanoid, humanoid
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
        if style == "auto" and not has_meshes(thing):
            style = "collision"
        match style:
            case "capsules":
                self._pieces: list[Piece] = []
            case "collision":
                self._pieces = list(self._of_collision_shapes(color))
            case _:
                self._pieces = list(self._of_shapes(files, color))
        if not self._pieces:
            self._pieces = self._of_capsules(color)
        #: Frames of a humanoid body, by the names of the robot's frames.
        self.humanoid: Humanoid | None = humanoid(thing) if isinstance(thing, kinopt.Robot) else None
        #: Tip of the limb of each joint.
        bases = tuple(f"{base}/" for base in self.model.free_joints)
        chains = {tip: joints_to(self.model, tip) for tip in reversed(self.tips)}
        self._limbs = {joint: tip for tip, chain in chains.items() for joint in chain if not joint.startswith(bases)}
        #: Meshes that could not be drawn, one line each; other shapes replace them.
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
    def tips(self) -> list[str]:
        """Feet, hands, pelvis and head of a humanoid; the ends of other robots."""
        return super().tips if self.humanoid is None else self.humanoid.frames

    def group(self, joint: str) -> str:
        """Tip of the limb of a joint; joints of a free base are in a group of their own."""
        return self._limbs.get(joint, "base")

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
        joint_of = moved_by(self.model)
        for link in self.thing.frame_names:
            for shape in self.thing.shapes(link):
                parts = _solids(shape, files)
                if parts is None:
                    simple = [other for other in self.thing.shapes(link, collision=True) if other.kind != "mesh"]
                    if not simple:
                        bare.add(joint_of[link])
                    for other in simple:
                        piece_count += 1
                        ((solid, _),) = _solids(other, files) or []
                        yield Piece(link, solid.moved(other.link_from_shape), color or look.LIGHT)
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
        carriers = moved_by(self.model)
        depths: dict[str | None, int] = {None: 0}
        for joint in self.model.joints:
            depths[joint.name] = depths[joint.parent] + (joint.kind != "fixed")
        for shape in carried:
            link = str(shape.attached)
            solid = solid_of(shape, 1.0).moved(shape.placement)
            yield Piece(link, solid, color or (look.LIGHT, look.GREY)[depths[carriers[link]] % 2])

    def _of_capsules(self, color: Color | None, only: set[str | None] | None = None) -> list[Piece]:
        """Capsules for the children of each joint, or of `only` those joints, each named after its frame."""
        bodies = look.capsules(self.model, self.size())
        drawn = (body for body in bodies if only is None or body.joint in only)
        named = self._kinematics.frame_of_joint
        return [Piece(named[body.joint], body.solid, color or body.color) for body in drawn]


def has_meshes(thing: Any) -> bool:
    """True for a robot whose file has meshes of links."""
    links = thing.frame_names if isinstance(thing, kinopt.Robot) else []
    return any(shape.kind == "mesh" for link in links for shape in thing.shapes(link))


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
