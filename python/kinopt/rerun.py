"""Robots and motions in the viewer of Rerun: ``pip install 'kinopt[rerun]'``.

```python
import kinopt, kinopt.rerun, rerun

rerun.init("panda", spawn=True)
kinopt.rerun.log(robot, trajectory)
```
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

if find_spec("rerun") is None:
    raise ImportError("kinopt.rerun needs the Rerun SDK: pip install 'kinopt[rerun]'")

import numpy as np
import rerun
from numpy.typing import ArrayLike
from rerun import RecordingStream

from ._kinopt import ForwardKinematics, JointPath, Robot, Trajectory
from .errors import InvalidValueError, UnknownNameError
from .types import Floats
from .view import look, solids
from .view.mesh_files import MeshFiles
from .view.shapes import solid_of


def log(
    robot: Robot,
    motion: Trajectory[Any] | JointPath[Any] | ArrayLike,
    *,
    entity: str = "robot",
    timeline: str | None = None,
    folder: str | Path | None = None,
    packages: Mapping[str, str | Path] | Iterable[str | Path] = (),
    recording: RecordingStream | None = None,
) -> None:
    """Logs a robot and its motion: placements of its links, values of its joints, and its shapes.

    ``motion`` is a trajectory, a joint path, or configurations of shape (nq,) or (N, nq). The joints of a path of an
    arm move; the others stay at the neutral configuration. The timeline of a trajectory is ``time``, in seconds; of
    other motions ``step``, from 0. ``timeline`` is another name.

    Entities: ``robot/links/LINK`` has the transform of the link to the world, in metres, and ``robot/joints`` a curve
    for each coordinate, in radians or metres. ``entity`` replaces "robot". A link is drawn by its visual meshes if they are in
    ``folder``, the folder of the robot's file, or in ``packages``, folders by package or folders that contain packages.
    Other links are drawn by their collision shapes. ``recording`` is the recording, by default Rerun's current one.

    Raises ``InvalidValueError`` for configurations of another shape, ``UnknownNameError`` for a motion of another
    robot's joints.
    """
    if not isinstance(robot, Robot):
        raise InvalidValueError(f"robot must be a kinopt.Robot, not {type(robot).__name__}")
    q = _configurations(robot, motion)
    if isinstance(motion, Trajectory):
        times = rerun.TimeColumn(timeline or "time", duration=motion.times)
    else:
        times = rerun.TimeColumn(timeline or "step", sequence=np.arange(len(q)))
    rerun.log(entity, rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True, recording=recording)
    kinematics = ForwardKinematics(robot)
    for link, placements in zip(kinematics.frame_names, np.moveaxis(kinematics.place(q), 1, 0), strict=True):
        columns = rerun.Transform3D.columns(translation=placements[:, :3, 3], mat3x3=placements[:, :3, :3])
        rerun.send_columns(_path(entity, "links", link), [times], columns, recording=recording)
    names = robot.coordinate_names
    if names:
        curves = rerun.Scalars.columns(scalars=q.ravel()).partition(lengths=[len(names)] * len(q))
        rerun.send_columns(_path(entity, "joints"), [times], curves, recording=recording)
        rerun.log(_path(entity, "joints"), rerun.SeriesLines(names=names), static=True, recording=recording)
    for number, (link, solid, color) in enumerate(_drawn(robot, folder, packages)):
        mesh = rerun.Mesh3D(
            vertex_positions=solid.vertices,
            triangle_indices=solid.triangles,
            vertex_normals=_normals(solid),
            albedo_factor=[*color, 255],
        )
        rerun.log(_path(entity, "links", link, f"shape{number}"), mesh, static=True, recording=recording)


def _path(entity: str, *parts: str) -> str:
    """Path of an entity below another one; names may contain any characters."""
    return entity + str(rerun.new_entity_path(list(parts)))


def _configurations(robot: Robot, motion: Any) -> Floats:
    """Configurations of the robot, shape (N, nq)."""
    q = np.atleast_2d(np.asarray(getattr(motion, "q", motion), dtype=float))
    columns = {name: i for i, name in enumerate(robot.coordinate_names)}
    names = getattr(motion, "names", getattr(motion, "joint_names", robot.coordinate_names))
    if q.ndim != 2 or q.shape[1] != len(names):
        raise InvalidValueError(f"configurations must have shape ({len(names)},) or (N, {len(names)}), not {q.shape}")
    unknown = [name for name in names if name not in columns]
    if unknown:
        raise UnknownNameError(f"the motion has a joint `{unknown[0]}`; joints of {robot.name}: {', '.join(columns)}")
    whole = np.tile(robot.neutral(), (len(q), 1))
    whole[:, [columns[name] for name in names]] = q
    return np.array([robot.apply_mimics(row) for row in whole])


def _drawn(
    robot: Robot, folder: str | Path | None, packages: Mapping[str, str | Path] | Iterable[str | Path]
) -> Iterator[tuple[str, solids.Solid, look.Color]]:
    """Surfaces in the frames of their links, with colours."""
    drawn = set()
    files = MeshFiles(None if folder is None else Path(folder), packages, robot.confined)
    for link in robot.frame_names:
        for shape in robot.shapes(link):
            for solid, color in (shape.kind == "mesh" and files.read(shape.measures["file"])) or []:
                drawn.add(link)
                yield link, solid.scaled(shape.measures["scale"]).moved(shape.link_from_shape), color or look.LIGHT
    for part in robot.collision_model(meshes="triangles", leave_out_missing=True).shapes:
        if part.attached is not None and part.attached not in drawn:
            yield part.attached, solid_of(part, 1.0).moved(part.placement), look.LIGHT


def _normals(solid: solids.Solid) -> Floats:
    """Unit normals of vertices, by the areas of their triangles."""
    corners = solid.vertices[solid.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(solid.vertices)
    np.add.at(normals, solid.triangles, areas[:, None])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return normals


__all__ = ["log"]
