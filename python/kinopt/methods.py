"""The methods of a ``kinopt.Solver``.

Levenberg-Marquardt is the one to take. The geometric ones (``Ccd``, ``Fabrik``, ``TwoBone``) need no
derivatives and take points and poses alone; all keep joint limits to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Union

from numpy.typing import ArrayLike

from ._kinopt import tasks as _compiled


@dataclass(frozen=True)
class LevenbergMarquardt:
    """Damped least squares with hard bounds.

    ``damping`` follows the ``"gain_ratio"`` (Nielsen 1999) or is ``"error_proportional"`` (Chan & Lawrence
    1988). ``initial_damping`` is its first value, positive: a share of the largest diagonal entry for the gain
    ratio (1e-3 unless given), a multiple of the cost otherwise (0.1). Settings out of range raise
    ``InvalidValueError`` where a ``kinopt.Solver`` is made of it.
    """

    damping: Literal["gain_ratio", "error_proportional"] = "gain_ratio"
    initial_damping: float | None = None

    _kind: ClassVar[str] = "levenberg-marquardt"


@dataclass(frozen=True)
class GaussNewton:
    """Least squares by a rank-revealing factorisation, with a line search.

    Diagonal entries below ``rank_tolerance`` (1e-8 unless given; from the machine's epsilon to 0.5) times the
    largest count as zero. One out of range raises ``InvalidValueError`` where a ``kinopt.Solver`` is made of it.
    """

    rank_tolerance: float | None = None

    _kind: ClassVar[str] = "gauss-newton"


@dataclass(frozen=True)
class ProjectedGradient:
    """Steepest descent along the projected path.

    ``first_step`` is the step that is tried first and halved, positive, or ``"barzilai_borwein"`` for one by the
    last change of gradient. One out of range raises ``InvalidValueError`` where a ``kinopt.Solver`` is made of it.
    """

    first_step: float | Literal["barzilai_borwein"] = 10_000.0

    _kind: ClassVar[str] = "projected-gradient"


@dataclass(frozen=True)
class Ccd:
    """Cyclic coordinate descent: every joint in turn does the best it can. Points, poses, orientations."""

    _kind: ClassVar[str] = "ccd"


@dataclass(frozen=True)
class Fabrik:
    """Forward and backward reaching on points, then the joints that come nearest. For chains of ball joints."""

    _kind: ClassVar[str] = "fabrik"


@dataclass(frozen=True, eq=False)
class TwoBone:
    """The closed form for a limb of two bones and one point for its end; everything else is locked.

    ``elbow`` is the side on which the bones meet: ``"positive"``, ``"negative"``, or a point of the world (the
    pole), shape (3,), metres, towards which it goes. A pole of another shape raises ``InvalidValueError``.
    """

    elbow: Literal["positive", "negative"] | ArrayLike = "positive"

    _kind: ClassVar[str] = "two_bone"

    def __post_init__(self) -> None:
        if not isinstance(self.elbow, str):
            object.__setattr__(self, "elbow", _compiled.numbers(self.elbow, "elbow", 3))


Method = Union[LevenbergMarquardt, GaussNewton, ProjectedGradient, Ccd, Fabrik, TwoBone]
"""Any of them."""

__all__ = [
    "Ccd",
    "Fabrik",
    "GaussNewton",
    "LevenbergMarquardt",
    "Method",
    "ProjectedGradient",
    "TwoBone",
]
