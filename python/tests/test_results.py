"""Results as tables, files, pages of notebooks and plots: their numbers are those of the results."""

from __future__ import annotations

import csv
import json
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt import tasks
from kinopt.errors import FileError, InvalidValueError, UnknownNameError
from kinopt.retargeting import FigureTarget
from kinopt.tables import columns
from kinopt.types import Floats

MODELS = Path(__file__).parents[2] / "models"
Q = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])


@pytest.fixture(scope="module")
def arm() -> kinopt.Arm:
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    return kinopt.Arm(robot, "base", "flange")


@pytest.fixture(scope="module")
def path(arm: kinopt.Arm) -> kinopt.JointPath[Any]:
    targets = np.repeat(arm.base_from_tool(Q)[None], 40, axis=0)
    targets[:, 1, 3] += np.linspace(0, 0.2, 40)
    return kinopt.solve_path(arm, targets)


@pytest.fixture(scope="module")
def nao() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(MODELS / "aldebaran_nao.urdf", base_joint="free")


@pytest.fixture(scope="module")
def walk(nao: kinopt.Robot) -> kinopt.Trajectory[kinopt.RetargetReport]:
    return kinopt.retarget(MODELS / "captures/steps.bvh", nao)


def lift() -> kinopt.Model:
    """A rail of 2 m with a joint without limits, and one of the name of a column."""
    builder = kinopt.ModelBuilder("lift")
    builder.joint("rail", "prismatic", None, axis=(0, 0, 1), lower=0.0, upper=2.0)
    builder.joint("<spin>", "revolute", "rail", axis=(0, 0, 1))
    builder.joint("reached", "revolute", "<spin>", axis=(1, 0, 0), lower=-1.0, upper=1.0)
    builder.frame("hook", "reached", kinopt.placement([0.5, 0.0, 0.0]))
    return builder.build()


def test_coordinates_name_units_and_limits(arm: kinopt.Arm, nao: kinopt.Robot) -> None:
    solution = arm.solve(arm.base_from_tool(Q), Q)
    found = solution.coordinates
    assert found.names == arm.joint_names and set(found.units) == {"rad"} and len(found) == 7
    assert np.array_equal(found.lower, arm.lower) and np.array_equal(found.upper, arm.upper)
    assert pickle.loads(pickle.dumps(solution)).coordinates == found == arm.coordinates
    rail = kinopt.Arm(lift(), None, "hook").coordinates
    assert rail.units == ["m", "rad", "rad"] and rail.upper.tolist() == [2.0, np.inf, 1.0]
    assert pickle.loads(pickle.dumps(rail)).lower.tolist() == [0.0, -np.inf, -1.0]
    with pytest.raises(InvalidValueError, match="`elbow` in place of the model's `rail`"):
        kinopt.Trajectory([0.0], [[0.0] * 3], ["elbow", "<spin>", "reached"], None, kinopt.Arm(lift(), None, "hook"))
    problem = kinopt.Problem(nao, [tasks.Posture(nao.neutral())])
    body = kinopt.Solver().solve(problem, nao.neutral()).coordinates
    assert body.names == nao.coordinate_names and body.units[:5] == ["m", "m", "m", "", ""]
    assert kinopt.Solver().solve_batch(problem, nao.neutral()).coordinates == body


def test_batches_are_tables(arm: kinopt.Arm) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    targets = arm.base_from_tool(np.random.default_rng(1).uniform(arm.lower, arm.upper, (50, 7)))
    targets[7, 0, 3] += 5.0
    batch = arm.solve_batch(targets, Q)
    frame = batch.to_frame()
    assert frame.columns.tolist() == [*arm.joint_names, "reached", "position_error", "orientation_error", "iterations", "attempts"]
    assert np.array_equal(frame[arm.joint_names].to_numpy(), batch.q)
    assert frame.index[~frame.reached].tolist() == [7] and frame.position_error[7] == batch.position_error[7] > 3.0
    assert batch.to_arrow().to_pandas().equals(frame)
    problem = kinopt.Problem(arm.robot, [tasks.Point("flange", [0.4, 0.2, 0.5], name="hand")])
    solutions = kinopt.Solver().solve_batch(problem, np.zeros(9), {"hand": [[0.4, 0.2, 0.5], [0.3, 0.1, 0.6]]})
    table = solutions.to_frame()
    assert np.array_equal(table["joint4"], solutions.q[:, 3]) and "orientation_error" not in table and len(table) == 2


