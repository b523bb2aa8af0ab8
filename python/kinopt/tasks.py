"""Tasks of a ``kinopt.Problem``.

Frames and joints are given by name. Every task has these keywords:

``name``
    its name in reports and targets; by default its kind and first frame.
``weight``
    factor of its rows: a number, or a dict by quantity such as ``{"metres": 1.0, "radians": 0.2}``. The default is 1
    per metre, pixel and joint unit, and a quarter of the model's reach per radian. Rows of weight 0 report their error
    but never count as missed.
``scale``
    factor of all its weights, given or default.
``tolerance``
    the error, before weighting, within which it counts as reached: a number, or a dict by quantity.
``role``
    ``"goal"``, a required task, or ``"preference"``, a soft task in the null space of the required tasks.
``level``
    a strict priority level, a whole number. Goals of level 0 are solved as if they were alone; goals of level 1 are
    minimised at no cost to level 0, and so on. Weights count within a level only. Preferences come after all goals, by
    their own levels.

Weights and tolerances below 0, unknown names and targets that are not finite raise ``kinopt.InvalidValueError`` when
the problem is created; wrong shapes when the task is created. Quantities are ``"metres"``, ``"radians"``, ``"pixels"``,
``"joint units"``, ``"joint units per second"``, ``"metres per second"``, ``"radians per second"`` and ``"ratio"``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import MISSING, dataclass, field, fields
from math import inf
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ._kinopt import PoseBounds, Model
from ._kinopt import tasks as _compiled
from ._kinopt.tasks import Camera
from .errors import InvalidValueError
from .jacobian_check import check
from .types import HasModel, PlacementLike


# Masses of frames in kilograms, at the frame's origin or at a position in its coordinates, shape (3,), metres.
Masses = Mapping[str, float | tuple[float, ArrayLike]]


@dataclass(frozen=True, eq=False, repr=False)
class Task:
    """Common fields of all tasks: name, weights, tolerances, role, level. The module's documentation defines them.

    Raises ``InvalidValueError`` for a name that is not a text, for values that are not numbers, and for a level that is
    not a whole number of at least 0.
    """

    name: str | None = field(default=None, kw_only=True)
    weight: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    scale: float = field(default=1.0, kw_only=True)
    tolerance: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    role: Literal["goal", "preference"] | None = field(default=None, kw_only=True)
    level: int = field(default=0, kw_only=True)

    _kind: ClassVar[str]
    # Fields that are names of frames, numbers, vectors with their length (None: any), placements, and placements under the
    # bounds of ``goal``. Frames and placements with a default are optional.
    _frames: ClassVar[tuple[str, ...]] = ()
    _numbers: ClassVar[tuple[str, ...]] = ()
    _vectors: ClassVar[Mapping[str, int | None]] = {}
    _placements: ClassVar[tuple[str, ...]] = ()
    _targets: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        self._check_common()
        for name in self._frames:
            self._check_name(name, getattr(self, name), optional=hasattr(type(self), name))
        for name in self._numbers:
            _check_number(name, getattr(self, name))
        for name, length in self._vectors.items():
            self._keep_vector(name, length)
        for name in self._placements:
            if not (getattr(self, name) is None and hasattr(type(self), name)):
                self._keep(name, _compiled.placement(getattr(self, name), name))
        goal = getattr(self, "goal", None)
        if goal is not None:
            self._keep("goal", _compiled.goal(goal))
        for name in self._targets:
            self._keep(name, _compiled.target(getattr(self, name), name, goal))

    def _check_common(self) -> None:
        self._check_name("name", self.name)
        for named in ("weight", "tolerance"):
            value = getattr(self, named)
            if isinstance(value, Mapping):
                for quantity, number in value.items():
                    self._check_name(f"a quantity of {named}", quantity, optional=False)
                    _check_number(f"{named} per {quantity}", number)
                self._keep(named, dict(value))
        _check_number("scale", self.scale)
        self._keep("level", _level(self.level))

    def _with(self, changes: Mapping[str, object]) -> Task:
        """The task with other values of these keywords."""
        changed = copy(self)
        for name, value in changes.items():
            changed._keep(name, value)
        changed._check_common()
        return changed

    def _keep(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _keep_vector(self, name: str, length: int | None) -> None:
        self._keep(name, _compiled.numbers(getattr(self, name), name, length))

    def _check_name(self, what: str, name: object, optional: bool = True) -> None:
        if not (isinstance(name, str) or (optional and name is None)):
            raise InvalidValueError(f"{what} must be a name, not {name!r}")

    def _joint_weights(self, *words: str) -> None:
        weights = getattr(self, "joint_weights", None)
        if isinstance(weights, Mapping):
            for joint, value in weights.items():
                self._check_name("a joint of joint_weights", joint, optional=False)
                _check_number(f"the weight of {joint}", value)
            self._keep("joint_weights", dict(weights))
        elif isinstance(weights, str):
            if weights not in words:
                allowed = " or ".join(f'"{word}"' for word in words)
                raise InvalidValueError(f"joint_weights must be numbers or {allowed}, not {weights!r}")
        elif weights is not None:
            self._keep_vector("joint_weights", None)

    def _masses(self) -> None:
        masses = getattr(self, "masses", None)
        if masses is None:
            return
        if not isinstance(masses, Mapping):
            raise InvalidValueError(f"masses must be a dict by frame, not {masses!r}")
        point_masses = {}
        for frame, value in masses.items():
            self._check_name("a frame of masses", frame, optional=False)
            mass, position = value if isinstance(value, Sequence) and len(value) == 2 else (value, (0.0, 0.0, 0.0))
            _check_number(f"the mass of {frame}", mass)
            point_masses[frame] = (float(mass), _compiled.numbers(position, f"the position of the mass of {frame}", 3))
        self._keep("masses", point_masses)

    def __repr__(self) -> str:
        shown = []
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, np.ndarray):
                value = value.tolist()
            default = list(item.default) if isinstance(item.default, tuple) else item.default
            if default is MISSING or value != default:
                shown.append(f"{item.name}={value!r}")
        return f"{type(self).__name__}({', '.join(shown)})"


@dataclass(frozen=True, eq=False, repr=False)
class Point(Task):
    """Position of a point of ``frame`` at ``target``, shape (3,), metres: three rows in metres.

    ``at`` is the point in the frame's own coordinates, shape (3,), by default its origin. The target is in the world,
    or in the frame ``base``, which may move with the joints.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    target: ArrayLike
    at: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "point"
    _frames = ("frame", "base")
    _vectors = {"target": 3, "at": 3}


