"""Results as tables of pandas and pyarrow."""

from __future__ import annotations

from typing import Any

from .errors import InvalidValueError
from .extras import load

#: Arrays of a result with one number for each row.
_COLUMNS = ("reached", "position_error", "orientation_error", "cost", "iterations", "attempts")


def columns(result: Any) -> dict[str, Any]:
    """Columns of a batch, a joint path or a trajectory, by name.

    Raises ``InvalidValueError`` for two columns of one name.
    """
    named: list[tuple[str, Any]] = list(zip(result.coordinates.names, result.q.T))
    times = getattr(result, "times", None)
    if times is not None and not callable(times):
        named.insert(0, ("time", times))
    # A joint path is reached as a whole.
    rows = {name: getattr(result, name, None) for name in _COLUMNS}
    named += [(name, row) for name, row in rows.items() if getattr(row, "shape", None) == (len(result),)]
    report: Any = getattr(result, "report", None)
    contact_frames: list[str] = getattr(report, "contact_frames", [])
    for k, frame in enumerate(contact_frames):
        # As in .csv files, a frame with several contact points has numbered columns from its second point on.
        count = contact_frames[:k].count(frame)
        named.append((f"{frame} in contact {count + 1}" if count else f"{frame} in contact", report.contacts[:, k]))
    table = dict(named)
    if len(table) < len(named):
        names = [name for name, _ in named]
        twice = next(name for name in names if names.count(name) > 1)
        raise InvalidValueError(f"two columns of the table have the name `{twice}`: rename the joint or frame")
    return table


def to_frame(result: Any) -> Any:
    """The columns of a result as a pandas ``DataFrame``."""
    return load("pandas", "tables", "to_frame").DataFrame(columns(result))


def to_arrow(result: Any) -> Any:
    """The columns of a result as a pyarrow ``Table``."""
    return load("pyarrow", "tables", "to_arrow").table(columns(result))


__all__ = ["columns", "to_arrow", "to_frame"]
