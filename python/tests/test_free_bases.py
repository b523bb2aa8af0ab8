"""Robots on free bases and models with ball joints: configurations as in Pinocchio, solved within their limits."""

from __future__ import annotations

import copy
import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks
from kinopt.errors import InvalidValueError, UnknownNameError

UR5E = Path(__file__).parents[2] / "models" / "universal_ur5e.urdf"


def matrix(q: np.ndarray) -> np.ndarray:
    """Pose of x, y, z, w, x, y, z."""
    w, x, y, z = q[3:7]
    out = np.eye(4)
    out[:3, 3] = q[:3]
    out[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return out


def exponential(twist: np.ndarray) -> np.ndarray:
    """exp of a 4 x 4 matrix by its series, scaled and squared."""
    vx, vy, vz, a, b, c = twist
    m = np.array([[0, -c, b, vx], [c, 0, -a, vy], [-b, a, 0, vz], [0, 0, 0, 0]]) / 2**10
    term, total = np.eye(4), np.eye(4)
    for k in range(1, 12):
        term = term @ m / k
        total = total + term
    for _ in range(10):
        total = total @ total
    return total


@pytest.fixture(scope="module")
def free() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(UR5E, base_joint="free")


def test_configuration_starts_with_pose_of_base(free: kinopt.Robot) -> None:
    fixed = kinopt.Robot.from_urdf(UR5E)
    assert (free.configuration_len, free.degrees_of_freedom) == (13, 12)
    assert free.lower.shape == free.upper.shape == free.neutral().shape == (13,)
    assert free.joint_names == [
        "root_joint/x",
        "root_joint/y",
        "root_joint/z",
        "root_joint/rotation",
        *fixed.joint_names,
    ]
    assert free.coordinate_names[3:7] == [f"root_joint/rotation {part}" for part in "wxyz"]
    q = free.random_configuration(seed=3)
    assert free.is_within_limits(q)
    flange = kinopt.frame_placement(free, "flange", q)
    assert np.allclose(flange, matrix(q) @ kinopt.frame_placement(fixed, "flange", q[7:]), atol=1e-13)


def test_integrate_and_difference_are_exp_and_log(free: kinopt.Robot) -> None:
    rng = np.random.default_rng(1)
    q = np.array([free.random_configuration(seed=seed) for seed in range(20)])
    v = rng.uniform(-1.5, 1.5, (20, 12))
    moved = free.integrate(q, v)
    assert moved.shape == (20, 13)
    for before, velocity, after in zip(q, v, moved, strict=True):
        assert np.allclose(matrix(after), matrix(before) @ exponential(velocity[:6]), atol=1e-12)
        assert np.allclose(free.integrate(before, velocity), after, atol=0)
    assert np.allclose(free.difference(q, moved), v, atol=1e-12)
    half = free.interpolate(q, moved, 0.5)
    assert np.allclose(free.difference(q, half), v / 2, atol=1e-12)
    longer = q[0].copy()
    longer[3:7] *= 2
    assert np.allclose(free.normalise(longer), q[0], atol=1e-15)


def test_jacobian_matches_motion_along_velocity(free: kinopt.Robot) -> None:
    q = free.random_configuration(seed=5)
    jacobian = free.frame_jacobian(q, "flange")
    assert jacobian.shape == (6, 12)
    assert np.array_equal(jacobian, kinopt.frame_jacobian(free, "flange", q))
    many = kinopt.Jacobian(free, ["flange"]).at(np.array([q, q]))
    assert many.shape == (2, 6, 12) and np.array_equal(many[1], jacobian)
    step = 1e-6
    for column in range(12):
        v = np.zeros(12)
        v[column] = step
        ahead, behind = (kinopt.frame_placement(free, "flange", free.integrate(q, s * v)) for s in (1, -1))
        linear = (ahead[:3, 3] - behind[:3, 3]) / (2 * step)
        skew = (ahead[:3, :3] @ behind[:3, :3].T - behind[:3, :3] @ ahead[:3, :3].T) / 2
        angular = np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) / (2 * step)
        assert np.allclose(jacobian[:, column], np.concatenate([linear, angular]), atol=1e-8)


