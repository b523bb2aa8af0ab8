"""Placements, configurations and numbers of joints in every form that Python users write."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.errors import InvalidValueError, UnknownNameError

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot() -> kinopt.Robot:
    return kinopt.Robot.read(MODELS / "franka_panda.urdf")


@pytest.fixture(scope="module")
def arm(robot: kinopt.Robot) -> kinopt.Arm:
    return kinopt.Arm(robot, "base", "tool")


def turn(axis: int, angle: float) -> np.ndarray:
    matrix, (i, j) = np.eye(3), [(1, 2), (2, 0), (0, 1)][axis]
    matrix[[i, i, j, j], [i, j, i, j]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    return matrix


RPY = (3.0, 0.2, -0.4)
ROTATION = turn(2, RPY[2]) @ turn(1, RPY[1]) @ turn(0, RPY[0])
POSITION = np.array([0.45, 0.1, 0.4])


def quaternion() -> np.ndarray:
    half = np.array(RPY) / 2
    (sr, sp, sy), (cr, cp, cy) = np.sin(half), np.cos(half)
    return np.array([
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ])


class Rotation:
    """Rotation of another library, as scipy's."""

    def as_matrix(self) -> np.ndarray:
        return ROTATION


def forms() -> list[object]:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = ROTATION, POSITION
    wxyz = quaternion()
    return [
        matrix,
        matrix.tolist(),
        np.concatenate([POSITION, wxyz]),
        (POSITION, wxyz),
        (POSITION.tolist(), tuple(wxyz)),
        (POSITION, RPY),
        (POSITION, ROTATION),
        (POSITION, Rotation()),
        kinopt.placement(POSITION, rpy=RPY),
    ]


@pytest.mark.parametrize("form", forms())
def test_every_form_is_one_placement(arm: kinopt.Arm, form: object) -> None:
    solution = arm.solve(form)  # type: ignore[arg-type]
    assert solution.reached
    reached = arm.base_from_tool(solution.q)
    assert np.allclose(reached[:3, :3], ROTATION, atol=1e-5) and np.allclose(reached[:3, 3], POSITION, atol=1e-5)
    assert arm.solve_batch([form]).reached.all()  # type: ignore[list-item]
    assert np.allclose(kinopt.interpolate(form, form, 0.5), forms()[0], atol=1e-12)  # type: ignore[arg-type]
    assert np.allclose(kinopt.CartesianPath(form).points, [forms()[0]], atol=1e-12)  # type: ignore[arg-type]


def test_batches_are_stacks_in_every_form(arm: kinopt.Arm) -> None:
    positions = POSITION + np.linspace(0, 0.1, 5)[:, None] * [0, 1, 0]
    wxyz = np.tile(quaternion(), (5, 1))
    expected = arm.solve_batch(kinopt.placement(positions, wxyz=wxyz))
    assert expected.reached.all()
    for stack in (
        np.hstack([positions, wxyz]),
        (positions, wxyz),
        (positions, np.tile(RPY, (5, 1))),
        (positions, np.tile(ROTATION, (5, 1, 1))),
        list(zip(positions, wxyz)),
    ):
        batch = arm.solve_batch(stack)  # type: ignore[arg-type]
        assert np.allclose(batch.q, expected.q, atol=1e-6)
        assert arm.track(stack).q.shape == (5, 7)  # type: ignore[arg-type]
    assert batch[3].reached and np.array_equal(batch[3].q, batch.q[3])


