"""Scenes and captures on a page: drawn in the library's poses, dragged from any pose of a clip."""

from pathlib import Path

import numpy as np
import pytest

import kinopt

pytest.importorskip("viser", reason="SKIPPED: the viewer's tests need viser (pip install 'kinopt[view]')")

from browser import made  # noqa: E402
from kinopt.view.opening import open_page  # noqa: E402
from kinopt.view.transforms import matrix_of  # noqa: E402
from test_view_page import drag, target_distance  # noqa: E402
from waiting import wait_until  # noqa: E402

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture
def humanoid():
    return kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")


@pytest.fixture
def opened(tmp_path):
    pages = []

    def open_one(name):
        pages.append(open_page(tmp_path / name, port=8240))
        return pages[-1]

    yield open_one
    for page in pages:
        page.scene.close()


def test_scene_plays_as_the_library_poses(humanoid, opened, tmp_path):
    made.write_scene(humanoid, "humanoid", tmp_path / "humanoid.glb")
    page = opened("humanoid.glb")
    scene = kinopt.Scene.read(tmp_path / "humanoid.glb")
    posing = scene.posing()
    for seconds in (0.0, 0.7, 2.2):
        page.call(lambda seconds=seconds: page.play_bar.show(seconds))
        expected = np.asarray(posing.positions(scene.clips[0].sample(seconds)))
        vertices = np.concatenate([piece.solid.vertices for piece in page.body.pieces()])
        # The page merges vertices of one position.
        assert np.abs(vertices.min(axis=0) - expected.min(axis=0)).max() < 1e-5
        assert np.abs(vertices.max(axis=0) - expected.max(axis=0)).max() < 1e-5
        assert np.abs(vertices.mean(axis=0) - expected.mean(axis=0)).max() < 2e-2


def test_scene_is_dragged_from_its_clip_pose(humanoid, opened, tmp_path):
    made.write_scene(humanoid, "humanoid", tmp_path / "humanoid.glb")
    page = opened("humanoid.glb")
    page.call(lambda: page.play_bar.show(1.3))
    hand, foot = "left_hand", "right_toes"
    page.call(lambda: page.add_target(hand))
    before = {frame: page.body.frame(frame) for frame in (hand, foot)}
    page.call(lambda: page._grab(hand))
    assert np.abs(page.body.frame(hand) - before[hand]).max() < 1e-6
    drag(page, hand, [0.0, 0.08, 0.05])
    assert page.answer.solution.reached and target_distance(page, hand) < 1e-4
    assert np.abs(page.body.frame(foot) - before[foot]).max() < 1e-4
    # Playback resets it.
    page.call(lambda: page.play_bar.show(1.3))
    assert np.abs(page.body.frame(hand) - before[hand]).max() < 1e-6
    assert not page.body.q.any()


def test_capture_is_played_and_dragged(humanoid, opened, tmp_path):
    made.write_capture(humanoid, tmp_path / "waving.bvh")
    page = opened("waving.bvh")
    capture = kinopt.MotionCapture.read(tmp_path / "waving.bvh")
    assert page.play_bar.clip.span[1] == pytest.approx((capture.frames - 1) * capture.frame_time, abs=1e-5)
    page.call(lambda: page.play_bar.show(0.5))
    bones = np.asarray(capture.armature.local_to_model(capture.clip.sample(0.5)))
    head = list(capture.armature.names).index("head")
    assert np.abs(page.body.frame("head")[:3, 3] - bones[head, :3, 3]).max() < 1e-6
    hand = next(frame for frame in page.targets if "left_hand" in frame)
    # The rotation of the forearm, by the matrices of its poses.
    curves = page.play_bar.clip.curves
    moment = len(curves.times) // 2
    clip, forearm = capture.clip, list(capture.armature.names).index("left_forearm")
    first, now = (np.asarray(clip.sample(float(t)).rotations_wxyz)[forearm] for t in curves.times[[0, moment]])
    turned = matrix_of(first, np.zeros(3))[:3, :3].T @ matrix_of(now, np.zeros(3))[:3, :3]
    angle = np.arccos(np.clip((np.trace(turned) - 1.0) / 2.0, -1.0, 1.0))
    assert curves.groups[hand]["left_forearm"][moment] == pytest.approx(angle, abs=1e-3) and angle > 0.05
    drag(page, hand, [0.0, 0.05, 0.0])
    assert page.answer.solution.reached
    # It starts again after its end; slow, for machines with other load.
    page.play_bar._speed.value = "0.1"
    page.call(page.play_bar.play)
    wait_until(lambda: page.play_bar.now != 0.5)
    page.call(page.play_bar.pause)
    assert page.scene.loop.failure is None and page.play_bar.now > 0.5


