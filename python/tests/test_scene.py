"""Scenes and captures: written, read again, posed, and sent to other processes."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import animation, skinning

MODELS = Path(__file__).parents[2] / "models"

NOD = """HIERARCHY
ROOT Neck {
    OFFSET 0 150 0
    CHANNELS 1 Xrotation
    End Site { OFFSET 0 20 0 }
}
MOTION
Frames: 3
Frame Time: 0.5
0
90
45
7"""


@pytest.fixture(scope="module")
def rig():
    return kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json")


def wave(armature):
    """Rotates one bone back and forth, and scales another one."""
    times = [0.0, 0.5, 1.0]
    half = np.sqrt(0.5)
    turn = animation.RotationCurve.slerp(times, xyzw=[[0, 0, 0, 1], [0, 0, half, half], [0, 0, 0, 1]])
    grow = animation.KeyedCurve.linear(times, [[1, 1, 1], [2, 2, 2], [1, 1, 1]])
    builder = animation.Clip.builder("wave", armature)
    builder.channel(armature.names[1], "rotation", turn)
    builder.channel(armature.names[2], "scale", grow)
    builder.event(0.5, "there")
    return builder.build()


@pytest.fixture(scope="module")
def scene(rig):
    armature = animation.Armature.of_skeleton(rig.skeleton)
    smile = skinning.MorphTarget("smile", [0, 3], [[0, 0, 0.1], [0.1, 0, 0]])
    armature = armature.with_morph_targets(["smile"])
    vertices = len(rig.mesh.positions)
    skin = kinopt.Skin(armature, "skin", armature.names, armature.rest_from_model, rig.weights)
    mesh = kinopt.SceneMesh(
        armature,
        "arm",
        armature.names[0],
        rig.mesh,
        morph_targets=skinning.MorphTargets(vertices, [smile]),
        skin=skin,
    )
    return kinopt.Scene(armature, [mesh], [wave(armature)])


def test_scene_and_rig_pose_equally(rig, scene):
    q = 0.2 * np.sin(np.arange(rig.skeleton.angles))
    pose = scene.armature.rest
    bridge = rig.skeleton.pose(q)
    for name, placed in zip(scene.armature.names, bridge):
        scene.armature.set_model_from_bone(pose, name, placed)
    posed = scene.posing().positions(pose)
    assert posed.dtype == np.float32
    assert np.abs(posed - rig.posing().positions(q)).max() < 1e-5
    assert np.array_equal(scene.posing().triangles, rig.mesh.triangles)
    assert np.array_equal(scene.posing().mesh(pose).positions, posed)
    pose.set_morph_weight("smile", 0.5)
    moved = np.flatnonzero((scene.posing().positions(pose) != posed).any(axis=1))
    assert set(moved) <= {0, 3} and len(moved)


def test_poses_are_written_into_out(scene):
    posing = scene.posing("dqs")
    clip = scene.clip("wave")
    poses = clip.sample(np.linspace(0, 1, 6), "loop")
    assert len(poses) == 6
    buffer = np.empty((6, len(scene.meshes[0].mesh.positions), 3), np.float32)
    assert posing.positions(poses, out=buffer) is buffer
    for i in range(6):
        assert np.array_equal(buffer[i], posing.positions(poses[i]))
        assert np.array_equal(buffer[i], posing.mesh(poses[i]).positions)
    if scene.meshes[0].mesh.normals is not None:
        lengths = np.linalg.norm(posing.normals(poses), axis=-1)
        assert np.abs(lengths - 1).max() < 1e-5
    with pytest.raises(kinopt.InvalidValueError, match="out must be a writable float32 array"):
        posing.positions(poses, out=buffer[:5])
    with pytest.raises(kinopt.InvalidValueError, match="bones"):
        posing.positions(kinopt.MotionCapture.from_bytes(NOD).armature.rest)


def test_scene_round_trips(scene, tmp_path):
    scene.write(tmp_path / "arm.glb")
    for twin in (
        kinopt.Scene.read(tmp_path / "arm.glb"),
        kinopt.Scene.from_bytes(scene.to_bytes(), "arm.glb"),
    ):
        assert twin.armature.names == scene.armature.names
        assert np.array_equal(twin.meshes[0].mesh.positions, scene.meshes[0].mesh.positions)
        assert np.array_equal(twin.meshes[0].skin.joint_from_mesh, scene.armature.rest_from_model)
        pose, same = (one.clip("wave").sample(0.3) for one in (twin, scene))
        assert np.array_equal(pose.rotations_xyzw, same.rotations_xyzw)
        assert np.abs(twin.posing().positions(pose) - scene.posing().positions(same)).max() < 1e-5
    with pytest.raises(kinopt.FileError):
        kinopt.Scene.read(tmp_path / "nothing.glb")
    with pytest.raises(kinopt.InvalidFileError):
        kinopt.Scene.from_bytes(b"glTF and then nothing")
    with pytest.raises(kinopt.InvalidFileError):
        kinopt.Scene.from_bytes('{"asset": {"version": "1.0"}}')
    with pytest.raises(kinopt.InvalidValueError, match="keys"):
        scene.to_bytes(-1.0)
    with pytest.raises(kinopt.UnknownNameError, match="no clip named `walk`"):
        scene.clip("walk")


def test_text_with_external_buffers_is_read():
    text = (
        '{"asset":{"version":"2.0"},"buffers":[{"uri":"m.bin","byteLength":36}],'
        '"bufferViews":[{"buffer":0,"byteLength":36}],'
        '"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",'
        '"min":[0,0,0],"max":[1,1,0]}],'
        '"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
        '"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}'
    )
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    scene = kinopt.Scene.from_bytes(text, "t.gltf", {"m.bin": triangle.tobytes()}.__getitem__)
    assert np.array_equal(scene.meshes[0].mesh.positions, triangle)
    with pytest.raises(kinopt.InvalidFileError, match="m.bin"):
        kinopt.Scene.from_bytes(text)


def test_copies_are_bitwise_equal(scene):
    twin = pickle.loads(pickle.dumps(scene))
    poses = [one.clip("wave").sample(np.linspace(0, 1, 5)) for one in (scene, twin)]
    assert np.array_equal(poses[0].rotations_xyzw, poses[1].rotations_xyzw)
    positions = [one.posing("dqs").positions(pose) for one, pose in zip((scene, twin), poses)]
    assert np.array_equal(*positions)
    assert twin.clip("wave").events == [(0.5, "there")]


def test_capture_matches_its_frames():
    capture = kinopt.MotionCapture.from_bytes(NOD, "nod.bvh")
    assert capture.armature.names == ["Neck", "Neck/tip"]
    assert (capture.frames, capture.frame_time) == (3, 0.5)
    assert capture.channels == [["Xrotation"], []]
    assert len(capture.notes) == 1 and "left out" in capture.notes[0]
    poses = capture.clip.sample(np.arange(3) * 0.5)
    tips = capture.armature.local_to_model(poses)[:, 1, :3, 3]
    angles = np.deg2rad([0, 90, 45])
    expected = np.c_[0 * angles, 150 + 20 * np.cos(angles), 20 * np.sin(angles)]
    assert np.abs(tips - expected).max() < 1e-4
    twin = pickle.loads(pickle.dumps(capture))
    assert twin.notes == capture.notes and twin.channels == capture.channels
    with pytest.raises(kinopt.InvalidFileError, match="line"):
        kinopt.MotionCapture.from_bytes(b"HIERARCHY\nROOT")


def test_written_capture_keeps_channels(tmp_path):
    text = NOD.replace("1 Xrotation", "2 Yrotation Xrotation").replace("Frames: 3", "Frames: 2")
    capture = kinopt.MotionCapture.from_bytes(text)
    capture.write(tmp_path / "nod.bvh")
    assert (tmp_path / "nod.bvh").read_text() == capture.to_text()
    again = kinopt.MotionCapture.read(tmp_path / "nod.bvh")
    assert again.channels == capture.channels == [["Yrotation", "Xrotation"], []]
    assert (again.frames, again.frame_time) == (capture.frames, capture.frame_time)
    armature, poses = capture.armature, capture.clip.sample([0.0, 0.5])
    written = kinopt.io.bvh_poses_to_text(armature, poses, 2.0, channels=capture.channels)
    assert "CHANNELS 2 Yrotation Xrotation" in written
    with pytest.raises(kinopt.UnknownNameError, match="Wrotation"):
        kinopt.io.bvh_poses_to_text(armature, poses, 2.0, channels=[["Wrotation"], []])
    with pytest.raises(kinopt.InvalidValueError, match="lists of channels"):
        kinopt.io.bvh_poses_to_text(armature, poses, 2.0, channels=[])


def test_motion_is_written_as_bvh(scene, tmp_path):
    capture = kinopt.MotionCapture.from_bytes(NOD)
    text = kinopt.io.bvh_to_text(capture.armature, capture.clip, 2.0)
    again = kinopt.MotionCapture.from_bytes(text)
    times = np.linspace(0, 1, 5)
    tips = [
        one.armature.local_to_model(one.clip.sample(times))[:, 1, :3, 3] for one in (capture, again)
    ]
    assert np.abs(tips[0] - tips[1]).max() < 1e-3
    poses = capture.clip.sample(times)
    kinopt.io.bvh_write_poses(capture.armature, poses, 4.0, tmp_path / "nod.bvh")
    assert kinopt.MotionCapture.read(tmp_path / "nod.bvh").frames == 5
    with pytest.raises(kinopt.InvalidValueError, match="frames a second"):
        kinopt.io.bvh_to_text(capture.armature, capture.clip, 0.0)
    with pytest.raises(kinopt.InvalidValueError, match="scaled"):
        kinopt.io.bvh_to_text(scene.armature, scene.clip("wave"), 30.0)


def test_meshes_and_tables_round_trip(rig, tmp_path):
    io = kinopt.io
    for encoding in ("binary", "binary_big_endian", "text"):
        twin = io.ply_from_bytes(io.ply_to_bytes(rig.mesh, encoding))
        assert np.array_equal(twin.positions, rig.mesh.positions)
        assert np.array_equal(twin.triangles, rig.mesh.triangles)
    io.ply_write(rig.mesh, tmp_path / "m.ply")
    assert np.array_equal(io.ply_read(tmp_path / "m.ply").positions, rig.mesh.positions)
    lines = io.obj_to_text(rig.mesh).splitlines()
    corners = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    assert np.array_equal(corners.astype(np.float32), rig.mesh.positions)
    io.gltf_write_mesh(rig.mesh, tmp_path / "m.glb")
    read = kinopt.Scene.read(tmp_path / "m.glb")
    assert np.array_equal(read.meshes[0].mesh.positions, rig.mesh.positions)
    table = np.arange(6.0).reshape(2, 3) / 7
    for encoding in ("binary", "text"):
        assert np.array_equal(io.dmat_from_bytes(io.dmat_to_bytes(table, encoding)), table)
    with pytest.raises(kinopt.UnknownNameError, match="encoding"):
        io.ply_to_bytes(rig.mesh, "morse")
    with pytest.raises(kinopt.InvalidFileError, match="m.ply"):
        io.ply_from_bytes(b"ply\n", "m.ply")


def test_damaged_captures_are_read_with_notes():
    text = NOD.replace("Frames: 3", "Frames: 9").replace("Neck", "N\u00e9ck")
    capture = kinopt.MotionCapture.from_bytes(text.encode("latin-1"))
    assert capture.armature.names == ["N\u00e9ck", "N\u00e9ck/tip"]
    assert capture.frames == 4
    assert [note.split(":")[0] for note in capture.notes] == ["line 2", "line 13"]
    assert pickle.loads(pickle.dumps(capture)).notes == capture.notes
