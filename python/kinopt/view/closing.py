"""Loop closure for bodies that are moved joint by joint."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

Array = NDArray[np.float64]


def closed(thing: Any, q: Array, moved: str | None = None) -> Array | None:
    """The configuration with the loops of a robot or a model closed, with the joint `moved` unchanged.

    The passive joints of a robot close them; without any, or if one of them is `moved`, all joints of the loops. None
    if the loops do not close.
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
