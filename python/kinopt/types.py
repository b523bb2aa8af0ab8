"""What functions take and give, for annotations."""

from __future__ import annotations

from typing import Any, Literal, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
"""An array of float64."""


BaseJoint = Literal["fixed", "free", "planar", "slide-x", "slide-y", "slide-z"]
"""What a robot's root moves on."""


class HasHomogeneous(Protocol):
    """A pose of pinocchio's: ``SE3``."""

    @property
    def homogeneous(self) -> Any: ...


class HasAsMatrix(Protocol):
    """A pose that gives its matrix by a method, as viser's and jaxlie's do."""

    def as_matrix(self) -> Any: ...


class HasA(Protocol):
    """A pose of spatialmath's: ``SE3``."""

    @property
    def A(self) -> Any: ...  # noqa: N802


PlacementLike = Union[ArrayLike, HasHomogeneous, HasAsMatrix, HasA]
"""One placement: an array of shape (4, 4), or an object that has one."""

PlacementsLike = Union[ArrayLike, "list[PlacementLike]", "tuple[PlacementLike, ...]"]
"""Many placements: an array of shape (N, 4, 4), or a list of placements."""


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
