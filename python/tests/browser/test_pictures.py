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
#: Folder of pictures outside the repository, such as Khronos' fox; they are opened only if it is given.
SHARED_FOLDER = os.environ.get("KINOPT_SHARED")


def model(kind, folder):
    """The file of a picture's model, created if missing."""
    rig = kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json")
    person = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    match kind:
        case "panda" | "obstacles" | "window":
            return MODELS / "franka_panda.urdf"
        case "humanoid":
            return MODELS / "humanoid" / "humanoid.json"
        case "gltf":
            made.write_scene(rig, "robot-arm", folder / "robot-arm.glb")
            return folder / "robot-arm.glb"
        case "capture":
            made.write_capture(person, folder / "waving.bvh")
            return folder / "waving.bvh"
    return Path(SHARED_FOLDER) / "assets" / "gltf" / "Fox.glb"


#: Dragged frame, displacement relative to the model's size, and time in the clip.
SCENES = {
    "panda": ("tool", [0.15, 0.2, -0.1], None),
    "obstacles": ("tool", [0.1, -0.1, -0.45], None),
    "window": ("tool", [0.1, 0.06, -0.08], None),
    "humanoid": ("left_hand/tip", [0.05, 0.0, 0.28], None),
    "gltf": (None, [0.0, 0.15, 0.0], 1.0),
    "capture": ("left_hand/tip", [0.05, 0.12, 0.08], 1.2),
    "fox": (None, [0.0, 0.15, 0.1], 0.35),
}


#: Kinds that are opened without KINOPT_PICTURES: the others open as in `test_pages` and `test_movements`.
TRIED_SCENES = ("window", "gltf")

#: Worlds of collision avoidance.
WORLDS = {"obstacles": MODELS / "worlds" / "table.json", "window": MODELS / "worlds" / "window.json"}


@pytest.mark.parametrize("kind", SCENES if PICTURES else TRIED_SCENES)
def test_page_opens_plays_and_is_dragged(kind, tmp_path, open_tab):
    if kind == "fox" and not SHARED_FOLDER:
        pytest.skip("SKIPPED: the fox is no part of the project; KINOPT_SHARED names a folder with it")
    page = open_page(model(kind, tmp_path), port=8320, world=WORLDS.get(kind), margin=0.01)
    try:
        shown = open_tab(page, 1280, 800, sharp=True) if PICTURES else open_tab(page)
        before = shown.colors()
        frame, displacement, seconds = SCENES[kind]
        if seconds is not None:
            page.call(lambda: page.play_bar.show(seconds))
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
