from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Skeleton, TriangleMesh


@final
class SkinWeights:
    def __new__(
        cls,
        vertices: ArrayLike,
        bones: ArrayLike,
        weights: ArrayLike,
        vertex_count: int,
        bone_count: int,
    ) -> SkinWeights: ...
    @classmethod
    def repaired(
        cls,
        vertices: ArrayLike,
        bones: ArrayLike,
        weights: ArrayLike,
        vertex_count: int,
        bone_count: int,
    ) -> tuple[SkinWeights, dict[str, Any]]: ...
    @classmethod
    def from_table(cls, table: ArrayLike) -> SkinWeights: ...
    def to_table(self) -> NDArray[np.float64]: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def bone_count(self) -> int: ...
    @property
    def max_influences(self) -> int: ...
    @property
    def starts(self) -> NDArray[np.int64]: ...
    @property
    def bones(self) -> NDArray[np.int64]: ...
    @property
    def weights(self) -> NDArray[np.float64]: ...
    def influences(self, vertex: int) -> list[tuple[int, float]]: ...
    def pruned(self, most: int) -> tuple[SkinWeights, dict[str, float]]: ...

@final
class MorphTarget:
    def __new__(
        cls,
        name: str,
        vertices: ArrayLike,
        position_deltas: ArrayLike,
        normal_deltas: ArrayLike | None = None,
        tangent_deltas: ArrayLike | None = None,
    ) -> MorphTarget: ...
    @classmethod
    def between(
        cls, name: str, rest: TriangleMesh, shape: TriangleMesh, threshold: float = 0.0
    ) -> MorphTarget: ...
    @property
    def name(self) -> str: ...
    @property
    def vertices(self) -> NDArray[np.uint32]: ...
    @property
    def position_deltas(self) -> NDArray[np.float32]: ...
    @property
    def normal_deltas(self) -> NDArray[np.float32] | None: ...
    @property
    def tangent_deltas(self) -> NDArray[np.float32] | None: ...

@final
class MorphTargets:
    def __new__(cls, vertex_count: int, targets: Sequence[MorphTarget]) -> MorphTargets: ...
    @property
    def targets(self) -> list[MorphTarget]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def vertex_count(self) -> int: ...
    def apply(
        self,
        weights: ArrayLike,
        positions: NDArray[np.float32] | None = None,
        normals: NDArray[np.float32] | None = None,
        tangents: NDArray[np.float32] | None = None,
    ) -> None: ...

@final
class BlendShapes:
    def __new__(cls, shapes: Mapping[str, ArrayLike]) -> BlendShapes: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def vertex_count(self) -> int: ...
    def blend(
        self, weights: ArrayLike, *, out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]: ...

@final
class MeshWeights:
    def __new__(
        cls,
        weights: SkinWeights,
        *,
        pivots: ArrayLike | None = None,
        packed: bool | None = None,
    ) -> MeshWeights: ...
    @property
    def is_packed(self) -> bool: ...
    @property
    def weights(self) -> SkinWeights: ...
    @property
    def pivots(self) -> NDArray[np.float32] | None: ...
    def positions(
        self,
        method: str,
        transforms: ArrayLike,
        rest: ArrayLike,
        *,
        out: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]: ...
    def normals(
        self,
        method: str,
        transforms: ArrayLike,
        rest: ArrayLike,
        *,
        out: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]: ...
    def tangents(
        self,
        method: str,
        transforms: ArrayLike,
        rest: ArrayLike,
        *,
        out: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]: ...
    def mesh(self, method: str, rest: TriangleMesh, transforms: ArrayLike) -> TriangleMesh: ...

@final
class PointHandle:
    def __new__(
        cls, rest: ArrayLike, posed: ArrayLike | None = None, linear: ArrayLike | None = None
    ) -> PointHandle: ...
    @property
    def rest(self) -> NDArray[np.float32]: ...
    @property
    def posed(self) -> NDArray[np.float32]: ...
    @property
    def linear(self) -> NDArray[np.float32]: ...
    @property
    def transform(self) -> NDArray[np.float32]: ...
    @staticmethod
    def transforms(handles: Sequence[PointHandle]) -> NDArray[np.float32]: ...

@final
class CageBinding:
    def __new__(cls, cage: TriangleMesh, points: ArrayLike) -> CageBinding: ...
    @property
    def point_count(self) -> int: ...
    def coordinates(self, point: int) -> NDArray[np.float32]: ...
    def positions(
        self, cage: ArrayLike, *, out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]: ...

@final
class BoneBoxes:
    def __new__(cls, weights: SkinWeights, rest: ArrayLike) -> BoneBoxes: ...
    def linear_blend(self, transforms: ArrayLike) -> NDArray[np.float32] | None: ...

@final
class AutomaticWeights:
    def __new__(
        cls, *, falloff: float = 4.0, smoothing_steps: int = 10, most: int = 8
    ) -> AutomaticWeights: ...
    def for_skeleton(self, mesh: TriangleMesh, skeleton: Skeleton) -> SkinWeights: ...
    def for_segments(self, mesh: TriangleMesh, segments: ArrayLike) -> SkinWeights: ...

@final
class HeatWeights:
    def __new__(cls, *, heat: float = 1.0, most: int = 8) -> HeatWeights: ...
    def for_skeleton(self, mesh: TriangleMesh, skeleton: Skeleton) -> SkinWeights: ...
    def for_segments(self, mesh: TriangleMesh, segments: ArrayLike) -> SkinWeights: ...
