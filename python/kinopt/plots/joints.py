"""Joints over time or rows, with their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._kinopt import Coordinates
from ..errors import UnknownNameError
from ..types import Floats
from .look import BLACK, BLUE, FORBIDDEN, RED, tidy

#: Largest number of columns of axes.
_MAX_COLUMNS = 6
#: Margin above and below the limits, as a share of their range.
_MARGIN = 0.08


def picked(coordinates: Coordinates, joints: Sequence[str] | None, base: Sequence[str] = ()) -> list[int]:
    """Indices of named numbers of a configuration; by default all but locked joints and the joints ``base``.

    Raises ``UnknownNameError`` for another name.
    """
    names = coordinates.names
    if joints is None:
        prefixes = tuple(f"{joint}/" for joint in base)
        moves = coordinates.lower < coordinates.upper
        return [k for k, name in enumerate(names) if moves[k] and not (prefixes and name.startswith(prefixes))]
    unknown = next((joint for joint in joints if joint not in names), None)
    if unknown is not None:
        raise UnknownNameError(f"unknown joint `{unknown}`; expected one of {', '.join(names)}")
    return [names.index(joint) for joint in joints]


def grid(count: int) -> tuple[int, int]:
    """Rows and columns of the axes of ``count`` joints."""
    columns = min(_MAX_COLUMNS, max(1, math.ceil(count / 4)))
    return math.ceil(count / columns), columns


def value_range(values: Floats, lower: float, upper: float) -> tuple[float, float]:
    """Range of an axis with the values and the limits."""
    ends = [end for end in (lower, upper, values.min(), values.max()) if math.isfinite(end)]
    low, high = min(ends), max(ends)
    margin = _MARGIN * max(high - low, 1e-3)
    return low - margin, high + margin


def draw_joints(
    figure: Any,
    at: Floats,
    q: Floats,
    coordinates: Coordinates,
    picks: Sequence[int],
    *,
    label: str,
    jumps: Sequence[tuple[float, str]] = (),
) -> None:
    """Draws one axes for each joint. ``at`` are times or rows, ``label`` names them. Each jump has the middle of its
    step and the joint that moves farthest."""
    rows, columns = grid(len(picks))
    every = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
    handles: dict[str, Any] = {"position": None}
    for axes, k in zip(every, picks):
        tidy(axes)
        lower, upper = coordinates.lower[k], coordinates.upper[k]
        low, high = value_range(q[:, k], lower, upper)
        for start, end in ((low, lower), (upper, high)):
            if math.isfinite(start) and math.isfinite(end):
                handles["beyond the limits"] = axes.axhspan(start, end, **FORBIDDEN)
        for middle, joint in jumps:
            strength = {"linewidth": 1.4, "alpha": 1.0} if joint == coordinates.names[k] else {"linewidth": 0.8, "alpha": 0.5}
            handles["jump"] = axes.axvline(middle, color=RED, linestyle="--", **strength)
        (handles["position"],) = axes.plot(at, q[:, k], color=BLUE, linewidth=1.6)
        unit = coordinates.units[k]
        axes.set_title(coordinates.names[k] + (f" ({unit})" if unit else ""), fontsize=8, loc="left", color=BLACK)
        axes.set_ylim(low, high)
    for axes in every[len(picks) :]:
        axes.set_visible(False)
    for axes in every[max(0, len(picks) - columns) : len(picks)]:
        axes.tick_params(labelbottom=True)
    if label == "row":
        every[0].xaxis.get_major_locator().set_params(integer=True)
    figure.supxlabel(label, fontsize=9)
    if len(at) > 1:
        every[0].set_xlim(at[0], at[-1])
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=3, fontsize=8, frameon=False)


def draw_values(figure: Any, q: Floats, coordinates: Coordinates, active: dict[str, float]) -> None:
    """Draws one row for each joint: its value between its limits. ``active`` has the values of active limits."""
    axes = tidy(figure.subplots())
    finite = np.isfinite(coordinates.lower) & np.isfinite(coordinates.upper)
    rows = np.arange(len(q))
    # Joints of different ranges and units share the axes: each range is drawn from 0 to 1.
    lower = np.where(finite, coordinates.lower, q - 1.0)
    width = np.where(finite, coordinates.upper, q + 1.0) - lower
    share = np.divide(q - lower, width, out=np.full(len(q), 0.5), where=width > 0)
    axes.axvspan(-_MARGIN, 0.0, **FORBIDDEN)
    axes.axvspan(1.0, 1.0 + _MARGIN, label="beyond the limits", **FORBIDDEN)
    axes.hlines(rows[finite], 0.0, 1.0, color="#bbbbbb", linewidth=5, label="range of the joint", capstyle="round")
    is_active = np.array([name in active for name in coordinates.names])
    axes.plot(share[~is_active], rows[~is_active], "o", color=BLUE, markersize=8, label="position")
    axes.plot(share[is_active], rows[is_active], "D", color=RED, markersize=8, label="active limit")
    for row, value in enumerate(q):
        unit = coordinates.units[row]
        limits = f"  in [{coordinates.lower[row]:.2f}, {coordinates.upper[row]:.2f}]" if finite[row] else "  without limits"
        axes.text(1.0 + 1.5 * _MARGIN, row, f"{round(value, 3) + 0.0: .3f} {unit:3}{limits}", va="center", fontsize=8, family="monospace")
    axes.set_yticks(rows, coordinates.names)
    axes.set_xticks([0.0, 0.5, 1.0], ["lower limit", "middle", "upper limit"])
    axes.set_xlim(-_MARGIN, 1.0 + _MARGIN)
    axes.set_ylim(len(q) - 0.4, -0.6)
    axes.grid(False, axis="y")
    handles, labels = axes.get_legend_handles_labels()
    shown = [(handle, label) for handle, label in zip(handles, labels) if label != "active limit" or is_active.any()]
    figure.legend(*zip(*shown), loc="outside lower center", ncols=4, fontsize=8, frameon=False)


__all__ = ["draw_joints", "draw_values", "grid", "picked", "value_range"]
