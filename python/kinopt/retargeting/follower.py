"""A movement live: frames as they come."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike

from .._kinopt import World
from .._kinopt.retargeting import Live
from ..types import Floats
from .maps import MapLike, naming
from .retarget import asked
from .sources import Source
from .targets import TargetLike


class RetargetFollower:
    """Follows a person live: one frame's places in, that frame's configuration out, in a bounded number of steps.

    ``measured`` is some movement of the same person, however short: limbs and the ground are measured in it, and its joints'
    order is that of the frames to come. The rest is as of ``retarget``. Limits of position hold in every frame, those of
    speed from each to the next at ``fps``. What stands is told by the frames before alone, so a foot is held some frames
    later than where the whole movement is known.

    Raises what ``retarget`` does.
    """

    def __init__(
        self,
        measured: Source,
        target: TargetLike,
        map: MapLike = None,
        *,
        joints: Sequence[str] | None = None,
        fps: float | None = None,
        up: Literal["y", "z"] | None = None,
        clip: str | None = None,
        contact_speed: float | None = None,
        contact_height: float | None = None,
        keep_clear: float | None = None,
        world: World | None = None,
        margin: float | None = None,
    ) -> None:
        own = asked(
            measured,
            target,
            map,
            joints=joints,
            fps=fps,
            up=up,
            clip=clip,
            contact_speed=contact_speed,
            contact_height=contact_height,
            acceleration=None,
            keep_clear=keep_clear,
            world=world,
            margin=margin,
        )
        with naming(map):
            self._live = Live(own.capture, own.target, json.dumps(own.map), own.options)
        self._map = own.map

    @property
    def q(self) -> Floats:
        """Where the body is, shape (nq,)."""
        return self._live.q

    @property
    def names(self) -> list[str]:
        """Names of the numbers of a configuration."""
        return self._live.names

    @property
    def map(self) -> dict[str, Any]:
        """The map that it goes by."""
        return self._map

    def step(self, positions: ArrayLike) -> Floats:
        """Goes on to the next frame: ``positions`` of shape (J, 3) in, the configuration of shape (nq,) out.

        Where a place is not finite the body stays. The GIL is released.

        Raises ``InvalidValueError`` for another number of joints.
        """
        return self._live.step(positions)


__all__ = ["RetargetFollower"]
