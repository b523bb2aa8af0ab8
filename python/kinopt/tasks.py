"""What the frames of a model should do: the tasks of a ``kinopt.Problem``.

Frames and joints are given by name. Every task takes, as keywords:

``name``
    what reports and targets call it; otherwise its kind and first frame do.
``weight``
    multiplies its rows: a number, or a dict by quantity such as ``{"metres": 1.0, "radians": 0.2}``. Unset it
    is 1 per metre, pixel and joint unit, and a quarter of the model's reach per radian. Rows of weight 0 are
    not asked for: they tell their error but never count as missed.
``times``
    multiplies all its weights, given or default.
``tolerance``
    the error, before weighting, within which it counts as reached: a number, or a dict by quantity.
``role``
    ``"goal"``, which must be met, or ``"preference"``, which pulls within what the goals leave free.
``level``
    a strict level, a whole number: goals of level 0 are met first, as if they were alone; those of level 1 come
    as near as they can at no cost to level 0, and so on, whatever their weights, which count within a level.
    Preferences come after all goals, by their own levels.

Weights and tolerances below 0, names that do not exist and targets that are not finite raise
``kinopt.InvalidValueError`` where the problem is made; wrong shapes where the task is. Quantities are
``"metres"``, ``"radians"``, ``"pixels"``, ``"joint units"``, ``"joint units per second"``, ``"metres per second"``,
``"radians per second"`` and ``"ratio"``.
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

from ._kinopt import Goal, Model
from ._kinopt import tasks as _compiled
from ._kinopt.tasks import Camera
from .errors import InvalidValueError
from .jacobian_check import check
from .types import HasModel, PlacementLike


# Masses on frames in kilograms, at the frame's origin or at a place in its coordinates, shape (3,), metres.
Masses = Mapping[str, float | tuple[float, ArrayLike]]


@dataclass(frozen=True, eq=False, repr=False)
class Task:
    """What all tasks have: a name, weights, tolerances, a role, a level. See the module for what they say.

    Raises ``InvalidValueError`` for a name that is no text, for what are no numbers, and for a level that is no
    whole number of at least 0.
    """

    name: str | None = field(default=None, kw_only=True)
    weight: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    times: float = field(default=1.0, kw_only=True)
    tolerance: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    role: Literal["goal", "preference"] | None = field(default=None, kw_only=True)
    level: int = field(default=0, kw_only=True)

    _kind: ClassVar[str]

    def __post_init__(self) -> None:
        self._check_name("name", self.name)
        for named in ("weight", "tolerance"):
            value = getattr(self, named)
            if isinstance(value, Mapping):
                for quantity, number in value.items():
                    self._check_name(f"a quantity of {named}", quantity, optional=False)
                    _check_number(f"{named} per {quantity}", number)
                self._keep(named, dict(value))
        _check_number("times", self.times)
        self._keep("level", _level(self.level))

    def _with(self, given: Mapping[str, object]) -> Task:
        """The same but for these keywords."""
        changed = copy(self)
        for name, value in given.items():
            changed._keep(name, value)
        Task.__post_init__(changed)
        return changed

    def _keep(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _numbers(self, name: str, length: int | None) -> None:
        self._keep(name, _compiled.numbers(getattr(self, name), name, length))

    def _check_name(self, what: str, name: object, optional: bool = True) -> None:
        if not (isinstance(name, str) or (optional and name is None)):
            raise InvalidValueError(f"{what} must be a name, not {name!r}")

    def _frames(self, *names: str) -> None:
        for name in names:
            self._check_name(name, getattr(self, name), optional=name == "base")

    def _joint_weights(self, *words: str) -> None:
        weights = getattr(self, "joint_weights", None)
        if isinstance(weights, Mapping):
            for joint, value in weights.items():
                self._check_name("a joint of joint_weights", joint, optional=False)
                _check_number(f"the weight of {joint}", value)
            self._keep("joint_weights", dict(weights))
        elif isinstance(weights, str):
            if weights not in words:
                known = " or ".join(f'"{word}"' for word in words)
                raise InvalidValueError(f"joint_weights must be numbers or {known}, not {weights!r}")
        elif weights is not None:
            self._numbers("joint_weights", None)

    def _masses(self) -> None:
        masses = getattr(self, "masses", None)
        if masses is None:
            return
        if not isinstance(masses, Mapping):
            raise InvalidValueError(f"masses must be a dict by frame, not {masses!r}")
        kept = {}
        for frame, given in masses.items():
            self._check_name("a frame of masses", frame, optional=False)
            mass, at = given if isinstance(given, Sequence) and len(given) == 2 else (given, (0.0, 0.0, 0.0))
            _check_number(f"the mass of {frame}", mass)
            kept[frame] = (float(mass), _compiled.numbers(at, f"where the mass of {frame} is", 3))
        self._keep("masses", kept)

    def __repr__(self) -> str:
        shown = []
        for own in fields(self):
            value = getattr(self, own.name)
            if isinstance(value, np.ndarray):
                value = value.tolist()
            default = list(own.default) if isinstance(own.default, tuple) else own.default
            if default is MISSING or value != default:
                shown.append(f"{own.name}={value!r}")
        return f"{type(self).__name__}({', '.join(shown)})"


@dataclass(frozen=True, eq=False, repr=False)
class Point(Task):
    """A point of ``frame`` should be at ``target``, shape (3,), metres: three rows in metres.

    ``at`` is the point in the frame's own coordinates, shape (3,), its origin unless given. The target is in
    the world, or in the frame ``base``, which may move with the joints.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    target: ArrayLike
    at: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "point"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame", "base")
        self._numbers("target", 3)
        self._numbers("at", 3)


