"""Solvers: every method, every limit, observers, Ctrl-C, and batches."""

import copy
import pickle
import signal
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import methods, tasks

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


@pytest.fixture(scope="module")
def problem(robot):
    placement = kinopt.frame_placement(robot, "tool", robot.random_configuration(seed=3))
    return kinopt.Problem(robot, [tasks.Pose("tool", placement, name="hand")])


@pytest.fixture(scope="module")
def point(robot):
    placement = kinopt.frame_placement(robot, "tool", robot.random_configuration(seed=3))
    return kinopt.Problem(robot, [tasks.Point("tool", placement[:3, 3], name="hand")])


def unreachable_target(robot):
    placement = np.eye(4)
    placement[0, 3] = 5.0
    return placement


OPTIMISERS = [
    "levenberg-marquardt",
    "gauss-newton",
    methods.LevenbergMarquardt("error_proportional", 0.2),
    methods.LevenbergMarquardt(initial_damping=1e-2),
    methods.GaussNewton(rank_tolerance=1e-6),
]
SLOW = ["projected-gradient", methods.ProjectedGradient("barzilai_borwein"), methods.ProjectedGradient(100.0)]


@pytest.mark.parametrize("method", OPTIMISERS, ids=str)
def test_methods_reach_poses_within_the_limits(robot, problem, method):
    solver = kinopt.Solver(method)
    for start in robot.random_configuration(10, seed=10):
        solution = solver.solve(problem, start)
        assert solution.reached and solution.position_error <= 1e-6 and solution.orientation_error <= 1e-6
        assert (solution.q >= robot.lower).all() and (solution.q <= robot.upper).all()
        placement = kinopt.frame_placement(robot, "tool", solution.q)
        assert np.abs(placement[:3, 3] - problem.tasks[0].target[:3, 3]).max() <= 1e-6


@pytest.mark.parametrize("method", [*SLOW, "ccd", methods.Ccd()], ids=str)
def test_methods_reach_points(robot, point, method):
    for start in robot.random_configuration(5, seed=10):
        assert kinopt.Solver(method, max_iterations=5000).solve(point, start).reached


def chain(bones):
    """Bones of half a metre along x, each with three revolute joints."""
    builder = kinopt.ModelBuilder("chain")
    parent, at = None, np.eye(4)
    for bone in range(bones):
        for axis in np.eye(3):
            name = f"{bone}/{axis.argmax()}"
            builder.joint(name, "revolute", parent, at, axis, -2.5, 2.5)
            parent, at = name, np.eye(4)
        at[0, 3] = 0.5
    builder.frame("tip", parent, at)
    return builder.build()


def test_geometric_methods_reach_points():
    model = chain(4)
    limb = chain(2)
    for seed in range(10):
        q = 0.3 * model.random_configuration(seed=seed)
        position = kinopt.frame_placement(model, "tip", q)[:3, 3]
        problem = kinopt.Problem(model, [tasks.Point("tip", position)])
        assert kinopt.Solver("fabrik").solve(problem, 0.9 * q).position_error < 1e-5
        position = kinopt.frame_placement(limb, "tip", q[:6])[:3, 3]
        problem = kinopt.Problem(limb, [tasks.Point("tip", position)])
        pole = methods.TwoBone([0.0, 5.0, 0.0])
        assert kinopt.Solver(pole).solve(problem, 0.1 * q[:6]).reached


def test_unsupported_task_of_method_raises(robot, problem):
    posture = kinopt.Problem(robot, [tasks.Posture(robot.neutral(), role="goal")])
    for method in ("ccd", "fabrik", methods.TwoBone()):
        with pytest.raises(kinopt.InvalidValueError):
            kinopt.Solver(method).solve(posture, robot.neutral())
    with pytest.raises(kinopt.InvalidValueError, match="2 bones"):
        kinopt.Solver(methods.TwoBone()).solve(kinopt.Problem(chain(3), [tasks.Point("tip", [1, 0, 0])]), np.zeros(9))


