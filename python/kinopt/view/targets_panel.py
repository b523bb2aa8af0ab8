"""Panel of targets, with pins."""

from __future__ import annotations

from typing import Any

from .dragging import Dragging


class TargetsPanel:
    """A row for each target, and a list to add others."""

    def __init__(self, page: Dragging) -> None:
        self._page = page
        gui = page.scene.server.gui
        self._folder = gui.add_folder("Targets")
        self._pins: dict[str, Any] = {}
        with self._folder:
            self._turns = gui.add_checkbox(
                "Orientation too", page.turns, hint="targets include the orientation of their frames"
            )
            self._frame = gui.add_dropdown(
                "Frame", tuple(page.body.frame_names), hint="any frame can be dragged"
            )
            self._change = gui.add_button_group("", ("Add", "Remove", "Release"))

        @self._turns.on_update
        def _(event: Any) -> None:
            if event.client is not None:
                turns = bool(self._turns.value)
                page.scene.loop.post(lambda: page.set_turns(turns))

        @self._change.on_click
        def _(event: Any) -> None:
            frame, change = str(self._frame.value), str(self._change.value)
            page.scene.loop.post(lambda: self._do(change, frame))

    def _do(self, change: str, frame: str) -> None:
        page = self._page
        if change == "Add":
            page.add_target(frame)
        elif change == "Release":
            page.let_go()
        elif frame in page.targets:
            page.remove_target(frame)

    def show(self) -> None:
        """Updates the rows to the targets of the page."""
        page = self._page
        for frame in [frame for frame in self._pins if frame not in page.targets]:
            self._pins.pop(frame).remove()
        for frame in page.targets:
            if frame not in self._pins:
                self._pins[frame] = self._row(frame)
            self._pins[frame].value = frame in page.pinned

    def _row(self, frame: str) -> Any:
        page = self._page
        with self._folder:
            pin = page.scene.server.gui.add_checkbox(
                f"pin {frame}", frame in page.pinned, hint="keeps the frame in place while others are dragged"
            )

        @pin.on_update
        def _(event: Any) -> None:
            if event.client is not None:
                pinned = bool(pin.value)
                page.scene.loop.post(lambda: page.pin(frame, pinned))

        return pin
