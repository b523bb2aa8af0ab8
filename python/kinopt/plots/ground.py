"""Paths in space: of a tool, and of the centre of mass over the support polygon."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import ForwardKinematics
from ..errors import KinoptError
from ..types import Floats
from .look import BLACK, BLUE, GREEN, ORANGE, RED, TIMES, tidy


def draw_tool(figure: Any, points: Floats, base: str) -> None:
    """Draws the path of a tool, points of shape (N, 3) in metres, in the axes of the frame ``base``."""
    axes = figure.add_subplot(projection="3d")
    axes.plot(*points.T, color=BLUE, linewidth=1.8)
    axes.plot(*points[:1].T, "o", color=GREEN, markersize=7, label="start", linestyle="none")
    axes.plot(*points[-1:].T, "s", color=RED, markersize=7, label="end", linestyle="none")
    # Equal scales, also for a path that is straight or flat.
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    half = 0.55 * max(float(np.ptp(points, axis=0).max()), 1e-3)
    axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axes.set(zlim=(middle[2] - half, middle[2] + half))
    axes.set_box_aspect((1, 1, 1), zoom=0.85)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz"):
        axis.set_label_text(f"{name} (m)", fontsize=8)
        axis.set_major_locator(_few_ticks())
        axis.pane.set_facecolor("#f7f7f7")
    axes.tick_params(labelsize=7)
    axes.set_title(f"path of the tool in `{base}`", fontsize=9, color=BLACK)
    figure.legend(loc="outside upper center", ncols=4, fontsize=8, frameon=False, columnspacing=1.0, handletextpad=0.4)


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4)


def mass_centres(model: Any, q: Floats) -> Floats | None:
    """Centres of mass of a body, shape (N, 3), metres; None without masses."""
    try:
        return np.asarray(model.center_of_mass(q))
    except (AttributeError, KinoptError):
        return None


def polygons(model: Any, q: Floats, report: Any, support: ArrayLike | None) -> list[tuple[int, int, Floats]]:
    """Spans of samples with corners of their support polygons, seen from above. ``support``: points that span all of
    them."""
    if support is not None:
        return [(0, len(q), hull(np.asarray(support, dtype=float).reshape(-1, 3)[:, :2]))]
    frames = getattr(report, "contact_frames", [])
    if not frames:
        return []
    placed = ForwardKinematics(model, frames).place(q)
    # A foot of a robot is in contact with its sole, other frames are with a point.
    soles = [model.sole(frame) if hasattr(model, "sole") else [at] for frame, at in zip(frames, report.contact_points)]
    changes = np.flatnonzero((report.contacts[1:] != report.contacts[:-1]).any(axis=1)) + 1
    ends = [0, *map(int, changes), len(q)]
    spans = [(first, end) for first, end in zip(ends, ends[1:]) if report.contacts[first].any()]

    def corners(sample: int) -> Floats:
        feet = np.flatnonzero(report.contacts[sample])
        points = [np.asarray(soles[k]) @ placed[sample, k, :2, :3].T + placed[sample, k, :2, 3] for k in feet]
        return hull(np.vstack(points))

    # Contacts are locked, so that one sample shows the polygon of its span.
    return [(first, end, corners((first + end) // 2)) for first, end in spans]


def hull(points: Floats) -> Floats:
    """Corners of the convex hull of points in the plane, anticlockwise, by Andrew's monotone chain."""
    ordered = sorted(set(map(tuple, points.tolist())))

    def chain(points: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
        corners: list[tuple[float, ...]] = []
        for x, y in points:
            while len(corners) > 1 and _turn(corners[-2], corners[-1], (x, y)) <= 0:
                corners.pop()
            corners.append((x, y))
        return corners

    if len(ordered) < 3:
        return np.array(ordered)
    return np.array(chain(ordered)[:-1] + chain(ordered[::-1])[:-1])


def _turn(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def draw_balance(figure: Any, times: Floats, centres: Floats, spans: list[tuple[int, int, Floats]]) -> None:
    """Draws the centre of mass and the support polygons from above, coloured by time."""
    from matplotlib import colormaps
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Polygon

    axes = tidy(figure.subplots())
    end = max(float(times[-1]), 1e-9)
    for number, (first, stop, corners) in enumerate(spans):
        colour = colormaps[TIMES](0.5 * (times[first] + times[stop - 1]) / end) if len(spans) > 1 else ORANGE
        label = "support polygon" if number == 0 else None
        if len(corners) > 2:
            axes.add_patch(Polygon(corners, facecolor=colour, alpha=0.12, edgecolor="none", label=label))
        axes.plot(*np.vstack([corners, corners[:1]]).T, color=colour, alpha=0.8, linewidth=0.9)
    flat = centres[:, :2]
    segments = LineCollection(list(np.stack([flat[:-1], flat[1:]], axis=1)), cmap=TIMES, linewidth=2.5, label="centre of mass", zorder=3)
    segments.set_array(times[:-1])
    axes.add_collection(segments)
    axes.plot(*flat[:1].T, "o", color=GREEN, markeredgecolor="white", markersize=6, label="start", linestyle="none", zorder=4)
    axes.plot(*flat[-1:].T, "s", color=RED, markeredgecolor="white", markersize=6, label="end", linestyle="none", zorder=4)
    axes.set_aspect("equal", adjustable="box")
    axes.autoscale_view()
    axes.margins(0.1)
    axes.set_xlabel("x (m)", fontsize=8)
    axes.set_ylabel("y (m)", fontsize=8)
    axes.set_title("centre of mass from above", fontsize=9, color=BLACK)
    figure.colorbar(segments, ax=axes, shrink=0.7).set_label("time (s)", fontsize=8)
    figure.legend(loc="outside upper center", ncols=4, fontsize=8, frameon=False, columnspacing=1.0, handletextpad=0.4)


__all__ = ["draw_balance", "draw_tool", "hull", "mass_centres", "polygons"]
