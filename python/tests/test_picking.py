"""Batches, tracks and solutions are indexed like arrays."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"
START = np.array([0.1, -1.2, 1.0, -1.3, -1.5, 0.2])
COLUMNS = ("q", "reached", "position_error", "orientation_error", "iterations", "attempts")


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")


@pytest.fixture(scope="module")
def arm(robot):
    return kinopt.Arm(robot, "base", "flange", atlas=False)


@pytest.fixture(scope="module")
def targets(arm):
    targets = arm.base_from_tool(START + np.linspace(0.0, 0.6, 20)[:, None])
    targets[4::5, :3, 3] += 9.0
    return targets


@pytest.fixture(scope="module")
def all_kinds(robot, arm, targets):
    problem = kinopt.Problem(robot, [tasks.Point("flange", [0.3, 0.2, 0.4], name="hand")])
    return [
        arm.solve_batch(targets, START),
        arm.solve_batch(list(targets), np.tile(START, (20, 1))),
        arm.track(targets, START).report,
        kinopt.Solver(attempts=2).solve_batch(problem, START, {"hand": targets[:, :3, 3]}),
    ]


def test_slices_masks_and_lists_select(all_kinds):
    for many in all_kinds:
        assert not many.reached.all() and many.reached.any()
        mask = np.arange(20) % 3 == 0
        for index in (slice(2, 5), slice(None, None, -3), mask, ~many.reached, [4, 1, 1], np.array([-1, 0]), []):
            part = many[index]
            assert len(part) == len(np.arange(20)[index])
            for column in COLUMNS:
                whole = getattr(many, column)
                assert whole is None or np.array_equal(getattr(part, column), whole[index])
            assert part.explain() == [many.explain(int(i)) for i in np.arange(20)[index]]
            for solution, q in zip(part, many.q[index], strict=True):
                assert np.array_equal(solution.q, q)
            assert np.array_equal(pickle.loads(pickle.dumps(part)).q, part.q)
            assert len(part[:2]) == min(len(part), 2)


def test_integers_select_from_either_end(all_kinds):
    for many in all_kinds:
        for index in (0, 19, -1, -20, np.int64(3), np.uint8(7)):
            assert np.array_equal(many[index].q, many.q[index])
            assert many[index].explain() == many.explain(int(index))
        for index in (20, -21, 2**70, -(2**70)):
            with pytest.raises(IndexError):
                many[index]
        for index in (20, -21):
            with pytest.raises(IndexError):
                many.explain(index)
        for index in ("a", 1.5, None, [[0, 1]], np.ones((20, 2), bool), np.ones(19, bool)):
            with pytest.raises(IndexError):
                many[index]


def test_track_contains_solutions_and_jumps(arm, targets):
    track = arm.track(targets[:3], START)
    assert type(track.report) is kinopt.Solutions
    back = pickle.loads(pickle.dumps(track))
    assert type(back) is kinopt.JointPath and np.array_equal(back.q, track.q)
    assert [repr(jump) for jump in back.jumps] == [repr(jump) for jump in track.jumps]
    reached = "reached" if track.reached else "not reached"
    assert repr(track) == f"JointPath(3 rows, {reached}, {len(track.jumps)} jumps)"


def test_arm_has_robot_base_and_tip(robot, arm):
    assert arm.robot is robot and (arm.base, arm.tip) == ("base", "flange")
    assert kinopt.Arm(robot, None, "flange", atlas=False).base is None


def test_arm_jacobian_is_the_derivative_of_its_tool(robot):
    tool = np.eye(4)
    tool[:3, 3] = [0.1, 0.2, 0.3]
    for name, base, tip in [("universal_ur5e", "forearm_link", "flange"), ("franka_panda", "link2", "tool")]:
        robot = kinopt.Robot.from_urdf(MODELS / f"{name}.urdf")
        if base not in robot.frame_names:
            base = robot.frame_names[2]
        arm = kinopt.Arm(robot, base, tip, tool=tool, atlas=False)
        q = np.random.default_rng(3).uniform(arm.lower, arm.upper, (5, arm.degrees_of_freedom))
        all_at_once = arm.jacobian(q)
        assert all_at_once.shape == (5, 6, arm.degrees_of_freedom)
        for configuration, jacobian in zip(q, all_at_once, strict=True):
            assert np.array_equal(arm.jacobian(configuration), jacobian)
            placement = arm.base_from_tool(configuration)
            for joint in range(len(configuration)):
                step = np.zeros(len(configuration))
                step[joint] = 1e-6
                rate = (arm.base_from_tool(configuration + step) - arm.base_from_tool(configuration - step)) / 2e-6
                spin = rate[:3, :3] @ placement[:3, :3].T
                twist = [*rate[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
                assert np.abs(jacobian[:, joint] - twist).max() < 1e-8
    for wrong in (np.zeros(3), np.full(arm.degrees_of_freedom, np.nan)):
        with pytest.raises(kinopt.InvalidValueError):
            arm.jacobian(wrong)
