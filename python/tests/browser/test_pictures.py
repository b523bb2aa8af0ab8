"""Pictures of the documentation, as the pages show them: written to the folder KINOPT_PICTURES."""

from __future__ import annotations

import os
from pathlib import Path

import kinopt
import numpy as np
import pytest

from . import made
from .conftest import unexpected

pytest.importorskip("viser", reason="SKIPPED: the viewer's browser tests need viser and Chromium")

from kinopt.view.opening import open_page  # noqa: E402

MODELS = Path(__file__).parents[3] / "models"
PICTURES = os.environ.get("KINOPT_PICTURES")
PANDA, NAO = MODELS / "franka_panda.urdf", MODELS / "aldebaran_nao.urdf"


def model(kind, folder):
    """The file of a picture's model, created if missing."""
    match kind:
        case "nao" | "play":
            return NAO
        case "humanoid":
            return MODELS / "humanoid" / "humanoid.json"
        case "gltf":
            made.write_scene(kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json"), "robot-arm", folder / "robot-arm.glb")
            return folder / "robot-arm.glb"
        case "capture":
            made.write_capture(kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json"), folder / "waving.bvh")
            return folder / "waving.bvh"
    return PANDA


#: Dragged frame, displacement relative to the model's size, and time in the clip.
SCENES = {
    "panda": ("tool", [0.15, 0.2, -0.1], None),
    "obstacles": ("tool", [0.1, -0.1, -0.45], None),
    "window": ("tool", [0.1, 0.06, -0.08], None),
    "humanoid": ("left_hand/tip", [0.05, 0.0, 0.28], None),
    "nao": ("left_hand", [0.05, 0.05, -0.3], None),
    "gltf": (None, [0.0, 0.15, 0.0], 1.0),
    "capture": ("left_hand/tip", [0.05, 0.12, 0.08], 1.2),
    "play": (None, None, 3.4),
}
#: Options of `open_page`.
OPTIONS = {
    "obstacles": {"world": MODELS / "worlds" / "table.json", "margin": 0.01},
    "window": {"world": MODELS / "worlds" / "window.json", "margin": 0.01},
    "nao": {"base_joint": "free"},
    "play": {"retarget": MODELS / "captures" / "steps.bvh"},
}

#: Kinds that are opened without KINOPT_PICTURES: the others open as in `test_pages` and `test_movements`.
TRIED_SCENES = ("window", "gltf")


def drag(page, shown, frame, displacement):
    """Drags the gizmo of a frame, the first one by default."""
    frame = frame or next(iter(page.targets))
    target = page.targets[frame]
    start = page.call(lambda: page._place(frame))
    page.call(lambda: target._hear(start, "start"))
    for k in range(1, 31):
        step = start.copy()
        step[:3, 3] += np.asarray(displacement) * page.body.size() * k / 30
        page.call(lambda step=step: target._hear(step, "update"))
        shown.settle(0.05)
    page.call(lambda: setattr(target, "placement", step))
    page.call(lambda: target._hear(step, "end"))


@pytest.mark.parametrize("kind", SCENES if PICTURES else TRIED_SCENES)
def test_page_opens_plays_and_is_dragged(kind, tmp_path, open_tab):
    page = open_page(model(kind, tmp_path), port=8320, **OPTIONS.get(kind, {}))
    try:
        shown = open_tab(page, 1500 if kind == "play" else 1280, 800, sharp=True) if PICTURES else open_tab(page)
        before = shown.colors()
        frame, displacement, seconds = SCENES[kind]
        if seconds is not None:
            page.call(lambda: page.play_bar.scrub(seconds))
        if displacement is None:
            shown.tab.get_by_text("Curves", exact=True).click()
            shown.tab.get_by_label("Joints of").click()
            shown.tab.get_by_role("option", name="left_sole").click()
        else:
            drag(page, shown, frame, displacement)
        shown.come_to_rest()
        assert page.scene.loop.failure is None
        assert (np.abs(shown.colors() - before).sum(axis=2) > 30).mean() > 0.003
        assert unexpected(shown.console) == []
        if PICTURES:
            from PIL import Image

            Path(PICTURES).mkdir(parents=True, exist_ok=True)
            image = Image.fromarray(shown.colors().astype(np.uint8))
            image.quantize(256).save(Path(PICTURES) / f"view-{kind}.png", optimize=True)
    finally:
        page.scene.close()