@dataclass(frozen=True, eq=False, repr=False)
class Pose(Task):
    """``frame`` should stand at ``target``, a placement of shape (4, 4): three rows in metres, three in radians.

    ``tool``, shape (4, 4), is what should stand there instead of the frame itself, in the frame's coordinates.
    ``goal``, a ``kinopt.Goal``, says which components count and how exactly. The target is in the world, or in
    the frame ``base``, which may move with the joints.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    target: PlacementLike
    tool: PlacementLike | None = field(default=None, kw_only=True)
    goal: Goal | None = field(default=None, kw_only=True)
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "pose"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame", "base")
        self._keep("target", _compiled.placement(self.target, "target"))
        if self.tool is not None:
            self._keep("tool", _compiled.placement(self.tool, "tool"))
        if not (self.goal is None or isinstance(self.goal, Goal)):
            raise InvalidValueError(f"goal must be a kinopt.Goal, not {self.goal!r}")


@dataclass(frozen=True, eq=False, repr=False)
class Orientation(Task):
    """The axes of ``frame`` should be the columns of ``target``, shape (3, 3): three rows in radians.

    The target may also be a placement, or an object of another library that stands for a rotation. It is in the
    world, or in the frame ``base``, which may move with the joints.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    target: Any
    base: str | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "orientation"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame", "base")
        self._keep("target", _compiled.rotation(self.target, "target"))


@dataclass(frozen=True, eq=False, repr=False)
class LookAt(Task):
    """``axis`` of ``frame``, shape (3,), should point from its origin to ``target``, shape (3,), metres.

    The axis is in the frame's coordinates, of any length but zero. Three rows in radians; their length is the
    angle that is missing.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    axis: ArrayLike
    target: ArrayLike

    _kind: ClassVar[str] = "look-at"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._numbers("axis", 3)
        self._numbers("target", 3)


@dataclass(frozen=True, eq=False, repr=False)
class Distance(Task):
    """The origins of the frames ``a`` and ``b`` should be ``distance`` metres apart: one row in metres.

    Raises ``InvalidValueError`` for what are no names and for what is no number.
    """

    a: str
    b: str
    distance: float

    _kind: ClassVar[str] = "distance"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("a", "b")
        _check_number("distance", self.distance)


@dataclass(frozen=True, eq=False, repr=False)
class Plane(Task):
    """The origin of ``frame`` should lie in the plane through ``point`` across ``normal``: one row in metres.

    Both are in the world, shape (3,); the normal is of any length but zero. The row is the signed distance.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    point: ArrayLike
    normal: ArrayLike

    _kind: ClassVar[str] = "plane"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._numbers("point", 3)
        self._numbers("normal", 3)


