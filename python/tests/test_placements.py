"""Placements from positions and rotations in all representations; rounded ones become rigid."""

import numpy as np
import pytest

import kinopt


def rotations(n):
    q = np.random.default_rng(2).normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def test_quaternion_orders_rotate_equally():
    wxyz = rotations(50)
    placed = kinopt.placement(np.arange(150.0).reshape(50, 3), wxyz=wxyz)
    assert np.array_equal(placed, kinopt.placement(np.arange(150.0).reshape(50, 3), xyzw=np.roll(wxyz, -1, 1)))
    v = np.array([0.3, -0.2, 0.9])
    u, w = wxyz[:, 1:], wxyz[:, :1]
    turned = v + 2 * np.cross(u, np.cross(u, v) + w * v)
    assert np.allclose(placed[:, :3, :3] @ v, turned, atol=1e-14)
    assert np.array_equal(placed[:, :3, 3], np.arange(150.0).reshape(50, 3))
    assert np.array_equal(placed[:, 3], np.tile([0.0, 0, 0, 1], (50, 1)))


def test_rounded_numbers_become_valid_poses():
    robot = kinopt.ModelBuilder("hinge")
    robot.joint("hinge", lower=-3, upper=3)
    robot.frame("tip", "hinge")
    arm = kinopt.Arm(robot.build(), None, "tip")
    for digits in (2, 4, 6):
        rough = kinopt.placement(wxyz=rotations(40)).round(digits)
        assert not arm.solve_batch(kinopt.placement(matrix=rough)).reached.all()
        assert np.abs(kinopt.placement(matrix=rough) - rough).max() < 10.0**-digits
    with pytest.raises(kinopt.InvalidValueError):
        arm.solve(kinopt.placement(wxyz=rotations(1)[0]).round(3))


@pytest.mark.parametrize(
    "wrong",
    [
        {"wxyz": [0, 0, 0, 0]},
        {"wxyz": [1, 0, 0]},
        {"wxyz": [1, 0, 0, 0], "xyzw": [0, 0, 0, 1]},
        {"matrix": np.diag([1.0, 1, -1])},
        {"matrix": 2 * np.eye(3)},
        {"matrix": np.eye(2)},
        {"position": [0, 1]},
        {"position": [0, 0, np.nan]},
        {"position": ["a", "b", "c"]},
        {"position": np.zeros((3, 3)), "wxyz": np.ones((2, 4))},
    ],
)
def test_invalid_placement_raises(wrong):
    with pytest.raises(kinopt.InvalidValueError):
        kinopt.placement(**wrong)
