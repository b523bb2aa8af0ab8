"""A residual in Python behaves like a task of the library."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"
TARGET = np.array([0.4, 0.2, 0.5])


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def at_target(frames):
    return frames[0, :3, 3] - TARGET


def slope_at_target(frames):
    return np.hstack([np.eye(3), np.zeros((3, 3))])


def user_residual(**about):
    return tasks.Residual(at_target, frames=["tool"], rows=3, name="own", **about)


@pytest.mark.parametrize("jacobian", [None, slope_at_target])
def test_residual_equals_the_library_task(robot, jacobian):
    problem = kinopt.Problem(robot, [user_residual(jacobian=jacobian)])
    theirs = kinopt.Problem(robot, [tasks.Point("tool", TARGET)])
    x = robot.random_configuration(seed=1)[:8]
    assert np.array_equal(problem.residual(x), theirs.residual(x))
    allowed = 1e-12 if jacobian else 1e-8
    for route in ("analytic", "dual"):
        ours = problem.with_derivatives(route).jacobian(x)
        assert np.abs(ours - theirs.jacobian(x)).max() <= allowed
    assert np.allclose(problem.gradient(x), theirs.gradient(x), rtol=0, atol=1e-7)
    for start in robot.random_configuration(10, seed=2):
        solution = kinopt.Solver().solve(problem, start)
        assert solution.reached and solution.position_error <= 1e-6
        placement = kinopt.frame_placement(robot, "tool", solution.q)
        assert np.linalg.norm(placement[:3, 3] - TARGET) <= 1e-6


def test_residual_reads_frames_joints_or_both(robot):
    seen = {}

    def frames_alone(frames):
        seen["frames"] = frames.shape, frames.dtype
        return [0.0]

    def joints_alone(q):
        seen["joints"] = q.shape
        return q

    def both(frames, q):
        seen["both"] = frames.shape, q.shape
        return np.float32(0.0)

    given = [
        tasks.Residual(frames_alone, frames=["tool", "link3"], rows=1),
        tasks.Residual(joints_alone, joints="all", rows={"joint units": 9}),
        tasks.Residual(both, frames=["tool"], joints=["joint2", "joint1"], rows={"radians": 1}),
    ]
    problem = kinopt.Problem(robot.model, given)
    q = robot.random_configuration(seed=3)
    assert np.array_equal(problem.residual(q)[1:10], q)
    assert seen == {"frames": ((2, 4, 4), np.float64), "joints": (9,), "both": ((1, 4, 4), (2,))}


def test_mixed_jacobian_has_twists_before_joints(robot):
    def residual(frames, q):
        a, b = frames
        return [a[:3, 0] @ b[:3, 3] + q[0] ** 2]

    def jacobian(frames, q):
        (a, b), row = frames, np.zeros((1, 13))
        row[0, 3:6] = np.cross(a[:3, 0], b[:3, 3])
        row[0, 6:9] = a[:3, 0]
        row[0, 12] = 2 * q[0]
        return row

    reads = {"frames": ["tool", "link4"], "joints": ["joint2"], "rows": {"ratio": 1}}
    exact = kinopt.Problem(robot.model, [tasks.Residual(residual, jacobian=jacobian, **reads)])
    differences = kinopt.Problem(robot.model, [tasks.Residual(residual, **reads)])
    for q in robot.random_configuration(10, seed=3):
        by_q = exact.with_derivatives("central_difference").jacobian(q)
        assert np.abs(exact.jacobian(q) - by_q).max() < 1e-8
        assert np.abs(differences.jacobian(q) - by_q).max() < 1e-8


def test_residual_accepts_bounds_weights_and_roles(robot):
    wish = tasks.Residual(at_target, frames=["tool"], rows=3, role="preference")
    look = tasks.Point("flange", TARGET + 0.1)
    solution = kinopt.Solver().solve(kinopt.Problem(robot, [look, wish]), robot.neutral())
    assert solution.reached and solution.tasks[1].role == "preference"
    bounded = kinopt.Problem(robot, [tasks.Bounded(user_residual(), 0.05)])
    solution = kinopt.Solver().solve(bounded, robot.neutral())
    placement = kinopt.frame_placement(robot, "tool", solution.q)
    assert solution.reached and np.abs(placement[:3, 3] - TARGET).max() < 0.05 + 1e-6


class Mine(Exception):
    pass


@pytest.mark.parametrize("after", [0, 1, 5, 40])
@pytest.mark.parametrize("where", ["function", "jacobian"])
def test_exception_propagates_unchanged(robot, after, where):
    mine, calls = Mine("mine"), [0]

    def failing(inner):
        def function(frames):
            calls[0] += 1
            if calls[0] > after:
                raise mine
            return inner(frames)

        return function

    if where == "function":
        task = tasks.Residual(failing(at_target), frames=["tool"], rows=3)
    else:
        task = tasks.Residual(at_target, jacobian=failing(slope_at_target), frames=["tool"], rows=3)
    problem = kinopt.Problem(robot, [task])
    # Several starts, so that later calls occur too.
    with pytest.raises(Mine) as caught:
        for start in robot.random_configuration(20, seed=5):
            kinopt.Solver().solve(problem, start)
    assert caught.value is mine
    # No computation continues after the exception.
    assert calls[0] == after + 1
    assert kinopt.Solver().solve(kinopt.Problem(robot, [user_residual()]), robot.neutral()).reached


@pytest.mark.parametrize("threads", [1, 3])
def test_exception_propagates_from_batches(robot, threads):
    mine = Mine("mine")

    def failing(frames):
        raise mine

    problem = kinopt.Problem(robot, [tasks.Residual(failing, frames=["tool"], rows=3)])
    with pytest.raises(Mine) as caught:
        kinopt.Solver().solve_batch(problem, robot.random_configuration(50, seed=1), threads=threads)
    assert caught.value is mine


def test_results_are_bitwise_equal_on_any_thread(robot):
    problem = kinopt.Problem(robot, [user_residual(), tasks.Posture(robot.neutral())])
    starts, solver = robot.random_configuration(20, seed=5), kinopt.Solver()
    alone = np.stack([solver.solve(problem, start).q for start in starts])
    assert np.array_equal(solver.solve_batch(problem, starts, threads=3).q, alone)
    with ThreadPoolExecutor(4) as pool:
        answers = pool.map(lambda start: solver.solve(problem, start).q, starts)
        assert np.array_equal(list(answers), alone)


def test_residual_may_solve_another_problem(robot):
    inner, solver = kinopt.Problem(robot, [user_residual()]), kinopt.Solver()

    def residual(q):
        return q[:1] - solver.solve(inner, robot.neutral()).q[0]

    outer = kinopt.Problem(robot, [tasks.Residual(residual, joints=["joint1"], rows={"radians": 1})])
    solution = solver.solve(outer, robot.neutral())
    assert solution.reached
    assert solution.q[0] == pytest.approx(solver.solve(inner, robot.neutral()).q[0], abs=1e-6)


@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_non_finite_values_end_the_search(robot, number):
    task = tasks.Residual(lambda frames: [number, 0, 0], frames=["tool"], rows=3)
    solution = kinopt.Solver().solve(kinopt.Problem(robot, [task]), robot.neutral())
    assert not solution.reached and solution.termination == "non_finite"
    assert np.isfinite(solution.q).all()
    twin = pickle.loads(pickle.dumps(solution))
    assert repr(twin) == repr(solution) and twin.explain() == solution.explain()


@pytest.mark.parametrize("result", [[1.0], np.zeros(4), np.zeros((3, 1)), "three", None, [1j, 0, 0]])
def test_results_of_wrong_shape_raise(robot, result):
    task = tasks.Residual(lambda frames: result, frames=["tool"], rows=3)
    with pytest.raises(kinopt.InvalidValueError, match="the residual's function returned"):
        kinopt.Solver().solve(kinopt.Problem(robot, [task]), robot.neutral())
    task = tasks.Residual(at_target, jacobian=lambda frames: result, frames=["tool"], rows=3)
    with pytest.raises(kinopt.InvalidValueError, match="the residual's jacobian returned"):
        kinopt.Solver().solve(kinopt.Problem(robot, [task]), robot.neutral())


def test_residual_pickles_if_its_function_does(robot):
    problem = kinopt.Problem(robot, [user_residual(jacobian=slope_at_target)])
    expected = kinopt.Solver().solve(problem, robot.neutral()).q
    for twin in (pickle.loads(pickle.dumps(problem)), copy.deepcopy(problem)):
        assert np.array_equal(kinopt.Solver().solve(twin, robot.neutral()).q, expected)
    with pytest.raises((pickle.PicklingError, AttributeError)):
        pickle.dumps(kinopt.Problem(robot, [tasks.Residual(lambda f: f, frames=["tool"], rows=3)]))


@pytest.mark.parametrize(
    "given",
    [
        {"function": 3, "frames": ["tool"], "rows": 3},
        {"frames": "tool", "rows": 3},
        {"frames": [3], "rows": 3},
        {"frames": ["paw"], "rows": 3},
        {"joints": ["elbow"], "rows": 3},
        {"joints": "some", "rows": 3},
        {"rows": 3},
        {"frames": ["tool"], "rows": 0},
        {"frames": ["tool"], "rows": -3},
        {"frames": ["tool"], "rows": 2.5},
        {"frames": ["tool"], "rows": {}},
        {"frames": ["tool"], "rows": {"miles": 3}},
        {"frames": ["tool"], "rows": 3, "jacobian": 3},
    ],
)
def test_invalid_arguments_raise(robot, given):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Problem(robot, [tasks.Residual(given.pop("function", at_target), **given)])


def test_wrong_jacobian_entry_is_named(robot):
    q = robot.random_configuration(seed=4)

    def leans(frames, joints):
        return [frames[0, :3, 0] @ [0.3, 0.2, 0.1] + np.sin(joints[1]), frames[1, 2, 3] * joints[0]]

    def slope(frames, joints):
        turning = np.cross(frames[0, :3, 0], [0.3, 0.2, 0.1])
        rows = np.zeros((2, 14))
        rows[0, 3:6] = turning
        rows[0, 13] = np.cos(joints[1])
        rows[1, 8] = joints[0]
        rows[1, 12] = frames[1, 2, 3]
        return rows

    def residual(jacobian):
        reads = {"frames": ["tool", "hand"], "joints": ["joint2", "joint3"]}
        return tasks.Residual(leans, **reads, rows=2, jacobian=jacobian, name="lean")

    residual(slope).check_jacobian(robot, q)
    residual(slope).check_jacobian(robot.model, q, tolerance=1e-8)
    for row, column, words in [
        (0, 4, "angular velocity about y of the frame 'tool'"),
        (1, 8, "velocity along z of the frame 'hand'"),
        (0, 13, "the joint 'joint3'"),
    ]:

        def wrong(frames, joints, row=row, column=column):
            rows = slope(frames, joints)
            rows[row, column] += 0.01
            return rows

        with pytest.raises(kinopt.InvalidValueError, match=f"of lean is wrong in 1 .* row {row} by .*{words}"):
            residual(wrong).check_jacobian(robot, q)
    with pytest.raises(kinopt.InvalidValueError, match="has no jacobian"):
        residual(None).check_jacobian(robot, q)
    with pytest.raises(kinopt.InvalidValueError, match="expected \\(2, 14\\)"):
        residual(lambda frames, joints: np.zeros((2, 13))).check_jacobian(robot, q)


def test_jacobian_of_ball_joint_is_checked():
    builder = kinopt.ModelBuilder("arm")
    builder.joint("hinge", "revolute", axis=[0, 0, 1], lower=-2.0, upper=2.0)
    builder.ball("wrist", "hinge")
    builder.frame("hand", "wrist")
    model = builder.build()
    q = model.random_configuration(seed=3)

    def function(joints):
        hinge, w, x, y, z = joints
        return np.array([x * z + hinge, w * y])

    def slope(joints):
        hinge, w, x, y, z = joints
        return np.array([[1.0, 0.0, z, 0.0, x], [0.0, y, 0.0, w, 0.0]])

    def residual(jacobian):
        return tasks.Residual(function, joints=["hinge", "wrist"], rows=2, jacobian=jacobian)

    residual(slope).check_jacobian(model, q, tolerance=1e-8)
    residual(slope).check_jacobian(model, model.neutral(), tolerance=1e-8)
    # A derivative along q is irrelevant, because it only leaves the unit sphere.
    residual(lambda joints: slope(joints) + np.outer([1.0, 2.0], [0.0, *joints[1:]])).check_jacobian(model, q)
    with pytest.raises(kinopt.InvalidValueError, match="rotation about . of the joint 'wrist'"):
        residual(lambda joints: slope(joints) * [1, 1, 1.5, 1, 1]).check_jacobian(model, q)
