"""Sliders of joints, from limit to limit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinopt

from .closing import closed
from .dragging import Dragging

#: With more joints than this, sliders are in closed groups.
MAX_UNGROUPED_JOINTS = 16
#: Range of a joint without limits in both directions: radians, or multiples of the model's size.
UNLIMITED_HALF_RANGE = float(np.pi)
#: Number of positions of a slider.
SLIDER_STEPS = 1000


class JointsPanel:
    """Sliders of the moving joints, without mimic joints."""

    def __init__(self, page: Dragging) -> None:
        self._page = page
        model, thing = page.body.model, page.body.thing
        followers = thing.mimics if isinstance(thing, kinopt.Robot) else {}
        kinds = {joint.name: joint.kind for joint in model.joints}
        slider_joints = [
            (index, name)
            for index, name in enumerate(model.coordinate_names)
            # The components of a quaternion have no sliders of their own.
            if name in kinds and name not in followers and model.lower[index] < model.upper[index]
        ]
        self._sliders: dict[int, Any] = {}
        gui = page.scene.server.gui
        size = page.body.size()
        with gui.add_folder("Joints", expand_by_default=len(slider_joints) <= MAX_UNGROUPED_JOINTS):
            self._buttons = gui.add_button_group("", ("Rest", "Random"))
            groups: dict[str, list[tuple[int, str]]] = {}
            for index, name in slider_joints:
                groups.setdefault(
                    page.body.group(name) if len(slider_joints) > MAX_UNGROUPED_JOINTS else "", []
                ).append((index, name))
            for group, joints in groups.items():
                if not group:
                    self._add(joints, kinds, size)
                    continue
                with gui.add_folder(group, expand_by_default=False):
                    self._add(joints, kinds, size)

        @self._buttons.on_click
        def _(event: Any) -> None:
            is_rest = self._buttons.value == "Rest"
            page.scene.loop.post(self._rest if is_rest else self._random)

    def _add(self, joints: list[tuple[int, str]], kinds: dict[str, str], size: float) -> None:
        page, model = self._page, self._page.body.model
        for index, name in joints:
            half_range = UNLIMITED_HALF_RANGE if kinds[name] in ("revolute", "continuous") else size
            lower = float(np.nan_to_num(model.lower[index], neginf=-half_range))
            upper = float(np.nan_to_num(model.upper[index], posinf=half_range))
            step = max((upper - lower) / SLIDER_STEPS, 1e-9)
            value = float(np.clip(page.body.q[index], lower, upper))
            slider = page.scene.server.gui.add_slider(page.body.short(name), lower, upper, step, value)
            self._sliders[index] = slider
            self._listen(slider, index, name)

    def _listen(self, slider: Any, index: int, name: str) -> None:
        page, model = self._page, self._page.body.model
        lower, upper = float(model.lower[index]), float(model.upper[index])

        def moved(event: Any) -> None:
            if event.client is not None:
                value = min(max(float(slider.value), lower), upper)
                page.scene.loop.post(lambda: page.set_joint(name, value))

        slider.on_update(moved)

    def show(self) -> None:
        """Updates the sliders to the body."""
        q = self._page.body.q
        for index, slider in self._sliders.items():
            value = float(min(max(q[index], slider.min), slider.max))
            if abs(slider.value - value) > 0.5 * slider.step:
                slider.value = value

    def _rest(self) -> None:
        self._stand_at(self._page.body.model.neutral())

    def _random(self) -> None:
        thing = self._page.body.thing
        draw = thing if isinstance(thing, kinopt.Robot) else self._page.body.model
        self._stand_at(draw.random_configuration(seed=np.random.default_rng()))

    def _stand_at(self, q: NDArray[np.float64]) -> None:
        """Moves the body, unless its loops do not close there."""
        going_along = closed(self._page.body.thing, q)
        self._page.set_configuration(self._page.body.q if going_along is None else going_along)
