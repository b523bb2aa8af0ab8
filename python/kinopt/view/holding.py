"""What of a character stays while something else is dragged."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

#: Strict levels of a body that stands: feet stay, and balance is kept, where a hand is beyond reach.
PINNED, BALANCE, DRAGGED = 0, 1, 2


@dataclass
class Holding:
    """Tasks that keep frames where they are, and joints that hardly turn."""

    tasks: list[Any] = field(default_factory=list)
    #: The problem's `ParameterMap`; None where all joints are free.
    parameters: Any = None
    #: Whether the tasks keep a posture too.
    has_posture: bool = False
