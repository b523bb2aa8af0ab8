"""Holds of a character during a drag."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

#: Strict priority levels of a standing body: foot locks and balance have priority over an unreachable hand.
PINNED, BALANCE, DRAGGED = 0, 1, 2


@dataclass
class Holding:
    """Tasks that keep frames in place, and joints with little motion."""

    tasks: list[Any] = field(default_factory=list)
    #: The problem's `ParameterMap`; None if all joints are free.
    parameters: Any = None
    #: True if the tasks include a posture.
    has_posture: bool = False
