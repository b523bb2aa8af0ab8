"""Motion capture on robots: all sources, with a map or without, whole or online."""

from __future__ import annotations

import json
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidFileError, InvalidValueError, UnknownNameError
from kinopt.retargeting import Capture, FigureTarget, read_capture
from kinopt.types import Floats

MODELS = Path(__file__).parents[2] / "models"
NAO = MODELS / "aldebaran_nao.urdf"
JOINTS = ["hips", "left", "right"]
MAP = {
    "joints": JOINTS,
    "fps": 30,
    "drives": {"hips": "torso", "left": "left_sole", "right": "right_sole"},
    "contacts": ["left", "right"],
}


def sway(frames: int = 30) -> Floats:
    """A hip that sways over two feet."""
    positions = np.zeros((frames, 3, 3))
    positions[:, 0, 2] = 0.9
    positions[:, 0, 1] = 0.05 * np.sin(0.2 * np.arange(frames))
    positions[:, 1, 1], positions[:, 2, 1] = 0.15, -0.15
    return positions


def person(frames: int = 12) -> tuple[list[str], Floats]:
    """A subject with SMPL's joints, standing with hanging arms, that bends the knees."""
    standing = {
        "pelvis": (0, 0, 0.95), "hip": (0, 0.1, 0.9), "spine1": (0, 0, 1.05), "knee": (0.02, 0.1, 0.5),
        "spine2": (0, 0, 1.2), "ankle": (0, 0.1, 0.08), "spine3": (0, 0, 1.3), "foot": (0.13, 0.1, 0.02),
        "neck": (0, 0, 1.5), "collar": (0, 0.08, 1.42), "head": (0, 0, 1.6), "shoulder": (0, 0.18, 1.42),
        "elbow": (0, 0.2, 1.15), "wrist": (0.02, 0.2, 0.9), "hand": (0.03, 0.2, 0.8),
    }  # fmt: skip
    names = (
        "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 left_foot right_foot "
        "neck left_collar right_collar head left_shoulder right_shoulder left_elbow right_elbow left_wrist right_wrist "
        "left_hand right_hand"
    ).split()
    positions = np.zeros((frames, len(names), 3))
    for k, name in enumerate(names):
        side, _, part = name.rpartition("_")
        x, y, z = standing[part]
        positions[:, k] = (x, -y if side == "right" else y, z)
    return names, positions


@pytest.fixture(scope="module")
def nao() -> kinopt.Robot:
    # Its file has no velocity limits.
    text = NAO.read_text().replace('velocity="0"', 'velocity="3"')
    return kinopt.Robot.from_urdf_text(text, NAO.name, base_joint="free")


def test_array_is_retargeted_within_limits(nao: kinopt.Robot) -> None:
    for whole in (False, True):
        found = kinopt.retarget(sway(), nao, MAP, whole=whole)
        assert found.q.shape == (30, nao.configuration_len) and found.names == nao.coordinate_names
        assert found.report.fps == 30 and len(found) == 30
        assert all(nao.is_within_limits(q) for q in found.q)
        # Joint velocities, between successive frames.
        max_step = nao.velocity_limits[7:] / 30
        assert np.all(np.abs(np.diff(found.q[:, 7:], axis=0)) <= max_step * (1 + 1e-12))
        # The reported angles are those of the legs, from the hips to the soles, by forward kinematics.
        assert found.report.limbs == ["left_leg", "right_leg"] and found.report.limb_angles.shape == (30, 2)
        placed = kinopt.ForwardKinematics(nao, ["torso", "left_sole", "right_sole"]).place(found.q)[:, :, :3, 3]
        for k, limb in enumerate(found.report.limbs):
            directions = [of[:, k + 1] - of[:, 0] for of in (sway(), placed)]
            a, b = (of / np.linalg.norm(of, axis=1, keepdims=True) for of in directions)
            angles = np.degrees(np.arccos((a * b).sum(axis=1)))
            assert np.allclose(found.report.limb_angles[:, k], angles, atol=1e-4)
            assert np.isclose(found.report.score.limbs[limb].mean, angles.mean(), atol=1e-4)
        assert found.report.contact_frames == ["left_sole", "right_sole"] and found.report.contacts.all()
        assert found.report.contact_points.shape == (2, 3) and not found.report.contact_points.any()
        soles = kinopt.ForwardKinematics(nao, found.report.contact_frames).place(found.q)[:, :, :3, 3]
        slip = np.linalg.norm(soles - soles[0], axis=2).max()
        assert np.isclose(slip, found.report.slip, atol=1e-9) and slip < 1e-3
        assert found.report.lost_contacts == [] and 0 <= found.report.ground_penetration < 1e-3


