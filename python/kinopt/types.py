"""Types of arguments and results, for annotations."""

from __future__ import annotations

from collections.abc import Mapping
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


PlacementLike = Union[ArrayLike, HasHomogeneous, HasAsMatrix, HasA, tuple[ArrayLike, Any]]
"""One placement, in metres and radians.

- a matrix of shape (4, 4), or an object with one: ``homogeneous``, ``as_matrix()`` or ``A``
- a position of shape (3,): a translation; as a target it requires ``goal="position"``
- a position and a quaternion of shape (7,): x, y, z, qw, qx, qy, qz
- a tuple of a position and a rotation: a quaternion (w, x, y, z); roll, pitch and yaw about the fixed axes x, y and z, as
  in URDF; a matrix of shape (3, 3), or an object with one
"""

PlacementsLike = Union[ArrayLike, "list[PlacementLike]", "tuple[PlacementLike, ...]"]
"""Several placements: an array of shape (N, 4, 4), (N, 7) or (N, 3), a tuple of N positions and N rotations, or a list of
placements."""

ConfigurationLike = Union[ArrayLike, Mapping[str, ArrayLike]]
"""A configuration: an array, or positions by joint name.

Joints that are not named are at the default start of an arm, or at the neutral configuration of a model. A ball joint has a
quaternion (w, x, y, z).
"""

PerJoint = Union[ArrayLike, Mapping[str, float]]
"""Numbers of joints: one for all, one for each, or a dict by joint name."""


class HasModel(Protocol):
    """A robot, a skeleton, a rig."""

    @property
    def model(self) -> Any: ...


__all__ = [
    "BaseJoint",
    "ConfigurationLike",
    "Floats",
    "HasA",
    "HasAsMatrix",
    "HasHomogeneous",
    "HasModel",
    "PerJoint",
    "PlacementLike",
    "PlacementsLike",
]