def test_positions_need_a_goal_of_positions(arm: kinopt.Arm, robot: kinopt.Robot) -> None:
    needs_goal = pytest.raises(InvalidValueError, match='goal="position"')
    for call in (
        lambda: arm.solve(POSITION),
        lambda: arm.solve_batch([POSITION]),
        lambda: arm.track(POSITION[None]),
        lambda: arm.follower().advance(POSITION),
        lambda: arm.servo(arm.default_start, 0.01).step(POSITION),
        lambda: kinopt.tasks.Pose("tool", POSITION),
        lambda: kinopt.tasks.FrameVelocity("tool", POSITION, 0.1),
    ):
        with needs_goal:
            call()
    with pytest.raises(InvalidValueError, match='goal "position"'):
        kinopt.solve_path(arm, POSITION[None])
    seeking = kinopt.Arm(robot, "base", "tool", goal="position")
    for other in (seeking, arm.with_goal("position")):
        solution = other.solve(POSITION)
        assert solution.reached and np.allclose(other.base_from_tool(solution.q)[:3, 3], POSITION, atol=1e-5)
    assert kinopt.solve_path(seeking, [POSITION, POSITION + [0, 0.01, 0]]).reached
    problem = kinopt.Problem(robot, [kinopt.tasks.Pose("tool", POSITION, goal="position", name="hand")])
    moved = kinopt.Solver().solve(problem, {"joint4": -2.0}, {"hand": POSITION + [0, 0, 0.1]})
    assert moved.reached
    full = kinopt.Problem(robot, [kinopt.tasks.Pose("tool", (POSITION, RPY), name="hand")])
    with needs_goal:
        kinopt.Solver().solve(full, {}, {"hand": POSITION})


@pytest.mark.parametrize("wrong", [np.eye(3), [1.0, 2.0], 1.0, (POSITION, [1.0, 2.0]), [[1, 2, 3], [4, 5, 6]], "tool"])
def test_ambiguous_target_lists_the_forms(arm: kinopt.Arm, wrong: object) -> None:
    with pytest.raises(InvalidValueError, match="quaternion|numbers"):
        arm.solve(wrong)  # type: ignore[arg-type]


def test_stack_of_another_shape_lists_the_forms(arm: kinopt.Arm) -> None:
    for wrong in (np.eye(4), POSITION, np.zeros((2, 5)), 1.0, (np.zeros((2, 3)), np.zeros((3, 4)))):
        with pytest.raises(InvalidValueError, match="list of placements|2 positions, but 3 rotations"):
            arm.solve_batch(wrong)
    with pytest.raises(InvalidValueError, match="length"):
        arm.solve((POSITION, [1.0, 1.0, 0.0, 0.0]))


def test_tools_and_worlds_take_positions(arm: kinopt.Arm) -> None:
    tool = arm.with_tool((0, 0, 0.1))
    assert np.allclose(tool.base_from_tool({})[:3, 3], (arm.base_from_tool({}) @ [0, 0, 0.1, 1])[:3])
    world = kinopt.World()
    world.add_box("box", (0.1, 0.1, 0.1), pose=(POSITION, RPY))
    assert np.allclose(world["box"].placement[:3, :3], ROTATION)


def test_configurations_by_name_keep_the_default_start(arm: kinopt.Arm, robot: kinopt.Robot) -> None:
    q = arm.default_start.copy()
    q[1] = 0.3
    by_name = {arm.joint_names[1]: 0.3}
    target = arm.base_from_tool(q)
    assert np.array_equal(arm.base_from_tool(by_name), target)
    assert np.array_equal(arm.jacobian(by_name), arm.jacobian(q))
    assert np.array_equal(arm.solve(target, by_name).q, arm.solve(target, q).q)
    assert np.array_equal(arm.solve_batch([target], by_name).q, arm.solve_batch([target], q).q)
    assert np.array_equal(kinopt.solve_path(arm, [target], start=by_name).q[0], q)
    neutral = robot.neutral()
    neutral[1] = 0.3
    assert np.array_equal(kinopt.frame_placement(robot, "tool", by_name), kinopt.frame_placement(robot, "tool", neutral))
    with pytest.raises(UnknownNameError, match="joint2"):
        arm.solve(target, {"joint_2": 0.3})
    with pytest.raises(UnknownNameError, match="joint2"):
        kinopt.frame_placement(robot, "tool", {"joint_2": 0.3})


def test_mimic_joints_follow_a_configuration_by_name() -> None:
    robot = kinopt.Robot.read(MODELS / "franka_panda.urdf")
    fingers = [k for k, name in enumerate(robot.joint_names) if "finger" in name]
    q = robot.apply_mimics({robot.joint_names[fingers[0]]: 0.03})
    assert np.array_equal(q[fingers], [0.03, 0.03])


