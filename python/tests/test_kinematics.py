"""Forward kinematics of frames, for one configuration and for several."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"


def two_links():
    builder = kinopt.ModelBuilder("two links")
    out = np.eye(4)
    out[0, 3] = 1.0
    builder.joint("shoulder", axis=[0, 0, 2.0], lower=-2.5, upper=2.5)
    builder.joint("elbow", "revolute", "shoulder", out, [0, 0, 1], -2.5, 2.5)
    builder.frame("tip", "elbow", out)
    return builder.build()


def test_planar_arm_matches_trigonometry():
    model = two_links()
    q = np.random.default_rng(1).uniform(-2.5, 2.5, (50, 2))
    tip = kinopt.frame_placement(model, "tip", q)
    a, b = q[:, 0], q[:, 0] + q[:, 1]
    assert np.allclose(tip[:, 0, 3], np.cos(a) + np.cos(b), atol=1e-14)
    assert np.allclose(tip[:, 1, 3], np.sin(a) + np.sin(b), atol=1e-14)
    assert np.allclose(tip[:, 0, 0], np.cos(b), atol=1e-14)
    assert np.array_equal(tip[7], kinopt.frame_placement(model, "tip", q[7]))


def test_jacobians_are_the_derivatives_of_placements():
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    kinematics = kinopt.ForwardKinematics(robot, ["flange", "link4"])
    jacobian = kinopt.Jacobian(robot, ["flange", "link4"])
    q = robot.random_configuration(5, seed=1)
    step = 1e-6
    many = jacobian.at(q)
    assert many.shape == (5, 12, 9)
    for j in range(9):
        move = np.zeros(9)
        move[j] = step
        ahead, behind = kinematics.place(q + move), kinematics.place(q - move)
        velocity = (ahead - behind)[:, :, :3, 3] / (2 * step)
        assert np.allclose(many[:, [0, 1, 2], j], velocity[:, 0], atol=1e-8)
        assert np.allclose(many[:, [6, 7, 8], j], velocity[:, 1], atol=1e-8)
        spin = (ahead - behind)[:, 0, :3, :3] / (2 * step) @ kinematics.place(q)[:, 0, :3, :3].swapaxes(1, 2)
        assert np.allclose(many[:, 5, j], spin[:, 1, 0], atol=1e-8)


def test_lists_floats_and_strides_are_converted():
    model = two_links()
    q = np.array([[0.25, 0.5], [1.0, -0.75]])
    want = kinopt.frame_placement(model, "tip", q)
    for same in (q.tolist(), q.astype(np.float32), np.asfortranarray(q), np.repeat(q, 2, 0)[::2]):
        assert np.array_equal(kinopt.frame_placement(model, "tip", same), want)


def test_models_pickle():
    model = two_links()
    for twin in (pickle.loads(pickle.dumps(model)), copy.deepcopy(model)):
        q = [0.3, -0.4]
        assert np.array_equal(
            kinopt.frame_placement(twin, "tip", q), kinopt.frame_placement(model, "tip", q)
        )
    kinematics = pickle.loads(pickle.dumps(kinopt.ForwardKinematics(model)))
    assert kinematics.frame_names == ["tip"]


@pytest.mark.parametrize("q", [[0.1], [[0.1, 0.2, 0.3]], [np.nan, 0.0], ["a", "b"], [1j, 0], None])
def test_invalid_configuration_raises(q):
    with pytest.raises(kinopt.InvalidValueError):
        kinopt.frame_placement(two_links(), "tip", q)
