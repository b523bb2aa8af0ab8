"""Robots from MJCF: MuJoCo's placements, its `qpos`, pickles without the file, errors with names."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt

FOLDER = Path(__file__).parents[2] / "tests" / "robot" / "mjcf"
REFERENCE = json.loads((FOLDER / "mujoco_placements.json").read_text())


@pytest.mark.parametrize("reference", REFERENCE["files"], ids=lambda reference: reference["file"])
def test_bodies_match_mujoco_also_in_copies(reference):
    robot = kinopt.Robot.from_mjcf(FOLDER / "files" / reference["file"])
    for model in (robot.model, pickle.loads(pickle.dumps(robot)).model):
        kinematics = kinopt.ForwardKinematics(model)
        for case in reference["configurations"]:
            placed = np.asarray(kinematics.place(case["q"]))
            for i, (name, numbers) in enumerate(case["bodies"]):
                assert name in (None, model.frame_names[i])
                np.testing.assert_allclose(placed[i][:3, 3], numbers[:3], atol=1e-12)
                np.testing.assert_allclose(placed[i][:3, :3].ravel(), numbers[3:], atol=1e-12)


def test_loops_and_mimic_joints_are_listed():
    robot = kinopt.Robot.from_mjcf(FOLDER / "files" / "gripper.xml")
    assert robot.mimics["right"] == ("left", -1.5, pytest.approx(0.1))
    names = [(name, kind) for name, kind, _, _ in robot.loops]
    assert names[:3] == [("bar", "connect"), ("left/connect", "connect"), ("hold", "weld")]
    _, _, frames, placements = robot.loops[0]
    assert frames == ["left_tip", "right_tip"]
    np.testing.assert_allclose(placements[0][:3, 3], [0.01, 0.02, 0.03], atol=0)


def test_omissions_are_reported_with_lines(tmp_path):
    path = tmp_path / "hand.xml"
    lines = [
        '<mujoco><worldbody><body name="target" mocap="true"/>',
        '<body name="hand"><joint name="wrist" axis="0 0 1"/></body></worldbody>',
        '<equality><weld name="reach" body1="hand" body2="target"/></equality></mujoco>',
    ]
    path.write_text("\n".join(lines))
    robot = kinopt.Robot.from_mjcf(path)
    line = int(robot.repairs[0].split(":")[0])
    assert 'name="reach"' in lines[line - 1] and "mocap" in robot.repairs[0]


def test_base_joint_is_added():
    robot = kinopt.Robot.from_mjcf(FOLDER / "files" / "gripper.xml", base_joint="free")
    assert len(robot.neutral()) == 7 + 6


def test_faults_name_file_and_line(tmp_path):
    path = tmp_path / "robot.xml"
    with pytest.raises(kinopt.FileError):
        kinopt.Robot.from_mjcf(path)
    path.write_text('<mujoco>\n<worldbody><body quat="0 0 0 0"/></worldbody></mujoco>')
    with pytest.raises(kinopt.InvalidFileError, match=r"robot.xml:2: .*quat"):
        kinopt.Robot.from_mjcf(path)
    path.write_text("<robot/>")
    with pytest.raises(kinopt.InvalidFileError, match="<mujoco>"):
        kinopt.Robot.from_mjcf(path)
