"""Arms solve reachable targets by forward kinematics: single poses, batches and paths."""

import copy
import os
import pickle
import signal
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"
START = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


@pytest.fixture(scope="module")
def arm(robot):
    return kinopt.Arm(robot, "base", "flange")


@pytest.fixture(scope="module")
def targets(arm):
    q = np.random.default_rng(5).uniform(arm.lower, arm.upper, (300, 7))
    return arm.base_from_tool(q)


def errors_of(arm, q, targets):
    """Distances and angles between the tool at q and its targets, by numpy."""
    tool = arm.base_from_tool(q)
    distance = np.linalg.norm(tool[..., :3, 3] - targets[..., :3, 3], axis=-1)
    turn = np.swapaxes(tool[..., :3, :3], -1, -2) @ targets[..., :3, :3]
    sine = np.stack(
        [
            turn[..., 2, 1] - turn[..., 1, 2],
            turn[..., 0, 2] - turn[..., 2, 0],
            turn[..., 1, 0] - turn[..., 0, 1],
        ],
        -1,
    )
    cosine = np.trace(turn, axis1=-2, axis2=-1) - 1
    return distance, np.arctan2(np.linalg.norm(sine, axis=-1), cosine)


def test_target_is_reached_within_limits(arm, targets):
    for target in targets[:50]:
        solution = arm.solve(target, START)
        assert solution.reached and solution.q.shape == (7,)
        assert (solution.q >= arm.lower).all() and (solution.q <= arm.upper).all()
        distance, angle = errors_of(arm, solution.q, target)
        assert distance < 1.001e-6 and angle < 1.001e-6
        assert abs(distance - solution.position_error) < 1e-12
        assert abs(angle - solution.orientation_error) < 1e-12


def test_poses_of_other_libraries_are_accepted(arm, targets):
    want = arm.solve(targets[0], START).q

    class Pinocchio:
        homogeneous = targets[0]

    class Viser:
        def as_matrix(self):
            return targets[0]

    class Spatialmath:
        A = targets[0]

    same = [Pinocchio(), Viser(), Spatialmath(), targets[0].tolist(), np.asfortranarray(targets[0])]
    for target in same:
        assert np.array_equal(arm.solve(target, START.tolist()).q, want)
    batch = arm.solve_batch(same, START)
    assert all(np.array_equal(q, want) for q in batch.q)


def test_batch_equals_single_queries_on_any_threads(arm, targets):
    batch = arm.solve_batch(targets, START)
    assert len(batch) == 300 and batch.reached.all()
    for i in range(0, 300, 7):
        solution = arm.solve(targets[i], START)
        assert np.array_equal(solution.q, batch.q[i])
        assert solution.position_error == batch.position_error[i]
        assert np.array_equal(batch[i].q, batch.q[i])
    starts = np.tile(START, (300, 1))
    out = np.empty((300, 7))
    for threads in (2, 3, None):
        again = arm.solve_batch(targets, starts, threads, out=out)
        assert again.q is out
        assert np.array_equal(out, batch.q)
    assert np.array_equal(errors_of(arm, out, targets)[0] < 1.001e-6, np.ones(300, bool))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_forked_process_does_not_wait_for_threads(arm, targets):
    batch = arm.solve_batch(targets, START, threads=2)
    with warnings.catch_warnings():
        # This test is about threads in a forked process.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        signal.alarm(120)
        same = np.array_equal(arm.solve_batch(targets, START, threads=2).q, batch.q)
        os._exit(0 if same else 1)
    assert os.waitpid(child, 0)[1] == 0
    assert np.array_equal(arm.solve_batch(targets, START, threads=2).q, batch.q)


def test_unreached_target_reports_error_and_reason(arm):
    unreachable = np.eye(4)
    unreachable[:3, 3] = 3.0, 0.0, 0.0
    solution = arm.solve(unreachable, START)
    assert not solution.reached and solution.position_error > 1
    assert "Not reached" in solution.explain()
    batch = arm.solve_batch([unreachable, unreachable], START)
    assert batch.explain(0) == solution.explain()
    assert batch.explain() == [solution.explain()] * 2
    assert not batch.reached.any()
    assert len(arm.solve_all(unreachable, START)) == 0


def test_all_solutions_differ_and_reach(arm, targets):
    found = arm.solve_all(targets[3], START)
    assert len(found) > 1 and not found.complete and found.argument is None
    assert found.shoulder == [None] * len(found)
    poses = np.broadcast_to(targets[3], (len(found), 4, 4))
    assert errors_of(arm, found.q, poses)[0].max() < 1.001e-6
    for i, one in enumerate(found.q):
        assert all(np.linalg.norm(one - other) > 0.3 for other in found.q[:i])