@dataclass(frozen=True, eq=False, repr=False)
class Ray(Task):
    """The origin of ``frame`` should lie on the line through ``eye`` and ``through``: three rows in metres.

    Both are points of the world, shape (3,), metres, apart from each other: ``Camera.viewing_ray`` gives them.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    eye: ArrayLike
    through: ArrayLike

    _kind: ClassVar[str] = "ray"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._numbers("eye", 3)
        self._numbers("through", 3)


@dataclass(frozen=True, eq=False, repr=False)
class Pixel(Task):
    """``camera`` should see the origin of ``frame`` at ``target``, a pixel (u, v), shape (2,): two rows in pixels.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    frame: str
    camera: Camera
    target: ArrayLike

    _kind: ClassVar[str] = "pixel"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._numbers("target", 2)
        if not isinstance(self.camera, Camera):
            raise InvalidValueError(f"camera must be a kinopt.tasks.Camera, not {self.camera!r}")


@dataclass(frozen=True, eq=False, repr=False)
class Posture(Task):
    """Joints should be near ``reference``: one row a joint, in joint units. A preference unless told otherwise.

    The reference is a configuration, shape (dof,), or a dict of some joints' values, radians or metres.
    ``joint_weights`` multiplies the rows of each joint by a number of at least 0: one for each of ``joint_names``, or a dict of
    some joints', the others 1, or ``"by range"``, which counts each joint in half its range, so that all give the
    same share of theirs, or ``"upright"``: what several limbs hang on (a back, the turn of a free base) counts five times
    as much as limbs do, and where a free base is not at all, so that legs bend where a back would.

    Raises ``InvalidValueError`` for what are no numbers.
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
            self._numbers("reference", None)
        self._joint_weights("by range", "upright")


@dataclass(frozen=True, eq=False, repr=False)
class Smoothness(Task):
    """Joints should move slowly from ``previous``, shape (dof,), where they stood ``time_step_s`` seconds ago.

    One row a joint, in joint units per second. A preference unless told otherwise. ``joint_weights`` are those of
    a `Posture`.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    previous: ArrayLike
    time_step_s: float
    joint_weights: ArrayLike | Mapping[str, float] | Literal["by range"] | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "smoothness"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._numbers("previous", None)
        _check_number("time_step_s", self.time_step_s)
        self._joint_weights("by range")


@dataclass(frozen=True, eq=False, repr=False)
class LimitCentring(Task):
    """Joints should stay away from their limits: 0 in the middle, 1 on a limit, one row a joint with two limits.

    A ratio. A preference unless told otherwise.

    Raises as ``Task``.
    """

    _kind: ClassVar[str] = "limit centring"


@dataclass(frozen=True, eq=False, repr=False)
class RelativePose(Task):
    """``frame`` should stand at ``target`` in the frame ``base``, whichever of the two moves: a placement, (4, 4).

    Three rows in metres, three in radians, in the axes of the base. It is a `Pose` whose ``base`` comes second;
    ``tool`` and ``goal`` are as there.

    Raises ``InvalidValueError`` for other shapes, what is no rigid placement and what are no names.
    """

    frame: str
    base: str
    target: PlacementLike
    tool: PlacementLike | None = field(default=None, kw_only=True)
    goal: Goal | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "pose"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._check_name("base", self.base, optional=False)
        self._keep("target", _compiled.placement(self.target, "target"))
        if self.tool is not None:
            self._keep("tool", _compiled.placement(self.tool, "tool"))
        if not (self.goal is None or isinstance(self.goal, Goal)):
            raise InvalidValueError(f"goal must be a kinopt.Goal, not {self.goal!r}")


