"""Plots of solutions, joint paths and trajectories; the results' ``plot()`` calls them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._kinopt import Arm, JointPath, Solution, TimedSpline, Trajectory
from ..types import Floats
from .ground import draw_balance, draw_tool, mass_centres, polygons
from .joints import draw_joints, draw_values, grid, picked
from .look import blank_figure

#: Number of samples of a spline.
_SAMPLES = 400


def plot_solution(solution: Solution, *, figure: Any = None) -> Any:
    """Draws each joint's value within its limits."""
    figure = blank_figure(figure, (8.0, 1.6 + 0.28 * len(solution.q)))
    active = {limit.joint: limit.value for limit in solution.active_limits}
    draw_values(figure, solution.q, solution.coordinates, active)
    figure.suptitle(solution.explain().splitlines()[0], fontsize=10)
    return figure


def plot_path(path: JointPath[Any], *, joints: Sequence[str] | None = None, figure: Any = None) -> Any:
    """Draws the joints by row, and the path of the tool."""
    picks = picked(path.coordinates, joints)
    left, right = _halves(figure, len(picks))
    # A jump happens between two rows; that of a cyclic path between the last row and the first.
    jumps = [((jump.index or len(path)) - 0.5, jump.joint) for jump in path.jumps]
    draw_joints(left, np.arange(len(path), dtype=float), path.q, path.coordinates, picks, label="row", jumps=jumps)
    draw_tool(right, _tool(path.arm, path.q), path.arm.base or "world")
    return left.figure


def plot_trajectory(
    trajectory: Trajectory[Any],
    *,
    joints: Sequence[str] | None = None,
    support: ArrayLike | None = None,
    figure: Any = None,
) -> Any:
    """Draws the joints over time. Of an arm it also draws the path of the tool, of a body with masses the centre of mass
    over its support polygon."""
    model, times, q = trajectory.model, trajectory.times, trajectory.q
    if isinstance(trajectory.report, TimedSpline):
        times = np.linspace(0.0, trajectory.duration, _SAMPLES)
        q = trajectory.at(times).q
    # A robot, a rig or a figure has a model.
    bare = getattr(model, "model", model)
    picks = picked(trajectory.coordinates, joints, getattr(bare, "free_joints", []))
    is_arm = isinstance(model, Arm)
    centres = None if is_arm or model is None else mass_centres(model, q)
    if not is_arm and centres is None:
        left = blank_figure(figure, _size(len(picks)))
        draw_joints(left, times, q, trajectory.coordinates, picks, label="time (s)")
        return left
    left, right = _halves(figure, len(picks))
    draw_joints(left, times, q, trajectory.coordinates, picks, label="time (s)")
    if centres is None:
        draw_tool(right, _tool(model, q), model.base or "world")
    else:
        draw_balance(right, times, centres, polygons(model, q, trajectory.report, support))
    return left.figure


def _tool(arm: Arm, q: Floats) -> Floats:
    """Positions of the tool, shape (N, 3), metres."""
    return np.asarray(arm.base_from_tool(q))[:, :3, 3]


def _size(joints: int) -> tuple[float, float]:
    """Size of the axes of joints, inches."""
    rows, columns = grid(joints)
    return max(4.0, 2.3 * columns), max(2.4, 1.35 * rows + 0.6)


def _halves(figure: Any, joints: int) -> Any:
    """A figure for joints, and a figure for a picture of space next to it."""
    width, height = _size(joints)
    height = max(height, 4.2)
    figure = blank_figure(figure, (width + 4.4, height))
    return figure.subfigures(1, 2, width_ratios=[width, 4.4])


__all__ = ["plot_path", "plot_solution", "plot_trajectory"]
