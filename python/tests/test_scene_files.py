"""Scene files keep their content while clips are added and nodes posed; clips from other clips."""

import json
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import animation

MODELS = Path(__file__).parents[2] / "models"
UNKNOWN = '"ACME_mood" : {"glad": 1.50}'


@pytest.fixture(scope="module")
def rig() -> kinopt.Rig:
    return kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json")


@pytest.fixture(scope="module")
def scene(rig: kinopt.Rig) -> kinopt.Scene:
    return kinopt.Scene.of_skeleton(rig.skeleton, rig.mesh, rig.weights)


def walk(armature: animation.Armature, name: str = "walk") -> animation.Clip:
    """The root moves along x for two seconds, rotating about y."""
    times = [0.0, 1.0, 2.0]
    root = armature.names[0]
    half = np.sqrt(0.5)
    builder = animation.Clip.builder(name, armature)
    positions = [[0, 0.5, 0], [1, 0.5, 0], [2, 0.5, 0]]
    builder.channel(root, "translation", animation.KeyedCurve.linear(times, positions))
    turns = [[0, 0, 0, 1], [0, half, 0, half], [0, 1, 0, 0]]
    builder.channel(root, "rotation", animation.RotationCurve.slerp(times, xyzw=turns))
    return builder.build()


def keys(clip: animation.Clip, prop: str) -> int:
    curves = [curve for _, bone_property, curve in clip.channels() if bone_property == prop]
    return sum(len(curve.times) for curve in curves if not isinstance(curve, animation.EulerCurve))


def json_of(data: bytes) -> str:
    length = int.from_bytes(data[12:16], "little")
    return data[20 : 20 + length].decode()


def test_skeleton_with_skin_is_a_scene(rig: kinopt.Rig, scene: kinopt.Scene) -> None:
    assert scene.armature.names == [*animation.Armature.of_skeleton(rig.skeleton).names, "mesh"]
    assert scene.meshes[0].skin is not None
    with pytest.raises(kinopt.InvalidValueError, match="given together"):
        kinopt.Scene.of_skeleton(rig.skeleton, rig.mesh)


def test_unknown_content_is_kept(scene: kinopt.Scene, tmp_path: Path) -> None:
    text = json.dumps({"asset": {"version": "2.0"}, "nodes": [{"name": "root"}], "scenes": [{"nodes": [0]}]})
    text = text[:-1] + ', "extensions": {' + UNKNOWN + "}}"
    file = kinopt.SceneFile.from_bytes(text)
    file.add_clip(walk(file.scene.armature))
    file.write(tmp_path / "own.glb")
    written = (tmp_path / "own.glb").read_bytes()
    assert UNKNOWN in json_of(written)
    again = kinopt.SceneFile.read(tmp_path / "own.glb")
    assert [clip.name for clip in again.scene.clips] == ["walk"]
    with pytest.raises(kinopt.InvalidValueError, match="walk"):
        again.add_clip(walk(again.scene.armature))
    pose = again.scene.clips[0].sample(1.0)
    again.set_rest(pose)
    posed = kinopt.Scene.from_bytes(again.to_bytes(), "posed.glb")
    np.testing.assert_allclose(posed.armature.rest.translations, pose.translations, atol=1e-6)
    other = kinopt.Scene.of_skeleton(kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json").skeleton)
    with pytest.raises(kinopt.InvalidValueError):
        again.set_rest(other.armature.rest)


def test_clips_from_poses_are_thinned(scene: kinopt.Scene) -> None:
    armature = scene.armature
    clip = walk(armature)
    times = np.linspace(0, 2, 61)
    poses = clip.sample(times)
    through = animation.Clip.through_poses("through", armature, times, poses)
    assert through.span == (0.0, 2.0)
    fewer = through.with_fewer_keys(1e-4, 1e-3)
    assert keys(fewer, "translation") == 2 and keys(fewer, "rotation") <= 4
    for elapsed in (0.0, 0.7, 1.9):
        original, other = clip.sample(elapsed), fewer.sample(elapsed)
        np.testing.assert_allclose(original.translations, other.translations, atol=1.1e-4)
    assert fewer.renamed("thin").name == "thin"
    assert keys(clip.baked(10), "translation") == 21
    with pytest.raises(kinopt.InvalidValueError, match="keys/s"):
        clip.baked(0)
    with pytest.raises(kinopt.InvalidValueError):
        animation.Clip.through_poses("no", armature, [0.0, 0.0], poses[:2])


def test_root_motion_is_extracted_and_restored(scene: kinopt.Scene) -> None:
    armature = scene.armature
    clip, root = walk(armature), armature.names[0]
    in_place, motion = clip.without_root_motion(root, (0, 1, 0), 60)
    still = [in_place.sample(t).translations[0][[0, 2]] for t in (0.0, 1.0, 2.0)]
    np.testing.assert_allclose(still, np.zeros((3, 2)), atol=1e-5)
    assert motion.heading.at(2.0) == pytest.approx(np.pi, abs=1e-4)
    np.testing.assert_allclose(motion.at(2.0)[:3, 3], [2, 0, 0], atol=1e-5)
    np.testing.assert_allclose(motion.after(4.0), motion.at(2.0) @ motion.at(2.0), atol=1e-4)
    again = in_place.with_root_motion(root, motion, 60)
    np.testing.assert_allclose(again.sample(1.5).translations, clip.sample(1.5).translations, atol=1e-4)
    with pytest.raises(kinopt.InvalidValueError, match="up"):
        clip.without_root_motion(root, (0, 0, 0))
    with pytest.raises(kinopt.UnknownNameError):
        clip.without_root_motion("nobody")


def test_closed_seam_ends_as_it_starts(scene: kinopt.Scene) -> None:
    clip = walk(scene.armature)
    closed = clip.with_closed_seam(0.5)
    start, end = closed.sample(0.0), closed.sample(2.0)
    np.testing.assert_allclose(start.translations, end.translations, atol=1e-6)
    with pytest.raises(kinopt.InvalidValueError, match="lasts 2 s"):
        clip.with_closed_seam(3.0)