def test_six_joints_have_a_complete_set():
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    ur5e = kinopt.Arm(robot, "base", "flange", atlas=False)
    q = np.array([0.4, -1.2, 1.1, -0.8, 1.2, 0.5])
    found = ur5e.solve_all(ur5e.base_from_tool(q), q)
    assert found.complete and not found.has_family and found.argument == "three_parallel_axes"
    assert np.abs(found.q[0] - q).max() < 1e-9
    # Eight branches with two turns of each joint.
    assert len(found) == 8 * 64
    branches = set(zip(found.shoulder, found.elbow, found.wrist))
    assert len(branches) == 8 and {name for names in branches for name in names} == {
        "left", "right", "up", "down", "flip", "no_flip",
    }
    assert found.position_errors.max() < 1e-9 and found.orientation_errors.max() < 1e-9


def test_self_motions_keep_the_tool_at_its_target(arm, targets):
    motions = arm.self_motions(targets[3])
    for motion in motions:
        poses = arm.base_from_tool(motion.q)
        assert np.abs(poses - targets[3]).max() < 1e-9
        assert len(motion) == 1 or np.abs(np.diff(motion.q, axis=0)).max() <= 0.05
    # The solutions of single queries lie on the curves.
    samples = np.concatenate([motion.q for motion in motions])
    for q in arm.solve_all(targets[3]).q:
        assert np.abs(samples - q).max(axis=1).min() < 0.05


def test_path_is_followed_without_jumps(arm):
    change = np.linspace(0, 1, 200)[:, None] * np.array([0.5, 0.3, -0.4, 0.2, 0.5, -0.3, 0.4])
    path = arm.base_from_tool(START + change)
    track = arm.track(path, START)
    assert track.reached and track.report.reached.all() and track.jumps == [] and len(track) == 200
    assert np.abs(np.diff(track.q, axis=0)).max() < 0.05
    assert errors_of(arm, track.q, path)[0].max() < 1.001e-6
    follower = arm.follower(START)
    for target in path:
        solution, jump = follower.advance(target)
        assert solution.reached and jump is None
    assert np.array_equal(follower.q, solution.q)


def test_servo_keeps_velocity_limits(arm, targets):
    servo = arm.servo(START, 0.001)
    last = START
    for _ in range(300):
        step = servo.step(targets[0])
        assert (np.abs(step.q - last) <= arm.velocity_limits * 0.001 + 1e-15).all()
        last = step.q
    assert step.status in ("speed_limited", "on_target", "settling", "nearest")


def test_options_are_checked_keywords(robot, arm, targets):
    held = kinopt.Arm(robot, "base", "flange", locked={"joint3": 0.25}, goal=kinopt.PoseBounds.position())
    assert held.joint_names == [name for name in arm.joint_names if name != "joint3"]
    tool = np.eye(4)
    tool[2, 3] = 0.1
    longer = kinopt.Arm(robot, "base", "flange", tool=tool)
    assert np.allclose(longer.base_from_tool(START), arm.base_from_tool(START) @ tool, atol=1e-15)
    assert np.array_equal(arm.with_tool(tool).solve(targets[1], START).q, longer.solve(targets[1], START).q)
    for wrong in (
        {"atempts": 3},
        {"attempts": -1},
        {"position_tolerance": 0.0},
        {"search": "best"},
        {"joint_weights": [1.0]},
        {"locked": {"elbow": 0.0}},
        {"time_limit": -1.0},
        {"goal": 6},
        {"posture": np.full(7, np.nan)},
        {"tool": np.ones((4, 4))},
    ):
        with pytest.raises(kinopt.InvalidValueError):
            kinopt.Arm(robot, "base", "flange", **wrong)
    for frame in (("base", "flang"), ("bse", "flange")):
        with pytest.raises(KeyError, match="flang|bse"):
            kinopt.Arm(robot, *frame)
    with pytest.raises(kinopt.UnknownNameError, match="did you mean `attempts`|attempts"):
        kinopt.Arm(robot, "base", "flange", atempts=3)


def test_pickles_and_copies_solve_equally(robot, targets):
    arm = kinopt.Arm(robot, "base", "flange", search="nearest", max_move=np.full(7, 2.0), atlas=False)
    for twin in (pickle.loads(pickle.dumps(arm)), copy.deepcopy(arm)):
        for target in targets[:5]:
            assert np.array_equal(twin.solve(target, START).q, arm.solve(target, START).q)
    batch = arm.solve_batch(targets[:5], START)
    assert np.array_equal(batch.q[2], arm.solve(targets[2], START).q)


def test_batches_and_tracks_pickle_and_iterate(arm, targets):
    batch, track = arm.solve_batch(targets[:20], START), arm.track(targets[:3], START)
    for twin in (pickle.loads(pickle.dumps(batch)), copy.deepcopy(batch)):
        assert np.array_equal(twin.q, batch.q) and np.array_equal(twin.reached, batch.reached)
        assert twin.explain(3) == batch.explain(3)
    twin = pickle.loads(pickle.dumps(track))
    assert np.array_equal(twin.q, track.q) and len(twin.jumps) == len(track.jumps)
    assert twin.report.explain() == track.report.explain()
    assert [solution.reached for solution in batch] == batch.reached.tolist()
    assert len(track) == len(list(track.report)) == 3