def test_search_limits_apply(robot, problem):
    start = robot.random_configuration(seed=11)
    three = kinopt.Solver(max_iterations=3, attempts=1).solve(problem, start)
    assert (three.iterations, three.attempts, three.termination) == (3, 1, "iteration_limit")
    missed = kinopt.Solver(attempts=5).solve(problem, start, {"hand": unreachable_target(robot)})
    assert missed.attempts == 5 and not missed.reached
    assert missed.is_out_of_reach and "Out of reach" in missed.explain()
    late = kinopt.Solver(time_limit=0.0).solve(problem, start, {"hand": unreachable_target(robot)})
    assert late.termination == "time_limit"
    agreed = kinopt.Solver(agreeing=2).solve(problem, start, {"hand": unreachable_target(robot)})
    assert agreed.agreeing >= 2 and agreed.attempts < 32
    strict = kinopt.Solver(gradient_tolerance=1e-3).solve(problem, start, {"hand": unreachable_target(robot)})
    assert strict.iterations < missed.iterations * 32
    other = kinopt.Solver(seed=5, attempts=5).solve(problem, start, {"hand": unreachable_target(robot)})
    assert other.counts != missed.counts
    few = kinopt.Solver(restart_steps=10).solve(problem, start, {"hand": unreachable_target(robot)})
    assert few.attempts <= 3
    kinopt.Solver(patience=np.inf, step_tolerance=1e-12).solve(problem, start)


@pytest.mark.parametrize(
    "given",
    [
        {"method": "simplex"},
        {"method": 3},
        {"method": methods.LevenbergMarquardt("none")},
        {"method": methods.LevenbergMarquardt(initial_damping=-1.0)},
        {"method": methods.LevenbergMarquardt(initial_damping="much")},
        {"method": methods.GaussNewton(2.0)},
        {"method": methods.ProjectedGradient(0.0)},
        {"method": methods.ProjectedGradient("long")},
        {"method": methods.TwoBone("left")},
        {"method": methods.TwoBone([np.nan, 0, 0])},
        {"method": methods.TwoBone(), "attempts": 3},
        {"attempts": 0},
        {"agreeing": 0},
        {"gradient_tolerance": -1.0},
        {"step_tolerance": np.nan},
        {"patience": 0},
        {"patience": 2.5},
        {"time_limit": -1.0},
        {"time_limit": np.nan},
    ],
)
def test_invalid_settings_raise(given):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Solver(**given)


@pytest.mark.parametrize("start", [np.zeros(3), np.full(9, np.nan), np.zeros((9, 9)), "here", [1j] * 9, None])
def test_invalid_starts_raise(problem, start):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Solver().solve(problem, start)


def test_starts_may_be_lists_float32_or_strided(robot, problem):
    start = robot.random_configuration(seed=4).astype(np.float32)
    expected = kinopt.Solver().solve(problem, start.astype(np.float64)).q
    wide = np.zeros((9, 2))
    wide[:, 0] = start
    for given in (start, start.tolist(), wide[:, 0]):
        assert np.array_equal(kinopt.Solver().solve(problem, given).q, expected)


def test_solvers_and_solutions_are_pickled(robot, problem):
    start = robot.random_configuration(seed=11)
    solver = kinopt.Solver(methods.GaussNewton(1e-7), attempts=7, seed=3, time_limit=100.0)
    for targets in (None, {"hand": unreachable_target(robot)}):
        solution = solver.solve(problem, start, targets)
        for twin in (pickle.loads(pickle.dumps(solver)), copy.deepcopy(solver)):
            assert repr(twin) == repr(solver)
            assert np.array_equal(twin.solve(problem, start, targets).q, solution.q)
        read = pickle.loads(pickle.dumps(solution))
        assert np.array_equal(read.q, solution.q) and read.explain() == solution.explain()
        assert repr(read) == repr(solution) and repr(read.tasks) == repr(solution.tasks)
        assert repr(read.active_limits) == repr(solution.active_limits)


def test_solution_has_all_reports(robot, problem):
    start = robot.random_configuration(seed=11)
    solution = kinopt.Solver().solve(problem, start, {"hand": unreachable_target(robot)})
    assert solution.q is solution.q and not solution.q.flags.writeable
    [hand] = solution.tasks
    assert (hand.name, hand.frame, hand.role, hand.reached) == ("hand", "tool", "goal", False)
    placement = kinopt.frame_placement(robot, "tool", solution.q)
    missed = np.linalg.norm(placement[:3, 3] - [5, 0, 0])
    assert solution.position_error == hand.position_error == pytest.approx(missed, rel=1e-12)
    assert hand.error("radians") == hand.orientation_error == solution.orientation_error
    assert {rows.quantity for rows in hand.rows} == {"metres", "radians"}
    assert solution.cost > 0 and solution.projected_gradient is not None
    assert solution.counts.residuals > solution.iterations > 0
    for limit in solution.active_limits:
        at = solution.q[robot.joint_names.index(limit.joint)]
        assert at == limit.value and limit.side in ("lower", "upper") and limit.push > 0
        assert limit.joint in solution.explain() and (limit.kind, limit.is_angle) == ("limit", True)
    wish = tasks.Posture(robot.neutral(), name="rest", scale=10.0)
    both = [problem.tasks[0], wish]
    traded = kinopt.Solver().solve(kinopt.Problem(robot, both, preferences="traded"), start)
    assert not traded.reached and traded.pulling_preferences == ["rest"]
    within = kinopt.Solver().solve(kinopt.Problem(robot, both), start)
    assert within.reached and within.pulling_preferences == []


