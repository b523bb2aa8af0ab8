"""Curves of joints over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from .body import Body

Array = NDArray[np.float64]

#: Largest number of curves in a plot, in these colours.
COLORS = ("#266aab", "#d1602b", "#2f9e60", "#8d5bbd", "#b8860b", "#c2417c", "#4a90a4", "#6b6b6b")
#: Largest number of drawn samples of a clip.
MAX_SAMPLES = 400
#: Choice without a plot.
NONE = "none"


@dataclass(frozen=True)
class Curves:
    """Joint values of a clip."""

    #: Sample times, shape (T,), seconds.
    times: Array
    #: Values by group and joint, shape (T,), radians or metres.
    groups: dict[str, dict[str, Array]]


def curves_of(body: Body, times: Array, q: Array) -> Curves:
    """Curves of a body's moving joints, by limb, for configurations of shape (T, nq)."""
    model = body.model
    kinds = {joint.name for joint in model.joints if joint.kind != "fixed"}
    groups: dict[str, dict[str, Array]] = {}
    for index, name in enumerate(model.coordinate_names):
        if name in kinds and model.lower[index] < model.upper[index]:
            groups.setdefault(body.group(name), {})[body.short(name)] = q[:, index]
    return curves_in(groups, times)


def curves_in(groups: dict[str, dict[str, Array]], times: Array) -> Curves:
    """Curves with few samples, in groups that fit into a plot."""
    few = np.unique(np.linspace(0, len(times) - 1, min(len(times), MAX_SAMPLES)).round().astype(int))
    parts: dict[str, dict[str, Array]] = {}
    for group, joints in groups.items():
        names = list(joints)
        for first in range(0, len(names), len(COLORS)):
            title = group if first == 0 else f"{group} ({first // len(COLORS) + 1})"
            parts[title] = {name: joints[name][few] for name in names[first : first + len(COLORS)]}
    return Curves(times[few], parts)


class CurvesPanel:
    """A plot of the joints of a limb, with a line at the current time."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle) -> None:
        self._gui, self._tab = gui, tab
        self._curves: Curves | None = None
        self._now = 0.0
        with tab:
            self._choice: Any = gui.add_dropdown("Joints of", (NONE,))
        self._plot: Any = None
        self._choice.on_update(lambda event: self._draw())

    def choose(self, clip: Any) -> None:
        """Offers the curves of a clip: its attribute `curves`, if it has any."""
        self._curves = getattr(clip, "curves", None)
        self._choice.options = (NONE, *(self._curves.groups if self._curves else ()))
        self._draw()

    def _joints(self) -> dict[str, Array]:
        return {} if self._curves is None else self._curves.groups.get(self._choice.value, {})

    def _data(self) -> tuple[Array, ...]:
        assert self._curves is not None
        times, values = self._curves.times, list(self._joints().values())
        # Two samples next to each other, from the bottom to the top.
        line = np.full(len(times), np.nan)
        after = int(np.searchsorted(times, self._now).clip(1, len(times) - 1))
        line[[after - 1, after]] = self._range(values)
        return (times, *values, line)

    @staticmethod
    def _range(values: list[Array]) -> tuple[float, float]:
        low, high = float(np.min(values)), float(np.max(values))
        margin = 0.05 * (high - low) + 1e-3
        return low - margin, high + margin

    def _draw(self) -> None:
        if self._plot is not None:
            self._plot.remove()
            self._plot = None
        joints = self._joints()
        if self._curves is None or not joints:
            return
        series: list[Any] = [{"label": "s"}]
        series += [{"label": name, "stroke": color, "width": 2} for name, color in zip(joints, COLORS)]
        series += [{"label": "now", "stroke": "#9aa5b1", "width": 1}]
        with self._tab:
            scales: Any = {"x": {"time": False}, "y": {"range": self._range(list(joints.values()))}}
            self._plot = self._gui.add_uplot(self._data(), tuple(series), scales=scales, height=150)

    def mark(self, seconds: float) -> None:
        """Moves the line to a time."""
        self._now = seconds
        if self._plot is not None:
            self._plot.data = self._data()
