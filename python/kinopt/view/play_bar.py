"""Play bar: pause, speed, scrubbing, recording and joint curves of clips."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from .body import Clip
from .canvas import Canvas
from .curves import CurvesPanel
from .recording import VIDEO_FORMATS, recorded

#: Playback speeds.
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
#: Seconds between two updates of the slider and the curves.
SLIDER_INTERVAL = 0.1


class PlayBar:
    """Selects clip and time, and plays in a loop; in the upper left corner."""

    def __init__(self, scene: Canvas, clips: Sequence[Clip], speed: float = 1.0) -> None:
        self.scene = scene
        self._clips = {clip.name: clip for clip in clips}
        #: The selected clip.
        self.clip: Clip = next(iter(self._clips.values()))
        #: Time in the clip, seconds.
        self.now: float = self.clip.span[0]
        self.playing: bool = False
        #: Callbacks after each motion.
        self.on_show: list[Callable[[], Any]] = []
        self._last = self._last_slow = 0.0
        speeds = sorted({*SPEEDS, float(speed)})
        gui = scene.server.gui
        self._panel = gui.add_panel()
        with self._panel.add_tab("Play"):
            self._choice: Any = gui.add_dropdown("Clip", tuple(self._clips), visible=len(self._clips) > 1)
            start, end = self.clip.span
            self._slider: Any = gui.add_slider("Seconds", start, max(end, start + 1e-3), 1e-3, start)
            self._play: Any = gui.add_button("Play", hint="plays the clip in a loop")
            self._speed: Any = gui.add_dropdown("Speed", tuple(f"{s:g}" for s in speeds), initial_value=f"{speed:g}")
        self._curves = CurvesPanel(gui, self._panel.add_tab("Curves"))
        with self._panel.add_tab("Record"):
            self._record: Any = gui.add_button_group("", ("HTML", *(kind.upper() for kind in VIDEO_FORMATS)))
        self._panel.float(x=16, y=16, width=300)
        self._listen()
        self.choose(self.clip.name)

    def _listen(self) -> None:
        post = self.scene.loop.post

        def clicked(event: Any) -> None:
            post(self.pause if self.playing else self.play)

        def moved(event: Any) -> None:
            if event.client is not None:
                seconds = float(self._slider.value)
                post(lambda: self.scrub(seconds))

        def chosen(event: Any) -> None:
            if event.client is not None:
                name = str(self._choice.value)
                post(lambda: self.choose(name))

        def wanted(event: Any) -> None:
            kind, now = str(self._record.value).lower(), self.now
            self.scene.loop.call(self.pause)
            try:
                data = recorded(self.scene, self.clip, kind, speed=self.speed, client=event.client)
            except ImportError as error:
                event.client.add_notification("Not recorded", str(error))
            else:
                event.client.send_file_download(f"{self.clip.name}.{kind}", data, save_immediately=True)
            post(lambda: self.scrub(now))

        self._play.on_click(clicked)
        self._slider.on_update(moved)
        self._choice.on_update(chosen)
        self._record.on_click(wanted)

    @property
    def speed(self) -> float:
        """Playback speed, relative to the clip's own."""
        return float(self._speed.value)

    def choose(self, name: str) -> None:
        """Selects another clip, at its start."""
        self.clip = self._clips[name]
        start, end = self.clip.span
        self._slider.min, self._slider.max = start, max(end, start + 1e-3)
        self._curves.choose(self.clip)
        self.show(start)
        self._update()

    def play(self) -> None:
        """Plays from the current time, in a loop."""
        self.playing = True
        self._last = time.perf_counter()
        self._play.label = "Pause"
        self.scene.loop.tick(self._tick)

    def pause(self) -> None:
        """Pauses at the current time."""
        if self.playing:
            self.playing = False
            self._play.label = "Play"

    def scrub(self, seconds: float) -> None:
        """Pauses at a time of the clip."""
        self.pause()
        self.show(seconds)
        self._update()

    def show(self, seconds: float) -> None:
        """Moves the body to a time of the clip."""
        self.now = seconds
        self.clip.show(seconds)
        for shown in self.on_show:
            shown()

    def remove(self) -> None:
        """Removes the bar."""
        self.pause()
        self._panel.remove()

    def _tick(self, now: float) -> bool:
        if not self.playing:
            self._update()
            return False
        start, end = self.clip.span
        passed = (now - self._last) * self.speed
        self._last = now
        length = max(end - start, 1e-9)
        self.show(start + (self.now + passed - start) % length)
        if now - self._last_slow > SLIDER_INTERVAL:
            self._last_slow = now
            self._update()
        return True

    def _update(self) -> None:
        """Moves the slider and the mark of the curves to the time."""
        if abs(self._slider.value - self.now) > 1e-3:
            self._slider.value = self.now
        self._curves.mark(self.now)


class Together:
    """Several clips as one; a clip that has ended stays in its last pose."""

    def __init__(self, clips: Sequence[Clip]) -> None:
        self.name: str = ", ".join(clip.name for clip in clips)
        self.span: tuple[float, float] = (min(clip.span[0] for clip in clips), max(clip.span[1] for clip in clips))
        self._clips = clips

    def show(self, seconds: float) -> None:
        """Sets the poses of all bodies at that time."""
        for clip in self._clips:
            clip.show(min(max(seconds, clip.span[0]), clip.span[1]))
