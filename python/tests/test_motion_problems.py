"""Promise: trajectory optimisation in Python gives the results of the library: targets and weights by sample, exact
limits, misses, active limits, and contacts."""

import pickle
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"
FRAMES = 40
STEP = 1 / 30


@pytest.fixture(scope="module")
def arm() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")


def jump(arm: kinopt.Robot, **options: object) -> kinopt.MotionProblem:
    """The tool's target jumps by 40 cm halfway, too fast for its joints."""
    rest = np.array([0.0, -1.2, 1.5, -1.0, -1.5, 0.0])
    tip = arm.frame_names[-1]
    at = kinopt.frame_placement(arm, tip, rest)[:3, 3]
    targets = np.tile(at, (FRAMES, 1))
    targets[FRAMES // 2 :, 2] += 0.4
    given: dict[str, object] = {
        "targets": {"reach": targets},
        "acceleration": 1e-5,
        "max_speeds": dict.fromkeys(arm.coordinate_names, 0.8),
    } | options
    work = [
        tasks.Point(tip, at, name="reach"),
        tasks.Posture(rest, name="rest", scale=0.01),
    ]
    return kinopt.MotionProblem(arm, FRAMES, STEP, work, **given)  # type: ignore[arg-type]


def test_motion_keeps_limits_and_reports_errors(arm: kinopt.Robot) -> None:
    rest = np.array([0.0, -1.2, 1.5, -1.0, -1.5, 0.0])
    motion = jump(arm)
    assert (motion.frames, motion.time_step, motion.task_names) == (FRAMES, STEP, ["reach", "rest"])
    solved = motion.solve(rest)
    assert solved.q.shape == (FRAMES, 6) and len(solved) == FRAMES
    assert solved.names == arm.coordinate_names
    speeds = np.abs(np.diff(solved.q, axis=0)) / STEP
    assert speeds.max() <= 0.8
    assert speeds.max() > 0.79
    # It starts before the jump, and the target is missed in the middle.
    assert not solved.report.reached
    missed = {miss.frame for miss in solved.report.missed if miss.task == "reach"}
    assert FRAMES // 2 in missed or FRAMES // 2 - 1 in missed
    limits = solved.report.active_limits
    assert limits and all(limit.bound == "speed" for limit in limits)
    assert all(limit.push > 0 and limit.side in ("lower", "upper") for limit in limits)
    assert solved.report.cost == pytest.approx(solved.report.frame_costs.sum() + solved.report.cost_of_rates)
    # From a near start, in windows, and pickled, the result is equal.
    near = motion.solve(solved.q)
    assert near.report.cost == pytest.approx(solved.report.cost, rel=1e-5)
    again = pickle.loads(pickle.dumps(motion)).solve(rest)
    np.testing.assert_array_equal(again.q, solved.q)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(solved)).q, solved.q)
    windows = motion.solve(rest, windows=(20, 15))
    assert windows.report.cost == pytest.approx(solved.report.cost, rel=0.05)


def test_contact_and_fixed_frames_are_kept() -> None:
    nao = kinopt.Robot.from_urdf(MODELS / "aldebaran_nao.urdf")
    start = nao.neutral()
    frames = 12
    sole, hand = "left_sole", "left_hand"
    at = kinopt.frame_placement(nao, hand, start)[:3, 3]
    aims = at + np.linspace(0, 0.05, frames)[:, None] * np.array([0.0, 0.0, -1.0])
    motion = kinopt.MotionProblem(
        nao,
        frames,
        STEP,
        [tasks.Point(hand, at, name="hand"), tasks.Posture(start, scale=0.05)],
        targets={"hand": aims},
        weights={"hand": np.linspace(0, 1, frames)},
        velocity=(1e-3, {nao.coordinate_names[0]: 2.0}),
        contacts=[kinopt.Contact(sole, 0, frames, np.array([[0, 0, 0], [0.05, 0, 0], [0, 0.03, 0]]))],
        first=start,
    )
    solved = motion.solve(start)
    assert solved.report.slip < 1e-6
    np.testing.assert_allclose(solved.q[0], start, atol=1e-12)


def test_other_threads_run_meanwhile(arm: kinopt.Robot) -> None:
    motion = jump(arm)
    ticks: list[float] = []
    solves: list[tuple[float, float]] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    # A solve takes milliseconds, and on a machine with other load the other thread may wait for several of them.
    while len(solves) < 1000 and sum(end - start for start, end in solves) < 2.0:
        start = time.monotonic()
        motion.solve(np.zeros(6))
        solves.append((start, time.monotonic()))
    done.set()
    thread.join()
    within = [moment for moment in ticks if any(start < moment < end for start, end in solves)]
    # If it had to wait for the GIL, it would wake between two solves only.
    assert len(within) > len(ticks) / 4


