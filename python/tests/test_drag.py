"""Drags: frame by frame, on one branch, within the displacement limit of a frame."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import methods, tasks

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def dragged(robot, **options):
    start = np.clip(np.array([0, 0.3, 0, -1.5, 0, 1.8, 0, 0.02, 0.02]), robot.lower, robot.upper)
    placement = kinopt.frame_placement(robot, "tool", start)
    problem = kinopt.Problem(robot, [tasks.Pose("tool", placement, name="hand")])
    return kinopt.Drag(problem, start, **options), placement, start


def test_hand_follows_the_mouse(robot):
    drag, placement, start = dragged(robot)
    assert drag.solution is None and np.array_equal(drag.q, start)
    for step in range(100):
        mouse = placement.copy()
        mouse[1, 3] += 0.002 * step
        solution = drag.advance({"hand": mouse})
        assert solution.reached and drag.jump is None
        before, start = start, drag.q
        assert np.abs(start - before).max() <= 0.15 + 1e-12
        assert np.array_equal(solution.q, start) and np.array_equal(drag.solution.q, start)
    drag.advance()
    assert drag.is_at_rest and not drag.is_speed_limited


def test_jumping_target_is_reached_in_frames(robot):
    drag, placement, start = dragged(robot, max_move=0.05)
    placement[0, 3] -= 0.2
    drag.set_targets({"hand": placement})
    solution = drag.advance()
    assert drag.is_speed_limited and not solution.reached
    assert any(limit.kind == "move" for limit in solution.active_limits)
    assert drag.follow().reached
    drag.set_configuration(start)
    assert np.array_equal(drag.q, start)
    assert drag.settle(frames=200).reached


def test_unreachable_target_is_reported(robot):
    drag, placement, _ = dragged(robot)
    placement[0, 3] = 3.0
    for _ in range(60):
        solution = drag.advance({"hand": placement})
        assert (solution.q >= robot.lower).all() and (solution.q <= robot.upper).all()
    assert not solution.reached and solution.is_out_of_reach


def test_branch_changes_only_with_search(robot):
    quiet, placement, _ = dragged(robot)
    leaping, _, _ = dragged(robot, search=8, seed=1)
    # Upside down behind the base.
    placement[:3, 3] = [-0.4, 0.1, 0.4]
    placement[:3, :3] = np.diag([1.0, -1.0, -1.0])
    leaps = []
    for _ in range(60):
        quiet.advance({"hand": placement})
        assert quiet.leap is None
        leaping.advance({"hand": placement})
        leaps += [leaping.leap] if leaping.leap else []
    assert leaping.solution.cost <= quiet.solution.cost * (1 + 1e-3)
    for jump in leaps:
        assert jump.joint in robot.joint_names and jump.distance > 0


def test_method_is_selectable(robot):
    drag, placement, _ = dragged(robot, solver=kinopt.Solver(methods.GaussNewton(), max_iterations=3))
    placement[2, 3] += 0.01
    assert drag.follow({"hand": placement}).reached
    with pytest.raises(kinopt.InvalidValueError, match="ccd"):
        dragged(robot, solver=kinopt.Solver("ccd"))


def test_exception_propagates_and_keeps_configuration(robot):
    fail = [False]

    def residual(frames):
        if fail[0]:
            raise KeyError("mine")
        return frames[0, :3, 3] - [0.4, 0.0, 0.6]

    problem = kinopt.Problem(robot, [tasks.Residual(residual, frames=["tool"], rows=3)])
    drag = kinopt.Drag(problem, robot.neutral())
    drag.follow()
    before, fail[0] = drag.q, True
    with pytest.raises(KeyError, match="mine"):
        drag.advance()
    assert np.array_equal(drag.q, before)
    fail[0] = False
    assert drag.advance().reached


def test_drag_is_shared_by_threads(robot):
    task = tasks.Residual(lambda f: f[0, :3, 3] - [0.4, 0.0, 0.6], frames=["tool"], rows=3)
    drag = kinopt.Drag(kinopt.Problem(robot, [task]), robot.neutral())
    with ThreadPoolExecutor(4) as pool:
        frames = [pool.submit(drag.advance) for _ in range(40)]
        looks = [pool.submit(lambda: (drag.q, drag.solution, drag.is_at_rest, drag.jump)) for _ in range(40)]
        assert all(frame.result().q.size for frame in frames) and all(look.result() for look in looks)
    assert drag.advance().reached


@pytest.mark.parametrize(
    "given",
    [{"max_move": 0.0}, {"max_move": np.nan}, {"search": 0}, {"start": np.zeros(3)}, {"start": np.full(9, np.nan)}],
)
def test_invalid_arguments_raise(robot, given):
    drag, _, start = dragged(robot)
    with pytest.raises(kinopt.KinoptError):
        kinopt.Drag(drag.problem, given.pop("start", start), **given)
    with pytest.raises(kinopt.KinoptError):
        drag.set_configuration(np.zeros(4))
    with pytest.raises(kinopt.KinoptError):
        drag.advance({"foot": np.eye(4)})