def test_active_limits_are_at_their_bound(nao: kinopt.Robot) -> None:
    # A fast sideways motion, limited by the speed limits.
    positions = sway(20)
    positions[10:, 0, 1] += 0.3
    found = kinopt.retarget(positions, nao, MAP)
    assert found.report.missed(1.0) and any(limit.bound.startswith("speed") for limit in found.report.limits)
    max_steps = dict(zip(nao.joint_names, nao.velocity_limits / 30))
    column = found.names.index
    for limit in found.report.limits:
        q = found.q[:, column(limit.joint)]
        if limit.bound.startswith("speed"):
            steps = np.abs(np.diff(q))[limit.first - 1 : limit.end - 1]
            assert np.allclose(steps, max_steps[limit.joint])
        else:
            ends = nao.lower if limit.bound == "lower" else nao.upper
            assert np.allclose(q[limit.first : limit.end], ends[column(limit.joint)])


def test_sources_of_every_kind_are_equal(nao: kinopt.Robot, tmp_path: Path) -> None:
    expected = kinopt.retarget(sway(), nao, MAP).q
    np.save(tmp_path / "sway.npy", sway().astype(np.float32).astype(np.float64))
    (tmp_path / "map.json").write_text(json.dumps(MAP))
    capture = Capture(sway(), JOINTS, 30)
    for source in (tmp_path / "sway.npy", str(tmp_path / "sway.npy"), capture):
        found = kinopt.retarget(source, nao, tmp_path / "map.json").q
        assert np.allclose(found, expected, atol=1e-6)
    assert np.allclose(kinopt.retarget(sway(), NAO, MAP).q[0], expected[0])
    upright = sway()[:, :, [0, 2, 1]] * [1, 1, -1]
    assert np.array_equal(kinopt.retarget(upright, nao, MAP, up="y").q, expected)
    assert kinopt.retarget(sway(), nao, {**MAP, "drives": {NAO.name: MAP["drives"], "g1.urdf": {}}}, fps=60).report.fps == 60


BVH = """HIERARCHY
ROOT hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT left
  {
    OFFSET 0.15 -0.9 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0 0.1
    }
  }
  JOINT right
  {
    OFFSET -0.15 -0.9 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0 0.1
    }
  }
}
MOTION
Frames: 5
Frame Time: 0.04
"""


def test_capture_file_and_its_clip_are_equal(nao: kinopt.Robot, tmp_path: Path) -> None:
    rows = "\n".join(f"0 {0.9 - 0.01 * k} 0" + " 0" * 9 for k in range(5))
    (tmp_path / "squat.bvh").write_text(BVH + rows + "\n")
    found = kinopt.retarget(tmp_path / "squat.bvh", nao, {"drives": MAP["drives"]})
    assert found.report.fps == 25 and len(found) == 5
    read = kinopt.MotionCapture.read(tmp_path / "squat.bvh")
    for source in (read, read_capture(read.clip, fps=25)):
        assert np.array_equal(kinopt.retarget(source, nao, {"drives": MAP["drives"]}).q, found.q)
    # No joint has the name of a foot, so there are no contacts without a map.
    assert found.report.contacts.shape == (5, 0) and found.report.contact_frames == []


def test_shipped_capture_has_a_map(nao: kinopt.Robot) -> None:
    names, positions = person()
    guess = kinopt.guess_map(Capture(positions, names, 30), nao)
    assert (guess.skeleton, guess.body) == ("smpl", None)
    # Its toes are in front of its ankles, unlike the frames of its feet.
    assert guess.map["drives"]["left_foot"]["offset"][0] > 0