@dataclass(frozen=True, eq=False, repr=False)
class CenterOfMass(Task):
    """The centre of mass should be at ``target``: (x, y, z), or (x, y) at any height, metres.

    A row in metres for each axis but those of ``free``, such as ``"z"`` or ``"xy"``; the target is in the world, or
    in the frame ``base``, which may move with the joints, and so are the axes. Masses are those of the robot's file,
    but for what stands in the world, or of a rig by the volume of its mesh; ``masses`` gives others:
    ``{"frame": kg}``, or ``{"frame": (kg, (x, y, z))}`` with a place in the frame's coordinates.

    Raises ``InvalidValueError`` for other shapes and what are no names; where the problem is made also for masses
    that are negative or none at all.
    """

    target: ArrayLike
    free: str = field(default="", kw_only=True)
    base: str | None = field(default=None, kw_only=True)
    masses: Masses | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "center of mass"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("base")
        self._numbers("target", None)
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
    """The centre of mass, seen from above, should be within the convex hull of points of support.

    ``points`` are in the world, shape (N, 3), ``on`` has those of frames, ``{"frame": points}`` of shape (N, 3) in
    the frame's coordinates: the corners of a foot's sole. One-sided: within the polygon, less ``margin`` metres
    from its edges, it costs nothing. Two rows in metres across ``up``, their length the distance from there.
    ``masses`` are as for `CenterOfMass`.

    Raises ``InvalidValueError`` for other shapes and what are no names; where the problem is made also for a
    margin that leaves nothing.
    """

    points: ArrayLike | None = None
    on: Mapping[str, ArrayLike] | None = field(default=None, kw_only=True)
    margin: float = field(default=0.0, kw_only=True)
    up: ArrayLike = field(default=(0.0, 0.0, 1.0), kw_only=True)
    masses: Masses | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "support polygon"

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
        _check_number("margin", self.margin)
        self._numbers("up", 3)
        self._masses()


@dataclass(frozen=True, eq=False, repr=False)
class Gaze(Task):
    """``axis`` of ``frame``, shape (3,), should point into a cone of ``half_angle``, radians within (0, pi).

    The cone is about the line of sight from the frame's origin to ``target``, metres, or about ``direction``, both
    in the world, shape (3,); one of the two is given. One-sided: one row in radians, how far outside the cone.

    Raises ``InvalidValueError`` for other shapes, what are no names, and both or none of target and direction.
    """

    frame: str
    axis: ArrayLike
    half_angle: float
    target: ArrayLike | None = field(default=None, kw_only=True)
    direction: ArrayLike | None = field(default=None, kw_only=True)

    _kind: ClassVar[str] = "gaze"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._numbers("axis", 3)
        _check_number("half_angle", self.half_angle)
        if (self.target is None) == (self.direction is None):
            raise InvalidValueError("Gaze takes a target or a direction")
        self._numbers("target" if self.direction is None else "direction", 3)


@dataclass(frozen=True, eq=False, repr=False)
class FrameVelocity(Task):
    """``frame`` should have moved at a velocity since it stood at ``previous``, (4, 4), ``time_step_s`` seconds ago.

    ``linear`` is in m/s, of its origin, ``angular`` in rad/s, both in world axes, shape (3,), and zero unless given.
    Three rows in metres per second and three in radians per second.

    Raises ``InvalidValueError`` for other shapes, what is no rigid placement and what are no names.
    """

    frame: str
    previous: PlacementLike
    time_step_s: float
    linear: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)
    angular: ArrayLike = field(default=(0.0, 0.0, 0.0), kw_only=True)

    _kind: ClassVar[str] = "frame velocity"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame")
        self._keep("previous", _compiled.placement(self.previous, "previous"))
        _check_number("time_step_s", self.time_step_s)
        self._numbers("linear", 3)
        self._numbers("angular", 3)