def test_base_keeps_bounds_and_is_pickled() -> None:
    bounds = {"x": (-0.1, 0.2), "y": (-1.0, 1.0)}
    robot = kinopt.Robot.from_urdf(UR5E, base_joint="planar", base_bounds=bounds)
    for same in (pickle.loads(pickle.dumps(robot)), copy.deepcopy(robot)):
        assert same.joint_names == robot.joint_names and np.array_equal(same.upper, robot.upper)
    problem = kinopt.Problem(robot, [tasks.Point("flange", [3.0, -2.0, 1.5])])
    solution = kinopt.Solver().solve(problem, robot.neutral())
    assert not solution.reached and robot.is_within_limits(solution.q)
    assert {"root_joint/x", "root_joint/y"} <= {limit.joint for limit in solution.active_limits}


def test_free_base_extends_the_reach(free: kinopt.Robot) -> None:
    goal = kinopt.frame_placement(free, "flange", free.random_configuration(seed=9))
    goal[:3, 3] += [4.0, 5.0, 6.0]
    problem = kinopt.Problem(free, [tasks.Pose("flange", goal)])
    solution = kinopt.Solver().solve(problem, free.neutral())
    assert solution.reached and abs(np.linalg.norm(solution.q[3:7]) - 1) < 1e-12
    assert np.allclose(kinopt.frame_placement(free, "flange", solution.q), goal, atol=1e-5)
    with pytest.raises(InvalidValueError, match="ball joint"):
        kinopt.Arm(in_the_world(), "anchor", "flange")


def in_the_world() -> kinopt.Robot:
    """A robot whose chain from a frame in the world contains a floating joint."""
    text = UR5E.read_text()
    begin = text.index("<link")
    joint = """<link name="anchor"/><joint name="float" type="floating"><parent link="anchor"/>
        <child link="base"/></joint>"""
    return kinopt.Robot.from_urdf_text(text[:begin] + joint + text[begin:])


def shoulder() -> kinopt.Model:
    builder = kinopt.ModelBuilder("arm")
    builder.ball("shoulder", axis=[1, 0, 0], swing=1.0, twist=(-0.5, 0.5))
    hand = np.eye(4)
    hand[0, 3] = 1.0
    builder.frame("hand", "shoulder", hand)
    return builder.build()


def test_cone_is_kept_and_reported_by_name() -> None:
    model = shoulder()
    joint = model.joints[0]
    assert (joint.kind, joint.swing, joint.twist) == ("ball", [1.0, 1.0], (-0.5, 0.5))
    problem = kinopt.Problem(model, [tasks.Point("hand", [0.0, 1.0, 0.0])])
    solution = kinopt.Solver().solve(problem, model.neutral())
    assert [limit.joint for limit in solution.active_limits] == ["shoulder swing"]
    assert solution.active_limits[0].value == pytest.approx(1.0, abs=1e-9)
    hand = kinopt.frame_placement(model, "hand", solution.q)[:3, 3]
    assert math.acos(hand[0]) == pytest.approx(1.0, abs=1e-9)
    assert model.is_within_limits(solution.q)
    held = kinopt.ParameterMap(model, lock={"shoulder": [1.0, 0.0, 0.0, 0.0]})
    assert held.variables == 0


def test_invalid_arguments_are_named(free: kinopt.Robot) -> None:
    q, v = free.neutral(), np.zeros(12)
    none = q.copy()
    none[3:7] = 0
    for wrong in (lambda: free.integrate(q[1:], v), lambda: free.integrate(q, q), lambda: free.integrate([q] * 2, [v] * 3)):
        with pytest.raises(InvalidValueError):
            wrong()
    with pytest.raises(InvalidValueError, match="root_joint/rotation"):
        free.integrate(none, v)
    with pytest.raises(InvalidValueError):
        free.interpolate(q, q, math.nan)
    with pytest.raises(UnknownNameError, match="planar"):
        kinopt.Robot.from_urdf(UR5E, base_joint="hovering")  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="x, y, yaw"):
        kinopt.Robot.from_urdf(UR5E, base_joint="planar", base_bounds={"z": (0.0, 1.0)})
    with pytest.raises(InvalidValueError, match="root_joint/x"):
        kinopt.Robot.from_urdf(UR5E, base_joint="free", base_bounds={"x": (1.0, 0.0)})
    for bounds in ((float("nan"), 1.0), (0.0, float("nan"))):
        with pytest.raises(kinopt.InvalidValueError, match="base_bounds along z"):
            kinopt.Robot.from_urdf(UR5E, base_joint="free", base_bounds={"z": bounds})
    builder = kinopt.ModelBuilder("arm")
    builder.ball("shoulder", swing=4.0)
    with pytest.raises(InvalidValueError, match="shoulder"):
        builder.build()


