"""Problems that grow task by task, and tasks on priority levels: a lower one costs nothing to a higher one."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt import tasks
from kinopt.errors import InvalidValueError, UnknownNameError

PANDA = Path(__file__).parents[2] / "models" / "franka_panda.urdf"


@pytest.fixture(scope="module")
def robot() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(PANDA)


def placement(robot: kinopt.Robot, frame: str, q: np.ndarray) -> np.ndarray:
    return kinopt.frame_placement(robot, frame, q)


def miss(robot: kinopt.Robot, q: np.ndarray, frame: str, target: np.ndarray) -> float:
    """Distance of a frame's origin from a point."""
    return float(np.linalg.norm(placement(robot, frame, q)[:3, 3] - target))


def test_tasks_added_singly_give_an_equal_problem(robot: kinopt.Robot) -> None:
    target = placement(robot, "tool", robot.random_configuration(seed=3))
    start = robot.random_configuration(seed=4)
    problem = kinopt.Problem(robot)
    hand = problem.add(tasks.Pose("tool", target, name="hand"))
    rest = problem.add(tasks.Posture(robot.neutral(), name="rest"), level=1, weight=0.5)
    assert (hand, rest) == (0, 1) and problem.task_names == ["hand", "rest"]
    at_once = kinopt.Problem(
        robot,
        [
            tasks.Pose("tool", target, name="hand"),
            tasks.Posture(robot.neutral(), name="rest", level=1, weight=0.5),
        ],
    )
    solver = kinopt.Solver()
    solution = solver.solve(problem, start)
    assert np.array_equal(solution.q, solver.solve(at_once, start).q)
    assert [task.level for task in solution.tasks] == [0, 1]
    assert repr(problem.tasks) == repr(at_once.tasks) and repr(problem) == repr(at_once)
    # Indices are as good as names.
    other = placement(robot, "tool", robot.random_configuration(seed=5))
    by_number = solver.solve(problem, start, {hand: other})
    assert by_number.tasks[hand].name == "hand"
    assert np.array_equal(by_number.q, solver.solve(at_once, start, {"hand": other}).q)
    for twin in (pickle.loads(pickle.dumps(problem)), copy.deepcopy(problem), problem.with_derivatives("dual")):
        assert repr(twin) == repr(problem) and repr(twin.tasks) == repr(problem.tasks)
        # A copy changes independently.
        twin.add(tasks.LimitCentring())
        assert len(problem.tasks) == 2


def test_add_overrides_the_task_level(robot: kinopt.Robot) -> None:
    task = tasks.Point("tool", [0.3, 0.0, 0.5], level=3, weight=2.0)
    problem = kinopt.Problem(robot)
    problem.add(task)
    problem.add(task, 1)
    problem.add(task, level=0, weight={"metres": 5.0})
    problem.add(tasks.Bounded(task, 0.1), level=0)
    assert [task.level for task in problem.tasks] == [3, 1, 0, 0]
    assert [task.weight for task in problem.tasks] == [2.0, 2.0, {"metres": 5.0}, 2.0]
    assert task.level == 3 and tasks.Bounded(task, 0.1).level == 3


USES: dict[str, Callable[[kinopt.Problem, np.ndarray], Any]] = {
    "solve": lambda problem, q: kinopt.Solver().solve(problem, q),
    "solve_batch": lambda problem, q: kinopt.Solver().solve_batch(problem, [q]),
    "drag": lambda problem, q: kinopt.Drag(problem, q),
    "residual": lambda problem, q: problem.residual(q),
    "jacobian": lambda problem, q: problem.jacobian(q),
    "variables": lambda problem, q: problem.variables,
    "lower": lambda problem, q: problem.lower,
}


@pytest.mark.parametrize("use", USES)
def test_problem_without_tasks_raises(robot: kinopt.Robot, use: str) -> None:
    problem = kinopt.Problem(robot)
    with pytest.raises(InvalidValueError, match="no task"):
        USES[use](problem, robot.neutral())
    assert problem.tasks == [] and problem.task_names == [] and problem.derivatives == "analytic"
    assert repr(problem) == repr(pickle.loads(pickle.dumps(problem))) == "Problem(no tasks)"


def test_problem_without_tasks_is_validated(robot: kinopt.Robot) -> None:
    wrong: list[dict[str, Any]] = [
        {"bounds": {"joint1": (5.0, 6.0)}},
        {"bounds": {"nose": (0.0, 1.0)}},
        {"derivatives": "guess"},
    ]
    for given in wrong:
        with pytest.raises(kinopt.KinoptError):
            kinopt.Problem(robot, **given)


