"""Cartesian paths: the fewest reconfigurations, and bounds of the deviation between the points."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidFileError, InvalidValueError

MODELS = Path(__file__).parents[2] / "models"
Q = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])


@pytest.fixture(scope="module")
def arm() -> kinopt.Arm:
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    return kinopt.Arm(robot, "base", "flange")


def sideways(arm: kinopt.Arm, points: int = 60) -> np.ndarray:
    path = np.repeat(arm.base_from_tool(Q)[None], points, axis=0)
    path[:, 1, 3] += np.linspace(0, 0.25, points)
    return path


def test_line_is_one_segment(arm: kinopt.Arm) -> None:
    path = sideways(arm)
    solved = kinopt.solve_path(arm, path)
    assert solved.jumps == [] and solved.reached
    assert solved.q.shape == (60, 7) and solved.joint_names == arm.joint_names
    assert np.allclose(arm.base_from_tool(solved.q), path, atol=2e-6)
    assert np.all(solved.q >= arm.lower) and np.all(solved.q <= arm.upper)
    assert np.isclose(solved.report.length, np.linalg.norm(np.diff(solved.q, axis=0), axis=1).sum())
    # No sample between the rows exceeds the reported bound.
    share = np.linspace(0, 1, 11)[:, None, None]
    between = solved.q[:-1] + share * np.diff(solved.q, axis=0)
    expected = path[:-1, :3, 3] + share * np.diff(path[:, :3, 3], axis=0)
    away = arm.base_from_tool(between.reshape(-1, 7))[:, :3, 3].reshape(expected.shape) - expected
    assert np.linalg.norm(away, axis=-1).max() <= solved.report.largest_deviation + 1e-9 < 1e-3


def test_points_are_read_from_files(arm: kinopt.Arm, tmp_path: Path) -> None:
    x, y, z = arm.base_from_tool(Q)[:3, 3]
    rows = np.array([[x, y + 0.005 * k, z, 0.0, 1.0, 0.0, 0.0] for k in range(20)])
    by_points = kinopt.solve_path(arm, rows)
    file = tmp_path / "path.csv"
    np.savetxt(file, rows, delimiter=",", header="x,y,z,qw,qx,qy,qz", comments="")
    by_file = kinopt.solve_path(arm, file)
    assert np.array_equal(by_points.q, by_file.q)
    assert by_points.report.read_as is None and by_file.report.read_as is not None and "header" in by_file.report.read_as
    last = rows[:, [0, 1, 2, 4, 5, 6, 3]]
    assert np.array_equal(kinopt.solve_path(arm, last, order="w-last").q, by_points.q)


def test_ends_traversals_and_tools(arm: kinopt.Arm) -> None:
    path = sideways(arm)
    assert np.array_equal(kinopt.solve_path(arm, path, start=Q).q[0], Q)
    there_and_back = np.concatenate([path, path[-2:0:-1]])
    cyclic = kinopt.solve_path(arm, there_and_back, traversal="cyclic")
    assert cyclic.reached and np.abs(cyclic.q[-1] - cyclic.q[0]).max() < 0.1
    anywhere = kinopt.solve_path(arm, there_and_back, traversal="any-start")
    assert anywhere.q.shape == (len(there_and_back) + 1, 7)
    drill = np.eye(4)
    drill[2, 3] = 0.1
    drilling = arm.with_tool(drill)
    tools = [0] * 30 + [1] * 30
    both = kinopt.solve_path(arm, path, tools=[drilling], tool_of_points=tools)
    assert np.allclose(drilling.base_from_tool(both.q[30:]), path[30:], atol=2e-6)


def test_table_names_the_tool_of_a_point(arm: kinopt.Arm, tmp_path: Path) -> None:
    path = sideways(arm)
    drill = np.eye(4)
    drill[2, 3] = 0.1
    drilling = arm.with_tool(drill)
    tools = [0] * 30 + [1] * 30
    table = tmp_path / "two.csv"
    rows = [f"{x!r},{y!r},{z!r},{tool}" for (x, y, z), tool in zip(path[:, :3, 3].tolist(), tools)]
    table.write_text("\n".join(["x,y,z,tool", *rows]))
    seeking = [each.with_goal(kinopt.PoseBounds.position()) for each in (arm, drilling)]
    both = kinopt.solve_path(seeking[0], table, tools=seeking[1:])
    assert both.reached and "tools from column 4" in (both.report.read_as or "")
    assert np.allclose(drilling.base_from_tool(both.q[30:])[:, :3, 3], path[30:, :3, 3], atol=2e-6)
    with pytest.raises(InvalidValueError, match="point 30 is for tool 1"):
        kinopt.solve_path(seeking[0], table)


def test_missed_points_are_reported(arm: kinopt.Arm) -> None:
    path = sideways(arm)
    path[30, 0, 3] += 3.0
    solved = kinopt.solve_path(arm, path)
    [missed] = solved.report.missed
    assert missed.index == 30 and "beyond reach" in missed.reason and missed.position_error > 1.5
    assert not solved.reached


def test_solutions_are_pickled(arm: kinopt.Arm) -> None:
    path = sideways(arm)
    path[10, 0, 3] += 3.0
    solved = kinopt.solve_path(arm, path)
    back = pickle.loads(pickle.dumps(solved))
    assert np.array_equal(back.q, solved.q) and repr(back) == repr(solved)
    assert repr(back.report.missed) == repr(solved.report.missed)
    assert repr(back.jumps) == repr(solved.jumps)


def test_times_keep_the_limits_of_a_file(arm: kinopt.Arm, tmp_path: Path) -> None:
    lines = [f"  joint{joint}: {{max_velocity: 0.8, max_acceleration: {joint}}}" for joint in range(1, 8)]
    file = tmp_path / "joint_limits.yaml"
    file.write_text("joint_limits:\n" + "\n".join(lines))
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf").with_joint_limits(file)
    limited = kinopt.Arm(pickle.loads(pickle.dumps(robot)), "base", "flange")
    assert np.array_equal(limited.acceleration_limits, np.arange(1.0, 8.0))
    assert np.array_equal(robot.acceleration_limits[:7], np.arange(1.0, 8.0))
    solved = kinopt.solve_path(limited, sideways(limited))
    for solution in (solved, pickle.loads(pickle.dumps(solved))):
        times = solution.times()
        assert times.shape == (60,) and times[0] == 0.0 and np.all(np.diff(times) > 0)
        speeds = np.abs(np.diff(solution.q, axis=0)) / np.diff(times)[:, None]
        assert speeds.max() <= 0.8 + 1e-9
    # Slower joints take longer; a single number applies to all.
    assert solved.times(acceleration_limits=0.1)[-1] > solved.times()[-1]
    assert solved.times(velocity_limits=0.01)[-1] > 10 * solved.times()[-1]
    with pytest.raises(InvalidValueError, match="acceleration_limits"):
        kinopt.solve_path(arm, sideways(arm)).times()
    with pytest.raises(InvalidValueError, match="acceleration_limits"):
        solved.times(acceleration_limits=np.ones(6))
    file.write_text("joint_limits:\n  elbow: {max_velocity: 1}")
    with pytest.raises(InvalidFileError, match="elbow"):
        robot.with_joint_limits(file)


def test_trajectories_keep_limits(arm: kinopt.Arm) -> None:
    solved = kinopt.solve_path(arm, sideways(arm))
    limited = solved.trajectory(acceleration_limits=5.0, velocity_limits=1.0)
    assert np.array_equal(limited.times, solved.times(acceleration_limits=5.0, velocity_limits=1.0))
    assert limited.times[-1] == limited.duration and limited.names == solved.joint_names
    bounded = solved.trajectory(acceleration_limits=5.0, velocity_limits=1.0, jerk_limits=50.0, corner_tolerance=0.0)
    slow = solved.trajectory(acceleration_limits=5.0, velocity_limits=1.0, arm=arm, tool_linear_limits=(0.1, 1.0), tool_angular_limits=(0.5, np.inf))
    assert bounded.duration > limited.duration and slow.duration > limited.duration
    for trajectory in (limited, bounded, slow):
        times = np.linspace(0.0, trajectory.duration, 4001)
        points = trajectory.at(times)
        assert points.q.shape == points.velocity.shape == points.acceleration.shape == (4001, 7)
        assert np.abs(points.velocity).max() <= 1.0 + 1e-9
        assert np.abs(points.acceleration).max() <= 5.0 + 1e-8
        velocities = np.gradient(points.q, times, axis=0)
        assert np.abs(velocities - points.velocity)[1:-1].max() < 5.0 * times[1]
        assert np.abs(trajectory.at(trajectory.times).q - solved.q).max() < 1.1e-5
    with pytest.raises(InvalidValueError, match="time is NaN"):
        limited.at(np.nan)
    one = limited.at(0.5)
    assert one.q.shape == (7,) and np.array_equal(one.q, limited.at([0.5]).q[0])
    jerks = np.diff(bounded.at(np.linspace(0, bounded.duration, 4001)).acceleration, axis=0) * 4000 / bounded.duration
    assert np.abs(jerks).max() <= 50.0 * 1.001
    tool = np.array([np.asarray(arm.base_from_tool(q))[:3, 3] for q in slow.at(np.linspace(0, slow.duration, 1001)).q])
    speeds = np.linalg.norm(np.diff(tool, axis=0), axis=1) * 1000 / slow.duration
    assert 0.099 < speeds.max() <= 0.1001


def test_trajectories_are_pickled(arm: kinopt.Arm) -> None:
    solved = kinopt.solve_path(arm, sideways(arm))
    trajectory = solved.trajectory(acceleration_limits=5.0, jerk_limits=np.full(7, 50.0), arm=arm, tool_linear_limits=(0.3, 2.0))
    twin = pickle.loads(pickle.dumps(trajectory))
    assert np.array_equal(twin.times, trajectory.times)
    point = trajectory.at(0.3)
    assert np.array_equal(pickle.loads(pickle.dumps(point)).velocity, point.velocity)


def test_trajectory_limits_name_option_and_joint(arm: kinopt.Arm) -> None:
    solved = kinopt.solve_path(arm, sideways(arm))
    limits = np.ones(7)
    limits[3] = 0.0
    for option in ("acceleration_limits", "velocity_limits", "jerk_limits"):
        with pytest.raises(InvalidValueError, match=f"{option}.*{solved.joint_names[3]}"):
            solved.trajectory(**{"acceleration_limits": 1.0, option: limits})  # type: ignore[arg-type]
    # The tool is that of the path's arm, or of another one.
    slow = solved.trajectory(acceleration_limits=1.0, tool_linear_limits=(0.1, 1.0))
    assert np.array_equal(slow.times, solved.trajectory(acceleration_limits=1.0, tool_linear_limits=(0.1, 1.0), arm=arm).times)
    assert slow.duration > 0.25 / 0.1
    for wrong in (0.5, (0.1,), "fast", (0.1, None)):
        with pytest.raises(kinopt.InvalidValueError, match=r"tool_linear_limits is .*: \(speed, acceleration\) in m/s"):
            solved.trajectory(acceleration_limits=1.0, arm=arm, tool_linear_limits=wrong)
    with pytest.raises(InvalidValueError, match="corner_tolerance"):
        solved.trajectory(acceleration_limits=1.0, corner_tolerance=-1.0)


def test_invalid_input_is_named(arm: kinopt.Arm, tmp_path: Path) -> None:
    path = sideways(arm)
    path[3, 0, 0] = np.nan
    with pytest.raises(InvalidValueError, match="point 3"):
        kinopt.solve_path(arm, path)
    path = sideways(arm)
    with pytest.raises(InvalidValueError, match="no points"):
        kinopt.solve_path(arm, path[:0])
    with pytest.raises(InvalidValueError, match="traversal"):
        kinopt.solve_path(arm, path, traversal="round")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError, match="max_step"):
        kinopt.solve_path(arm, path, max_step=-1.0)
    with pytest.raises(InvalidValueError, match="start"):
        kinopt.solve_path(arm, path, start=np.zeros(7))
    with pytest.raises(InvalidValueError, match="times"):
        kinopt.solve_path(arm, path, times=np.zeros(60))
    with pytest.raises(InvalidValueError, match="shape"):
        kinopt.solve_path(arm, np.zeros((4, 5)))
    with pytest.raises(FileError, match="nowhere"):
        kinopt.solve_path(arm, tmp_path / "nowhere.csv")
    bad = tmp_path / "bad.csv"
    bad.write_text("x,y,z\n1,2,here\n")
    with pytest.raises(InvalidFileError, match="line 2"):
        kinopt.solve_path(arm, bad)


def test_pick_and_place_is_a_path_of_segments(arm: kinopt.Arm) -> None:
    home = arm.base_from_tool({})
    pick, place = home[:3, 3] + [0, 0.1, -0.1], home[:3, 3] + [0, -0.1, -0.1]
    path = kinopt.CartesianPath(home).through([pick + [0, 0, 0.1], pick, pick + [0, 0, 0.1]])
    path = path.arc_through(home[:3, 3] + [-0.05, 0, 0.05], place + [0, 0, 0.1]).through(place, step=0.005)
    assert np.linalg.norm(np.diff(path.points[:, :3, 3], axis=0), axis=1).max() <= 0.01 + 1e-12
    assert np.allclose(path.points[:, :3, :3], home[:3, :3], atol=1e-12)
    solved = kinopt.solve_path(arm, path, start={})
    assert solved.reached and solved.unreached == []
    assert solved.trajectory(acceleration_limits=5.0).duration > 0.5
    twin = pickle.loads(pickle.dumps(path))
    assert np.array_equal(twin.points, path.points)
    assert kinopt.solve_path(arm, twin, start={}).report.largest_deviation == solved.report.largest_deviation
    spline = kinopt.CartesianPath(home).spline_through([pick, place])
    assert all(np.abs(spline.points[:, :3, 3] - key).sum(axis=1).min() < 1e-12 for key in (pick, place))
    with pytest.raises(InvalidValueError, match="on one line"):
        path.arc_through(place, place)
    with pytest.raises(InvalidValueError, match="step"):
        path.through(place, step=-1.0)


def test_unreached_rows_are_timed_only_if_allowed(arm: kinopt.Arm) -> None:
    path = sideways(arm)
    path[30, 0, 3] += 3.0
    solved = kinopt.solve_path(arm, path)
    assert solved.unreached == [30]
    for time in (solved.times, solved.trajectory):
        with pytest.raises(InvalidValueError, match="1 of 60 rows .* row 30"):
            time(acceleration_limits=5.0)
        time(acceleration_limits=5.0, allow_unreached=True)