def test_paths_and_motions_are_tables(path: kinopt.JointPath[Any], walk: kinopt.Trajectory[Any]) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    assert np.array_equal(path.to_frame().to_numpy(), path.q)
    frame = walk.to_frame()
    assert frame.columns[0] == "time" and np.array_equal(frame.time, walk.times)
    assert np.array_equal(frame["left_foot in contact"], walk.report.contacts[:, 0])
    # Ankles and toes are contact points of the same frames.
    assert walk.report.contact_frames == ["left_foot", "right_foot"] * 2
    assert np.array_equal(frame["left_foot in contact 2"], walk.report.contacts[:, 2])
    assert walk.to_arrow().column_names == frame.columns.tolist()
    batch = kinopt.Arm(lift(), None, "hook").solve_batch([np.eye(4)])
    with pytest.raises(InvalidValueError, match="`reached`"):
        batch.to_frame()


@pytest.mark.parametrize(
    ("package", "extra", "use"),
    [
        ("pandas", "tables", kinopt.JointPath.to_frame),
        ("pyarrow", "tables", kinopt.JointPath.to_arrow),
        ("matplotlib", "plot", kinopt.JointPath.plot),
    ],
)
def test_missing_package_names_its_extra(
    path: kinopt.JointPath[Any], monkeypatch: pytest.MonkeyPatch, package: str, extra: str, use: Callable[[Any], Any]
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, f"{package}.pyplot", raising=False)
    with pytest.raises(ImportError, match=rf"{package}: pip install 'kinopt\[{extra}\]'"):
        use(path)


def test_tables_are_saved(path: kinopt.JointPath[Any], walk: kinopt.Trajectory[Any], tmp_path: Path) -> None:
    timed = path.trajectory(acceleration_limits=5.0)
    for motion, span in [(timed, {"times"}), (walk, {"fps", "contacts", "contact_frames", "contact_points"})]:
        for extension in ("npz", "json", "csv"):
            motion.save(tmp_path / f"motion.{extension}")
        with np.load(tmp_path / "motion.npz") as arrays:
            assert set(arrays) == {"q", "names"} | span
            assert np.array_equal(arrays["q"], motion.q) and arrays["names"].tolist() == motion.names
        document = json.loads((tmp_path / "motion.json").read_text())
        assert set(document) == {"q", "names"} | span and np.array_equal(document["q"], motion.q)
        rows = list(csv.reader((tmp_path / "motion.csv").open()))
        assert rows[0][: 1 + len(motion.names)] == ["time", *motion.names] and len(rows) == 1 + len(motion)
        assert [float(number) for number in rows[3][: 1 + len(motion.names)]] == [motion.times[2], *motion.q[2]]
    assert rows[0] == list(columns(walk)) and {row[-1] for row in rows[1:]} == {"0", "1"}
    # Bare rows have the quaternion of the base as x, y, z, w.
    walk.save(tmp_path / "bare.csv", header=False)
    bare = np.loadtxt(tmp_path / "bare.csv", delimiter=",")
    order = [0, 1, 2, 4, 5, 6, 3, *range(7, bare.shape[1])]
    assert np.array_equal(bare, walk.q[:, order])


def test_files_that_fail_are_reported(walk: kinopt.Trajectory[Any], tmp_path: Path) -> None:
    with pytest.raises(InvalidValueError, match="npz, .json, .csv, .bvh or .glb"):
        walk.save(tmp_path / "walk.fbx")
    with pytest.raises(InvalidValueError, match="needs a figure"):
        walk.save(tmp_path / "walk.bvh")
    with pytest.raises(UnknownNameError, match="layout"):
        walk.save(tmp_path / "walk.csv", layout="qpos")  # type: ignore[arg-type]
    with pytest.raises(FileError, match="nowhere"):
        walk.save(tmp_path / "nowhere" / "walk.npz")
    assert list(tmp_path.iterdir()) == []


