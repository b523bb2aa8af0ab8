"""Time line for clips and captures, with playback and scrubbing."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from .body import Clip
from .dragging import Dragging

#: Playback speeds.
SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")


class TimePanel:
    """Selects clip and time, and plays; below the picture."""

    def __init__(self, page: Dragging, clips: Sequence[Clip]) -> None:
        self._page = page
        self._clips = {clip.name: clip for clip in clips}
        self._clip = next(iter(self._clips.values()))
        #: Time in the clip, seconds.
        self.now: float = self._clip.span[0]
        self.playing: bool = False
        self._last = 0.0
        gui = page.scene.server.gui
        self._panel = gui.add_panel()
        with self._panel.add_tab("Time"):
            self._choice: Any = gui.add_dropdown("Clip", tuple(self._clips), visible=len(self._clips) > 1)
            start, end = self._clip.span
            self._slider: Any = gui.add_slider("Seconds", start, max(end, start + 1e-3), 1e-3, start)
            self._play: Any = gui.add_button("Play", hint="plays the clip in a loop")
            self._speed: Any = gui.add_dropdown("Speed", SPEEDS, initial_value="1")
        self._panel.float(x=16, y=-16, width=360)
        self._listen()
        self.show(self.now)

    def _listen(self) -> None:
        post = self._page.scene.loop.post

        def clicked(event: Any) -> None:
            post(self.pause if self.playing else self.play)

        def moved(event: Any) -> None:
            if event.client is not None:
                seconds = float(self._slider.value)
                post(lambda: self._scrub(seconds))

        def chosen(event: Any) -> None:
            if event.client is not None:
                name = str(self._choice.value)
                post(lambda: self.choose(name))

        self._play.on_click(clicked)
        self._slider.on_update(moved)
        self._choice.on_update(chosen)

    def choose(self, name: str) -> None:
        """Selects another clip, at its start."""
        self._clip = self._clips[name]
        start, end = self._clip.span
        self._slider.min, self._slider.max = start, max(end, start + 1e-3)
        self.show(start)
        self._slider.value = start

    def play(self) -> None:
        """Plays from the current time, in a loop."""
        self.playing = True
        self._last = time.perf_counter()
        self._play.label = "Pause"
        self._page.scene.loop.tick(self._tick)

    def pause(self) -> None:
        """Pauses at the current time."""
        if self.playing:
            self.playing = False
            self._play.label = "Play"

    def _scrub(self, seconds: float) -> None:
        self.pause()
        self.show(seconds)

    def show(self, seconds: float) -> None:
        """Moves the body to a time of the clip."""
        self.now = seconds
        self._clip.show(seconds)
        self._page.stands_elsewhere()

    def _tick(self, now: float) -> bool:
        if not self.playing:
            return False
        start, end = self._clip.span
        passed = (now - self._last) * float(self._speed.value)
        self._last = now
        length = max(end - start, 1e-9)
        self.show(start + (self.now + passed - start) % length)
        return True

    def follow(self) -> None:
        """Updates the slider to the time."""
        if abs(self._slider.value - self.now) > 1e-3:
            self._slider.value = self.now