def test_observer_sees_every_step_and_may_stop(robot, problem):
    start, seen = robot.random_configuration(seed=11), []
    solution = kinopt.Solver(attempts=1).solve(problem, start, observer=seen.append)
    assert [step.index for step in seen] == list(range(len(seen)))
    assert seen[-1].cost <= seen[0].cost and seen[0].x.shape == (problem.variables,)
    assert solution.iterations in (len(seen), len(seen) - 1)
    stopped = kinopt.Solver().solve(problem, start, observer=lambda step: step.index == 2)
    assert (stopped.termination, stopped.iterations) == ("cancelled", 2)


class Mine(Exception):
    pass


def test_observer_exception_propagates(robot, problem):
    mine = Mine("here")

    def observer(step):
        raise mine

    with pytest.raises(Mine) as caught:
        kinopt.Solver().solve(problem, robot.random_configuration(seed=11), observer=observer)
    assert caught.value is mine
    assert kinopt.Solver().solve(problem, robot.random_configuration(seed=11)).reached


def batch(robot, n):
    starts = robot.random_configuration(n, seed=30)
    goals = robot.random_configuration(n, seed=90)
    return starts, np.stack([kinopt.frame_placement(robot, "tool", q) for q in goals])


def test_batch_equals_single_queries_on_any_threads(robot, problem):
    starts, targets = batch(robot, 60)
    targets[7] = unreachable_target(robot)
    solver = kinopt.Solver()
    single = [solver.solve(problem, q, {"hand": position}) for q, position in zip(starts, targets)]
    for threads in (1, 2, 5, None):
        solutions = solver.solve_batch(problem, starts, {"hand": targets}, threads=threads)
        assert len(solutions) == 60 and solutions.q.shape == (60, 9)
        assert np.array_equal(solutions.q, [solution.q for solution in single])
        assert list(solutions.reached) == [solution.reached for solution in single]
        assert list(solutions.position_error) == [solution.position_error for solution in single]
        assert list(solutions.orientation_error) == [solution.orientation_error for solution in single]
        assert list(solutions.iterations) == [solution.iterations for solution in single]
        assert list(solutions.attempts) == [solution.attempts for solution in single]
        assert list(solutions.cost) == [solution.cost for solution in single]
    assert solutions.explain()[7] == single[7].explain() == solutions[7].explain()
    assert np.array_equal(solutions[-1].q, single[-1].q)
    with pytest.raises(IndexError):
        solutions[60]
    assert repr(solutions) == f"Solutions({solutions.reached.sum()} of 60 reached)"


def test_batch_accepts_one_start_or_no_targets(robot, problem):
    starts, targets = batch(robot, 5)
    solver = kinopt.Solver()
    assert len(solver.solve_batch(problem, starts)) == 5
    one = solver.solve_batch(problem, starts[0], {"hand": list(targets)})
    assert np.array_equal(one[3].q, solver.solve(problem, starts[0], {"hand": targets[3]}).q)
    assert len(solver.solve_batch(problem, np.zeros((0, 9)))) == 0
    calls = []
    solver.solve_batch(problem, starts, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (5, 5)


@pytest.mark.parametrize(
    ("starts", "given"),
    [
        (np.zeros((3, 9)), {"targets": {"hand": np.stack([np.eye(4)] * 2)}}),
        (np.zeros((3, 9)), {"targets": {"foot": np.stack([np.eye(4)] * 3)}}),
        (np.zeros((3, 9)), {"targets": {"hand": 3}}),
        (np.zeros((3, 8)), {}),
        (np.zeros((3, 9, 9)), {}),
        (np.full((3, 9), np.nan), {}),
        (np.zeros((3, 9)), {"threads": 0}),
        (np.zeros((3, 9)), {"progress": 5}),
    ],
)
def test_invalid_batches_raise(problem, starts, given):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Solver().solve_batch(problem, starts, **given)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs an interval timer")
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_stops_a_long_batch(robot, problem, threads):
    """A raising signal handler, as for Ctrl-C, ends a batch of minutes."""

    def handler(number, frame):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, handler)
    beyond = kinopt.Problem(robot, [tasks.Pose("tool", unreachable_target(robot))])
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(KeyboardInterrupt):
            kinopt.Solver().solve_batch(beyond, np.zeros((200_000, 9)), threads=threads)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