@dataclass(frozen=True, eq=False, repr=False)
class JointCoupling(Task):
    """The joints should keep a linear relation: the sum of ``coefficients`` times their values is ``offset``.

    ``coefficients`` is a dict by joint; one row, in radians where the first joint turns, in metres where it slides.

    Raises ``InvalidValueError`` for what are no names and no numbers.
    """

    coefficients: Mapping[str, float]
    offset: float = 0.0

    _kind: ClassVar[str] = "joint coupling"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.coefficients, Mapping):
            raise InvalidValueError(f"coefficients must be a dict by joint, not {self.coefficients!r}")
        for joint, value in self.coefficients.items():
            self._check_name("a joint of coefficients", joint, optional=False)
            _check_number(f"the coefficient of {joint}", value)
        self._keep("coefficients", dict(self.coefficients))
        _check_number("offset", self.offset)


@dataclass(frozen=True, eq=False, repr=False)
class Manipulability(Task):
    """``frame`` should be able to move every way: Yoshikawa's measure, the square root of det(J J^T), at least ``least``.

    J is the Jacobian of the frame by the joints that move it against ``base``, the world unless given; ``of`` says
    which of its rows count: ``"pose"``, all six, ``"position"`` or ``"orientation"``. One row without a unit, 1 at a
    singularity and 0 from ``least`` on: one-sided. A preference unless told otherwise; as a goal give it a tolerance.

    Raises ``InvalidValueError`` for what are no names and no numbers.
    """

    frame: str
    least: float
    base: str | None = field(default=None, kw_only=True)
    of: Literal["pose", "position", "orientation"] = field(default="pose", kw_only=True)

    _kind: ClassVar[str] = "manipulability"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._frames("frame", "base")
        _check_number("least", self.least)
        if self.of not in ("pose", "position", "orientation"):
            raise InvalidValueError(f"of must be \"pose\", \"position\" or \"orientation\", not {self.of!r}")


@dataclass(frozen=True, eq=False, repr=False)
class Within(Task):
    """Another task whose rows cost only what lies beyond an interval: a room, a floor, a least distance.

    ``half_width`` stands for the interval from -half_width to half_width; otherwise it goes from ``lower`` to
    ``upper``, either of which may be infinite. All rows share it, in their own unit. Name, weights, tolerance,
    role and level are those of the task inside unless given here.

    A limit that depends on other joints is one of these, penalised and not refused::

        beyond = tasks.Residual(lambda q: [q[0] + 0.5 * q[1] - 1.2], joints=["wrist", "elbow"], rows={"radians": 1})
        problem = kinopt.Problem(robot, [tasks.Within.at_most(beyond, 0.0), tasks.Point("hand", [0.4, 0.1, 0.3])])

    Raises ``InvalidValueError`` for what is no task, or another ``Within``, and for an interval given twice.
    """

    task: Task
    half_width: float | None = None
    lower: float = field(default=-inf, kw_only=True)
    upper: float = field(default=inf, kw_only=True)

    _kind: ClassVar[str] = "within"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.task, Task) or isinstance(self.task, Within):
            raise InvalidValueError(f"Within takes one of the other tasks, not {self.task!r}")
        if self.half_width is not None:
            if (self.lower, self.upper) != (-inf, inf):
                raise InvalidValueError("Within takes half_width, or lower and upper, not both")
            _check_number("half_width", self.half_width)
            self._keep("lower", -self.half_width)
            self._keep("upper", self.half_width)
            self._keep("half_width", None)
        _check_number("lower", self.lower)
        _check_number("upper", self.upper)
        for own in fields(Task):
            if getattr(self, own.name) == own.default:
                self._keep(own.name, getattr(self.task, own.name))

    @classmethod
    def at_most(cls, task: Task, upper: float) -> Within:
        """Rows of at most ``upper`` cost nothing. Raises as the class does."""
        return cls(task, upper=upper)

    @classmethod
    def at_least(cls, task: Task, lower: float) -> Within:
        """Rows of at least ``lower`` cost nothing. Raises as the class does."""
        return cls(task, lower=lower)

    @classmethod
    def between(cls, task: Task, lower: float, upper: float) -> Within:
        """Rows from ``lower`` to ``upper`` cost nothing; either may be infinite. Raises as the class does."""
        return cls(task, lower=lower, upper=upper)


