"""Trajectories of a body, with the subject of a retargeted motion next to it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from . import stage
from .body import Body
from .canvas import Canvas
from .curves import Curves, curves_of
from .transforms import matrix_of

Array = NDArray[np.float64]

#: Colour of the subject.
COLOR = (196, 120, 52)
#: Number of frames that are used to find bones.
MAX_SAMPLED_FRAMES = 64
#: Weight of a bone's length relative to its variation: of joints at equally constant distance, the nearer ones share a
#: bone.
LENGTH_COST = 0.05
#: Width of bones, pixels.
LINE_WIDTH = 5.0
#: Number of frames whose extent the camera views.
PATH_SAMPLES = 12
#: Size of joints, for a body as large as a person.
JOINT_SIZE = 0.006


class Person:
    """Captured joints, and lines for the bones between them."""

    def __init__(
        self, scene: Canvas, name: str, positions: Array, bones: list[tuple[int, int]] | None = None
    ) -> None:
        self.scene = scene
        #: Name in the scene.
        self.name = name
        #: Positions of its joints, shape (T, J, 3).
        self.positions = positions
        self.bones: NDArray[np.intp] = bones_of(positions) if bones is None else np.array(bones, dtype=np.intp).reshape(-1, 2)
        first = positions[0]
        self._joints: Any = scene.points(f"{name}/joints", first, COLOR, size=JOINT_SIZE * stage.DRAWN / scene.drawn)
        self._lines: Any = scene.server.scene.add_line_segments(
            f"/{name}/bones", points=self._ends(0), colors=COLOR, thickness=LINE_WIDTH, thickness_units="screen"
        )

    def _ends(self, frame: int) -> Any:
        return (self.positions[frame][self.bones] * self.scene.drawn).astype(np.float32)

    def show(self, frame: int) -> None:
        """Moves it to a frame."""
        self._joints.points = (self.positions[frame] * self.scene.drawn).astype(np.float32)
        self._lines.points = self._ends(frame)

    def remove(self) -> None:
        """Removes it from the scene."""
        self._joints.remove()
        self._lines.remove()


class Movement:
    """A trajectory of a body in a scene, with the subject of a retargeted motion next to it: a clip."""

    def __init__(self, name: str, movement: kinopt.Trajectory[Any], body: Body, person: Person | None) -> None:
        #: Name of the clip.
        self.name = name
        self.movement: kinopt.Trajectory[Any] = movement
        self.body: Body = body
        self.person: Person | None = person
        self._times = np.asarray(movement.times, dtype=float)
        #: Start and end time, seconds.
        self.span: tuple[float, float] = (float(self._times[0]), float(self._times[-1]))
        self._at = body.at.copy()
        self._base = 0
        names = body.model.coordinate_names
        self._columns = [names.index(joint) for joint in movement.names if joint in names]
        width = movement.q.shape[1]
        if len(self._columns) != width:
            # A rig has no base joint.
            self._base, self._columns = 7, list(range(len(names)))
        if width != self._base + len(self._columns):
            raise kinopt.InvalidValueError(
                f"the motion has {width} numbers for each frame, {body.name} has {len(names)}"
            )

    def show(self, seconds: float) -> None:
        """Sets the poses of body and subject at that time."""
        frame = int(np.abs(self._times - seconds).argmin())
        if self._base:
            q = self.movement.q[frame]
            self.body.at = self._at @ matrix_of(q[3:7], q[:3])
        self.body.q = self._configurations(self.movement.q[frame])
        if self.person is not None:
            self.person.show(frame)

    def _configurations(self, q: Array) -> Array:
        """Configurations of the body, shape (..., nq): joints that the trajectory lacks stay."""
        whole = np.broadcast_to(self.body.q, (*q.shape[:-1], len(self.body.q))).copy()
        whole[..., self._columns] = q[..., self._base :]
        return whole

    @property
    def curves(self) -> Curves:
        """Joints of the body over time."""
        return curves_of(self.body, self._times, self._configurations(self.movement.q))


def show_movement(
    scene: Canvas, movement: kinopt.Trajectory[Any], body: Body, beside: float | None, name: str
) -> Movement:
    """Implements `Scene.add_movement`."""
    played = Movement(name, movement, body, None)
    played.show(played.span[0])
    size = body.size()
    if beside is not None and isinstance(movement.report, kinopt.RetargetReport):
        positions = upright(movement)
        # To its left: in most files it faces along x.
        positions[..., 1] += beside * size
        played.person = Person(scene, scene.clear(name), positions, movement.report.capture.bones)
        scene.place(name, played.person)
    _look(scene, played)
    return played


def upright(movement: kinopt.Trajectory[kinopt.RetargetReport]) -> Array:
    """Positions of the subject's joints with z upward and legs as long as the body's, the lowest on the ground."""
    report = movement.report
    positions = report.capture.positions
    if report.map.get("up", report.capture.up) == "y":
        positions = positions[..., [0, 2, 1]] * [1.0, -1.0, 1.0]
    positions = report.stride * positions
    positions[..., 2] -= np.quantile(positions[..., 2].min(axis=1), 0.05)
    return positions


def bones_of(positions: Array) -> NDArray[np.intp]:
    """Pairs of joints that bones connect, shape (J - 1, 2): the tree with the most constant distances."""
    looked_at = positions[:: max(len(positions) // MAX_SAMPLED_FRAMES, 1)][:MAX_SAMPLED_FRAMES]
    distances = np.linalg.norm(looked_at[:, :, None] - looked_at[:, None], axis=3)
    edge_cost = distances.std(axis=0) + LENGTH_COST * distances.mean(axis=0)
    joints = len(edge_cost)
    reached, nearest, best = np.zeros(joints, bool), np.zeros(joints, int), edge_cost[0].copy()
    reached[0] = True
    bones = []
    for _ in range(joints - 1):
        joint = int(np.where(reached, np.inf, best).argmin())
        bones.append((nearest[joint], joint))
        reached[joint] = True
        nearer = edge_cost[joint] < best
        nearest[nearer], best[nearer] = joint, edge_cost[joint][nearer]
    return np.array(bones, dtype=np.intp).reshape(-1, 2)


def _look(scene: Canvas, played: Movement) -> None:
    """Sets the camera to view the whole path."""
    boxes = []
    for seconds in np.linspace(*played.span, PATH_SAMPLES):
        played.show(seconds)
        boxes.append(played.body.box())
    played.show(played.span[0])
    low, high = np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)
    if played.person is not None:
        positions = played.person.positions
        low = np.minimum(low, positions.min(axis=(0, 1)))
        high = np.maximum(high, positions.max(axis=(0, 1)))
    stage.show_box(scene.server, scene.up, low * scene.drawn, high * scene.drawn)
