"""A subject next to the robot with its retargeted motion, in a real browser: both are drawn, and both move."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import kinopt

from . import made
from .conftest import unexpected

pytest.importorskip("viser", reason="SKIPPED: the viewer's browser tests need viser and Chromium")

from kinopt.view.opening import open_page  # noqa: E402

MODELS = Path(__file__).parents[3] / "models"


def test_source_and_target_play_together(tmp_path, open_tab):
    person = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    made.write_capture(person, tmp_path / "waving.bvh")
    page = open_page(MODELS / "aldebaran_nao.urdf", port=8340, retarget=tmp_path / "waving.bvh", fps=30.0)
    try:
        from PIL import Image

        shown = open_tab(page)
        movement = page.play_bar.clip
        assert movement.name == "waving" and movement.span[1] > 1.0
        orange = _orange(shown)
        assert orange.sum() > 50, "the person is not drawn"
        before = shown.colors()
        page.call(lambda: page.play_bar.show(1.2))
        shown.come_to_rest()
        # The robot has the solved configuration, and the subject the captured positions.
        frame = round(1.2 * movement.movement.report.fps)
        assert np.array_equal(page.body.q, movement.movement.q[frame])
        hand = movement.movement.report.capture.joints.index("left_hand")
        position = movement.person.positions[frame, hand]
        column, row = shown.pixel(position).round().astype(int)
        assert _orange(shown)[row - 6 : row + 7, column - 6 : column + 7].any(), "the hand is drawn elsewhere"
        assert (np.abs(shown.colors() - before).sum(axis=2) > 30).mean() > 0.001
        # After a click on its button, time passes.
        shown.tab.get_by_role("button", name="Play").click()
        shown.until(lambda: page.play_bar.now != 1.2)
        assert page.play_bar.now != 1.2
        shown.tab.get_by_role("button", name="Pause").click()
        shown.until(lambda: not page.play_bar.playing)
        # Keys on the slider scrub to its ends.
        thumb = shown.tab.get_by_role("slider").first
        for key, seconds in (("Home", 0.0), ("End", movement.span[1])):
            thumb.press(key)
            shown.until(lambda seconds=seconds: page.play_bar.now == pytest.approx(seconds, abs=1e-3))
            assert page.play_bar.now == pytest.approx(seconds, abs=1e-3) and not page.play_bar.playing
        assert np.array_equal(page.body.q, movement.movement.q[-1])
        # A download of the page without a server, and a video that the browser renders.
        shown.tab.get_by_text("Record", exact=True).click()
        with shown.tab.expect_download() as download:
            shown.tab.get_by_role("button", name="HTML").last.click()
        assert download.value.suggested_filename == "waving.html"
        part = SimpleNamespace(name="part", span=(1.0, 1.08), show=movement.show)
        page.scene.record(tmp_path / "part.gif", part, size=(160, 90))
        with Image.open(tmp_path / "part.gif") as video:
            assert video.n_frames == 3 and video.size == (160, 90) and video.info["duration"] == 40
            red, green, blue = np.moveaxis(np.asarray(video.convert("RGB"), dtype=int), 2, 0)
        assert ((red - blue > 60) & (red > green)).any(), "the person is not in the video"
        assert page.scene.loop.failure is None and unexpected(shown.console) == []
    finally:
        page.scene.close()


def _orange(shown):
    red, green, blue = np.moveaxis(shown.colors(), 2, 0)
    return (red > 150) & (green > 60) & (green < 170) & (blue < 120) & (red - blue > 80)