@dataclass(frozen=True, eq=False, repr=False)
class Pose(Task):
    """Pose of ``frame`` at the placement ``target``: three rows in metres, three in radians.

    ``tool`` is the placement in the frame that reaches the target; by default the frame itself. ``goal``, a
    ``kinopt.PoseBounds``, ``"pose"`` or ``"position"``, sets the goal bounds. The target is in the world, or in the
    frame ``base``, which may move with the joints. A target that is a position requires ``goal="position"``.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    target: PlacementLike
    tool: PlacementLike | None = field(default=None, kw_only=True)
    goal: PoseBounds | Literal["pose", "position"] | None = field(default=None, kw_only=True)
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "pose"
    _frames = ("frame", "base")
    _targets = ("target",)
    _placements = ("tool",)


@dataclass(frozen=True, eq=False, repr=False)
class Orientation(Task):
    """Orientation of ``frame``: its axes are the columns of ``target``, shape (3, 3): three rows in radians.

    The target may also be a placement, or a rotation object of another library. It is in the world, or in the frame
    ``base``, which may move with the joints.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    target: Any
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "orientation"
    _frames = ("frame", "base")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("target", _compiled.rotation(self.target, "target"))


@dataclass(frozen=True, eq=False, repr=False)
class LookAt(Task):
    """Direction of ``axis`` of ``frame``, shape (3,), from its origin to ``target``, shape (3,), metres.

    The axis is in the frame's coordinates, of any length but zero. Three rows in radians; their norm is the angle
    between axis and direction.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    axis: ArrayLike
    target: ArrayLike

    _kind: ClassVar[str] = "look at"
    _frames = ("frame",)
    _vectors = {"axis": 3, "target": 3}


@dataclass(frozen=True, eq=False, repr=False)
class Distance(Task):
    """Distance between the origins of the frames ``a`` and ``b``, equal to ``distance`` metres: one row in metres.

    Raises ``InvalidValueError`` for names that are not texts and for a distance that is not a number.
    """

    a: str
    b: str
    distance: float

    _kind: ClassVar[str] = "distance"
    _frames = ("a", "b")
    _numbers = ("distance",)


@dataclass(frozen=True, eq=False, repr=False)
class Plane(Task):
    """The origin of ``frame`` lies in the plane through ``point`` with the normal ``normal``: one row in metres.

    Both are in the world, shape (3,); the normal is of any length but zero. The row is the signed distance.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    point: ArrayLike
    normal: ArrayLike

    _kind: ClassVar[str] = "plane"
    _frames = ("frame",)
    _vectors = {"point": 3, "normal": 3}


