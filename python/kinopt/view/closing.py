"""Loops of what is moved joint by joint: the joints that close them go along."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

Array = NDArray[np.float64]


def closed(thing: Any, q: Array, moved: str | None = None) -> Array | None:
    """The configuration with the loops of a robot or a model closed, the joint that was `moved` kept where it is.

    The passive joints of a robot close them; where there are none, or one of them was moved, all that move a loop.
    None where that does not close them.
    """
    model = getattr(thing, "model", thing)
    if not model.loops:
        return q
    moving = [joint.name for joint in model.joints if joint.kind != "fixed" and joint.name != moved]
    passive = thing.passive_joints if isinstance(thing, kinopt.Robot) else []
    for dependent in (passive, moving):
        if not dependent or moved in dependent:
            continue
        try:
            return kinopt.LoopClosure(thing, dependent).close(q)
        except kinopt.KinoptError:
            continue
    return None
