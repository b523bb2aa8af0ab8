"""Retargeted motions on a page: bodies have the solved poses, subjects the captured positions."""

from pathlib import Path

import numpy as np
import pytest

import kinopt

pytest.importorskip("viser", reason="SKIPPED: the viewer's tests need viser (pip install 'kinopt[view]')")

from kinopt.view import Scene  # noqa: E402
from kinopt.view.movement import bones_of  # noqa: E402
from kinopt.view.opening import open_page  # noqa: E402
from waiting import wait_until  # noqa: E402
from test_retargeting import JOINTS, MAP, NAO, person, sway  # noqa: E402

MODELS = Path(__file__).parents[2] / "models"


def test_robot_and_subject_move_together():
    robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
    movement = kinopt.retarget(sway(), robot, MAP)
    with Scene(port=8250) as scene:
        body = scene.add(robot)
        clip = scene.add_movement(movement, body, beside=2.0)
        assert clip.span == (0.0, 29 / 30)
        for frame in (0, 7, 29):
            clip.show(frame / 30)
            assert np.array_equal(body.q, movement.q[frame])
            # On the ground, with legs as long as the robot's.
            drawn = np.asarray(clip.person._joints.points) / scene.drawn
            assert np.isclose(drawn[0, 2] - drawn[1, 2], 0.9 * movement.report.stride, rtol=1e-3)
            assert np.isclose(drawn[:, 2].min(), 0.0, atol=1e-6)
        # Beyond its ends it stays at them.
        clip.show(99.0)
        assert np.array_equal(body.q, movement.q[-1])
        other = scene.add(kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf"))
        with pytest.raises(kinopt.InvalidValueError, match="numbers for each frame"):
            scene.add_movement(movement, other)


@pytest.fixture
def played():
    """The play bar of the Panda's path: every joint goes from 0 to its index, -4 for the fourth, in two seconds."""
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    goal = np.array([0.0, 1.0, 2.0, -2.0, 1.0, 2.0, 1.0])
    times = np.linspace(0.0, 2.0, 21)
    names = [f"joint{i}" for i in range(1, 8)]
    trajectory = kinopt.Trajectory(times, times[:, None] / 2.0 * goal, names, None)
    with Scene(port=8254) as scene:
        body = scene.add(robot)
        yield scene, body, scene.play(scene.add_movement(trajectory, body), speed=0.3)


def test_play_bar_plays_pauses_and_scrubs(played):
    scene, body, bar = played
    assert bar.speed == 0.3 and bar.playing
    wait_until(lambda: bar.now > 0.0)
    scene.loop.call(bar.pause)
    now = bar.now
    assert now > 0.0 and body.q[1] == pytest.approx(now / 2.0, abs=0.03)
    scene.loop.call(lambda: bar.scrub(1.5))
    assert bar.now == bar._slider.value == 1.5 and not bar.playing
    np.testing.assert_allclose(body.q[:7], 0.75 * np.array([0.0, 1.0, 2.0, -2.0, 1.0, 2.0, 1.0]), atol=1e-12)
    # The fingers, which the trajectory lacks, stay.
    assert np.array_equal(body.q[7:], scene.add(body.thing).q[7:])
    scene.loop.call(bar.play)
    wait_until(lambda: bar.now != 1.5)
    assert bar.now != 1.5 and scene.loop.failure is None
    for wrong in (lambda: scene.play(), lambda: scene.play(bar.clip, speed=0.0)):
        with pytest.raises(kinopt.InvalidValueError, match="speed"):
            wrong()


def test_curves_show_the_joints_of_a_clip(played):
    scene, body, bar = played
    scene.loop.call(bar.pause)
    curves = bar.clip.curves
    (joints,) = (group for group in curves.groups.values() if "joint4" in group)
    np.testing.assert_allclose(joints["joint4"], -curves.times)
    scene.loop.call(lambda: setattr(bar._curves._choice, "value", "tool"))
    scene.loop.call(bar._curves._draw)
    scene.loop.call(lambda: bar.scrub(1.0))
    times, *values, line = bar._curves._plot.data
    assert len(values) == 7 and times[~np.isnan(line)] == pytest.approx([0.9, 1.0])


def test_clip_is_recorded(played, tmp_path):
    scene, body, bar = played
    still = len(scene.snapshot())
    scene.record(tmp_path / "path.html", bar.clip)
    assert (tmp_path / "path.html").stat().st_size > still
    with pytest.raises(kinopt.InvalidValueError, match="browser"):
        scene.record(tmp_path / "path.gif", bar.clip)
    with pytest.raises(kinopt.InvalidValueError, match="expected html, gif, mp4"):
        scene.record(tmp_path / "path.avi", bar.clip)
    with pytest.raises(kinopt.FileError, match="nowhere"):
        scene.record(tmp_path / "nowhere" / "path.html", bar.clip)


def test_clips_play_together(played):
    scene, body, bar = played
    other = scene.add(body.thing, at=[0.0, 1.0, 0.0])
    clip = bar.clip
    late = scene.add_movement(
        kinopt.Trajectory(np.array([0.0, 1.0]), np.array([[0.0], [-1.0]]), ["joint4"], None), other
    )
    both = scene.play(clip, late)
    assert both.clip.span == (0.0, 2.0) and not bar.playing
    scene.loop.call(lambda: both.scrub(2.0))
    assert body.q[3] == -2.0 and other.q[3] == -1.0


def test_page_opens_with_collision_free_motion():
    steps = MODELS / "captures" / "steps.bvh"
    page = open_page(NAO, port=8252, retarget=steps, fps=10, keep_clear=0.002)
    with page.scene:
        robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
        movement = kinopt.retarget(steps, robot, fps=10, keep_clear=0.002)
        page._played[0].show(2.0)
        assert np.array_equal(page.body.q, movement.q[20])


def test_rig_follows_the_movement():
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    names, positions = person()
    positions[:, :, 0] += 0.02 * np.arange(len(positions))[:, None]
    movement = kinopt.retarget(positions, rig, "smpl", fps=30)
    with Scene(port=8251) as scene:
        body = scene.add(rig)
        clip = scene.add_movement(movement, body, beside=None)
        clip.show(0.0)
        start = body.frame("pelvis")[:3, 3]
        clip.show(clip.span[1])
        moved = body.frame("pelvis")[:3, 3] - start
        assert clip.person is None and moved[0] > 0.1
        assert np.array_equal(body.q, movement.q[-1, 7:])


def test_bones_connect_points_of_constant_distance():
    # A chain of three whose ends come near each other, and one next to it.
    turn = np.linspace(0.0, 2.5, 40)
    positions = np.zeros((40, 4, 3))
    positions[:, 1, 0] = 1.0
    positions[:, 2, 0] = 1.0 + np.cos(turn)
    positions[:, 2, 1] = np.sin(turn)
    positions[:, 3] = positions[:, 2] + [0.0, 0.0, 0.5]
    assert {tuple(sorted(bone)) for bone in bones_of(positions).tolist()} == {(0, 1), (1, 2), (2, 3)}
    assert JOINTS and bones_of(positions[:, :1]).shape == (0, 2)
