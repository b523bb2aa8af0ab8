"""No joint moves farther from the start than `max_move`: one step of a controller."""

import numpy as np
import pytest

import kinopt
from kinopt import tasks


@pytest.fixture
def body():
    builder = kinopt.ModelBuilder("body")
    builder.free("base")
    builder.ball("shoulder", "base", swing=1.5, twist=(-1.0, 1.0))
    builder.joint("elbow", "revolute", "shoulder", axis=[0, 0, 1], lower=-2.0, upper=2.0)
    tip = np.eye(4)
    tip[0, 3] = 1.0
    builder.frame("hand", "elbow", tip)
    return builder.build()


def angle(p, q):
    return 2 * np.arccos(min(1.0, abs(float(np.dot(p, q)))))


@pytest.fixture
def problem(body):
    goal = np.eye(4)
    goal[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    goal[:3, 3] = [3.0, 4.0, 5.0]
    return kinopt.Problem(body, [tasks.Pose("hand", goal)])


def test_move_is_speed_times_time_step(body, problem):
    start = body.neutral()
    max_move = np.array([0.01, 0.02, 0.03] + [0.04] * 4 + [0.05] * 4 + [0.06])
    solution = kinopt.Solver().solve(problem, start, max_move=max_move)
    q = solution.q
    assert (np.abs(q - start)[[0, 1, 2, 11]] <= max_move[[0, 1, 2, 11]]).all()
    assert np.allclose(np.abs(q[:3] - start[:3]), max_move[:3])
    assert angle(q[3:7], start[3:7]) <= 0.04 + 1e-7
    assert angle(q[7:11], start[7:11]) <= 0.05 + 1e-7
    held = {limit.joint for limit in solution.active_limits if limit.kind == "move"}
    assert {"base/x", "base/y", "base/z", "base/rotation", "shoulder"} <= held


def test_moves_by_joint_or_by_one_angle(body, problem):
    start = body.neutral()
    q = kinopt.Solver().solve(problem, start, max_move={"shoulder": 0.1, "elbow": 0.0}).q
    assert q[11] == start[11] and angle(q[7:11], start[7:11]) <= 0.1 + 1e-7
    q = kinopt.Solver().solve(problem, start, max_move=0.1).q
    assert abs(q[11]) <= 0.1 and angle(q[3:7], start[3:7]) <= 0.1 + 1e-7
    assert (np.abs(q[:3]) <= 0.1 * 0.25 * 1.0 + 1e-9).all()


@pytest.mark.parametrize(
    "given",
    [np.full(3, 0.1), np.full(12, -1.0), np.full(12, np.nan), 0.0, np.arange(1.0, 13.0), {"shoulder": -1.0}],
)
def test_invalid_moves_raise(body, problem, given):
    with pytest.raises(kinopt.InvalidValueError):
        kinopt.Solver().solve(problem, body.neutral(), max_move=given)


def test_unknown_joints_raise(body, problem):
    with pytest.raises(kinopt.UnknownNameError, match="shoulder"):
        kinopt.Solver().solve(problem, body.neutral(), max_move={"knee": 1.0})


@pytest.mark.parametrize("method", ["ccd", "fabrik"])
def test_geometric_methods_keep_moves_reject_balls(body, problem, method):
    with pytest.raises(kinopt.InvalidValueError, match="is a ball"):
        kinopt.Solver(method).solve(problem, body.neutral(), max_move={"elbow": 0.1})
    builder = kinopt.ModelBuilder("arm")
    link = np.eye(4)
    link[0, 3] = 1.0
    for k in range(3):
        builder.joint(f"j{k}", "revolute", f"j{k - 1}" if k else None, link if k else None, lower=-2, upper=2)
    builder.frame("hand", "j2", link)
    arm = builder.build()
    reach = kinopt.Problem(arm, [tasks.Point("hand", [0.0, 2.0, 0.0])])
    start = np.array([0.1, 0.2, 0.3])
    q = kinopt.Solver(method).solve(reach, start, max_move=[0.2, 0.1, 0.05]).q
    assert (np.abs(q - start) <= [0.2, 0.1, 0.05]).all() and (q != start).any()


@pytest.mark.parametrize("threads", [1, 3])
def test_batch_limits_moves_from_each_start(body, problem, threads):
    starts = body.random_configuration(20, seed=3)
    max_move = np.full(12, 0.03)
    solver = kinopt.Solver()
    batch = solver.solve_batch(problem, starts, max_move=max_move, threads=threads)
    plain = [0, 1, 2, 11]
    assert (np.abs(batch.q - starts)[:, plain] <= 0.03).all()
    turned = [max(angle(p[3:7], q[3:7]), angle(p[7:11], q[7:11])) for p, q in zip(batch.q, starts, strict=True)]
    assert max(turned) <= 0.03 + 1e-7
    for start, solution in zip(starts, batch, strict=True):
        assert (solver.solve(problem, start, max_move=max_move).q == solution.q).all()
    one = solver.solve_batch(problem, starts[0], {0: np.stack([np.eye(4)] * 2)}, max_move={"elbow": 0.0})
    assert (one.q[:, 11] == starts[0, 11]).all()
    assert len(solver.solve_batch(problem, starts[:0], max_move=0.1)) == 0
    with pytest.raises(kinopt.InvalidValueError):
        solver.solve_batch(problem, starts, max_move=[0.1])


def test_ball_joint_keeps_total_angle():
    builder = kinopt.ModelBuilder("arm")
    builder.ball("shoulder", angle=0.5)
    builder.frame("hand", "shoulder")
    model = builder.build()
    assert model.joints[0].angle == 0.5
    goal = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    problem = kinopt.Problem(model, [tasks.Orientation("hand", goal)])
    solution = kinopt.Solver().solve(problem, model.neutral())
    assert np.allclose(solution.q, [np.cos(0.25), 0, 0, np.sin(0.25)], atol=1e-7)
    assert [limit.joint for limit in solution.active_limits] == ["shoulder"]
