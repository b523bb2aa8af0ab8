"""Problems: free joints and bounds; one problem serves several queries and threads."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


@pytest.fixture(scope="module")
def target(robot):
    return kinopt.frame_placement(robot, "tool", robot.random_configuration(seed=3))


def hand(target, **about):
    return tasks.Pose("tool", target, name="hand", **about)


def test_mimic_joints_of_robot_follow(robot, target):
    problem = kinopt.Problem(robot, [hand(target)])
    assert problem.configuration_len == 9 and problem.variables == 8
    q = kinopt.Solver().solve(problem, robot.random_configuration(seed=4)).q
    [(joint, (master, ratio, offset))] = robot.mimics.items()
    names = robot.joint_names
    assert q[names.index(joint)] == ratio * q[names.index(master)] + offset
    assert kinopt.Problem(robot.model, [hand(target)]).variables == 9


def test_joints_are_locked_coupled_narrowed_and_freed(robot, target):
    start = robot.random_configuration(seed=4)
    [(follower, (master, *_))] = robot.mimics.items()
    locked = kinopt.ParameterMap(robot, lock={"joint3": 0.25, master: 0.02})
    assert locked.variables == 6 and "joint3" not in locked.variable_names
    q = kinopt.Solver().solve(kinopt.Problem(robot, [hand(target)], parameters=locked), start).q
    names = robot.joint_names
    assert q[names.index("joint3")] == 0.25 and q[names.index(follower)] == 0.02

    coupled = kinopt.ParameterMap(robot, couple={"joint5": ("joint3", -2.0, 0.1)})
    q = kinopt.Solver().solve(kinopt.Problem(robot, [hand(target)], parameters=coupled), start).q
    assert q[4] == -2.0 * q[2] + 0.1

    narrow = kinopt.ParameterMap(robot, narrow={"joint2": (0.1, 0.2)})
    problem = kinopt.Problem(robot, [hand(target)], parameters=narrow)
    assert 0.1 <= kinopt.Solver().solve(problem, start).q[1] <= 0.2
    problem = kinopt.Problem(robot, [hand(target)], bounds={"joint2": (0.1, 0.2)})
    assert (problem.lower[1], problem.upper[1]) == (0.1, 0.2)

    only = kinopt.ParameterMap(robot, only=["joint6", "joint7"], at=start)
    assert only.variable_names == ["joint6", "joint7"]
    q = kinopt.Solver().solve(kinopt.Problem(robot, [hand(target)], parameters=only), start).q
    assert np.array_equal(q[:5], start[:5])

    x = (only.lower + only.upper) / 2
    assert np.allclose(only.reduce(only.expand(x)), x, rtol=0, atol=1e-15)
    for twin in (pickle.loads(pickle.dumps(only)), copy.deepcopy(only)):
        assert np.array_equal(twin.expand(x), only.expand(x))


@pytest.mark.parametrize(
    "given",
    [
        {"lock": {"elbow": 0.0}},
        {"lock": {"joint1": 100.0}},
        {"lock": {"joint1": np.nan}},
        {"lock": {"joint1": "here"}},
        {"lock": ["joint1"]},
        {"couple": {"joint1": ("joint1", 1.0, 0.0)}},
        {"couple": {"joint1": "joint2"}},
        {"narrow": {"joint1": (2.0, 1.0)}},
        {"narrow": {"joint1": 1.0}},
        {"only": ["elbow"]},
        {"only": ["joint1"], "at": [0.0]},
        {"at": np.zeros(9)},
    ],
)
def test_invalid_parameters_raise(robot, given):
    with pytest.raises(kinopt.KinoptError):
        kinopt.ParameterMap(robot, **given)


@pytest.mark.parametrize(
    "given",
    [
        {"bounds": {"elbow": (0.0, 1.0)}},
        {"bounds": {"joint1": (5.0, 6.0)}},
        {"bounds": {"joint1": 3.0}},
        {"tolerance": -1.0},
        {"tolerance": {"miles": 1.0}},
        {"derivatives": "guess"},
        {"preferences": "none"},
    ],
)
def test_invalid_options_raise(robot, target, given):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Problem(robot, [hand(target)], **given)


def test_pickled_problem_solves_bitwise_equally(robot, target):
    posture = tasks.Posture(robot.neutral(), scale=0.1)
    parameters = kinopt.ParameterMap(robot, lock={"joint3": 0.25})
    problem = kinopt.Problem(
        robot,
        [hand(target), posture],
        parameters=parameters,
        bounds={"joint1": (-1.0, 1.0)},
        tolerance={"metres": 1e-7},
        derivatives="dual",
        preferences="traded",
    )
    start = robot.random_configuration(seed=4)
    solution = kinopt.Solver().solve(problem, start)
    for twin in (pickle.loads(pickle.dumps(problem)), copy.deepcopy(problem)):
        assert (twin.derivatives, twin.preferences) == ("dual", "traded")
        assert repr(twin) == repr(problem)
        again = kinopt.Solver().solve(twin, start)
        assert np.array_equal(again.q, solution.q) and again.counts == solution.counts


def test_targets_change_without_a_new_problem(robot, target):
    problem = kinopt.Problem(robot, [hand(target), tasks.Posture(robot.neutral(), name="rest")])
    start, solver = robot.random_configuration(seed=4), kinopt.Solver()
    before = solver.solve(problem, start)
    other = kinopt.frame_placement(robot, "tool", robot.random_configuration(seed=8))
    rest = robot.random_configuration(seed=9)
    moved = solver.solve(problem, start, {"hand": other, "rest": rest})
    stated = kinopt.Problem(robot, [hand(other), tasks.Posture(rest, name="rest")])
    assert np.array_equal(moved.q, solver.solve(stated, start).q)
    assert np.array_equal(solver.solve(problem, start, {0: other, 1: rest}).q, moved.q)
    assert np.array_equal(solver.solve(problem, start).q, before.q)
    x = problem.lower * 0.5
    assert np.array_equal(problem.residual(x, {"hand": other, "rest": rest}), stated.residual(x))


def test_every_kind_of_target_changes(robot):
    rest = robot.neutral()
    first, other = np.array([0.3, 0.1, 0.4]), np.array([0.5, -0.2, 0.3])
    pose, moved = np.eye(4), np.eye(4)
    moved[:3, 3], moved[:2, :2] = other, [[0, -1], [1, 0]]
    camera = tasks.Camera.pinhole(np.eye(4), [500, 500], [320, 240])
    pairs = [
        (tasks.Point("tool", first), other),
        (tasks.Pose("tool", pose), moved),
        (tasks.Orientation("tool", pose[:3, :3]), moved[:3, :3]),
        (tasks.LookAt("tool", [0, 0, 1], first), other),
        (tasks.Distance("tool", "base", 0.3), 0.5),
        (tasks.Plane("tool", first, [0, 0, 1]), [other, [0, 1, 0]]),
        (tasks.Ray("tool", first, first + 1), [other, other - 1]),
        (tasks.Pixel("tool", camera, [1, 2]), [3, 4]),
        (tasks.Posture(rest), rest + 0.1),
        (tasks.Smoothness(rest, 0.1), rest + 0.1),
        (tasks.Bounded(tasks.Point("tool", first), 0.01), other),
        (tasks.Residual(lambda q: q - 1, joints="all", rows=9), lambda q: q - 2),
    ]
    problem = kinopt.Problem(robot.model, [task for task, _ in pairs])
    x = robot.random_configuration(seed=2)
    after = problem.residual(x, {i: target for i, (_, target) in enumerate(pairs)})
    stated = [stated_with(task, target) for task, target in pairs]
    expected = kinopt.Problem(robot.model, stated).residual(x)
    assert np.array_equal(after, expected)
    assert (np.abs(after - problem.residual(x)) > 1e-3).sum() > len(after) / 2


def stated_with(task, target):
    """The task with another target from the start."""
    match task:
        case tasks.Bounded():
            return replace(task, task=stated_with(task.task, target))
        case tasks.Plane():
            return replace(task, point=target[0], normal=target[1])
        case tasks.Ray():
            return replace(task, eye=target[0], through=target[1])
    fields = {
        tasks.Distance: "distance",
        tasks.Posture: "reference",
        tasks.Smoothness: "previous",
        tasks.Residual: "function",
    }
    return replace(task, **{fields.get(type(task), "target"): target})


@pytest.mark.parametrize(
    "targets",
    [
        {"foot": np.eye(4)},
        {7: np.eye(4)},
        {-1: np.eye(4)},
        {None: np.eye(4)},
        {"hand": np.eye(3)},
        {"hand": np.full((4, 4), np.nan)},
        {"hand": np.diag([1.0, 1, 2, 1])},
        {"hand": "there"},
        {"hand": np.eye(4), 0: np.eye(4)},
        [np.eye(4)],
    ],
)
def test_invalid_targets_raise_and_change_nothing(robot, target, targets):
    problem = kinopt.Problem(robot, [hand(target)])
    start = robot.random_configuration(seed=4)
    with pytest.raises(kinopt.KinoptError):
        kinopt.Solver().solve(problem, start, targets)
    assert kinopt.Solver().solve(problem, start).reached


def test_problem_is_shared_by_threads(robot):
    problem = kinopt.Problem(robot, [hand(np.eye(4)), tasks.Posture(robot.neutral())])
    solver, start = kinopt.Solver(), robot.neutral()
    targets = [kinopt.frame_placement(robot, "tool", q) for q in robot.random_configuration(60, seed=1)]

    def solve(target):
        return solver.solve(problem, start, {"hand": target}).q

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(solve, targets))
    assert all(np.array_equal(q, solve(target)) for q, target in zip(together, targets))