def test_map_is_guessed_and_correctable(tmp_path: Path) -> None:
    names, positions = person()
    # The names of links do not matter: the robot's tree has its parts.
    text = NAO.read_text().replace('velocity="0"', 'velocity="3"').replace('"left_shank"', '"left_calf"')
    nao = kinopt.Robot.from_urdf_text(text, "stranger.urdf", base_joint="free")
    guess = kinopt.guess_map(Capture(positions, names, 30), nao)
    assert guess.skeleton == "smpl" and guess.body is None
    drives = guess.map["drives"]
    assert drives["left_knee"] == "left_calf" and drives["left_wrist"] == "left_wrist"
    assert drives["left_ankle"] == "left_foot"
    # SMPL's feet are toes, and the robot's are in front of its ankles.
    assert drives["left_foot"]["frame"] == "left_foot" and drives["left_foot"]["offset"][0] > 0.03
    by_name = kinopt.retarget(positions, nao, "smpl", fps=30)
    assert by_name.report.map == guess.map and by_name.report.notes == guess.notes
    lying = kinopt.guess_map(Capture(positions, names, 30, "y"), nao)
    assert "the body is upright along z, but the upward axis is y" in lying.notes
    guess.save(tmp_path / "map.json")
    again = kinopt.retarget(positions, nao, tmp_path / "map.json", joints=names, fps=30)
    assert np.array_equal(again.q, by_name.q)
    # Names of another convention.
    other = [name.replace("left_", "L_").replace("right_", "R_").title() for name in names]
    assert len(kinopt.guess_map(Capture(positions, other, 30), nao).map["drives"]) == len(drives)


def test_rig_is_a_target() -> None:
    rig = kinopt.Rig.read(MODELS / "humanoid/humanoid.json")
    names, positions = person()
    positions[:, :, 0] += 0.02 * np.arange(len(positions))[:, None]
    found = kinopt.retarget(positions, rig, "smpl", fps=30)
    assert found.q.shape == (12, 7 + rig.model.configuration_len)
    assert found.q[-1, 0] - found.q[0, 0] > 0.1
    assert found.report.map["drives"]["left_foot"] == "left_toes"


def test_frames_are_followed_one_by_one(nao: kinopt.Robot) -> None:
    positions = sway(40)
    live = kinopt.RetargetFollower(positions[:10], nao, MAP)
    q = np.array([live.step(frame) for frame in positions])
    assert np.array_equal(live.q, q[-1]) and live.names == nao.coordinate_names and live.map == MAP
    assert all(nao.is_within_limits(row) for row in q)
    soles = kinopt.ForwardKinematics(nao, ["left_sole", "right_sole"]).place(q)[:, :, :3, 3]
    # Locked once they are known to be in contact.
    assert np.linalg.norm(soles[10:] - soles[10], axis=2).max() < 1e-3
    torso = kinopt.ForwardKinematics(nao, ["torso"]).place(q)[:, 0, 1, 3]
    expected_q = kinopt.retarget(positions, nao, MAP).q
    expected = kinopt.ForwardKinematics(nao, ["torso"]).place(expected_q)[:, 0, 1, 3]
    assert np.abs(torso - expected)[10:].max() < 0.01
    # If the capture loses a joint, the configuration stays.
    lost = positions[5].copy()
    lost[1] = np.nan
    assert np.array_equal(live.step(lost), q[-1])
    with pytest.raises(InvalidValueError):
        live.step(positions[0][:2])


def test_result_is_saved_and_pickled(nao: kinopt.Robot, tmp_path: Path) -> None:
    found = kinopt.retarget(sway(), nao, MAP)
    found.save(tmp_path / "sway.npz")
    with np.load(tmp_path / "sway.npz") as read:
        assert np.array_equal(read["q"], found.q) and read["fps"] == 30
        assert read["names"].tolist() == found.names and np.array_equal(read["contacts"], found.report.contacts)
    assert [file.name for file in tmp_path.iterdir()] == ["sway.npz"]
    again = pickle.loads(pickle.dumps(found))
    assert np.array_equal(again.q, found.q) and again.report.map == found.report.map
    capture = pickle.loads(pickle.dumps(Capture(sway(), JOINTS, 30, "y")))
    assert capture.joints == JOINTS and capture.up == "y" and np.array_equal(capture.positions, sway())


