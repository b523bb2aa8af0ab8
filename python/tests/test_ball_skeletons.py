"""Bones on ball joints: conversion between poses and configurations, solutions within their cones, invalid input."""

from __future__ import annotations

import copy
import json
import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

WAVE = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 4 Xposition Yposition Zposition Yrotation
  JOINT Arm
  {
    OFFSET 0 4 0
    CHANNELS 2 Zrotation Xrotation
    End Site { OFFSET 3 0 0 }
  }
}
MOTION
Frames: 2
Frame Time: 0.25
0 0 0 0 0 0
1 2 5 90 90 0
"""
HALF = math.sqrt(0.5)


@pytest.fixture
def wave(tmp_path: Path) -> Path:
    path = tmp_path / "wave.bvh"
    path.write_text(WAVE)
    return path


def test_captured_pose_and_configuration_convert(wave: Path) -> None:
    capture = kinopt.MotionCapture.read(wave)
    figure = kinopt.BallSkeleton.read(wave, root="free")
    pose = capture.clip.sample(0.25)
    q = figure.configuration(pose)
    np.testing.assert_allclose(q, [1, 2, 5, HALF, 0, HALF, 0, HALF, 0, 0, HALF], atol=1e-6)
    placed = figure.pose(q)
    tip = figure.bone_names.index("Arm/tip")
    np.testing.assert_allclose(placed[tip, :3, 3], [1, 9, 5], atol=1e-5)
    np.testing.assert_allclose(figure.pose(np.stack([q, q]))[1], placed)
    back = figure.to_pose(q)
    np.testing.assert_allclose(back.translations, pose.translations, atol=1e-5)
    assert figure.joints("Hips") == ["Hips/x", "Hips/y", "Hips/z", "Hips/rotation"]
    assert figure.joints("Arm/tip") == []
    rest = figure.model.neutral()
    np.testing.assert_allclose(figure.skinning_transforms(rest), np.tile(np.eye(4), (3, 1, 1)), atol=1e-12)


def test_solutions_stay_within_cones_of_file_or_dict(wave: Path, tmp_path: Path) -> None:
    side = tmp_path / "cones.json"
    side.write_text(json.dumps({"Arm": {"swing": 30, "twist": [-10, 10]}}))
    twist = math.radians(10)
    given = {"Arm": {"swing": math.radians(30), "twist": (-twist, twist)}}
    for cones in (side, given):
        figure = kinopt.BallSkeleton.read(wave, cones=cones)
        # The hips rotate too, so only the arm's swing reaches the target.
        goal = tasks.Point("Arm/tip", [0.0, 7.0, 0.0])
        problem = kinopt.Problem(figure.model, [goal])
        solution = kinopt.Solver().solve(problem, figure.model.neutral())
        assert not solution.reached
        w, x, y, z = solution.q[4:]
        assert 2 * math.hypot(y, z) <= 2 * math.sin(math.radians(15)) + 1e-9
        assert any(limit.joint == "Arm swing" for limit in solution.active_limits)


def test_skeleton_is_pickled_and_copied(wave: Path) -> None:
    cones = {"Arm": {"swing": (0.5, 0.25), "about": [0, 1, 0], "axis": [1, 0, 0], "twist": (-0.1, 0.2)}}
    figure = kinopt.BallSkeleton.read(wave, cones=cones, root="free", bounds={"y": (-1.0, 1.0)})
    q = figure.model.random_configuration(seed=3)
    for again in (pickle.loads(pickle.dumps(figure)), copy.deepcopy(figure)):
        assert repr(again) == repr(figure)
        np.testing.assert_array_equal(again.pose(q), figure.pose(q))
        np.testing.assert_array_equal(again.model.random_configuration(seed=3), q)


def test_rig_skeleton_has_ball_joints() -> None:
    rig = kinopt.Rig.read(Path(__file__).parents[2] / "models" / "humanoid" / "humanoid.json")
    figure = kinopt.BallSkeleton(rig.skeleton)
    assert figure.model.degrees_of_freedom == 3 * len(figure.bone_names)
    rest = figure.pose(figure.model.neutral())
    np.testing.assert_allclose(rest, rig.skeleton.pose(np.zeros(rig.skeleton.angles)), atol=1e-12)


def test_total_angle_is_equal_in_file_and_dict(wave: Path, tmp_path: Path) -> None:
    side = tmp_path / "angle.json"
    side.write_text('{"Arm": {"angle": 30}}')
    for cones in (side, {"Arm": {"angle": np.radians(30)}}):
        figure = kinopt.BallSkeleton.read(wave, cones=cones)
        for skeleton in (figure, pickle.loads(pickle.dumps(figure))):
            (arm,) = (joint for joint in skeleton.model.joints if joint.name == "Arm")
            assert arm.angle == pytest.approx(np.radians(30), abs=1e-15)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"cones": {"Amr": {"swing": 1.0}}}, kinopt.UnknownNameError, "Arm"),
        ({"cones": {"Arm": {"swnig": 1.0}}}, kinopt.UnknownNameError, "swing"),
        ({"cones": {"Arm": {"swing": 4.0}}}, kinopt.InvalidValueError, "swing"),
        ({"cones": {"Arm": {"swing": (1.0, 0.5)}}}, kinopt.InvalidValueError, "about"),
        ({"cones": {"Arm": {"angle": 4.0}}}, kinopt.InvalidValueError, "angle of Arm"),
        ({"cones": {"Arm": {"angle": "far"}}}, kinopt.InvalidValueError, "angle of Arm"),
        ({"cones": {"Arm": {"twist": 1.0}}}, kinopt.InvalidValueError, "twist"),
        ({"cones": {"Arm/tip": {"swing": 1.0}}}, kinopt.InvalidValueError, "is locked"),
        ({"cones": {"Hips": {"swing": 1.0}}, "root": "free"}, kinopt.InvalidValueError, "free root"),
        ({"cones": 3}, kinopt.InvalidValueError, "cones"),
        ({"cones": "no such file.json"}, kinopt.FileError, "no such file"),
        ({"root": "planar"}, kinopt.UnknownNameError, "free"),
        ({"bounds": {"x": (0.0, 1.0)}}, kinopt.UnknownNameError, "x"),
        ({"root": "free", "bounds": {"x": 1.0}}, kinopt.InvalidValueError, "bounds"),
    ],
)
def test_invalid_arguments_raise(wave: Path, arguments: dict, error: type, words: str) -> None:
    with pytest.raises(error, match=words):
        kinopt.BallSkeleton.read(wave, **arguments)
