"""Inverse kinematics by optimisation: robot arms and skeletons, hard limits, honest results.

Placements are 4 x 4 arrays (or what has ``homogeneous``, ``as_matrix()`` or ``A``), metres and radians;
``world_from_tip`` maps tip coordinates to world coordinates. Many of anything come first:
``(N, 4, 4)`` targets give ``(N, dof)`` configurations.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from . import animation, io, methods, retargeting, skinning, tasks
from ._kinopt import (
    ActiveLimit,
    Arm,
    BallSkeleton,
    ArmDerivative,
    Batch,
    Bone,
    CollisionModel,
    Collision,
    Counts,
    Drag,
    Follower,
    ForwardKinematics,
    Frame,
    Goal,
    Iteration,
    Jacobian,
    Joint,
    Jump,
    Leap,
    LoopClosure,
    Model,
    MissedPoint,
    ModelBuilder,
    MotionCapture,
    Obstacle,
    ParameterMap,
    PathSolution,
    Problem,
    Reconfiguration,
    Rig,
    RigPosing,
    Robot,
    RowsReport,
    Scene,
    SceneFile,
    SceneMesh,
    ScenePosing,
    Separation,
    Servo,
    ServoStep,
    Shape,
    Skeleton,
    SkeletonBuilder,
    Skin,
    Solution,
    SolutionDerivative,
    Solutions,
    Solver,
    SphereModel,
    Srdf,
    TaskReport,
    Track,
    TriangleMesh,
    World,
    __version__,
    frame_jacobian,
    frame_placement,
    solve_path,
)
from .errors import (
    FileError,
    InvalidFileError,
    InvalidValueError,
    KinoptError,
    UnknownNameError,
)

from .placements import placement
from .retargeting import RetargetFollower, Retargeted, guess_map, retarget

if TYPE_CHECKING:
    from types import ModuleType


def __getattr__(name: str) -> ModuleType:
    # Their extras need not be installed for the rest.
    if name in ("jax", "ray", "torch", "view"):
        return importlib.import_module(f"kinopt.{name}")
    raise AttributeError(f"module 'kinopt' has no attribute {name!r}")


__all__ = [
    "ActiveLimit",
    "Arm",
    "BallSkeleton",
    "ArmDerivative",
    "Batch",
    "Bone",
    "CollisionModel",
    "Collision",
    "Counts",
    "Drag",
    "FileError",
    "Follower",
    "ForwardKinematics",
    "Frame",
    "Goal",
    "InvalidFileError",
    "InvalidValueError",
    "Iteration",
    "Jacobian",
    "Joint",
    "Jump",
    "KinoptError",
    "Leap",
    "LoopClosure",
    "Model",
    "MissedPoint",
    "ModelBuilder",
    "MotionCapture",
    "Obstacle",
    "ParameterMap",
    "PathSolution",
    "Problem",
    "Reconfiguration",
    "RetargetFollower",
    "Retargeted",
    "Rig",
    "RigPosing",
    "Robot",
    "RowsReport",
    "Scene",
    "SceneFile",
    "SceneMesh",
    "ScenePosing",
    "Separation",
    "Servo",
    "ServoStep",
    "Shape",
    "Skeleton",
    "SkeletonBuilder",
    "Skin",
    "Solution",
    "SolutionDerivative",
    "Solutions",
    "Solver",
    "SphereModel",
    "Srdf",
    "TaskReport",
    "Track",
    "TriangleMesh",
    "UnknownNameError",
    "World",
    "__version__",
    "animation",
    "frame_jacobian",
    "frame_placement",
    "guess_map",
    "retarget",
    "retargeting",
    "solve_path",
    "io",
    "methods",
    "placement",
    "skinning",
    "tasks",
]