def figures(folder: Path) -> dict[str, Any]:
    """The humanoid as each kind of target."""
    rig = kinopt.Rig.read(MODELS / "humanoid/humanoid.json")
    kinopt.Scene.of_skeleton(rig.skeleton, rig.mesh, rig.weights).write(folder / "scene.glb", up=(0.0, 0.0, 1.0))
    return {
        "rig": rig,
        "skeleton": rig.skeleton,
        "scene": kinopt.Scene.read(folder / "scene.glb"),
        "file": folder / "scene.glb",
        "capture": kinopt.MotionCapture.read(MODELS / "captures/steps.bvh"),
    }


@pytest.mark.parametrize("kind", ["rig", "skeleton", "scene", "file", "capture"])
def test_figures_are_saved_as_animations(kind: str, tmp_path: Path) -> None:
    motion = kinopt.retarget(MODELS / "captures/steps.bvh", figures(tmp_path)[kind])
    expected = kinopt.retargeting.to_clip(motion, motion.model)
    motion.save(tmp_path / "motion.bvh")
    motion.save(tmp_path / "motion.glb", clip="steps")
    capture, scene = kinopt.MotionCapture.read(tmp_path / "motion.bvh"), kinopt.Scene.read(tmp_path / "motion.glb")
    assert capture.frames == len(motion) and [clip.name for clip in scene.clips][-1] == "steps"
    assert bool(scene.meshes) == (kind in ("rig", "scene", "file"))
    figure = motion.model if isinstance(motion.model, FigureTarget) else FigureTarget(motion.model)
    armature = figure.armature
    bones = [bone for bone in armature.names if bone in scene.armature.names and bone in capture.armature.names]
    assert len(bones) > 10
    for time in (0.0, 1.0, 3.0):
        distance = spread(armature, expected.sample(time), bones)
        assert spread(scene.armature, scene.clip("steps").sample(time), bones) == pytest.approx(distance, abs=1e-4)
        assert spread(capture.armature, capture.clip.sample(time), bones) == pytest.approx(distance, abs=1e-4)
    again = pickle.loads(pickle.dumps(motion))
    again.save(tmp_path / "again.bvh")
    assert (tmp_path / "again.bvh").read_text() == (tmp_path / "motion.bvh").read_text()


def spread(armature: Any, pose: Any, bones: list[str]) -> Floats:
    """Distances of bones from the first one, which are independent of the axes of a file."""
    origins = np.array([armature.model_from_bone(pose, bone)[:3, 3] for bone in bones])
    return np.asarray(np.linalg.norm(origins - origins[0], axis=1))


def test_pages_have_names_values_and_limits(arm: kinopt.Arm, path: kinopt.JointPath[Any], walk: kinopt.Trajectory[Any]) -> None:
    solution = arm.solve(arm.base_from_tool(Q), Q)
    page = solution._repr_html_()
    assert page.count("<tr>") == 8 and page.count("<circle") == 7 and solution.explain() in page
    for name, value, lower in zip(arm.joint_names, solution.q, arm.lower):
        assert f"<td>{name}</td><td>{value:.4f}</td>" in page and f"[{lower:.3f}" in page
    assert path._repr_html_().count("<polyline") == 7 and "40 rows, reached" in path._repr_html_()
    assert "more joints are not shown" not in walk._repr_html_() and walk._repr_html_().count("<polyline") == len(walk.names)
    spin = kinopt.Arm(lift(), None, "hook").solve(kinopt.placement([0.5, 0.0, 3.0]))._repr_html_()
    assert "<spin>" not in spin and "&lt;spin&gt;" in spin and "<td>none</td>" in spin


def curve(axes: Any) -> Floats:
    """The y values of the last line of axes."""
    return np.asarray(axes.get_lines()[-1].get_ydata())


def joint_axes(figure: Any) -> dict[str, Any]:
    """Axes of joints by their titles."""
    return {axes.get_title(loc="left"): axes for axes in figure.axes if axes.get_title(loc="left")}