def test_one_number_is_for_all_joints(robot: kinopt.Robot) -> None:
    options = {"joint_weights": 2.0, "max_move": 0.1}
    arm = kinopt.Arm(robot, "base", "tool", **options)  # type: ignore[arg-type]
    listed = kinopt.Arm(robot, "base", "tool", joint_weights=[2.0] * 7, max_move=[0.1] * 7)
    target = arm.base_from_tool(arm.default_start + 0.3)
    assert np.array_equal(arm.solve(target).q, listed.solve(target).q)
    by_name = kinopt.Arm(robot, "base", "tool", max_move={"joint1": 0.0})
    assert by_name.solve(target).q[0] == by_name.default_start[0]
    servo = arm.servo(arm.default_start, 0.01, velocity_limits=0.5, acceleration_limits=2.0, jerk_limits=50.0)
    assert np.array_equal(servo.velocity_limits, [0.5] * 7) and np.array_equal(servo.jerk_limits, [50.0] * 7)
    with pytest.raises(InvalidValueError, match="no number for joint `joint2`"):
        arm.servo(arm.default_start, 0.01, velocity_limits={"joint1": 0.5})


def test_joint_limits_narrow_those_of_the_robot(robot: kinopt.Robot) -> None:
    arm = kinopt.Arm(robot, "base", "tool", joint_limits={"joint3": (0.2, 0.5)})
    assert (arm.lower[2], arm.upper[2]) == (0.2, 0.5)
    samples = arm.random_configuration(200, seed=3)
    assert samples.shape == (200, 7) and np.array_equal(samples, arm.random_configuration(200, seed=3))
    assert np.all(samples >= arm.lower) and np.all(samples <= arm.upper) and np.ptp(samples[:, 2]) > 0.25
    assert arm.random_configuration(seed=4).shape == (7,)
    with pytest.raises(InvalidValueError, match=r"joint3.*-2\.8973"):
        kinopt.Arm(robot, "base", "tool", joint_limits={"joint3": (-4.0, 0.5)})
    with pytest.raises(UnknownNameError, match="joint3"):
        kinopt.Arm(robot, "base", "tool", joint_limits={"joint_3": (0.0, 0.5)})


def test_read_detects_the_format(tmp_path: Path) -> None:
    assert kinopt.Robot.read(MODELS / "franka_panda.urdf").joint_names[0] == "joint1"
    file = tmp_path / "arm.xml"
    file.write_text("<!-- a <robot> --><mujoco><worldbody><body name='arm'><joint name='hinge'/></body></worldbody></mujoco>")
    assert kinopt.Robot.read(file, base_joint="free").joint_names[-1] == "hinge"
    with pytest.raises(InvalidValueError, match="lenient"):
        kinopt.Robot.read(file, lenient=True)
    with pytest.raises(kinopt.FileError):
        kinopt.Robot.read(tmp_path / "nowhere.urdf")


def test_interpolation_is_straight_and_uniform() -> None:
    a, b = (POSITION, (0, 0, 0)), (POSITION + [0.2, 0, 0], (0, 0, 1.0))
    between = kinopt.interpolate(a, b, [0.0, 0.25, 1.0])
    assert np.allclose(between[:, :3, 3], POSITION + np.outer([0, 0.05, 0.2], [1, 0, 0]))
    assert np.allclose(between[1, :3, :3], turn(2, 0.25))
    assert kinopt.interpolate(a, b, 0.5).shape == (4, 4)
    with pytest.raises(InvalidValueError, match="t is NaN"):
        kinopt.interpolate(a, b, np.nan)
    with pytest.raises(InvalidValueError, match="a: "):
        kinopt.interpolate(np.diag([2.0, 1, 1, 1]), b, 0.5)


def test_goal_bounds_without_arguments_list_constructors(robot: kinopt.Robot) -> None:
    with pytest.raises(InvalidValueError, match=r"PoseBounds.position\(\)"):
        kinopt.PoseBounds()
    with pytest.raises(UnknownNameError, match="position"):
        kinopt.Arm(robot, "base", "tool", goal="positon")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError, match="goal must be"):
        kinopt.tasks.Pose("tool", np.eye(4), goal=3)  # type: ignore[arg-type]