@dataclass(frozen=True, eq=False, repr=False)
class Ray(Task):
    """The origin of ``frame`` lies on the line through ``eye`` and ``through``: three rows in metres.

    Both are different points of the world, shape (3,), metres, as from ``Camera.viewing_ray``.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    eye: ArrayLike
    through: ArrayLike

    _kind: ClassVar[str] = "ray"
    _frames = ("frame",)
    _vectors = {"eye": 3, "through": 3}


@dataclass(frozen=True, eq=False, repr=False)
class Pixel(Task):
    """``camera`` sees the origin of ``frame`` at ``target``, a pixel (u, v), shape (2,): two rows in pixels.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    frame: str
    camera: Camera
    target: ArrayLike

    _kind: ClassVar[str] = "pixel"
    _frames = ("frame",)
    _vectors = {"target": 2}

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.camera, Camera):
            raise InvalidValueError(f"camera must be a kinopt.tasks.Camera, not {self.camera!r}")


@dataclass(frozen=True, eq=False, repr=False)
class Posture(Task):
    """Nominal posture: joints near ``reference``, one row for each joint, in joint units. A preference by default.

    The reference is a configuration, shape (nq,), or a dict of some joints' values, radians or metres.
    ``joint_weights`` are factors of the joints' rows, at least 0: one for each of ``joint_names``, or a dict of some
    joints', the others 1. ``"by range"`` makes rows relative to half of each joint's range. With ``"upright"``, joints
    that carry several limbs (a back, the rotation of a free base) weigh five times as much as limbs. The position of a
    free base then weighs nothing, so that legs bend before the back does.

    Raises ``InvalidValueError`` for values that are not numbers.
    """

    reference: ArrayLike | Mapping[str, float]
    joint_weights: ArrayLike | Mapping[str, float] | Literal["by range", "upright"] | None = field(
        default=None, kw_only=True
    )

    _kind: ClassVar[str] = "posture"

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.reference, Mapping):
            for joint, value in self.reference.items():
                _check_number(f"the reference of {joint}", value)
            self._keep("reference", dict(self.reference))
        else:
            self._keep_vector("reference", None)
        self._joint_weights("by range", "upright")