@dataclass(frozen=True, eq=False, repr=False)
class Residual(Task):
    """A task of one's own: a function of numpy arrays that is zero when all is as it should be.

    ``function`` is called with what the residual reads and returns ``rows`` numbers:
    ``function(placements)`` where it reads ``frames`` (their names; placements of shape (F, 4, 4), world from
    frame), ``function(q)`` where it reads ``joints`` (their names or ``"all"``; values of shape (J,), radians or
    metres), ``function(placements, q)`` where it reads both. ``rows`` says how many numbers it returns and what
    they measure, such as ``{"metres": 3, "radians": 1}``, in that order; a number alone counts metres, and
    ``"chords"`` are rows whose norm is the chord 2 sin(angle / 2).

    ``jacobian``, called with the same, returns the derivatives, shape (rows, 6 F + J): for each frame those by
    its velocity and its angular velocity, in world axes at the frame's own origin, then those by the joints.
    Without it they are taken by central differences.

    It may be called from any thread, one call at a time in each. What it raises comes out of the solve
    unchanged; numbers that are not finite end the search as "non_finite". It pickles as far as its functions do.

    Raises ``InvalidValueError`` for what is no function, for names that are no texts, for a residual that reads
    nothing or returns nothing; for wrong derivatives see ``check_jacobian``.
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
            raise InvalidValueError("the residual reads neither frames nor joints: name what its function takes")
        rows = self.rows if isinstance(self.rows, Mapping) else {"metres": self.rows}
        for quantity, count in rows.items():
            if not isinstance(count, (int, np.integer)) or isinstance(count, bool) or not 0 < count < 1 << 20:
                raise InvalidValueError(f"rows has {count!r} in {quantity}, which is no whole number of at least 1")
        if not rows:
            raise InvalidValueError("rows is empty: say how many numbers the function returns")
        self._keep("rows", {quantity: int(count) for quantity, count in rows.items()})

    def check_jacobian(self, model: Model | HasModel, q: ArrayLike, *, tolerance: float = 1e-5) -> None:
        """Compares ``jacobian`` with central differences of ``function`` at a configuration, shape (dof,).

        Where an entry is off by more than ``tolerance`` of the largest of its row (of 1 where all are smaller)
        it raises ``InvalidValueError``, which names the row and the motion, and tells both numbers. A wrong
        Jacobian goes unnoticed otherwise: searches only become slow or stop too early. ``model`` is a model, a
        robot, a skeleton or a rig.
        """
        check(self, model, q, tolerance)


def _points(what: str, points: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Points, shape (N, 3), also a single one or none."""
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
    """A level as a plain number; ``numpy``'s whole numbers are some too."""
    whole = operator.index(level) if hasattr(level, "__index__") and not isinstance(level, bool) else -1
    if not 0 <= whole < 2**32:
        raise InvalidValueError(f"level must be a whole number of at least 0, not {level!r}")
    return whole


def _check_number(what: str, value: object) -> None:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InvalidValueError(f"{what} must be a number, not {value!r}") from None


__all__ = [
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
    "Within",
]
