"""Pages in a real browser: gizmos are dragged with the mouse, the mesh follows, limits hold, and misses are shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from .conftest import unexpected

pytest.importorskip("viser", reason="SKIPPED: the viewer's browser tests need viser and Chromium")

from kinopt.view.opening import open_page  # noqa: E402

ROOT = Path(__file__).parents[3]
MODELS = ROOT / "models"


@pytest.fixture
def opened():
    """Opens pages, and closes them in the end."""
    pages = []

    def open_one(*path, **options):
        page = open_page(MODELS.joinpath(*path), port=8300, **options)
        pages.append(page)
        return page

    yield open_one
    for page in pages:
        page.scene.close()


class Watched:
    """Every configuration that a page shows while it is observed."""

    def __init__(self, page):
        self.q = []
        draw = page.body._place

        def draw_and_record(q):
            self.q.append(q.copy())
            draw(q)

        page.body._place = draw_and_record

    def hold_limits(self, model):
        q = np.array(self.q)
        return bool((q >= model.lower).all() and (q <= model.upper).all())


def drag(shown, frame, displacement, points=25, back=False):
    """Drags the gizmo of a frame by one of its arrows along `displacement`, with the mouse, and `back` if requested.

    Returns the texts of the status before the mouse goes back.
    """
    target = shown.page.targets[frame]
    placement = target.placement
    displacement = np.asarray(displacement, dtype=float)
    axis = int(np.abs(placement[:3, :3].T @ displacement).argmax())
    arrow = placement[:3, axis] * 0.75 * target.size
    start, end = shown.pixel(placement[:3, 3] + arrow), shown.pixel(placement[:3, 3] + arrow + displacement)
    mouse, texts = shown.tab.mouse, []

    def go(first, last):
        for k in range(1, points + 1):
            mouse.move(*(first + (last - first) * k / points))
        shown.come_to_rest()
        texts.append(shown.status())

    # An arrow can be dragged once the page has drawn the mouse over it, which takes a variable time.
    for _ in range(10):
        mouse.move(*start)
        shown.settle(0.3)
        mouse.down()
        shown.until(lambda: target.held, seconds=5.0)
        if target.held:
            break
        mouse.up()
    assert target.held, "the gizmo is not taken"
    go(start, end)
    if back:
        texts[-1] += "".join(mark.text for mark in shown.page.status.marks.values())
        go(end, start)
    mouse.up()
    shown.come_to_rest()
    return texts


def along_an_axis(placement, displacement):
    """Component of a vector along the nearest axis of a placement."""
    share = placement[:3, :3].T @ displacement
    axis = int(np.abs(share).argmax())
    return share[axis] * placement[:3, axis]


def error_of(page, frame):
    return float(np.linalg.norm(page.body.frame(frame)[:3, 3] - page.targets[frame].placement[:3, 3]))


def test_panda_tool_is_dragged(opened, open_tab):
    page = opened("franka_panda.urdf")
    shown = open_tab(page)
    assert list(page.targets) == ["tool"]
    watched = Watched(page)
    sent = len(shown.received)
    before = shown.colors()
    start = page.body.frame("tool")
    height = shown.tab.locator(".kinopt-status").bounding_box()["height"]
    inwards = -0.2 * start[:3, 3] / np.linalg.norm(start[:2, 3]) * [1.0, 1.0, 0.0]
    drag(shown, "tool", along_an_axis(start, inwards))
    moved = page.body.frame("tool")
    assert np.linalg.norm(moved[:3, 3] - start[:3, 3]) > 0.1
    assert page.answer.solution.reached and error_of(page, "tool") < 1e-6
    assert len(watched.q) >= 10 and watched.hold_limits(page.body.model)
    assert page.status.text.startswith("Reached")
    assert shown.status().startswith("Reached")
    # The controls below the text do not move.
    assert shown.tab.locator(".kinopt-status").bounding_box()["height"] == height
    # The picture follows, and only transforms are sent: nothing near the size of a mesh.
    assert (np.abs(shown.colors() - before).sum(axis=2) > 30).mean() > 0.01
    assert max(shown.received[sent:]) < 20_000 < max(shown.received[:sent])
    assert unexpected(shown.console) == []


def test_unreachable_target_is_reported(opened, open_tab):
    page = opened("universal_ur5e.urdf")
    shown = open_tab(page)
    watched = Watched(page)
    (frame,) = page.targets
    page.call(lambda: page.set_turns(False))
    missed, reached = drag(shown, frame, [0.0, 0.0, 1.0], points=15, back=True)
    assert missed.startswith("Missed") and "misses by" in missed and "No joint limit" in missed
    # The distance is shown next to the gizmo.
    assert missed.endswith(" off")
    assert reached.startswith("Reached") and page.status.marks == {}
    assert page.answer.solution.reached and error_of(page, frame) < 1e-6
    assert watched.hold_limits(page.body.model)
    assert unexpected(shown.console) == []


def test_humanoid_mesh_follows_dragged_hand(opened, open_tab):
    page = opened("humanoid", "humanoid.json")
    shown = open_tab(page)
    hand = "left_hand/tip"
    assert {hand, "right_hand/tip", "head/tip", "left_foot/tip", "right_foot/tip"} == page.pinned
    watched = Watched(page)
    pinned = {frame: page.body.frame(frame)[:3, 3] for frame in page.pinned - {hand}}
    sent = len(shown.received)
    ground = shown.colors()
    drag(shown, hand, [0.0, 0.0, 0.35])
    assert page.answer.solution.reached
    for frame, position in pinned.items():
        assert np.linalg.norm(page.body.frame(frame)[:3, 3] - position) < 1e-5
    assert len(watched.q) >= 10 and watched.hold_limits(page.body.model)
    # No joint jumps.
    assert np.abs(np.diff(np.array(watched.q), axis=0)).max() <= 0.15 + 1e-9
    # The forearm's skin is where the library computes it: the colour of skin now, of the background before.
    mesh = page.body.pieces()[0].solid.vertices
    elbow, wrist = (page.body.frame(frame)[:3, 3] for frame in ("left_forearm", "left_hand"))
    middle = (elbow + wrist) / 2
    near = mesh[np.linalg.norm(mesh - middle, axis=1) < 0.06].mean(axis=0)
    u, v = np.round(shown.pixel(near)).astype(int)
    now = shown.colors()
    assert np.abs(now[v, u] - ground[v, u]).sum() > 40
    red, green, blue = now[v, u]
    assert red > green > blue, "the skin's colour is warm"
    assert max(shown.received[sent:]) < 20_000 < max(shown.received[:sent])
    assert unexpected(shown.console) == []


def test_panel_controls_joints_pins_options_and_time(opened, open_tab):
    page = opened("humanoid", "humanoid.json")
    shown = open_tab(page, width=900, height=900)
    tab = shown.tab
    # Pins.
    assert "head/tip" in page.pinned
    tab.get_by_label("pin head/tip").click()
    shown.until(lambda: "head/tip" not in page.pinned)
    assert "head/tip" not in page.pinned
    # Play, and pause.
    tab.get_by_role("button", name="Play").click()
    shown.until(lambda: page.play_bar.playing)
    assert page.play_bar.playing
    q = page.body.q
    shown.until(lambda: not np.array_equal(page.body.q, q))
    assert not np.array_equal(page.body.q, q)
    tab.get_by_role("button", name="Pause").click()
    shown.until(lambda: not page.play_bar.playing)
    assert not page.play_bar.playing
    # Save.
    for kind in ("JSON", "OBJ", "GLB"):
        with tab.expect_download() as download:
            tab.get_by_role("button", name=kind).click()
        assert Path(download.value.path()).stat().st_size > 500
        assert download.value.suggested_filename.endswith(kind.lower())
    assert unexpected(shown.console) == []