@dataclass(frozen=True, eq=False, repr=False)
class Smoothness(Task):
    """Slow motion of joints from ``previous``, shape (nq,), their values ``time_step_s`` seconds ago.

    One row for each joint, in joint units per second. A preference by default. ``joint_weights`` are those of a
    `Posture`.

    Raises ``InvalidValueError`` for other shapes and for names that are not texts.
    """

    previous: ArrayLike
    time_step_s: float
    joint_weights: ArrayLike | Mapping[str, float] | Literal["by range"] | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "smoothness"
    _numbers = ("time_step_s",)
    _vectors = {"previous": None}

    def __post_init__(self) -> None:
        super().__post_init__()
        self._joint_weights("by range")


@dataclass(frozen=True, eq=False, repr=False)
class LimitCentring(Task):
    """Joints near the middle of their limits: 0 in the middle, 1 at a limit, one row for each joint with two limits.

    A ratio. A preference by default.

    Raises as ``Task``.
    """

    _kind: ClassVar[str] = "limit centring"


@dataclass(frozen=True, eq=False, repr=False)
class RelativePose(Task):
    """Pose of ``frame`` at ``target`` in the frame ``base``, with either of them moving: a placement.

    Three rows in metres, three in radians, in the axes of the base. It is a `Pose` with ``base`` as the second
    argument; ``tool`` and ``goal`` are those of `Pose`.

    Raises ``InvalidValueError`` for other shapes, a placement that is not rigid and names that are not texts.
    """

    frame: str
    base: str
    target: PlacementLike
    tool: PlacementLike | None = field(default=None, kw_only=True)
    goal: PoseBounds | Literal["pose", "position"] | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "pose"
    _frames = ("frame", "base")
    _targets = ("target",)
    _placements = ("tool",)


@dataclass(frozen=True, eq=False, repr=False)
class CenterOfMass(Task):
    """Position of the centre of mass at ``target``: (x, y, z), or (x, y) at any height, metres.

    A row in metres for each axis except those of ``free``, such as ``"z"`` or ``"xy"``. Target and axes are those of
    the world, or of the frame ``base``, which may move with the joints. Masses are those of the robot's file, without
    links fixed in the world, or of a rig by the volume of its mesh. ``masses`` replaces them: ``{"frame": kg}``, or
    ``{"frame": (kg, (x, y, z))}`` with a position in the frame's coordinates.

    Raises ``InvalidValueError`` for other shapes and names that are not texts; when the problem is created, also for
    masses that are negative or missing.
    """

    target: ArrayLike
    free: str = field(default="", kw_only=True)
    base: str | None = field(default=None, kw_only=True)
    masses: Masses | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "center of mass"
    _frames = ("base",)
    _vectors = {"target": None}

    def __post_init__(self) -> None:
        super().__post_init__()
        target: Any = self.target
        if not (isinstance(self.free, str) and set(self.free) <= set("xyz")):
            raise InvalidValueError(f"free must be axes such as \"z\" or \"xy\", not {self.free!r}")
        if len(target) == 2:
            self._keep("target", _compiled.numbers(np.append(target, 0.0), "target", 3))
            self._keep("free", self.free if "z" in self.free else self.free + "z")
        elif len(target) != 3:
            raise InvalidValueError(f"target has shape ({len(target)},), expected (3,), or (2,) for any height")
        self._masses()


@dataclass(frozen=True, eq=False, repr=False)
class SupportPolygon(Task):
    """The vertical projection of the centre of mass is within the convex hull of support points.

    ``points`` are in the world, shape (N, 3). ``on`` has those of frames, ``{"frame": points}`` of shape (N, 3) in the
    frame's coordinates: the corners of a foot's sole. One-sided: there is no cost within the polygon, reduced by
    ``margin`` metres from its edges. Two rows in metres across ``up``; their norm is the distance from the reduced
    polygon. ``masses`` are as for `CenterOfMass`.

    Raises ``InvalidValueError`` for other shapes and names that are not texts; when the problem is created, also for a
    margin that leaves no polygon.
    """

    points: ArrayLike | None = None
    on: Mapping[str, ArrayLike] | None = field(default=None, kw_only=True)
    margin: float = field(default=0.0, kw_only=True)
    up: ArrayLike = field(default=(0.0, 0.0, 1.0), kw_only=True)
    masses: Masses | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "support polygon"
    _numbers = ("margin",)
    _vectors = {"up": 3}

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("points", _points("points", () if self.points is None else self.points))
        if not (self.on is None or isinstance(self.on, Mapping)):
            raise InvalidValueError(f"on must be a dict by frame, not {self.on!r}")
        on = {}
        for frame, points in (self.on or {}).items():
            self._check_name("a frame of on", frame, optional=False)
            on[frame] = _points(f"the points on {frame}", points)
        self._keep("on", on)
        self._masses()


