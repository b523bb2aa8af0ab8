"""Methods of a ``kinopt.Solver``.

Levenberg-Marquardt is the recommended method. The geometric methods (``Ccd``, ``Fabrik``, ``TwoBone``) need no
derivatives and support points and poses only. All methods satisfy joint limits exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Union

from numpy.typing import ArrayLike

from ._kinopt import tasks as _compiled


@dataclass(frozen=True)
class LevenbergMarquardt:
    """Damped least squares with hard bounds.

    ``damping`` is ``"gain_ratio"`` (Nielsen 1999) or ``"error_proportional"`` (Chan & Lawrence 1988).
    ``initial_damping`` is its first value, positive. For the gain ratio it is relative to the largest diagonal entry
    (default 1e-3), otherwise a multiple of the cost (default 0.1). ``kinopt.Solver`` raises ``InvalidValueError`` for
    settings out of range.
    """

    damping: Literal["gain_ratio", "error_proportional"] = "gain_ratio"
    initial_damping: float | None = None

    _kind: ClassVar[str] = "levenberg-marquardt"


@dataclass(frozen=True)
class GaussNewton:
    """Least squares by a rank-revealing factorisation, with a line search.

    Diagonal entries below ``rank_tolerance`` (default 1e-8; from the machine epsilon to 0.5) times the largest count as
    zero. ``kinopt.Solver`` raises ``InvalidValueError`` for a value out of range.
    """

    rank_tolerance: float | None = None

    _kind: ClassVar[str] = "gauss-newton"


@dataclass(frozen=True)
class ProjectedGradient:
    """Steepest descent along the projected path.

    ``first_step`` is the initial step length, positive, which is halved, or ``"barzilai_borwein"`` for a step length
    from the last change of the gradient. ``kinopt.Solver`` raises ``InvalidValueError`` for a value out of range.
    """

    first_step: float | Literal["barzilai_borwein"] = 10_000.0

    _kind: ClassVar[str] = "projected-gradient"


@dataclass(frozen=True)
class Ccd:
    """Cyclic coordinate descent: optimises one joint after another. Supports points, poses and orientations."""

    _kind: ClassVar[str] = "ccd"


@dataclass(frozen=True)
class Fabrik:
    """Forward and backward reaching on points, then the nearest joint values. For chains of ball joints."""

    _kind: ClassVar[str] = "fabrik"


@dataclass(frozen=True, eq=False)
class TwoBone:
    """Closed form for a limb of two bones with one point task for its end; all other joints are locked.

    ``elbow`` is the bend direction: ``"positive"``, ``"negative"``, or a pole, a point of the world, shape (3,),
    metres, towards which the limb bends. A pole of another shape raises ``InvalidValueError``.
    """

    elbow: Literal["positive", "negative"] | ArrayLike = "positive"

    _kind: ClassVar[str] = "two_bone"

    def __post_init__(self) -> None:
        if not isinstance(self.elbow, str):
            object.__setattr__(self, "elbow", _compiled.numbers(self.elbow, "elbow", 3))


Method = Union[LevenbergMarquardt, GaussNewton, ProjectedGradient, Ccd, Fabrik, TwoBone]
"""Any method."""

__all__ = [
    "Ccd",
    "Fabrik",
    "GaussNewton",
    "LevenbergMarquardt",
    "Method",
    "ProjectedGradient",
    "TwoBone",
]