HEAVY = """<robot name="heavy"><link name="pelvis"><inertial><origin xyz="0 0 0.1"/><mass value="4"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="1.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="shoulder" type="continuous"><origin xyz="0 0.2 0.3"/><parent link="pelvis"/><child link="arm"/></joint></robot>"""


@pytest.fixture
def heavy(tmp_path: Path) -> kinopt.Robot:
    file = tmp_path / "heavy.urdf"
    file.write_text(HEAVY)
    return kinopt.Robot.from_urdf(file, base_joint="free")


def test_batches_equal_single_configurations(heavy: kinopt.Robot) -> None:
    many = heavy.random_configuration(7, seed=3)
    for of_one in [
        heavy.center_of_mass,
        heavy.center_of_mass_jacobian,
        lambda q: heavy.frame_jacobian(q, "arm"),
    ]:
        table = of_one(many)
        assert table.shape[0] == 7
        for row, q in zip(table, many, strict=True):
            assert (row == of_one(q)).all()
        assert of_one(many[:0]).shape == (0, *table.shape[1:])
        with pytest.raises(InvalidValueError, match=r"\(N, 8\)"):
            of_one(many[:, :5])
    parts = kinopt.ForwardKinematics(heavy, ["pelvis", "arm"]).place(many)
    weighed = 4.0 * (parts[:, 0] @ [0, 0, 0.1, 1])[:, :3] + 1.5 * (parts[:, 1] @ [0.3, 0, 0, 1])[:, :3]
    assert np.allclose(heavy.center_of_mass(many), weighed / 5.5, atol=1e-14)
    rig = kinopt.Rig.read(UR5E.parent / "humanoid" / "humanoid.json")
    many = rig.skeleton.model.random_configuration(2, seed=3)
    assert (rig.center_of_mass(many)[1] == rig.center_of_mass(many[1])).all()


def test_one_configuration_broadcasts(heavy: kinopt.Robot) -> None:
    many, one = heavy.random_configuration(5, seed=3), heavy.random_configuration(seed=9)
    for other in (one, one[None]):
        v = heavy.difference(other, many)
        assert v.shape == (5, 7)
        back = heavy.difference(many, other)
        for k, q in enumerate(many):
            assert (v[k] == heavy.difference(one, q)).all()
            assert (back[k] == heavy.difference(q, one)).all()
        moved = heavy.integrate(other, v)
        assert np.allclose(heavy.center_of_mass(moved), heavy.center_of_mass(many), atol=1e-12)
        assert heavy.interpolate(other, many, 0.5).shape == (5, 8)
    assert heavy.difference(one[None], one).shape == (1, 7)
    with pytest.raises(InvalidValueError, match="one row of either"):
        heavy.difference(many[:2], many[:3])


def test_universal_joints_and_joint_coordinates() -> None:
    builder = kinopt.ModelBuilder("arm")
    builder.universal("wrist", axes=[[0, 0, 1], [0, 1, 0]], limits=[(-1, 1), (-0.5, 0.5)])
    builder.frame("hand", "wrist", np.array([[1.0, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))
    model = builder.build()
    assert model.joint_names == ["wrist/first", "wrist/second"]
    assert (model.lower == [-1, -0.5]).all() and (model.upper == [1, 0.5]).all()
    a, b = 0.3, -0.4
    position = kinopt.frame_placement(model, "hand", [a, b])[:3, 3]
    assert np.allclose(position, [math.cos(a) * math.cos(b), math.sin(a) * math.cos(b), -math.sin(b)])
    with pytest.raises(UnknownNameError, match=r"\.ball\(\), \.free\(\), \.planar\(\), \.universal\(\)"):
        kinopt.ModelBuilder("arm").joint("shoulder", "ball")


@pytest.mark.parametrize("swing", ["wide", [0.1], [0.1, 0.2, 0.3], {}])
def test_invalid_swing_raises(swing: object) -> None:
    with pytest.raises(InvalidValueError, match="swing must be a half angle in radians, or two of them, not"):
        kinopt.ModelBuilder("arm").ball("shoulder", swing=swing)  # type: ignore[arg-type]


def test_unknown_kinds_list_the_valid_ones() -> None:
    with pytest.raises(InvalidValueError, match="base_joint must be one of fixed, free, planar, slide-x.*not 3"):
        kinopt.Robot.from_urdf(UR5E, base_joint=3)  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="planar"):
        kinopt.Robot.from_urdf(UR5E, base_joint="floating")  # type: ignore[arg-type]
    rig = UR5E.parent / "humanoid" / "humanoid.json"
    skeleton = kinopt.Rig.read(rig).skeleton
    with pytest.raises(UnknownNameError, match="planar.*valid names: fixed, free"):
        kinopt.BallSkeleton(skeleton, root="planar")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError, match="root must be one of fixed, free, not 3"):
        kinopt.BallSkeleton(skeleton, root=3)  # type: ignore[arg-type]