def test_camera_views_a_whole_capture(humanoid, opened, tmp_path):
    rig_armature, clip = made.keyframes(humanoid, "walk")
    poses = clip.sample(np.linspace(0.0, 1.0, 5))
    translations = np.array(poses.translations)
    # From twenty to thirty metres away from the origin.
    translations[:, 0] += np.linspace([20.0, 0.0, -20.0], [30.0, 0.0, -20.0], 5)
    moved = kinopt.animation.Poses(rig_armature, translations=translations, rotations_xyzw=poses.rotations_xyzw)
    walk = kinopt.animation.Clip.through_poses("walk", rig_armature, np.linspace(0.0, 1.0, 5), moved)
    kinopt.io.bvh_write(rig_armature, walk, 4.0, tmp_path / "walk.bvh")
    page = opened("walk.bvh")
    camera = page.scene.server.initial_camera
    forward = (camera.look_at - camera.position) / np.linalg.norm(camera.look_at - camera.position)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    shares = []
    for seconds in np.linspace(*page.play_bar.clip.span, 9):
        page.call(lambda seconds=seconds: page.play_bar.show(seconds))
        for frame in page.body.frame_names:
            position = page.body.frame(frame)[:3, 3] * page.scene.drawn - camera.position
            height = position @ forward * np.tan(camera.fov / 2)
            shares.append([abs(position @ right) / height, abs(position @ np.cross(right, forward)) / height])
    # Within a picture that is a little wider than high, and not lost in it.
    assert (np.max(shares, axis=0) < [1.15, 1.0]).all() and np.max(shares) > 0.6


def test_textures_color_the_triangles(tmp_path, opened):
    import trimesh
    from PIL import Image

    image = Image.new("RGB", (2, 1))
    image.putdata([(200, 40, 30), (20, 90, 210)])
    # The upper half of the triangles is at the left of the image, the other at its right.
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh = mesh.submesh([np.arange(len(mesh.faces))], append=True)
    mesh.unmerge_vertices()
    upper = mesh.vertices[mesh.faces].mean(axis=1)[:, 1] > 0.0
    uv = np.zeros((len(mesh.vertices), 2))
    uv[mesh.faces] = np.where(upper, 0.25, 0.75)[:, None, None] * [1.0, 0.0] + [0.0, 0.5]
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image)
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    mesh.export(tmp_path / "ball.glb")
    pieces = opened("ball.glb").body.pieces()
    centres = {piece.color: piece.solid.vertices[piece.solid.triangles].mean(axis=1) for piece in pieces}
    assert set(centres) == {(200, 40, 30), (20, 90, 210)}
    assert (centres[200, 40, 30][:, 1] > 0.0).all() and (centres[20, 90, 210][:, 1] <= 0.0).all()


def test_scaled_bones_send_mesh_vertices(tmp_path, opened):
    armature = kinopt.animation.Armature(["root", "tip"], [-1, 0], translations=[[0, 0, 0], [0, 1, 0]])
    clip = kinopt.animation.Clip.builder("grow", armature)
    growing = kinopt.animation.KeyedCurve.linear([0.0, 1.0], [[1.0, 1.0, 1.0], [1.0, 3.0, 1.0]])
    clip.channel("tip", "scale", growing)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.uint32)
    mesh = kinopt.SceneMesh(armature, "body", "tip", kinopt.TriangleMesh(corners, faces))
    kinopt.Scene(armature, [mesh], [clip.build()]).write(tmp_path / "grow.glb")
    page = opened("grow.glb")
    assert any("its vertices are sent" in note for note in page.notes)
    page.call(lambda: page.play_bar.show(1.0))
    (piece,) = page.body.pieces()
    assert piece.solid.vertices.max(axis=0) == pytest.approx([1.0, 4.0, 1.0])
