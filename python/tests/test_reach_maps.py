"""Reach maps agree with forward kinematics and with the disc of a planar arm, and files hold them bitwise."""

import base64
import json
import pickle
import re

import numpy as np
import pytest

import kinopt

PLANAR = """<robot name="planar"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
  <joint name="first" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="second" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-3.1" upper="3.1" effort="1" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="0.3 0 0"/></joint></robot>"""


@pytest.fixture(scope="module")
def arm():
    return kinopt.Arm(kinopt.models.ur5e(), "base", "flange")


@pytest.fixture(scope="module")
def reach(arm):
    return kinopt.ReachMap.build(arm, position_step=0.4, orientation_step=np.pi / 2, threads=2)


def test_reached_poses_are_never_unreachable(arm, reach):
    targets = arm.base_from_tool(np.random.default_rng(1).uniform(arm.lower, arm.upper, (3000, 6)))
    status, q = reach.query(targets)
    assert status.dtype == np.int8 and not (status == -1).any() and (status == 1).mean() > 0.2
    assert np.isnan(q[status != 1]).all() and np.isfinite(q[status == 1]).all()
    # The tool is in the cell, so at most half its diagonal from the centre, which is as far from the target.
    distance = np.linalg.norm(arm.base_from_tool(q[status == 1])[:, :3, 3] - targets[status == 1, :3, 3], axis=1)
    assert distance.max() < 0.2 * np.sqrt(3) + 1e-3

    decided, exact = reach.decide(arm, targets[:100])
    assert (decided == 1).all()
    np.testing.assert_allclose(arm.base_from_tool(exact), targets[:100], atol=5e-6)
    far = kinopt.placement([3.0, 0, 0])
    assert reach.query([far])[0][0] == reach.decide(arm, [far])[0][0] == -1


def test_planar_arm_fills_a_ring(tmp_path):
    (tmp_path / "planar.urdf").write_text(PLANAR)
    planar = kinopt.Arm(kinopt.Robot.from_urdf(tmp_path / "planar.urdf"), "base", "tip", goal="position")
    reach = kinopt.ReachMap.build(planar, position_step=0.05)
    cells = 0.05 * np.arange(-14, 15)
    x, y = np.meshgrid(cells, cells)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    distance = np.hypot(points[:, 0], points[:, 1])
    status, q = reach.query(points)
    half_diagonal = 0.025 * np.sqrt(2)
    assert not (status[(distance > 0.1) & (distance < 0.7)] == -1).any()
    # Distances of the centre of a reached cell.
    assert (distance[status == 1] < 0.7 + 1e-6).all() and (distance[status == 1] > 0.1 - 1e-6).all()
    inner = (distance > 0.11) & (distance < 0.69)
    assert (status[inner] == 1).mean() > 0.99
    assert (status[distance > 0.7 + half_diagonal] == -1).mean() > 0.8
    shares = reach.orientation_shares(points)
    np.testing.assert_array_equal(shares[:, 0] == 1, status == 1)


def test_parts_and_threads_give_equal_maps(arm, reach):
    options = {"position_step": 0.4, "orientation_step": np.pi / 2}
    parts = [kinopt.ReachMap.build(arm, part=(k, 3), **options) for k in (1, 2, 0)]
    assert kinopt.ReachMap.merged(parts) == reach
    assert parts[0].reached < reach.reached
    assert pickle.loads(pickle.dumps(reach)) == reach
    with pytest.raises(kinopt.InvalidValueError, match="different parts"):
        kinopt.ReachMap.merged([reach, parts[0]])
    with pytest.raises(kinopt.InvalidValueError, match="part 3 of 3"):
        kinopt.ReachMap.build(arm, part=(3, 3))
    seen = []
    kinopt.ReachMap.build(arm, position_step=0.8, orientation_step=2.0, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1][0] == seen[-1][1]


@pytest.mark.parametrize("ending", ["npz", "arrow"])
def test_files_hold_maps_bitwise(arm, reach, tmp_path, ending):
    if ending == "arrow":
        pytest.importorskip("pyarrow", reason="SKIPPED LOUDLY: pyarrow is not installed")
    path = tmp_path / f"map.{ending}"
    reach.save(path)
    loaded = kinopt.ReachMap.load(path)
    assert loaded == reach and loaded.joint_names == arm.joint_names
    other = kinopt.Arm(kinopt.models.panda(), "base", "flange")
    with pytest.raises(kinopt.InvalidValueError, match="its joints are"):
        loaded.decide(other, [np.eye(4)])
    short = kinopt.Arm(kinopt.models.ur5e(), "base", "flange", tool=kinopt.placement([0, 0, 0.1]))
    with pytest.raises(kinopt.InvalidValueError, match="placement of the tool"):
        loaded.decide(short, [np.eye(4)])
    path.write_bytes(b"nothing")
    with pytest.raises(kinopt.InvalidFileError, match="map"):
        kinopt.ReachMap.load(path)
    with pytest.raises(kinopt.FileError):
        kinopt.ReachMap.load(tmp_path / f"none.{ending}")
    with pytest.raises(kinopt.InvalidValueError, match=".npz or .arrow"):
        reach.save(tmp_path / "map.csv")


def test_damaged_arrays_are_errors(reach):
    arrays = reach.arrays()
    with pytest.raises(kinopt.InvalidValueError, match="`cells`"):
        kinopt.ReachMap.from_arrays({**arrays, "configurations": arrays["configurations"][:6]})
    del arrays["cubes"]
    with pytest.raises(kinopt.InvalidValueError, match="no array `cubes`"):
        kinopt.ReachMap.from_arrays(arrays)


def test_base_at_the_base_of_the_targets_is_best(arm, reach):
    base = kinopt.placement([2.0, -1.0, 0.3])
    targets = base @ arm.base_from_tool(np.random.default_rng(2).uniform(arm.lower, arm.upper, (20, 6)))
    bases = np.stack([kinopt.placement([-3.0, 0, 0]), base])
    best, worst = reach.place_base(arm, targets, bases)
    assert (best.candidate, best.reached, worst.reached, worst.unreachable) == (1, 20, 0, 20)
    np.testing.assert_allclose(base @ arm.base_from_tool(best.q), targets, atol=5e-6)


def test_pictures_and_pages_show_the_shares(reach, tmp_path):
    pytest.importorskip("matplotlib", reason="SKIPPED LOUDLY: matplotlib is not installed").use("Agg")
    image = reach.plot(plane="xy", at=0.2).axes[0].images[0].get_array()
    count = reach.cubes_per_axis
    assert image.shape == (count, count) and 0 < image.max() <= 100
    with pytest.raises(kinopt.UnknownNameError, match="xz"):
        reach.plot(plane="zx")

    reach.page(tmp_path / "map.html")
    text = (tmp_path / "map.html").read_text()
    data = json.loads(re.search(r"const map = (\{.*?\}), n", text)[1])
    shares = np.frombuffer(base64.b64decode(data["shares"]), np.uint8)
    assert len(shares) == 2 * count**3
    centre = shares.reshape(count, count, count, 2)[(count // 2,) * 3]
    np.testing.assert_allclose(centre / 255, reach.orientation_shares([reach.centre])[0], atol=1 / 255)
