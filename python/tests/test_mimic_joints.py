"""Mimic joints follow their source joints in every configuration of a robot, and restrict them only on request."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"


def gripper(limits=(0.0, 0.5), offset=0.1, **options):
    """A drive from -0.2 to 0.8 rad, and a second finger, a mimic joint at twice its angle."""
    text = f"""<robot name="gripper"><link name="palm"/><link name="left"/><link name="right"/><link name="tip"/>
      <joint name="drive" type="revolute"><parent link="palm"/><child link="left"/><limit lower="-0.2" upper="0.8"/></joint>
      <joint name="other" type="revolute"><parent link="palm"/><child link="right"/><axis xyz="0 0 1"/>
        <limit lower="{limits[0]}" upper="{limits[1]}"/><mimic joint="drive" multiplier="2" offset="{offset}"/></joint>
      <joint name="end" type="fixed"><parent link="right"/><child link="tip"/><origin xyz="0.5 0 0"/></joint></robot>"""
    return kinopt.Robot.from_urdf_text(text, "gripper.urdf", **options)


def test_mimic_limits_restrict_the_source_on_request():
    free, both = gripper(), gripper(mimic_limits="both")
    for robot, (lower, upper) in [(free, (-0.2, 0.8)), (both, (-0.05, 0.2))]:
        map = kinopt.ParameterMap(robot)
        np.testing.assert_allclose([map.lower[0], map.upper[0]], [lower, upper], atol=1e-15)
        for twin in (robot, pickle.loads(pickle.dumps(robot))):
            np.testing.assert_array_equal(kinopt.ParameterMap(twin).lower, map.lower)
    assert len(free.repairs) == 1 and not both.repairs
    assert "`drive`" in free.repairs[0] and "`other`" in free.repairs[0]
    with pytest.raises(kinopt.UnknownNameError, match="source"):
        gripper(mimic_limits="none")


def test_configurations_of_a_robot_honour_mimic_joints():
    robot = gripper()
    np.testing.assert_array_equal(robot.neutral(), [0.0, 0.1])
    tip = kinopt.frame_placement(robot, "tip", robot.neutral())[:3, 3]
    np.testing.assert_allclose(tip, [0.5 * np.cos(0.1), 0.5 * np.sin(0.1), 0.0], atol=1e-15)
    many = robot.random_configuration(50, seed=4)
    np.testing.assert_allclose(many[:, 1], 2.0 * many[:, 0] + 0.1, atol=1e-15)
    assert np.ptp(many[:, 0]) > 0.8
    np.testing.assert_array_equal(many[3], robot.random_configuration(seed=7))
    assert all(robot.is_within_limits(q) for q in many)
    assert not robot.is_within_limits(many[0] + [0.0, 1e-6])
    np.testing.assert_array_equal(robot.apply_mimics([0.3, 9.0]), [0.3, 0.7])
    np.testing.assert_array_equal(robot.apply_mimics(many * [1.0, 0.0]), many)
    with pytest.raises(kinopt.InvalidValueError):
        robot.apply_mimics([0.3])


@pytest.mark.parametrize("file", sorted(MODELS.glob("*.urdf")), ids=lambda file: file.stem)
def test_residual_takes_random_configurations(file):
    robot = kinopt.Robot.from_urdf(file)
    problem = kinopt.Problem(robot, [tasks.Point(robot.tips[0], [0.1, 0.2, 0.3])])
    for seed in range(5):
        q = robot.random_configuration(seed=seed)
        assert robot.is_within_limits(q)
        tip = kinopt.frame_placement(robot, robot.tips[0], q)[:3, 3]
        np.testing.assert_allclose(np.linalg.norm(problem.residual(q)), np.linalg.norm(tip - [0.1, 0.2, 0.3]), atol=1e-9)