def test_returned_arrays_are_read_only(arm, robot):
    for array in (arm.lower, robot.upper, robot.velocity_limits, arm.solve(arm.base_from_tool(START), START).q):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_option_arrays_are_copied(robot, targets):
    moves = np.full(7, 0.5)
    arm = kinopt.Arm(robot, "base", "flange", max_move=moves, atlas=False)
    before = arm.solve(targets[0], START).q
    moves[:] = 0.0
    assert np.array_equal(pickle.loads(pickle.dumps(arm)).solve(targets[0], START).q, before)


def test_arm_is_shared_by_threads(arm, targets):
    want = arm.solve_batch(targets, START).q
    found = np.zeros_like(want)

    def solve_part(part):
        for i in range(part, 300, 8):
            found[i] = arm.solve(targets[i], START).q

    threads = [threading.Thread(target=solve_part, args=(part,)) for part in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(found, want)


def test_progress_is_reported_and_its_exception_stops(arm, targets):
    calls = []
    many = np.repeat(targets, 20, axis=0)
    arm.solve_batch(many, START, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (6000, 6000) and len(calls) > 1
    assert [done for done, _ in calls] == sorted(done for done, _ in calls)

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        arm.solve_batch(many, START, progress=stop)


@pytest.mark.parametrize(
    "target",
    [
        np.eye(3),
        np.full((4, 4), np.nan),
        2 * np.eye(4),
        np.diag([1.0, 1.0, -1.0, 1.0]),
        np.eye(4, dtype=complex),
        np.eye(4).astype(str),
        [[1, 2], [3]],
        None,
        "pose",
        np.ones((4, 4)),
    ],
)
def test_invalid_pose_raises(arm, target):
    with pytest.raises(kinopt.KinoptError):
        arm.solve(target, START)
    with pytest.raises(kinopt.KinoptError):
        arm.solve_batch([target], START)


def test_invalid_target_of_batch_is_named(arm, targets):
    many = np.repeat(targets, 20, axis=0)
    many[5000, 0, 0] = np.nan
    with pytest.raises(kinopt.InvalidValueError, match="target 5000"):
        arm.solve_batch(many, START)
    with pytest.raises(kinopt.InvalidValueError, match="starts has 3 rows, targets has 300"):
        arm.solve_batch(targets, np.zeros((3, 7)))
    for out in (np.empty((300, 6)), np.empty((300, 7), np.float32), np.empty((7, 300)).T):
        with pytest.raises(kinopt.InvalidValueError, match="out must be"):
            arm.solve_batch(targets, START, out=out)
    frozen = np.empty((300, 7))
    frozen.flags.writeable = False
    with pytest.raises(kinopt.InvalidValueError, match="writable"):
        arm.solve_batch(targets, START, out=frozen)


def test_reachability_is_a_solution_or_a_proof(robot, targets):
    arm = kinopt.Arm(robot, "base", "flange")
    found = arm.reachability(targets[0])
    assert found.reachable and found.solution.reached and found.boxes == 0
    turned = kinopt.placement([0.8, 0, 0.3], rpy=[0, -1.57, 0])
    proof = arm.reachability(turned)
    assert proof.reachable is False and proof.boxes > 0
    assert proof.solution.is_out_of_reach and "Out of reach" in proof.explain()
    assert arm.reachability(turned, max_boxes=0).reachable is None


def test_goal_sets_rank_targets_of_tools(arm, targets):
    far = np.array(targets[:40])
    far[::4, :3, 3] += 3.0
    tools = np.tile(np.eye(4), (2, 1, 1))
    tools[1, 2, 3] = 0.1
    found = arm.solve_goals(far, tools, threads=2)
    assert found.reached.shape == found.cost.shape == (2, 40)
    assert found.reached[0, 1::4].all() and not found.reached[:, ::4].any()
    assert found.status[0][0] == "out of reach" and np.isnan(found.q[0][0]).all()
    single = arm.solve(far[1])
    np.testing.assert_array_equal(found.q[0][1], single.q)
    costs = found.cost[tuple(found.ranking.T)]
    assert (np.diff(costs) >= 0).all() and len(costs) == found.reached.sum()
    assert tuple(found.ranking[0]) == found.best
    assert "Out of reach" in found.explain(0, 0)

    wrist = kinopt.solve_goals([arm], far, criterion=lambda index, q: np.abs(q[:, 6]))
    reached = wrist.reached[0]
    np.testing.assert_array_equal(wrist.cost[0][reached], np.abs(wrist.q[0][reached, 6]))
    with pytest.raises(kinopt.UnknownNameError, match="distance, manipulability, clearance"):
        arm.solve_goals(far, criterion="speed")
    with pytest.raises(kinopt.InvalidValueError, match="one start for each arm"):
        kinopt.solve_goals([arm], far, starts=[START, START])
