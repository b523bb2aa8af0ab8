"""Promise: inverse kinematics over a clip: hands reach over their spans, feet are planted, and errors name invalid
input."""

from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.animation import Armature, Clip, EditedClip, Reach

HUMANOID = Path(__file__).parents[2] / "models" / "humanoid" / "humanoid.json"


@pytest.fixture(scope="module")
def wave() -> tuple[kinopt.Skeleton, Clip]:
    rig = kinopt.Rig.read(HUMANOID)
    armature = Armature.of_skeleton(rig.skeleton)
    builder = Clip.builder("wave", armature)
    builder.euler_clip(rig.clip)
    return rig.skeleton, builder.build()


def tip(edited: EditedClip | Clip, bone: str, length: float, time: float) -> np.ndarray:
    clip = edited.clip if isinstance(edited, EditedClip) else edited
    placement = clip.armature.model_from_bone(clip.sample(time), bone)
    return np.asarray((placement @ np.array([length, 0, 0, 1]))[:3], dtype=float)


def test_hand_reaches_while_feet_stay_planted(wave: tuple[kinopt.Skeleton, Clip]) -> None:
    skeleton, clip = wave
    target = (0.35, 0.25, 1.1)
    edited = clip.with_ik(
        [Reach("left_hand", target, span=(1.2, 2.4), fade=0.3)],
        ["left_foot", "right_foot"],
        up=(0, 0, 1),
        keys_per_second=20,
        skeleton=skeleton,
    )
    assert {stance.bone for stance in edited.report.stances} == {"left_foot", "right_foot"}
    assert max(stance.slide for stance in edited.report.stances) < 1e-4
    assert max(stance.stray for stance in edited.report.stances) < 1e-3
    assert max(result.miss for result in edited.report.led) < 1e-4
    assert edited.report.root_moved == 0.0
    length = skeleton.bones[skeleton.bone_names.index("left_hand")].length
    np.testing.assert_allclose(tip(edited, "left_hand", length, 1.8), target, atol=1e-4)
    before = tip(clip, "left_hand", length, 0.5)
    np.testing.assert_allclose(tip(edited, "left_hand", length, 0.5), before, atol=2e-3)
    assert "2 foot plants" in repr(edited)


def test_curve_ground_and_travel_options_work(wave: tuple[kinopt.Skeleton, Clip]) -> None:
    skeleton, clip = wave
    given: dict[str, object] = {"up": (0, 0, 1), "keys_per_second": 10, "skeleton": skeleton}
    curve = np.array([[0.3, 0.3, 1.0], [0.35, 0.2, 1.1], [0.3, 0.3, 1.2]])
    edited = clip.with_ik([Reach("left_hand", curve, times=(0.5, 1.5, 2.5), span=(0.5, 2.5))], **given)  # type: ignore[arg-type]
    assert edited.report.led[0].bone == "left_hand" and edited.report.led[0].miss < 1e-3
    feet = ["left_foot", "right_foot"]
    high = clip.with_ik(plant=feet, ground=lambda x, y, z: 0.1, **given)  # type: ignore[arg-type]
    assert high.report.root_moved == pytest.approx(0.1, abs=1e-3)
    world = kinopt.World()
    world.add_box("floor", (4, 4, 0.1), (0, 0, 0.05))
    same = clip.with_ik(plant=feet, ground=world, **given)  # type: ignore[arg-type]
    np.testing.assert_allclose(
        [stance.place for stance in same.report.stances], [stance.place for stance in high.report.stances], atol=1e-6
    )
    gone = clip.with_ik(plant=["left_hand"], root_velocity=(0.2, 0, 0), **given)  # type: ignore[arg-type]
    pelvis = gone.clip.armature.model_from_bone(gone.clip.sample(3.0), "pelvis")
    start = clip.armature.model_from_bone(clip.sample(3.0), "pelvis")
    assert pelvis[0, 3] - start[0, 3] == pytest.approx(0.6, abs=0.2)


def test_invalid_arguments_are_named(wave: tuple[kinopt.Skeleton, Clip]) -> None:
    _, clip = wave
    reach = Reach("left_hand", (0, 0, 1))
    with pytest.raises(kinopt.UnknownNameError, match="paw"):
        clip.with_ik([Reach("paw", (0, 0, 1))])
    with pytest.raises(kinopt.UnknownNameError, match="hoof"):
        clip.with_ik(plant=["hoof"])
    with pytest.raises(kinopt.InvalidValueError, match="nothing"):
        clip.with_ik()
    with pytest.raises(kinopt.InvalidValueError, match="two targets"):
        clip.with_ik([reach], ["left_hand"])
    with pytest.raises(kinopt.InvalidValueError, match="from 5 s"):
        clip.with_ik([Reach("left_hand", (0, 0, 1), span=(5, 6))])
    with pytest.raises(kinopt.InvalidValueError):
        clip.with_ik([Reach("left_hand", (0, np.nan, 1))])
    with pytest.raises(kinopt.InvalidValueError, match="keys/s"):
        clip.with_ik([reach], keys_per_second=0)
    with pytest.raises(kinopt.InvalidValueError, match="ground"):
        clip.with_ik(plant=["left_foot"], ground=3)  # type: ignore[arg-type]
    with pytest.raises(ZeroDivisionError):
        clip.with_ik(plant=["left_foot"], ground=lambda x, y, z: 1 / 0, up=(0, 0, 1))