def test_other_threads_run_meanwhile(nao: kinopt.Robot) -> None:
    counted = 0
    worker = threading.Thread(target=lambda: kinopt.retarget(sway(600), nao, MAP))
    worker.start()
    while worker.is_alive():
        counted += 1
    assert counted > 10


def test_invalid_arguments_are_named(nao: kinopt.Robot, tmp_path: Path) -> None:
    lost = sway()
    lost[7, 1, 2] = np.nan
    with pytest.raises(InvalidValueError, match="frame 7.*`left`"):
        kinopt.retarget(lost, nao, MAP)
    with pytest.raises(InvalidValueError, match="frames, 2, 3"):
        kinopt.retarget(sway()[:, :2, :2], nao, MAP, joints=["hips", "left"])
    with pytest.raises(InvalidValueError, match="the 3 joints have no names"):
        kinopt.retarget(sway(), nao)
    with pytest.raises(InvalidValueError, match="match no body parts"):
        kinopt.retarget(sway(), nao, joints=["a", "b", "c"])
    with pytest.raises(InvalidValueError, match="no frame"):
        kinopt.retarget(np.zeros((0, 3, 3)), nao, MAP)
    with pytest.raises(UnknownNameError, match="left_sole"):
        kinopt.retarget(sway(), nao, {**MAP, "drives": {"hips": "torso", "left": "left_soul"}})
    with pytest.raises(UnknownNameError, match="`lift`.*left"):
        kinopt.retarget(sway(), nao, {**MAP, "drives": {"lift": "left_sole"}})
    with pytest.raises(UnknownNameError, match="cmu"):
        kinopt.retarget(sway(), nao, "kinect")
    with pytest.raises(InvalidValueError, match="drives no frame"):
        kinopt.retarget(sway(), nao, {**MAP, "drives": {}, "contacts": []})
    with pytest.raises(InvalidValueError, match="fps|frames a second"):
        kinopt.retarget(sway(), nao, MAP, fps=0)
    with pytest.raises(FileError):
        kinopt.retarget(sway(), nao, tmp_path / "none.json")
    with pytest.raises(FileError):
        kinopt.retarget(tmp_path / "none.npy", nao, MAP)
    (tmp_path / "broken.json").write_text("{")
    with pytest.raises(InvalidFileError):
        kinopt.retarget(sway(), nao, tmp_path / "broken.json")
    (tmp_path / "broken.npy").write_bytes(b"no array")
    with pytest.raises(InvalidFileError):
        kinopt.retarget(tmp_path / "broken.npy", nao, MAP)
    with pytest.raises(InvalidValueError, match="bvh"):
        kinopt.retarget(tmp_path / "walk.fbx", nao, MAP)
    joint = "OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 1 0 }"
    (tmp_path / "empty.bvh").write_text(f"HIERARCHY ROOT Hips {{ {joint} }} MOTION Frames: 0 Frame Time: 0.1")
    empty = kinopt.MotionCapture.read(tmp_path / "empty.bvh")
    for source in (tmp_path / "empty.bvh", empty, empty.clip, pickle.loads(pickle.dumps(empty.clip))):
        with pytest.raises(InvalidValueError, match="no frames"):
            kinopt.retarget(source, nao, MAP)
    # Errors about a file's numbers name the file.
    damaged = sway(4)
    damaged[2, 1, 0] = np.nan
    np.save(tmp_path / "nan.npy", damaged)
    for name, words in [("empty.bvh", "no frames"), ("nan.npy", "frame 2: the position of joint")]:
        with pytest.raises(InvalidValueError, match=f"{name}: .*{words}"):
            kinopt.retarget(tmp_path / name, nao, MAP)
    half = (tmp_path / "nan.npy").read_bytes()[:200]
    for name, data in [("none.npy", b""), ("text.npy", b"no array"), ("half.npy", half)]:
        (tmp_path / name).write_bytes(data)
        with pytest.raises(InvalidFileError, match=f"{name}: not a valid NumPy array"):
            kinopt.retarget(tmp_path / name, nao, MAP)