@dataclass(frozen=True, eq=False, repr=False)
class Gaze(Task):
    """Direction of ``axis`` of ``frame``, shape (3,), within a cone of ``half_angle``, radians within (0, pi).

    The cone is about the line of sight from the frame's origin to ``target``, metres, or about ``direction``, both in
    the world, shape (3,). Exactly one of the two is given. One-sided: one row in radians, the angle outside the cone.

    Raises ``InvalidValueError`` for other shapes, names that are not texts, and both or none of target and direction.
    """

    frame: str
    axis: ArrayLike
    half_angle: float
    target: ArrayLike | None = field(default=None, kw_only=True)
    direction: ArrayLike | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "gaze"
    _frames = ("frame",)
    _numbers = ("half_angle",)
    _vectors = {"axis": 3}

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.target is None) == (self.direction is None):
            raise InvalidValueError("Gaze takes a target or a direction")
        self._keep_vector("target" if self.direction is None else "direction", 3)


@dataclass(frozen=True, eq=False, repr=False)
class FrameVelocity(Task):
    """Velocity of ``frame`` since its pose ``previous``, ``time_step_s`` seconds ago.

    ``linear`` is in m/s, of its origin, ``angular`` in rad/s, both in world axes, shape (3,), default zero. Three rows
    in metres per second and three in radians per second.

    Raises ``InvalidValueError`` for other shapes, a placement that is not rigid and names that are not texts.
    """

    frame: str
    previous: PlacementLike
    time_step_s: float
    linear: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)
    angular: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)

    _kind: ClassVar[str] = "frame velocity"
    _frames = ("frame",)
    _numbers = ("time_step_s",)
    _vectors = {"linear": 3, "angular": 3}
    _targets = ("previous",)


@dataclass(frozen=True, eq=False, repr=False)
class JointCoupling(Task):
    """Linear relation of joints: the sum of ``coefficients`` times their values is ``offset``.

    ``coefficients`` is a dict by joint; one row, in radians if the first joint is revolute, in metres if it is
    prismatic.

    Raises ``InvalidValueError`` for names that are not texts and values that are not numbers.
    """

    coefficients: Mapping[str, float]
    offset: float = 0.0

    _kind: ClassVar[str] = "joint coupling"
    _numbers = ("offset",)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.coefficients, Mapping):
            raise InvalidValueError(f"coefficients must be a dict by joint, not {self.coefficients!r}")
        for joint, value in self.coefficients.items():
            self._check_name("a joint of coefficients", joint, optional=False)
            _check_number(f"the coefficient of {joint}", value)
        self._keep("coefficients", dict(self.coefficients))


@dataclass(frozen=True, eq=False, repr=False)
class Manipulability(Task):
    """Manipulability of ``frame``: Yoshikawa's measure, the square root of det(J J^T), is at least ``least``.

    J is the Jacobian of the frame with respect to the joints that move it relative to ``base``, by default the world.
    ``of`` selects its rows: ``"pose"``, all six, ``"position"`` or ``"orientation"``. One row without a unit, 1 at a
    singularity and 0 from ``least`` on: one-sided. A preference by default; as a goal it needs a tolerance.

    Raises ``InvalidValueError`` for names that are not texts and values that are not numbers.
    """

    frame: str
    least: float
    base: str | None = field(default=None, kw_only=True)
    of: Literal["pose", "position", "orientation"] = field(default="pose", kw_only=True)

    _kind: ClassVar[str] = "manipulability"
    _frames = ("frame", "base")
    _numbers = ("least",)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.of not in ("pose", "position", "orientation"):
            raise InvalidValueError(f"of must be \"pose\", \"position\" or \"orientation\", not {self.of!r}")


