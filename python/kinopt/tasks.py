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

Weights and tolerances below 0, names that do not exist and targets that are not finite raise
``kinopt.InvalidValueError`` where the problem is made; wrong shapes where the task is. Quantities are
``"metres"``, ``"radians"``, ``"pixels"``, ``"joint units"``, ``"joint units per second"``, ``"metres per second"``,
``"radians per second"`` and ``"ratio"``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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


@dataclass(frozen=True, eq=False, repr=False)
class Task:
    """What all tasks have: a name, weights, tolerances, a role. See the module for what they say.

    Raises ``InvalidValueError`` for a name that is no text and for what are no numbers.
    """

    name: str | None = field(default=None, kw_only=True)
    weight: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    times: float = field(default=1.0, kw_only=True)
    tolerance: float | Mapping[str, float] | None = field(default=None, kw_only=True)
    role: Literal["goal", "preference"] | None = field(default=None, kw_only=True)

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

    Raises ``InvalidValueError`` for what are no numbers.
    """

    reference: ArrayLike | Mapping[str, float]

    _kind: ClassVar[str] = "posture"

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.reference, Mapping):
            for joint, value in self.reference.items():
                _check_number(f"the reference of {joint}", value)
            self._keep("reference", dict(self.reference))
        else:
            self._numbers("reference", None)


@dataclass(frozen=True, eq=False, repr=False)
class Smoothness(Task):
    """Joints should move slowly from ``previous``, shape (dof,), where they stood ``time_step_s`` seconds ago.

    One row a joint, in joint units per second. A preference unless told otherwise.

    Raises ``InvalidValueError`` for other shapes and for what are no names.
    """

    previous: ArrayLike
    time_step_s: float

    _kind: ClassVar[str] = "smoothness"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._numbers("previous", None)
        _check_number("time_step_s", self.time_step_s)


@dataclass(frozen=True, eq=False, repr=False)
class LimitCentring(Task):
    """Joints should stay away from their limits: 0 in the middle, 1 on a limit, one row a joint with two limits.

    A ratio. A preference unless told otherwise.

    Raises as ``Task``.
    """

    _kind: ClassVar[str] = "limit centring"


@dataclass(frozen=True, eq=False, repr=False)
class Within(Task):
    """Another task whose rows cost only what lies beyond an interval: a room, a floor, a least distance.

    ``half_width`` stands for the interval from -half_width to half_width; otherwise it goes from ``lower`` to
    ``upper``, either of which may be infinite. All rows share it, in their own unit. Name, weights, tolerance
    and role are those of the task inside unless given here.

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


def _names(what: str, names: Sequence[str]) -> tuple[str, ...]:
    if isinstance(names, str) or not all(isinstance(name, str) for name in names):
        raise InvalidValueError(f"{what} must be a list of names, not {names!r}")
    return tuple(names)


def _check_number(what: str, value: object) -> None:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InvalidValueError(f"{what} must be a number, not {value!r}") from None


__all__ = [
    "Camera",
    "Distance",
    "LimitCentring",
    "LookAt",
    "Orientation",
    "Pixel",
    "Plane",
    "Point",
    "Pose",
    "Posture",
    "Ray",
    "Residual",
    "Smoothness",
    "Task",
    "Within",
]
