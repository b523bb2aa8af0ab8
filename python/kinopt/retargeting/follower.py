"""Online retargeting."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike

from .._kinopt import World
from .._kinopt.retargeting import Live
from ..types import Floats
from .maps import MapLike, naming
from .retarget import retarget_request
from .sources import Source
from .targets import TargetLike


class RetargetFollower:
    """Retargets a live motion capture: from one frame's joint positions to its configuration, in a bounded number of
    steps.

    ``measured`` is a motion capture of the subject, of any length. Limbs and the ground are measured in it, and live
    frames have its order of joints. Other arguments are as in ``retarget``. Position limits hold in every frame, speed
    limits between successive frames at ``fps``. Contacts are detected from past frames only, so a foot lock starts some
    frames later than in ``retarget``.

    Raises the errors of ``retarget``.
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
        request = retarget_request(
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
            self._live = Live(request.capture, request.target, json.dumps(request.map), request.options)
        self._map = request.map

    @property
    def q(self) -> Floats:
        """Current configuration, shape (nq,)."""
        return self._live.q

    @property
    def names(self) -> list[str]:
        """Names of the numbers of a configuration."""
        return self._live.names

    @property
    def map(self) -> dict[str, Any]:
        """The map in use."""
        return self._map

    def step(self, positions: ArrayLike, rotations: ArrayLike | None = None) -> Floats:
        """Processes the next frame: ``positions`` of shape (J, 3); returns the configuration of shape (nq,).

        ``rotations`` of shape (J, 4) are those of the joints, as in ``Capture``. Characters use them; without them they
        get the rotations that the positions determine. A frame with a number that is not finite keeps the configuration. The GIL is released.

        Raises ``InvalidValueError`` for another number of joints.
        """
        return self._live.step(positions, rotations)


__all__ = ["RetargetFollower"]
