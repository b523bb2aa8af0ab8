"""Models of the package are the files of the repository, and load by name."""

from pathlib import Path

import numpy as np
import pytest

import kinopt

SHIPPED = Path(__file__).parents[2] / "models"

# Joints from the base to the gripper frame of SO-ARM100's so101_new_calib.urdf: position (m), fixed-axis angles (rad),
# and limits (rad) if the joint moves about its z.
SO101 = [
    ((0.0388353, -8.97657e-09, 0.0624), (3.14159, 4.18253e-17, -3.14159), (-1.91986, 1.91986)),
    ((-0.0303992, -0.0182778, -0.0542), (-1.5708, -1.5708, 0), (-1.74533, 1.74533)),
    ((-0.11257, -0.028, 1.73763e-16), (-3.63608e-16, 8.74301e-16, 1.5708), (-1.69, 1.69)),
    ((-0.1349, 0.0052, 3.62355e-17), (4.02456e-15, 8.67362e-16, -1.5708), (-1.65806, 1.65806)),
    ((5.55112e-17, -0.0611, 0.0181), (1.5708, 0.0486795, 3.14159), (-2.74385, 2.84121)),
    ((-0.0079, -0.000218121, -0.0981274), (0, 3.14159, 0), None),
]


def turned(axis, angle):
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix = np.eye(4)
    matrix[[i, j], [i, j]] = np.cos(angle)
    matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
    return matrix


@pytest.mark.parametrize("name", kinopt.models.names())
def test_each_model_loads_and_equals_its_file(name):
    path = kinopt.models.path(name)
    (original,) = SHIPPED.rglob(path.name)
    assert path.read_bytes() == original.read_bytes()
    model = getattr(kinopt.models, name)()
    if path.suffix == ".urdf":
        assert model.name == path.stem
        assert model.frame_names == kinopt.Robot.from_urdf(original).frame_names


def test_package_contains_every_shipped_robot():
    packaged = {kinopt.models.path(name).name for name in kinopt.models.names()}
    assert {path.name for path in SHIPPED.glob("*.urdf")} <= packaged


def test_base_joint_frees_a_robot():
    assert kinopt.models.nao(base_joint="free").configuration_len == kinopt.models.nao().configuration_len + 7


def test_unknown_model_error_lists_models():
    with pytest.raises(kinopt.UnknownNameError, match="no model named `pr2`; models: baxter, .*ur5e"):
        kinopt.models.path("pr2")


def test_so101_equals_its_published_joints():
    arm = kinopt.Arm(kinopt.models.so101(), "base_link", "gripper_frame_link")
    limits = [limits for *_, limits in SO101 if limits]
    np.testing.assert_array_equal(np.transpose([arm.lower, arm.upper]), limits)
    for q in np.random.default_rng(1).uniform(arm.lower, arm.upper, (20, 5)):
        placed, angles = np.eye(4), iter(q)
        for position, (roll, pitch, yaw), moves in SO101:
            joint = turned(2, yaw) @ turned(1, pitch) @ turned(0, roll)
            joint[:3, 3] = position
            placed = placed @ joint @ (turned(2, next(angles)) if moves else np.eye(4))
        np.testing.assert_allclose(arm.base_from_tool(q), placed, atol=1e-14)


def test_so101_at_zero_is_free_of_self_collisions():
    robot = kinopt.models.so101()
    arm = kinopt.Arm(robot, "base_link", "gripper_frame_link", world=kinopt.World())
    assert not arm.collisions(np.zeros(5))
    # Folded, the gripper overlaps the base.
    assert arm.collisions([0, -1.7, 1.6, 1.6, 0])


def test_unknown_function_error_lists_models():
    with pytest.raises(AttributeError, match="no model named `g1`.*panda"):
        kinopt.models.g1()  # type: ignore[attr-defined]
