"""Reach maps that the machines of a cluster build in parts."""

from __future__ import annotations

from typing import Any

import ray

from .._kinopt import Arm, ReachMap
from ..errors import InvalidValueError


def build_reach_map(arm: Arm, *, parts: int = 100, **options: Any) -> ReachMap:
    """Builds a reach map in parts, each a Ray task of one core; ``options`` are those of ``ReachMap.build``.

    The map is bitwise that of ``ReachMap.build``. Raises ``InvalidValueError`` as ``ReachMap.build`` does, and for fewer
    than one part.
    """
    if parts < 1:
        raise InvalidValueError(f"parts is {parts}, expected at least 1")
    for option in ("part", "threads", "progress"):
        if option in options:
            raise InvalidValueError(f"option {option} does not apply to tasks of a cluster")
    shared = ray.put(arm)
    build = ray.remote(_build_part)
    return ReachMap.merged(ray.get([build.remote(shared, (part, parts), options) for part in range(parts)]))


def _build_part(arm: Arm, part: tuple[int, int], options: dict[str, Any]) -> ReachMap:
    return ReachMap.build(arm, part=part, threads=1, **options)


__all__ = ["build_reach_map"]