def test_self_collisions_are_avoided() -> None:
    robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
    positions = sway(6) * np.array([1.0, 1.5, 1.0])
    found = kinopt.retarget(positions, robot, MAP, keep_clear=0.002)
    apart = kinopt.Problem(robot, [kinopt.tasks.Posture(robot.model.neutral())], margin=0.002)
    assert {pair.frame for pair in found.report.touching} == {k for k, q in enumerate(found.q) if apart.collisions(q)}
    assert not found.report.touching
    follower = kinopt.RetargetFollower(positions, robot, MAP, keep_clear=0.002)
    assert robot.is_within_limits(follower.step(positions[0]))
    with pytest.raises(InvalidValueError, match="margin"):
        kinopt.retarget(positions, robot, MAP, keep_clear=-1.0)


def test_robot_avoids_a_world() -> None:
    robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
    positions = sway(6) * np.array([1.0, 1.5, 1.0])
    plain = kinopt.retarget(positions, robot, MAP, keep_clear=0.002)
    # A pole at the position of the head without the pole.
    head = kinopt.frame_placement(robot, "head", plain.q[3])[:3, 3]
    world = kinopt.World()
    world.add_box("pole", (0.04, 0.04, 2.0), head + [0.08, 0, 0])
    apart = kinopt.Problem(robot, [kinopt.tasks.Posture(robot.model.neutral())], world=world, margin=0.002)
    assert any(apart.collisions(q) for q in plain.q)
    for whole in [False, True]:
        found = kinopt.retarget(positions, robot, MAP, world=world, margin=0.002, whole=whole)
        assert {pair.frame for pair in found.report.touching} == {k for k, q in enumerate(found.q) if apart.collisions(q)}
        assert len(found.report.touching) == 0
    # A pole at the position near the subject is farther away and thicker.
    persons = world.scaled(1 / plain.report.stride)
    found = kinopt.retarget(positions, robot, MAP, world=persons.scaled(plain.report.stride), margin=0.002)
    assert len(found.report.touching) == 0 and not any(apart.collisions(q) for q in found.q)
    with pytest.raises(InvalidValueError, match="times"):
        world.scaled(0.0)
    follower = kinopt.RetargetFollower(positions, robot, MAP, world=world, margin=0.002)
    assert not apart.collisions(follower.step(positions[0]))
    with pytest.raises(InvalidValueError, match="give one of them"):
        kinopt.retarget(positions, robot, MAP, world=world, margin=0.1, keep_clear=0.1)
    with pytest.raises(InvalidValueError, match=r"world must be a kinopt\.World"):
        kinopt.retarget(positions, robot, MAP, world="boxes.json")  # type: ignore[arg-type]
    figure = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    with pytest.raises(InvalidValueError, match="a Robot with collision shapes"):
        kinopt.retarget(STEPS, figure, world=world)


STEPS = MODELS / "captures" / "steps.bvh"


def heights(clip: Any, bone: str, times: list[float]) -> list[float]:
    """Heights of a bone in a clip whose file has y up."""
    places = []
    for time in times:
        pose = clip.sample(time)
        places.append(float(clip.armature.local_to_model(pose)[clip.armature.names.index(bone)][1, 3]))
    return places


