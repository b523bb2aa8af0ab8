"""Properties of robots, from files and from text, and pickling to other processes."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"


def panda():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def test_names_and_limits_are_in_configuration_order():
    robot = panda()
    assert len(robot.joint_names) == robot.degrees_of_freedom == 9
    assert robot.joint_names[0] == "joint1"
    assert robot.lower.shape == robot.upper.shape == (9,)
    assert (robot.lower < robot.upper).all()
    assert {"base", "flange", "tool"} <= set(robot.frame_names)


def test_pickles_and_copies_are_equal():
    tool = np.eye(4)
    tool[2, 3] = 0.1
    robot = panda().with_tool("pen", "flange", tool)
    for twin in (pickle.loads(pickle.dumps(robot)), copy.deepcopy(robot)):
        assert twin.joint_names == robot.joint_names
        assert twin.frame_names == robot.frame_names
        assert np.array_equal(twin.random_configuration(5, seed=3), robot.random_configuration(5, seed=3))


def test_random_configurations_are_within_limits():
    robot = panda()
    q = robot.random_configuration(100, seed=7)
    assert q.shape == (100, 9)
    assert (q >= robot.lower).all() and (q <= robot.upper).all()
    assert np.array_equal(q[3], robot.random_configuration(seed=10))
    drawn = robot.random_configuration(4, seed=np.random.default_rng(1))
    assert np.array_equal(drawn, robot.random_configuration(4, seed=np.random.default_rng(1)))


def test_invalid_arguments_are_named():
    with pytest.raises(kinopt.UnknownNameError, match="no frame named `nowhere`"):
        panda().chain("base", "nowhere")
    with pytest.raises(kinopt.FileError):
        kinopt.Robot.from_urdf("no such file.urdf")
    with pytest.raises(kinopt.InvalidFileError):
        kinopt.Robot.from_urdf_text("<robot")
