"""Types of arguments and results, for annotations."""

from __future__ import annotations

from typing import Any, Literal, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
"""An array of float64."""


BaseJoint = Literal["fixed", "free", "planar", "slide-x", "slide-y", "slide-z"]
"""Joint between a robot's root and the world."""


class HasHomogeneous(Protocol):
    """Pose type of pinocchio: ``SE3``."""

    @property
    def homogeneous(self) -> Any: ...


class HasAsMatrix(Protocol):
    """Pose with a method that returns its matrix, as in viser and jaxlie."""

    def as_matrix(self) -> Any: ...


class HasA(Protocol):
    """Pose type of spatialmath: ``SE3``."""

    @property
    def A(self) -> Any: ...  # noqa: N802


PlacementLike = Union[ArrayLike, HasHomogeneous, HasAsMatrix, HasA]
"""One placement: an array of shape (4, 4), or an object with one."""

PlacementsLike = Union[ArrayLike, "list[PlacementLike]", "tuple[PlacementLike, ...]"]
"""Several placements: an array of shape (N, 4, 4), or a list of placements."""


class HasModel(Protocol):
    """A robot, a skeleton, a rig."""

    @property
    def model(self) -> Any: ...


__all__ = [
    "BaseJoint",
    "Floats",
    "HasA",
    "HasAsMatrix",
    "HasHomogeneous",
    "HasModel",
    "PlacementLike",
    "PlacementsLike",
]