def test_figure_moves_in_its_file_format(tmp_path: Path) -> None:
    # Retargeting to a body with equal bones, whose file has y up, returns the motion itself.
    capture = kinopt.MotionCapture.read(STEPS)
    found = kinopt.retarget(STEPS, capture, fps=30)
    clip = kinopt.retargeting.to_clip(found, capture, "again")
    assert clip.name == "again" and np.isclose(clip.span[1], capture.clip.span[1], atol=1 / 30)
    times = [0.5, 2.0, 3.5]
    assert np.allclose(heights(clip, "Head", times), heights(capture.clip, "Head", times), rtol=0.04)
    # From its file, from a target with an upward axis, and after pickling.
    assert np.array_equal(kinopt.retarget(STEPS, STEPS, fps=30).q, found.q)
    figure = FigureTarget(capture, up="y")
    assert np.array_equal(kinopt.retarget(STEPS, figure, fps=30).q, found.q)
    back = pickle.loads(pickle.dumps(figure))
    assert back.up == "y" and back.model.joint_names == figure.model.joint_names
    # A scene with these bones keeps its content and gets an additional clip.
    scene = kinopt.Scene(capture.armature)
    scene.write(tmp_path / "body.glb")
    file = kinopt.SceneFile.read(tmp_path / "body.glb")
    movement = kinopt.retarget(STEPS, file.scene, fps=30)
    file.add_clip(kinopt.retargeting.to_clip(movement, file.scene, "Steps"))
    file.write(tmp_path / "moving.glb")
    written = kinopt.Scene.read(tmp_path / "moving.glb")
    assert [clip.name for clip in written.clips] == ["Steps"]
    assert np.allclose(heights(written.clips[0], "Head", times), heights(capture.clip, "Head", times), rtol=0.04)


def test_rig_with_z_up_is_upright_in_scene(tmp_path: Path) -> None:
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    found = kinopt.retarget(STEPS, rig, fps=30)
    clip = kinopt.retargeting.to_clip(found, rig, "Steps")
    scene = kinopt.Scene(clip.armature, clips=[clip])
    scene.write(tmp_path / "steps.glb", up=(0, 0, 1))
    clip = kinopt.Scene.read(tmp_path / "steps.glb").clips[0]
    times = [0.5, 2.0, 3.5]
    assert np.all(np.subtract(heights(clip, "head", times), heights(clip, "left_foot", times)) > 1.0)
    with pytest.raises(kinopt.InvalidValueError, match="up axis"):
        scene.to_bytes(up=(0, 0, 0))


def test_map_of_other_robot_is_completed_by_names(nao: kinopt.Robot) -> None:
    other = {"drives": {"g1.urdf": {"Hips": "pelvis_link"}}}
    found = kinopt.retarget(STEPS, nao, other, fps=30)
    guessed = kinopt.retarget(STEPS, nao, fps=30)
    assert np.array_equal(found.q, guessed.q) and found.report.map["drives"] == guessed.report.map["drives"]
    assert "guessed from names" in found.report.notes[0]


def test_invalid_figures_raise(nao: kinopt.Robot, tmp_path: Path) -> None:
    with pytest.raises(InvalidValueError, match="rig"):
        FigureTarget(nao)
    with pytest.raises(InvalidValueError, match="\\(frames, "):
        FigureTarget(kinopt.MotionCapture.read(STEPS)).clip(np.zeros((3, 5)), 30.0)
    with pytest.raises(InvalidValueError, match="up is"):
        FigureTarget(kinopt.MotionCapture.read(STEPS), up="x")  # type: ignore[arg-type]
    (tmp_path / "body.fbx").write_text("")
    with pytest.raises(InvalidFileError, match="body.fbx.*[.]urdf"):
        kinopt.retarget(sway(), tmp_path / "body.fbx", MAP)


def test_fixed_base_of_a_humanoid_is_noted() -> None:
    free = kinopt.Robot.from_urdf(NAO, base_joint="free")
    fixed = kinopt.Robot.from_urdf(NAO)

    def named(robot: kinopt.Robot) -> list[str]:
        return [note for note in kinopt.retarget(sway(4), robot, MAP).report.notes if 'base_joint="free"' in note]

    assert len(named(fixed)) == 1 and not named(free)


def test_repr_of_a_movement_is_one_line() -> None:
    found = kinopt.retarget(sway(4), kinopt.Robot.from_urdf(NAO, base_joint="free"), MAP)
    assert repr(found).startswith("Trajectory(4 rows") and "\n" not in repr(found)
    assert len(repr(found)) < 160


def test_whole_movement_reports_progress() -> None:
    calls: list[tuple[int, int]] = []
    robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
    plain = kinopt.retarget(sway(40), robot, MAP, whole=True)
    found = kinopt.retarget(sway(40), robot, MAP, whole=True, progress=lambda *now: calls.append(now))
    assert calls[-1] == (40, 40) and calls == sorted(calls)
    np.testing.assert_array_equal(found.q, plain.q)