@dataclass(frozen=True, eq=False, repr=False)
class Bounded(Task):
    """Interval of another task: its rows cost only the part outside it, as for a floor or a smallest distance.

    ``half_width`` is the interval from -half_width to half_width; otherwise it is from ``lower`` to ``upper``, either
    of which may be infinite. It applies to every row, in its own unit. Name, weights, tolerance, role and level are by
    default those of the inner ``task``.

    A limit that depends on other joints is an example; it is a penalty, not a hard bound::

        beyond = tasks.Residual(lambda q: [q[0] + 0.5 * q[1] - 1.2], joints=["wrist", "elbow"], rows={"radians": 1})
        problem = kinopt.Problem(robot, [tasks.Bounded.at_most(beyond, 0.0), tasks.Point("hand", [0.4, 0.1, 0.3])])

    Raises ``InvalidValueError`` for another object than a task, for a nested ``Bounded``, and for an interval given
    twice.
    """

    task: Task
    half_width: float | None = None
    lower: float = field(default=-inf, kw_only=True)
    upper: float = field(default=inf, kw_only=True)

    _kind: ClassVar[str] = "bounded"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.task, Task) or isinstance(self.task, Bounded):
            raise InvalidValueError(f"Bounded takes one of the other tasks, not {self.task!r}")
        if self.half_width is not None:
            if (self.lower, self.upper) != (-inf, inf):
                raise InvalidValueError("Bounded takes half_width, or lower and upper, not both")
            _check_number("half_width", self.half_width)
            self._keep("lower", -self.half_width)
            self._keep("upper", self.half_width)
            self._keep("half_width", None)
        _check_number("lower", self.lower)
        _check_number("upper", self.upper)
        for item in fields(Task):
            if getattr(self, item.name) == item.default:
                self._keep(item.name, getattr(self.task, item.name))

    @classmethod
    def at_most(cls, task: Task, upper: float) -> Bounded:
        """Rows of at most ``upper`` cost nothing. Raises as the class does."""
        return cls(task, upper=upper)

    @classmethod
    def at_least(cls, task: Task, lower: float) -> Bounded:
        """Rows of at least ``lower`` cost nothing. Raises as the class does."""
        return cls(task, lower=lower)

    @classmethod
    def between(cls, task: Task, lower: float, upper: float) -> Bounded:
        """Rows from ``lower`` to ``upper`` cost nothing; either may be infinite. Raises as the class does."""
        return cls(task, lower=lower, upper=upper)


