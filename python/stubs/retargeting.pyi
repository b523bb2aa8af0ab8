import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeAlias, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..types import Floats, HasModel
from . import Model, MotionCapture, Rig, Scene, SceneFile, Skeleton
from .animation import Armature, Clip

_Target: TypeAlias = Union[Model, HasModel, Scene, SceneFile, MotionCapture]

@final
class Capture:
    def __new__(
        cls,
        positions: ArrayLike,
        joints: list[str],
        fps: float,
        up: str | None = None,
        bones: list[tuple[int, int]] | None = None,
        rotations: ArrayLike | None = None,
        rest: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Capture: ...
    @staticmethod
    def of_clip(clip: Clip, fps: float, up: str | None = None) -> Capture: ...
    @staticmethod
    def of_c3d(path: str | os.PathLike[str], up: str | None = None) -> Capture: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def fps(self) -> float: ...
    @property
    def up(self) -> Literal["y", "z"]: ...
    @property
    def bones(self) -> list[tuple[int, int]] | None: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def rotations(self) -> Floats | None: ...
    @property
    def rest(self) -> tuple[Floats, Floats] | None: ...
    def __len__(self) -> int: ...

@final
class FigureTarget:
    def __new__(
        cls,
        of: Rig | Skeleton | Scene | SceneFile | MotionCapture | Model | HasModel,
        up: Literal["y", "z"] | None = None,
    ) -> FigureTarget: ...
    @property
    def model(self) -> Model: ...
    @property
    def armature(self) -> Armature: ...
    @property
    def up(self) -> Literal["y", "z"]: ...
    def clip(self, q: ArrayLike, fps: float, name: str = "retargeted") -> Clip: ...

@final
class Live:
    def __new__(
        cls, capture: Capture, target: _Target, map: str, options: dict[str, Any]
    ) -> Live: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def q(self) -> Floats: ...
    def step(self, positions: ArrayLike, rotations: ArrayLike | None = None) -> Floats: ...

def capture_retargeted(
    capture: Capture,
    target: _Target,
    map: str,
    whole: bool,
    options: dict[str, Any],
    progress: Callable[[int, int], None] | None,
) -> tuple[
    Floats,
    list[str],
    NDArray[np.bool_],
    tuple[list[str], Floats],
    tuple[Floats, list[str]],
    tuple[float, float, float],
    str,
    list[tuple[str, str, int, int]],
    list[tuple[int, str, str, float]],
    list[tuple[int, str]],
    tuple[str | None, bool],
    Floats,
]: ...
def motion_scored(
    motion: ArrayLike | str,
    target: _Target,
    capture: Capture | None,
    map: str | None,
    options: dict[str, Any],
) -> str: ...
def map_completed(
    map: str, capture: Capture, target: _Target
) -> tuple[str | None, list[str]]: ...
def map_guessed(
    capture: Capture, target: _Target
) -> tuple[str, str | None, str | None, list[str]]: ...
def map_of_skeleton(
    skeleton: str, capture: Capture, target: _Target
) -> tuple[str, str | None, str | None, list[str]]: ...
def skeleton_names() -> list[str]: ...
def skeleton_joints(skeleton: str, joints: int) -> list[str] | None: ...
def folder_begun(
    folders: tuple[str | os.PathLike[str], str | os.PathLike[str]],
    target: _Target,
    map: str | None,
    skeleton: str | None,
    reading: dict[str, Any],
    options: dict[str, Any],
    overwrite: bool,
) -> list[tuple[str, str, bool]]: ...
def unfinished(out: str | os.PathLike[str]) -> Path: ...
def hand_map_guessed(capture: Capture, target: _Target, side: str | None) -> str: ...
def hand_retargeted(
    capture: Capture, target: _Target, map: str
) -> tuple[Floats, list[str], tuple[float, float, list[float]]]: ...
@final
class LiveHand:
    def __new__(cls, capture: Capture, target: _Target, map: str) -> LiveHand: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def q(self) -> Floats: ...
    def step(self, positions: ArrayLike) -> Floats: ...
