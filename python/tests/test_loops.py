"""Models with closed loops: closing joints, loops in solutions, and forward kinematics."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

ROOT = Path(__file__).parents[2]
LEG = ROOT / "tests" / "solver" / "loops" / "files" / "knee.xml"
GROUND, CRANK, COUPLER, ROCKER = 0.4, 0.12, 0.35, 0.3


def along_x(length):
    placement = np.eye(4)
    placement[0, 3] = length
    return placement


def four_bar():
    builder = kinopt.ModelBuilder("four-bar")
    limits = {"lower": -4.0, "upper": 4.0}
    builder.joint("crank", **limits)
    builder.joint("coupler", parent="crank", parent_from_joint=along_x(CRANK), **limits)
    builder.joint("rocker", parent_from_joint=along_x(GROUND), **limits)
    builder.frame("coupler end", "coupler", along_x(COUPLER))
    builder.frame("rocker", "rocker")
    builder.close("pin", ["coupler end", "rocker"], places=[np.eye(4), along_x(ROCKER)])
    return builder.build()


def freudenstein(crank, rocker):
    """Zero if the loop is closed (Freudenstein 1954)."""
    k3 = (CRANK**2 - COUPLER**2 + ROCKER**2 + GROUND**2) / (2 * CRANK * ROCKER)
    return GROUND / CRANK * np.cos(rocker) - GROUND / ROCKER * np.cos(crank) + k3 - np.cos(crank - rocker)


def test_dependent_joints_follow_in_batches():
    model = four_bar()
    closure = kinopt.LoopClosure(model, ["coupler", "rocker"])
    q = np.column_stack([np.linspace(-3.0, 3.0, 50), np.full(50, 0.5), np.full(50, 1.5)])
    closed = closure.close(q)
    assert closed.shape == (50, 3)
    np.testing.assert_array_equal(closed[:, 0], q[:, 0])
    np.testing.assert_allclose(freudenstein(closed[:, 0], closed[:, 2]), 0.0, atol=1e-8)
    np.testing.assert_array_equal(closure.close(q[7]), closed[7])
    ((name, gap, angle),) = closure.gaps(closed[3])
    assert (name, angle) == ("pin", 0.0) and gap <= 1e-9
    ((_, gap, _),) = closure.gaps([0.0, 0.0, 0.0])
    assert gap == pytest.approx(GROUND + ROCKER - CRANK - COUPLER, abs=1e-12)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(closure)).close(q), closed)
    drawn = closure.random_configuration(3)
    assert abs(freudenstein(drawn[0], drawn[2])) < 1e-8


def test_solution_closes_loops_or_names_open_ones():
    model = four_bar()
    assert [(name, kind, frames) for name, kind, frames, _ in model.loops] == [
        ("pin", "connect", ["coupler end", "rocker"])
    ]
    solver = kinopt.Solver()
    unreachable = kinopt.Problem(model, [tasks.Point("coupler end", [2.0, 1.0, 0.0])])
    solution = solver.solve(unreachable, [0.5, 0.5, 1.5])
    assert not solution.reached and solution.loops_closed and solution.open_loops == []
    assert abs(freudenstein(solution.q[0], solution.q[2])) < 1e-8
    assert [task.is_loop for task in solution.tasks] == [False, True]
    held = kinopt.ParameterMap(model, lock={"coupler": 0.0, "rocker": 0.0})
    solution = solver.solve(kinopt.Problem(model, far_tasks(), parameters=held), [0.0, 0.0, 0.0])
    assert not solution.loops_closed
    ((name, gap, _),) = solution.open_loops
    assert name == "pin" and gap > 0.2
    assert "loop `pin` is open by" in solution.explain()


def far_tasks():
    return [tasks.Point("coupler end", [0.3, 0.3, 0.0])]


def test_mjcf_knee_follows_its_motor():
    robot = kinopt.Robot.from_mjcf(LEG)
    closure = kinopt.LoopClosure(robot)
    assert closure.dependent == ["knee_rod", "knee", "ankle_rod", "ankle"]
    assert "base/rotation" in robot.passive_joints
    names = robot.coordinate_names
    q = robot.neutral()
    q[names.index("knee_motor")] = 0.5
    closed = closure.close(q)
    assert closed[names.index("knee")] > 0.3
    assert max(gap for _, gap, _ in closure.gaps(closed)) <= 1e-9
    q[names.index("knee_motor")] = 1.6
    with pytest.raises(kinopt.InvalidValueError, match="loop `knee_rod` is open by"):
        closure.close(q)
    open_robot = robot.without_loops()
    assert open_robot.loops == [] and len(robot.loops) == 2


def test_urdf_robot_keeps_loops_in_copies():
    robot = kinopt.Robot.from_urdf(ROOT / "models" / "rethink_baxter.urdf")
    grips = []
    for side in (1.0, -1.0):
        grip = along_x(0.0)
        grip[1:3, 1:3] = [[0.0, -side], [side, 0.0]]
        grip[2, 3] = 0.2
        grips.append(grip)
    hands = robot.with_loop("box", ["left_tool", "right_tool"], "weld", grips)
    hands = hands.with_passive_joints(robot.chain("torso", "right_tool"))
    for same in (hands, copy.deepcopy(hands), pickle.loads(pickle.dumps(hands))):
        ((name, kind, frames, placements),) = same.loops
        assert (name, kind, frames) == ("box", "weld", ["left_tool", "right_tool"])
        np.testing.assert_array_equal(placements, grips)
        assert same.passive_joints == hands.passive_joints
    problem = kinopt.Problem(hands, [tasks.Point("left_tool", [0.7, 0.2, 0.3])])
    solution = kinopt.Solver().solve(problem, hands.neutral())
    assert solution.reached and solution.loops_closed
    placed = kinopt.ForwardKinematics(hands, ["left_tool", "right_tool"]).place(solution.q)
    boxes = placed @ np.array(grips)
    np.testing.assert_allclose(boxes[0], boxes[1], atol=2e-9)
    # An arm does not close loops.
    with pytest.raises(kinopt.InvalidValueError, match="moves loop `box`"):
        kinopt.Arm(hands, None, "left_tool")


def test_invalid_arguments_are_named():
    robot = kinopt.Robot.from_urdf(ROOT / "models" / "rethink_baxter.urdf")
    ends = ["left_tool", "right_tool"]
    with pytest.raises(kinopt.UnknownNameError, match="left_tol"):
        robot.with_loop("box", ["left_tol", "right_tool"])
    with pytest.raises(kinopt.UnknownNameError, match="hinge"):
        robot.with_loop("box", ends, "hinge")
    with pytest.raises(kinopt.InvalidValueError, match="loop `box` cannot close"):
        robot.with_loop("box", ends, places=[along_x(99.0), np.eye(4)])
    with pytest.raises(kinopt.InvalidValueError):
        robot.with_loop("box", ends, places=[along_x(np.nan), np.eye(4)])
    with pytest.raises(kinopt.UnknownNameError, match="elbow"):
        robot.with_passive_joints(["elbow"])
    looped = robot.with_loop("box", ends)
    with pytest.raises(kinopt.InvalidValueError, match="no passive joints"):
        kinopt.LoopClosure(looped)
    closure = kinopt.LoopClosure(looped, robot.chain("torso", "right_tool"))
    with pytest.raises(kinopt.InvalidValueError):
        closure.close(np.zeros(3))
    with pytest.raises(kinopt.InvalidValueError):
        closure.close(np.full(len(robot.coordinate_names), np.nan))
