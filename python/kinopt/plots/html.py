"""Results in notebooks: tables with small drawings, without dependencies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

import numpy as np

from .._kinopt import Coordinates, JointPath, Solution, Trajectory
from ..types import Floats
from .joints import value_range
from .look import BLUE, RED

#: Largest number of rows of a table.
_MAX_ROWS = 40
#: Size of a drawing, pixels.
_WIDTH, _HEIGHT = 160, 28
#: Largest number of points of a curve.
_MAX_POINTS = 160


def solution_page(solution: Solution) -> str:
    """Table of joints with values, limits and positions within them, and the text of ``explain``."""
    active = {limit.joint for limit in solution.active_limits}
    names = solution.coordinates.names
    drawings = [
        _drawing(solution.q[k : k + 1], solution.coordinates, k, RED if name in active else BLUE) for k, name in enumerate(names)
    ]
    values = [f"{value:.4f}" for value in solution.q]
    return _page(solution.explain(), solution.coordinates, [("position", values)], drawings)


def path_page(path: JointPath[Any]) -> str:
    """Table of joints with their ranges, limits and curves."""
    jumps = [f"jump before row {jump.index}: {jump.joint} moves by {jump.distance:.3f}" for jump in path.jumps]
    return _curves("\n".join([repr(path), *jumps]), path.q, path.coordinates)


def trajectory_page(trajectory: Trajectory[Any]) -> str:
    """Table of joints with their ranges, limits and curves."""
    return _curves(repr(trajectory), trajectory.q, trajectory.coordinates)


def _curves(text: str, q: Floats, coordinates: Coordinates) -> str:
    if not len(q):
        return _page(text, coordinates, [], [])
    ends = [("smallest", [f"{value:.3f}" for value in q.min(axis=0)]), ("largest", [f"{value:.3f}" for value in q.max(axis=0)])]
    step = max(1, math.ceil(len(q) / _MAX_POINTS))
    drawings = [_drawing(q[::step, k], coordinates, k, BLUE) for k in range(q.shape[1])]
    return _page(text, coordinates, ends, drawings)


def _page(
    text: str, coordinates: Coordinates, columns: Sequence[tuple[str, Sequence[str]]], drawings: Iterable[str]
) -> str:
    limits = [_limits(lower, upper) for lower, upper in zip(coordinates.lower, coordinates.upper)]
    every = [("joint", [escape(name) for name in coordinates.names]), *columns, ("unit", coordinates.units), ("limits", limits)]
    head = "".join(f"<th>{title}</th>" for title, _ in every) + "<th>within the limits</th>"
    rows = [
        "<tr>" + "".join(f"<td>{cells[k]}</td>" for _, cells in every) + f"<td>{drawing}</td></tr>"
        for k, drawing in enumerate(drawings)
    ]
    more = len(rows) - _MAX_ROWS
    note = f"<p>{more} more joints are not shown.</p>" if more > 0 else ""
    return f"<pre>{escape(text)}</pre><table><tr>{head}</tr>{''.join(rows[:_MAX_ROWS])}</table>{note}"


def _limits(lower: float, upper: float) -> str:
    if math.isinf(lower) and math.isinf(upper):
        return "none"
    return f"[{lower:.3f}, {upper:.3f}]"


def _drawing(values: Floats, coordinates: Coordinates, k: int, colour: str) -> str:
    """One value as a point between the limits, several as a curve; the ranges beyond the limits are shaded."""
    lower, upper = float(coordinates.lower[k]), float(coordinates.upper[k])
    low, high = value_range(values, lower, upper)
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    limits = [(limit - low) / (high - low) if math.isfinite(limit) else end for limit, end in ((lower, 0.0), (upper, 1.0))]
    if len(values) == 1:
        x = [_WIDTH * limit for limit in limits]
        bands = [(0.0, x[0], 0.0, 1.0 * _HEIGHT), (x[1], _WIDTH - x[1], 0.0, 1.0 * _HEIGHT)]
        mark = f'<circle cx="{_WIDTH * share[0]:.1f}" cy="{_HEIGHT / 2}" r="4" fill="{colour}"/>'
    else:
        y = [_HEIGHT * (1.0 - limit) for limit in limits]
        bands = [(0.0, 1.0 * _WIDTH, y[0], _HEIGHT - y[0]), (0.0, 1.0 * _WIDTH, 0.0, y[1])]
        across = np.linspace(0.0, _WIDTH, len(values))
        points = " ".join(f"{x:.1f},{_HEIGHT * (1.0 - y):.1f}" for x, y in zip(across, share))
        mark = f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.5"/>'
    shaded = "".join(
        f'<rect x="{x:.1f}" width="{width:.1f}" y="{y:.1f}" height="{height:.1f}" fill="{RED}" fill-opacity="0.2"/>'
        for x, width, y, height in bands
    )
    frame = f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="#bbbbbb"/>'
    return f'<svg width="{_WIDTH}" height="{_HEIGHT}" style="display:block">{shaded}{mark}{frame}</svg>'


__all__ = ["path_page", "solution_page", "trajectory_page"]