def test_invalid_arguments_are_named(arm: kinopt.Robot) -> None:
    def assert_raises(kind: type[Exception], text: str, **options: object) -> None:
        with pytest.raises(kind, match=text):
            jump(arm, **options)

    assert_raises(kinopt.UnknownNameError, "task named `reech`", targets={"reech": np.zeros((FRAMES, 3))})
    assert_raises(kinopt.InvalidValueError, "are 3 for 40 frames", targets={"reach": np.zeros((3, 3))})
    bad = np.zeros((FRAMES, 3))
    bad[7, 1] = np.nan
    assert_raises(kinopt.InvalidValueError, "frame 7", targets={"reach": bad})
    assert_raises(kinopt.InvalidValueError, "weights of reach", weights={"reach": [1.0, 2.0]})
    assert_raises(kinopt.InvalidValueError, "frame 3", weights={"reach": [1.0] * 3 + [-1.0] * 37})
    assert_raises(kinopt.UnknownNameError, "elbow", max_speeds={"elbow": 1.0})
    assert_raises(kinopt.InvalidValueError, "max_speed", max_speeds={arm.coordinate_names[0]: -1.0})
    assert_raises(kinopt.InvalidValueError, "rate cost", jerk=-1.0)
    assert_raises(kinopt.UnknownNameError, "hip", acceleration=(1.0, {"hip": 2.0}))
    assert_raises(kinopt.UnknownNameError, "foot", contacts=[kinopt.Contact("foot", 0, 5)])
    tip = arm.frame_names[-1]
    assert_raises(kinopt.InvalidValueError, "0 to 99", contacts=[kinopt.Contact(tip, 0, 99)])
    assert_raises(kinopt.InvalidValueError, "first", first=np.zeros(3))
    assert_raises(kinopt.InvalidValueError, "fixed frame is outside", last=np.full(6, 99.0))
    with pytest.raises(kinopt.InvalidValueError, match="no frame"):
        kinopt.MotionProblem(arm, 0, STEP, [tasks.Posture(np.zeros(6))])
    with pytest.raises(kinopt.InvalidValueError, match="time_step"):
        kinopt.MotionProblem(arm, 3, 0.0, [tasks.Posture(np.zeros(6))])
    motion = jump(arm)
    for start in (np.zeros(3), np.zeros((3, 6)), np.full(6, np.nan)):
        with pytest.raises(kinopt.InvalidValueError):
            motion.solve(start)
    with pytest.raises(kinopt.InvalidValueError, match="tolerance"):
        motion.solve(np.zeros(6), tolerance=-1.0)


def between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Rotation angles between quaternions (w, x, y, z), row by row."""
    return 2 * np.arccos(np.clip(np.abs(np.sum(a * b, axis=-1)), 0, 1))


def test_free_bases_and_ball_joints_keep_speeds() -> None:
    free = kinopt.Robot.from_urdf(MODELS / "aldebaran_nao.urdf", base_joint="free")
    start = free.neutral()
    frame = free.frame_names[0]
    goal = np.eye(4)
    goal[:3, 3] = [0.6, 0.3, 0.2]
    goal[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    work = [tasks.Pose(frame, goal, name="base"), tasks.Posture(start, scale=0.01)]
    motion = kinopt.MotionProblem(
        free, FRAMES, STEP, work, acceleration=1e-3, first=start, max_speeds={"root_joint": (0.9, 1.3)}
    )
    q = motion.solve(start).q
    slid = np.linalg.norm(np.diff(q[:, :3], axis=0), axis=1)
    assert 0.89 * STEP < slid.max() <= 0.9 * STEP
    turned = between(q[1:, 3:7], q[:-1, 3:7])
    assert 1.29 * STEP < turned.max() <= 1.3 * STEP + 1e-7
    with pytest.raises(kinopt.UnknownNameError, match="rot_joint"):
        kinopt.MotionProblem(free, FRAMES, STEP, work, max_speeds={"rot_joint": (0.9, 1.3)})


def test_two_hands_hold_a_box_in_all_frames() -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "rethink_baxter.urdf")
    left, right = (kinopt.placement([0, 0, 0.2], wxyz=[0.5**0.5, side * 0.5**0.5, 0, 0]) for side in (1, -1))
    robot = robot.with_loop("box", ["left_tool", "right_tool"], "weld", places=[left, right])
    at = np.array([0.7, 0.2, 0.3])
    start = kinopt.Solver().solve(kinopt.Problem(robot, [tasks.Point("left_tool", at)]), robot.neutral()).q
    aims = at + np.linspace(0, 1, FRAMES)[:, None] * np.array([0.0, 0.0, 0.15])
    motion = kinopt.MotionProblem(
        robot,
        FRAMES,
        STEP,
        [tasks.Point("left_tool", at, name="hand"), tasks.Posture(start, scale=0.01)],
        targets={"hand": aims},
        acceleration=1e-4,
        first=start,
    )
    solved = motion.solve(start)
    assert solved.report.loop_gap <= 1e-9, solved
    assert not any("loop" in miss.task for miss in solved.report.missed)
    for q in solved.q:
        one = kinopt.frame_placement(robot, "left_tool", q) @ left
        other = kinopt.frame_placement(robot, "right_tool", q) @ right
        np.testing.assert_allclose(one, other, atol=3e-9)
    assert pickle.loads(pickle.dumps(solved)).report.loop_gap == solved.report.loop_gap
