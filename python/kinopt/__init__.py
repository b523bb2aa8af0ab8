"""Inverse kinematics by optimisation: robot arms and skeletons, hard limits, honest results.

Placements are 4 x 4 arrays (or what has ``homogeneous``, ``as_matrix()`` or ``A``), metres and radians;
``world_from_tip`` maps tip coordinates to world coordinates. Many of anything come first:
``(N, 4, 4)`` targets give ``(N, dof)`` configurations.
"""

from ._kinopt import Frame, Joint, Model, ModelBuilder, Robot, Shape, __version__
from .errors import (
    FileError,
    InvalidFileError,
    InvalidValueError,
    KinoptError,
    UnknownNameError,
)

__all__ = [
    "FileError",
    "Frame",
    "InvalidFileError",
    "InvalidValueError",
    "Joint",
    "KinoptError",
    "Model",
    "ModelBuilder",
    "Robot",
    "Shape",
    "UnknownNameError",
    "__version__",
]