@dataclass(frozen=True, eq=False, repr=False)
class Residual(Task):
    """A custom task: a function of numpy arrays that is zero at the target.

    ``function`` is called with the inputs of the residual and returns ``rows`` numbers: ``function(placements)`` if it
    reads ``frames`` (their names; placements of shape (F, 4, 4), world from frame), ``function(q)`` if it reads
    ``joints`` (their names or ``"all"``; values of shape (J,), radians or metres), ``function(placements, q)`` if it
    reads both. ``rows`` is the number of rows by quantity, such as ``{"metres": 3, "radians": 1}``, in that order. A
    plain number counts metres, and ``"chords"`` are rows whose norm is the chord 2 sin(angle / 2).

    ``jacobian``, called with equal arguments, returns the derivatives, shape (rows, 6 F + J). First come those with
    respect to each frame's velocity and angular velocity, in world axes at the frame's own origin, then those with
    respect to the joints. The default is central differences.

    It may be called from any thread, one call at a time in each. Its exceptions propagate out of the solve; numbers
    that are not finite end the search as "non_finite". It can be pickled if its functions can.

    Raises ``InvalidValueError`` for an object that is not a function, for names that are not texts, for a residual
    without inputs or rows. ``check_jacobian`` finds wrong derivatives.
    """

    function: Callable[..., Any]
    frames: Sequence[str] = field(default=(), kw_only=True)
    joints: Sequence[str] | Literal["all"] = field(default=(), kw_only=True)
    rows: int | Mapping[str, int] = field(kw_only=True)
    jacobian: Callable[..., Any] | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "custom"

    def __post_init__(self) -> None:
        super().__post_init__()
        for named in ("function", "jacobian"):
            function = getattr(self, named)
            if not (callable(function) or (named == "jacobian" and function is None)):
                raise InvalidValueError(f"{named} must be a function, not {function!r}")
        self._keep("frames", _names("frames", self.frames))
        if self.joints != "all":
            self._keep("joints", _names("joints", self.joints))
        if not self.frames and not self.joints:
            raise InvalidValueError("the residual reads neither frames nor joints: set frames or joints")
        rows = self.rows if isinstance(self.rows, Mapping) else {"metres": self.rows}
        for quantity, count in rows.items():
            if not isinstance(count, (int, np.integer)) or isinstance(count, bool) or not 0 < count < 1 << 20:
                raise InvalidValueError(f"rows has {count!r} in {quantity}, which is no whole number of at least 1")
        if not rows:
            raise InvalidValueError("rows is empty: set the number of rows by quantity")
        self._keep("rows", {quantity: int(count) for quantity, count in rows.items()})

    def check_jacobian(self, model: Model | HasModel, q: ArrayLike, *, tolerance: float = 1e-5) -> None:
        """Compares ``jacobian`` with central differences of ``function`` at a configuration, shape (nq,).

        Raises ``InvalidValueError`` if an entry differs by more than ``tolerance`` times the largest of its row (at
        least 1). The message names the row, the motion and both numbers. A wrong Jacobian otherwise only makes searches
        slow or ends them too early. ``model`` is a model, a robot, a skeleton or a rig.
        """
        check(self, model, q, tolerance)


def _points(what: str, points: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Reads points, shape (N, 3), also a single one or none."""
    try:
        rows = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        raise InvalidValueError(f"{what} must be numbers, not {points!r}") from None
    rows = np.empty((0, 3)) if rows.size == 0 else np.atleast_2d(rows).copy()
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InvalidValueError(f"{what} has shape {np.shape(points)}, expected (N, 3)")
    rows.setflags(write=False)
    return rows


def _names(what: str, names: Sequence[str]) -> tuple[str, ...]:
    if isinstance(names, str) or not all(isinstance(name, str) for name in names):
        raise InvalidValueError(f"{what} must be a list of names, not {names!r}")
    return tuple(names)


def _level(level: object) -> int:
    """Reads a level as an int; accepts ``numpy``'s integers too."""
    index = operator.index(level) if hasattr(level, "__index__") and not isinstance(level, bool) else -1
    if not 0 <= index < 2**32:
        raise InvalidValueError(f"level must be a whole number of at least 0, not {level!r}")
    return index


def _check_number(what: str, value: object) -> None:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InvalidValueError(f"{what} must be a number, not {value!r}") from None


__all__ = [
    "Bounded",
    "Camera",
    "CenterOfMass",
    "Distance",
    "FrameVelocity",
    "Gaze",
    "JointCoupling",
    "LimitCentring",
    "LookAt",
    "Manipulability",
    "Orientation",
    "Pixel",
    "Plane",
    "Point",
    "Pose",
    "Posture",
    "Ray",
    "RelativePose",
    "Residual",
    "Smoothness",
    "SupportPolygon",
    "Task",
]
