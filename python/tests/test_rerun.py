"""Robots and motions logged to Rerun, read back from the recording."""

import re
from pathlib import Path

import numpy as np
import pytest

import kinopt

rr = pytest.importorskip("rerun", reason="SKIPPED LOUDLY: Rerun is not installed: pip install 'kinopt[rerun]'")


@pytest.fixture
def recorded(tmp_path):
    """Calls `kinopt.rerun.log` and returns the chunks of the recording by entity."""
    from rerun.chunk import RrdReader

    def record(*arguments, **options):
        recording = rr.RecordingStream("kinopt_test")
        recording.save(tmp_path / "motion.rrd")
        kinopt.rerun.log(*arguments, recording=recording, **options)
        recording.flush()
        recording.disconnect()
        chunks = RrdReader(tmp_path / "motion.rrd").stream()
        # An entity has moving and static components in separate chunks.
        return {chunk.entity_path + (" static" if chunk.is_static else ""): chunk for chunk in chunks}

    return record


def column(chunk, name):
    """Values of a component or a timeline, one entry a row."""
    return chunk.to_record_batch().column(name).to_pylist()


def matrices(chunk):
    """Transforms of a chunk, shape (N, 4, 4)."""
    placements = np.tile(np.eye(4), (chunk.num_rows, 1, 1))
    # Rerun stores matrices by columns.
    rotations = np.array(column(chunk, "Transform3D:mat3x3")).reshape(-1, 3, 3).swapaxes(1, 2)
    placements[:, :3, :3] = rotations
    placements[:, :3, 3] = np.array(column(chunk, "Transform3D:translation")).reshape(-1, 3)
    return placements


def panda_trajectory():
    robot = kinopt.models.panda()
    arm = kinopt.Arm(robot, "base", "tool")
    path = np.repeat(arm.base_from_tool([0, -0.8, 0, -2.4, 0, 1.6, 0.8])[None], 10, axis=0)
    path[:, 1, 3] += np.linspace(0, 0.1, 10)
    return robot, arm, kinopt.solve_path(arm, path).trajectory(acceleration_limits=5.0)


def test_trajectory_is_read_back_with_times(recorded):
    robot, arm, trajectory = panda_trajectory()
    chunks = recorded(robot, trajectory)
    tool = chunks["/robot/links/tool"]
    np.testing.assert_allclose(matrices(tool), arm.base_from_tool(trajectory.q), atol=1e-6)
    seconds = tool.to_record_batch().column("time").to_numpy(zero_copy_only=False).astype(float) / 1e9
    np.testing.assert_allclose(seconds, trajectory.times, atol=2e-9)
    curves = np.array(column(chunks["/robot/joints"], "Scalars:scalars"))
    np.testing.assert_array_equal(curves[:, :7], trajectory.q)
    assert (curves[:, 7:] == robot.neutral()[7:]).all()
    assert column(chunks["/robot/joints static"], "SeriesLines:names") == [robot.joint_names]


def test_page_logs_a_path(recorded, monkeypatch):
    root = Path(__file__).parents[2]
    page = (root / "docs" / "guide" / "interoperation.md").read_text()
    (block,) = re.findall(r"^<!-- with Rerun -->\n```python\n(.*?)^```", page, re.S | re.M)
    monkeypatch.chdir(root)
    logged, opened = [], []
    monkeypatch.setattr(rr, "init", lambda name, spawn: opened.append((name, spawn)))
    monkeypatch.setattr(kinopt.rerun, "log", lambda *arguments: logged.append(arguments))
    exec(block, {})  # noqa: S102
    assert opened == [("panda", True)]
    monkeypatch.undo()
    assert "/robot/links/tool" in recorded(*logged[0])


def test_shapes_are_in_the_frames_of_their_links(recorded):
    robot = kinopt.models.panda()
    chunks = recorded(robot, robot.neutral(), entity="world/arm")
    drawn = [path for path, chunk in chunks.items() if "Mesh3D:vertex_positions" in chunk.to_record_batch().schema.names]
    assert len(drawn) == len(robot.collision_model().shapes)
    (base,) = [path for path in drawn if path.startswith("/world/arm/links/base/")]
    corners = np.array(column(chunks[base], "Mesh3D:vertex_positions")[0])
    np.testing.assert_allclose([corners.min(0), corners.max(0)], [[-0.145, -0.095, 0], [0.075, 0.095, 0.14]], atol=1e-6)
    normals = np.array(column(chunks[base], "Mesh3D:vertex_normals")[0])
    np.testing.assert_allclose(np.abs(normals).max(1), 1, atol=1e-6)
    assert chunks["/world/arm/links/tool"].timeline_names == ["step"]


def test_meshes_of_the_file_are_drawn_where_they_are_found(recorded, tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    obj = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "corner.obj").write_text("\n".join(obj))
    visual = '<visual><origin xyz="0 0 1"/><geometry><mesh filename="{file}" scale="2 2 2"/></geometry></visual>'
    collision = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    links = [f'<link name="{name}/0">{visual.format(file=name + ".obj")}{collision}</link>' for name in ("corner", "lost")]
    joint = '<joint name="j" type="fixed"><parent link="corner/0"/><child link="lost/0"/></joint>'
    robot = kinopt.Robot.from_urdf_text(f'<robot name="r">{"".join(links)}{joint}</robot>')
    chunks = recorded(robot, np.zeros((2, 0)), folder=tmp_path)
    shapes = {path: chunk for path, chunk in chunks.items() if "/shape" in path}
    found, lost = sorted(shapes)
    assert found.startswith(r"/robot/links/corner\/0/shape") and lost.startswith(r"/robot/links/lost\/0/shape")
    np.testing.assert_allclose(np.array(column(shapes[found], "Mesh3D:vertex_positions")[0]).max(0), [2, 2, 3])
    np.testing.assert_allclose(np.array(column(shapes[lost], "Mesh3D:vertex_positions")[0]).max(0), [0.5, 0.5, 0.5])


def test_retargeted_motion_of_a_free_base_is_logged(recorded):
    nao = kinopt.models.nao(base_joint="free")
    motion = kinopt.retarget(kinopt.models.path("steps"), nao)
    chunks = recorded(nao, motion)
    torso = chunks["/robot/links/torso"]
    np.testing.assert_allclose(matrices(torso)[:, :3, 3], motion.q[:, :3], atol=1e-6)
    np.testing.assert_array_equal(column(chunks["/robot/joints"], "Scalars:scalars"), motion.q)


def test_invalid_motions_are_named():
    robot = kinopt.models.panda()
    with pytest.raises(kinopt.InvalidValueError, match=r"shape \(9,\) or \(N, 9\), not \(2, 7\)"):
        kinopt.rerun.log(robot, np.zeros((2, 7)))
    _, _, trajectory = panda_trajectory()
    with pytest.raises(kinopt.UnknownNameError, match="the motion has a joint `joint7`; joints of universal_ur5e: joint1"):
        kinopt.rerun.log(kinopt.models.ur5e(), trajectory)
    with pytest.raises(kinopt.InvalidValueError, match="must be a kinopt.Robot, not str"):
        kinopt.rerun.log("robot.urdf", np.zeros(3))
