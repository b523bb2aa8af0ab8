from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "SkinWeights",
]

@final
class SkinWeights:
    def __new__(
        cls,
        vertices: ArrayLike,
        bones: ArrayLike,
        weights: ArrayLike,
        vertex_count: int,
        bone_count: int,
    ) -> Self: ...
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
    def __reduce__(self) -> tuple[Any, ...]: ...
