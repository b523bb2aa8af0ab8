from collections.abc import Mapping
from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Skeleton

__all__ = [
    "EulerClip",
]

@final
class EulerClip:
    def __new__(
        cls,
        skeleton: Skeleton,
        tracks: Mapping[str, tuple[ArrayLike, ArrayLike]],
        interpolation: str | ArrayLike | Mapping[str, str | ArrayLike] | None = None,
    ) -> Self: ...
    @property
    def skeleton(self) -> Skeleton: ...
    @property
    def bones(self) -> list[str]: ...
    @property
    def keyless(self) -> list[str]: ...
    @property
    def is_empty(self) -> bool: ...
    @property
    def time_span(self) -> tuple[float, float] | None: ...
    def keys(self, bone: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def interpolation(self, bone: str) -> str | NDArray[np.float64]: ...
    def sample(
        self,
        times: ArrayLike,
        playback: str = "hold",
        *,
        out: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]: ...
    @staticmethod
    def _rebuild(skeleton: Skeleton, text: str) -> EulerClip: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
