"""Kinematics with the interface of LeRobot."""

import inspect

import numpy as np
import pytest

import kinopt
from kinopt.lerobot import RobotKinematics

MOTORS = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]


@pytest.fixture
def so101():
    return RobotKinematics(str(kinopt.models.path("so101")), "gripper_frame_link", MOTORS)


def cost_of(kinematics, degrees, target, position_weight, orientation_weight):
    """Weighted sum of the squared distance and the squared angle to a target."""
    pose = kinematics.forward_kinematics(degrees)
    turn = pose[:3, :3].T @ target[:3, :3]
    sine = np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    angle = np.arctan2(sine, (np.trace(turn) - 1) / 2)
    return position_weight * ((pose[:3, 3] - target[:3, 3]) ** 2).sum() + orientation_weight * angle**2


def tilted(pose, angle):
    """A pose rotated about the y axis of the world, which an arm of five joints cannot follow in general."""
    c, s = np.cos(angle), np.sin(angle)
    turned = pose.copy()
    turned[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]] @ pose[:3, :3]
    return turned


def test_arguments_are_those_of_lerobot():
    def arguments(function):
        parameters = [p for p in inspect.signature(function).parameters.values() if p.kind is not p.KEYWORD_ONLY]
        return {p.name: p.default for p in parameters if p.name != "self"}

    required = inspect.Parameter.empty
    assert arguments(RobotKinematics) == {"urdf_path": required, "target_frame_name": "gripper_frame_link", "joint_names": None}
    assert arguments(RobotKinematics.forward_kinematics) == {"joint_pos_deg": required}
    assert arguments(RobotKinematics.inverse_kinematics) == {
        "current_joint_pos": required, "desired_ee_pose": required, "position_weight": 1.0, "orientation_weight": 0.01
    }


def test_default_joint_names_begin_with_the_chain(so101):
    assert RobotKinematics(kinopt.models.path("so101")).joint_names == so101.joint_names == MOTORS


def test_forward_kinematics_takes_degrees(so101):
    degrees = np.array([30.0, -20, 40, 10, 80, 55])
    arm = kinopt.Arm(kinopt.models.so101(), "base_link", "gripper_frame_link")
    expected = arm.base_from_tool(np.deg2rad(degrees[:5]))
    np.testing.assert_allclose(so101.forward_kinematics(degrees), expected, atol=1e-15)


def test_reachable_poses_are_reached_in_one_call(so101):
    random = np.random.default_rng(1)
    for _ in range(50):
        there = random.uniform(-50, 50, 6)
        here = there + random.uniform(-10, 10, 6)
        target = so101.forward_kinematics(there)
        found = so101.inverse_kinematics(here, target)
        assert found.shape == (6,) and found[5] == here[5]
        np.testing.assert_allclose(so101.forward_kinematics(found), target, atol=2e-6)


def test_joints_after_the_names_pass_through_in_their_type(so101):
    five = RobotKinematics(kinopt.models.path("so101"), joint_names=MOTORS[:5])
    here = np.array([10, 20, 30, 10, 0, 77, 5], dtype=np.float32)
    found = five.inverse_kinematics(here, five.forward_kinematics(here[:5] + 3))
    assert found.dtype == np.float32 and found[5:].tolist() == [77, 5]
    np.testing.assert_allclose(found[:5], here[:5] + 3, atol=1e-3)
    assert five.inverse_kinematics(here[:5], five.forward_kinematics(here)).dtype == np.float64


@pytest.mark.parametrize("weights", [(1.0, 0.01), (1.0, 1.0), (5.0, 1e-4)])
def test_weights_trade_position_for_orientation(so101, weights):
    random = np.random.default_rng(2)
    for _ in range(20):
        here = np.append(random.uniform(-40, 40, 5), 0)
        target = tilted(so101.forward_kinematics(here), 0.3)
        found = so101.inverse_kinematics(here, target, *weights)
        best = cost_of(so101, found, target, *weights)
        assert best < cost_of(so101, here, target, *weights)
        for step in np.concatenate([np.eye(5), -np.eye(5), random.normal(size=(20, 5))]):
            other = found + np.append(0.2 * step, 0)
            assert cost_of(so101, other, target, *weights) > best * (1 - 1e-9)


def test_zero_weights_free_position_or_orientation(so101):
    here = np.array([0.0, 10, 20, 30, 40, 0])
    target = tilted(so101.forward_kinematics(here), 0.3)
    target[:3, 3] += [0.02, 0.03, 0.01]
    by_position = so101.inverse_kinematics(here, target, orientation_weight=0.0)
    np.testing.assert_allclose(so101.forward_kinematics(by_position)[:3, 3], target[:3, 3], atol=2e-6)
    by_orientation = so101.inverse_kinematics(here, target, position_weight=0.0)
    np.testing.assert_allclose(so101.forward_kinematics(by_orientation)[:3, :3], target[:3, :3], atol=2e-6)


def test_results_are_within_limits_and_do_not_jump(so101):
    here, steps = np.array([0.0, 0, 0, 0, 0, 0]), []
    for along in np.linspace(0, 1, 200):
        target = np.eye(4)
        target[:3, :3] = so101.forward_kinematics(np.zeros(6))[:3, :3]
        target[:3, 3] = [0.1 + 0.5 * along, 0.2 * np.sin(6 * along), 0.25]  # leaves the reach
        there = so101.inverse_kinematics(here, target)
        steps.append(abs(there - here).max())
        here = there
        robot = kinopt.models.so101()
        assert (np.deg2rad(here) >= robot.lower - 1e-15).all() and (np.deg2rad(here) <= robot.upper + 1e-15).all()
    assert max(steps[1:]) < 15


def test_attempts_find_far_poses():
    searching = RobotKinematics(kinopt.models.path("so101"), attempts=50)
    random = np.random.default_rng(3)
    for _ in range(50):
        target = searching.forward_kinematics(random.uniform(-90, 90, 6))
        found = searching.inverse_kinematics(random.uniform(-90, 90, 6), target)
        np.testing.assert_allclose(searching.forward_kinematics(found), target, atol=2e-6)


def test_joints_that_are_not_named_stay_at_zero():
    two = RobotKinematics(kinopt.models.path("so101"), joint_names=["elbow_flex", "shoulder_pan"])
    target = two.forward_kinematics([20, 10])
    np.testing.assert_allclose(two.inverse_kinematics([0, 0], target), [20, 10], atol=1e-3)
    all_joints = RobotKinematics(kinopt.models.path("so101"))
    np.testing.assert_allclose(all_joints.forward_kinematics([10, 0, 20, 0, 0, 0]), target, atol=1e-4)


def test_invalid_arguments_are_named(so101):
    path = kinopt.models.path("so101")
    with pytest.raises(kinopt.UnknownNameError, match="no joint named `wrist`; joints: shoulder_pan"):
        RobotKinematics(path, joint_names=["wrist"])
    with pytest.raises(kinopt.UnknownNameError, match="gripper"):
        RobotKinematics(path, "gripper")
    with pytest.raises(kinopt.InvalidValueError, match=r"shape \(6,\) or longer, not \(5,\)"):
        so101.forward_kinematics(np.zeros(5))
    with pytest.raises(kinopt.InvalidValueError, match="not both 0"):
        so101.inverse_kinematics(np.zeros(6), np.eye(4), 0, 0)
    with pytest.raises(kinopt.InvalidValueError):
        so101.inverse_kinematics(np.zeros(6), np.ones((4, 4)))