def test_invalid_task_leaves_the_problem_unchanged(robot: kinopt.Robot) -> None:
    problem = kinopt.Problem(robot, [tasks.Point("tool", [0.3, 0.0, 0.5], name="hand")])
    before = repr(problem), kinopt.Solver().solve(problem, robot.neutral()).q
    with pytest.raises(UnknownNameError, match="nose"):
        problem.add(tasks.Point("nose", [0.0, 0.0, 0.0]))
    with pytest.raises(InvalidValueError):
        problem.add(tasks.Point("tool", [0.0, 0.0, 0.0]), weight=-1.0)
    with pytest.raises(InvalidValueError, match="no task of kinopt.tasks"):
        problem.add("hand", level=1)  # type: ignore[arg-type]
    assert repr(problem) == before[0]
    assert np.array_equal(kinopt.Solver().solve(problem, robot.neutral()).q, before[1])


@pytest.mark.parametrize("level", [-1, 1.5, "first", None, True, 2**70, np.nan])
def test_level_is_an_integer(robot: kinopt.Robot, level: Any) -> None:
    with pytest.raises(InvalidValueError, match="level must be a whole number of at least 0"):
        tasks.Point("tool", [0.3, 0.0, 0.5], level=level)
    if level is not None:
        with pytest.raises(InvalidValueError, match="level must be a whole number of at least 0"):
            kinopt.Problem(robot).add(tasks.Point("tool", [0.3, 0.0, 0.5]), level=level)
    assert tasks.Point("tool", [0.3, 0.0, 0.5], level=np.int64(2)).level == 2  # type: ignore[arg-type]


def test_drag_keeps_its_initial_tasks(robot: kinopt.Robot) -> None:
    q = robot.random_configuration(seed=6)
    problem = kinopt.Problem(robot, [tasks.Point("tool", placement(robot, "tool", q)[:3, 3], name="hand")])
    drag = kinopt.Drag(problem, q)
    problem.add(tasks.Point("link4", [9.0, 0.0, 0.0], name="elbow"))
    solution = drag.advance({"hand": placement(robot, "tool", q)[:3, 3]})
    assert solution.reached and [task.name for task in solution.tasks] == ["hand"]
    with pytest.raises(UnknownNameError, match="elbow"):
        drag.set_targets({"elbow": [0.0, 0.0, 0.0]})


def test_tasks_are_added_from_many_threads(robot: kinopt.Robot) -> None:
    problem = kinopt.Problem(robot)
    made = [tasks.Point("tool", [0.3, 0.0, 0.5], name=f"task {i}") for i in range(24)]
    with ThreadPoolExecutor(8) as threads:
        numbers = list(threads.map(problem.add, made))
    assert sorted(numbers) == list(range(24))
    for number, task in zip(numbers, made):
        assert problem.task_names[number] == task.name


def test_lower_level_never_changes_the_first(robot: kinopt.Robot) -> None:
    solver, conflicts, nearer = kinopt.Solver(), 0, 0
    for seed in range(12):
        start, target_q, other_q = robot.random_configuration(3, seed=seed)
        tool, elbow = placement(robot, "tool", target_q), placement(robot, "link4", other_q)[:3, 3]
        alone = kinopt.Problem(robot, [tasks.Pose("tool", tool)])
        both = kinopt.Problem(robot)
        both.add(tasks.Point("link4", elbow, scale=1000.0), level=1)
        both.add(tasks.Pose("tool", tool), level=0)
        by_itself, solution = solver.solve(alone, start), solver.solve(both, start)
        first = solution.tasks[1]
        for error in ("position_error", "orientation_error"):
            assert abs(getattr(first, error) - getattr(by_itself.tasks[0], error)) < 1e-9
        if not solution.reached:
            conflicts += 1
            assert "Level 1 gives way" in solution.explain()
            # Not always nearer, because it is the nearest on its own branch.
            nearer += miss(robot, solution.q, "link4", elbow) < miss(robot, by_itself.q, "link4", elbow)
    assert conflicts > 3 and nearer > conflicts / 2


def test_drag_keeps_level_0_with_unreachable_level_1(robot: kinopt.Robot) -> None:
    q = robot.random_configuration(seed=6)
    tool, elbow = (placement(robot, frame, q)[:3, 3] for frame in ("tool", "link4"))
    problem = kinopt.Problem(robot)
    problem.add(tasks.Point("tool", tool))
    pulled = problem.add(tasks.Point("link4", elbow), level=1)
    drag = kinopt.Drag(problem, q)
    missed = 0
    for step in range(60):
        solution = drag.advance({pulled: elbow + 0.02 * step * np.array([1.0, -1.0, 0.0])})
        assert miss(robot, solution.q, "tool", tool) < 1.01e-6, solution.explain()
        missed += not solution.reached
    assert missed > 20