def test_path_plot_has_joints_limits_and_tool(arm: kinopt.Arm, path: kinopt.JointPath[Any]) -> None:
    plots = pytest.importorskip("matplotlib.pyplot")
    figure = path.plot()
    drawn = joint_axes(figure)
    assert list(drawn) == [f"{name} (rad)" for name in arm.joint_names]
    for k, axes in enumerate(drawn.values()):
        assert np.array_equal(curve(axes), path.q[:, k])
        bands = sorted(patch.get_extents().transformed(axes.transData.inverted()).intervaly.tolist() for patch in axes.patches)
        assert bands[0][1] == pytest.approx(arm.lower[k]) and bands[1][0] == pytest.approx(arm.upper[k])
    space = next(axes for axes in figure.axes if hasattr(axes, "get_zlim"))
    assert np.allclose(np.array(space.get_lines()[0].get_data_3d()).T, arm.base_from_tool(path.q)[:, :3, 3])
    assert (space.get_xlabel(), space.get_zlabel()) == ("x (m)", "z (m)")
    assert list(joint_axes(path.plot(joints=["joint4"]))) == ["joint4 (rad)"]
    with pytest.raises(UnknownNameError, match="`elbow`.*joint4"):
        path.plot(joints=["elbow"])
    given = plots.figure()
    assert path.plot(figure=given) is given
    plots.close("all")


def test_jumps_are_drawn_between_rows(arm: kinopt.Arm) -> None:
    plots = pytest.importorskip("matplotlib.pyplot")
    target = arm.base_from_tool(Q)
    near, *_, far = arm.solve_all(target, Q).q
    jumping = kinopt.solve_path(arm, [target] * 3, start=near, end=far)
    (jump,) = jumping.jumps
    axes = joint_axes(jumping.plot())["joint1 (rad)"]
    assert axes.get_lines()[0].get_xdata() == [jump.index - 0.5] * 2
    plots.close("all")


def test_trajectory_plot_is_the_spline(path: kinopt.JointPath[Any]) -> None:
    plots = pytest.importorskip("matplotlib.pyplot")
    timed = path.trajectory(acceleration_limits=5.0)
    axes = joint_axes(timed.plot())["joint1 (rad)"]
    times = axes.get_lines()[-1].get_xdata()
    assert times[-1] == timed.duration and np.array_equal(curve(axes), timed.at(times).q[:, 0])
    plots.close("all")


def test_balance_is_drawn_from_above(nao: kinopt.Robot, walk: kinopt.Trajectory[Any]) -> None:
    plots = pytest.importorskip("matplotlib.pyplot")
    figure = walk.plot()
    assert not any(title.startswith("root_joint") for title in joint_axes(figure))
    ground = next(axes for axes in figure.axes if axes.get_title() == "centre of mass from above")
    segments = ground.collections[0].get_segments()
    centres = nao.center_of_mass(walk.q)[:, :2]
    assert np.allclose([segment[0] for segment in segments], centres[:-1])
    # Both feet are on the ground at the start: the first polygon contains all corners of both soles.
    assert walk.report.contacts[0].all()
    corners = ground.patches[0].get_path()
    for foot in walk.report.contact_frames:
        place = kinopt.frame_placement(nao, foot, walk.q[0])
        assert corners.contains_points((nao.sole(foot) @ place[:3, :3].T + place[:3, 3])[:, :2], radius=2e-3).all()
    given = walk.plot(support=[[0, 0, 0], [0.2, 0, 0], [0.2, 0.3, 0], [0.1, 0.1, 0], [0, 0.3, 0]])
    ground = next(axes for axes in given.axes if axes.get_title() == "centre of mass from above")
    assert len(ground.patches) == 1 and len(ground.patches[0].get_xy()) == 5  # Four corners, closed.
    plots.close("all")


def test_solution_plot_marks_active_limits(arm: kinopt.Arm) -> None:
    plots = pytest.importorskip("matplotlib.pyplot")
    far = kinopt.placement([0.0, 0.0, 3.0])
    model = lift()
    missed = kinopt.Arm(model, None, "hook").solve(far)
    assert [limit.joint for limit in missed.active_limits] == ["rail"]
    (axes,) = missed.plot().axes
    points = {line.get_label(): line for line in axes.get_lines() if line.get_label() in ("position", "active limit")}
    assert points["active limit"].get_ydata().tolist() == [0] and points["active limit"].get_xdata().tolist() == [1.0]
    assert len(points["position"].get_xdata()) == 2
    assert [label.get_text() for label in axes.get_yticklabels()] == ["rail", "<spin>", "reached"]
    plots.close("all")