def test_free_robot_has_a_free_base(tmp_path: Path) -> None:
    file = tmp_path / "body.xml"
    file.write_text(
        """<mujoco model="body"><worldbody><body name="torso"><freejoint name="float"/>
        <body name="arm"><joint name="shoulder"/></body></body></worldbody></mujoco>"""
    )
    plain = kinopt.Robot.from_mjcf(file)
    free = kinopt.Robot.from_mjcf(file, base_joint="free", base_bounds={"z": (0.2, 1.5)})
    assert free.joint_names == plain.joint_names and free.lower[2] == 0.2
    with pytest.raises(InvalidValueError, match="`float/x` already moves all of `body` freely"):
        kinopt.Robot.from_mjcf(file, base_joint="planar")


def test_centre_of_mass_task_is_named(heavy: kinopt.Robot) -> None:
    problem = kinopt.Problem(heavy, [tasks.CenterOfMass([0.0, 0.0, 0.1])])
    solution = kinopt.Solver().solve(problem, heavy.neutral())
    assert [(task.name, task.frame) for task in solution.tasks] == [("center of mass", None)]


def test_residual_accepts_configuration_or_variables(free: kinopt.Robot) -> None:
    goal = kinopt.frame_placement(free, "flange", free.random_configuration(seed=9))
    problem = kinopt.Problem(free, [tasks.Pose("flange", goal), tasks.Posture(free.neutral())])
    q = kinopt.Solver().solve(problem, free.neutral()).q
    assert problem.variables == 12 and q.shape == (13,)
    x = kinopt.ParameterMap(free).reduce(q)
    turned = np.concatenate([q[:3], -q[3:7], q[7:]])
    for evaluate in (problem.residual, problem.jacobian, problem.gradient):
        assert np.array_equal(evaluate(q), evaluate(x))
        assert np.allclose(evaluate(turned), evaluate(x), rtol=0, atol=1e-12)
    assert np.linalg.norm(problem.residual(q)[:6]) < 1e-5
    for other in (q[:11], np.append(q, 0.0)):
        with pytest.raises(InvalidValueError, match=r"expected variables, \(12,\), or a configuration, \(13,\)"):
            problem.residual(other)


def test_configuration_outside_the_map_is_named() -> None:
    robot = kinopt.Robot.from_urdf(UR5E)
    elbow = robot.joint_names[2]
    start = robot.neutral() + 0.25
    q = np.where(np.array(robot.joint_names) == elbow, 0.5, start)
    problem = kinopt.Problem(
        robot, [tasks.Point("flange", [0.4, 0.1, 0.5])], parameters=kinopt.ParameterMap(robot, lock={elbow: 0.5})
    )
    assert np.array_equal(problem.residual(q), problem.residual(np.delete(q, 2)))
    with pytest.raises(InvalidValueError, match=f"`{elbow}` is at 0.25, but .* require 0.5"):
        problem.residual(start)
    q[0] = 7.0
    with pytest.raises(InvalidValueError, match=f"`{robot.joint_names[0]}` is at 7"):
        problem.residual(q)
    q[0] = np.nan
    with pytest.raises(InvalidValueError):
        problem.residual(q)


def test_sole_includes_fixed_links() -> None:
    robot = kinopt.Robot.from_urdf(UR5E.parent / "aldebaran_nao.urdf", base_joint="free")
    sole = robot.sole("left_sole")
    assert np.array_equal(sole[0], np.zeros(3)) and sole.shape == (10, 3)
    assert np.allclose(sole.min(axis=0)[:2], [-0.06, -0.04]) and np.allclose(sole.max(axis=0)[:2], [0.1, 0.04])
    q = robot.random_configuration(seed=4)
    ankle = kinopt.frame_placement(robot, "left_foot", q)
    foot = kinopt.frame_placement(robot, "left_sole", q)
    of_foot, of_sole = (
        at[:3, :3] @ robot.sole(name).T + at[:3, 3:] for at, name in ((ankle, "left_foot"), (foot, "left_sole"))
    )
    assert np.allclose(sorted(map(tuple, of_foot.T.round(9))), sorted(map(tuple, of_sole.T.round(9))))
    with pytest.raises(UnknownNameError, match="left_sole"):
        robot.sole("left_soul")