def test_whole_movement_ends_by_progress_exception() -> None:
    robot = kinopt.Robot.from_urdf(NAO, base_joint="free")

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        kinopt.retarget(sway(400), robot, MAP, whole=True, progress=stop)


def test_whole_movement_ends_by_ctrl_c() -> None:
    code = (
        # A process that is started in the background ignores Ctrl-C otherwise.
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "import sys, kinopt; sys.path.insert(0, sys.argv[1]); from test_retargeting import NAO, MAP, sway; "
        "robot = kinopt.Robot.from_urdf(NAO, base_joint='free'); print('begun', flush=True); "
        "kinopt.retarget(sway(20000), robot, MAP, whole=True); print('done', flush=True)"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", code, str(Path(__file__).parent)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert child.stdout is not None and child.stdout.readline() == "begun\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    out, errors = child.communicate(timeout=60)
    assert out == "" and "KeyboardInterrupt" in errors


def test_up_axis_is_detected(tmp_path: Path) -> None:
    nao = kinopt.Robot.from_urdf(NAO, base_joint="free")
    joints = ["Hips", "LeftFoot", "RightFoot"]
    positions = np.zeros((12, 3, 3))
    positions[:, 0, 2] = 0.9
    positions[:, 0, 1] = 0.02 * np.sin(np.arange(12))
    positions[:, 1, 1], positions[:, 2, 1] = 0.1, -0.1
    upright = kinopt.retarget(positions, nao, joints=joints, fps=30)
    assert upright.report.capture.up == "z" and not any("upward" in note for note in upright.report.notes)
    # The same motion with y upward.
    turned = np.stack([positions[..., 0], positions[..., 2], -positions[..., 1]], axis=-1)
    detected = kinopt.retarget(turned, nao, joints=joints, fps=30)
    assert detected.report.capture.up == "y"
    assert "the body is upright along y, which is used as the upward axis: up= sets it" in detected.report.notes
    assert np.abs(detected.q - upright.q).max() < 1e-9
    given = kinopt.retarget(turned, nao, joints=joints, fps=30, up="z")
    assert given.report.capture.up == "z" and np.abs(given.q - upright.q).max() > 1e-3
    assert "the body is upright along y, but the upward axis is z" in given.report.notes


def test_terrain_raises_and_tilts_a_motion(nao: kinopt.Robot, tmp_path: Path) -> None:
    steps = MODELS / "captures" / "steps.bvh"
    level = kinopt.retarget(steps, nao, fps=10)
    plate = {"patches": [{"centre": [0, 0, 0.25], "size": [50, 50]}]}
    raised = kinopt.retarget(steps, nao, fps=10, terrain=plate)
    assert np.allclose(raised.q[:, 2], level.q[:, 2] + 0.25, atol=2e-3)
    (tmp_path / "plate.json").write_text(json.dumps(plate))
    assert np.array_equal(kinopt.retarget(steps, nao, fps=10, terrain=tmp_path / "plate.json").q, raised.q)
    with pytest.raises(kinopt.KinoptError, match="size"):
        kinopt.retarget(steps, nao, fps=10, terrain={"patches": [{"centre": [0, 0, 0], "size": [0, 1]}]})


def test_object_moves_with_the_hands(nao: kinopt.Robot) -> None:
    capture = read_capture(MODELS / "captures" / "steps.bvh", fps=10)
    hands = [capture.positions[:, capture.joints.index(f"{side}Hand")] for side in ("Left", "Right")]
    poses = np.concatenate([np.mean(hands, axis=0), np.tile([1.0, 0, 0, 0], (len(capture), 1))], axis=1)
    radius = float(np.linalg.norm(hands[0] - hands[1], axis=1).min() / 2)
    held = {"shape": {"ball": radius}, "poses": poses, "model_shape": {"ball": 0.08}}
    motion = kinopt.retarget(capture, nao, held_object=held)
    assert motion.report.object_poses.shape == (len(capture), 7)
    with pytest.raises(kinopt.KinoptError, match="3 poses"):
        kinopt.retarget(capture, nao, held_object={**held, "poses": poses[:3]})
