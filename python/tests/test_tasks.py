"""Every task has the expected residual, by every derivative mode, and validates its arguments."""

import copy
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks

MODELS = Path(__file__).parents[2] / "models"
ROUTES = ["analytic", "dual", "forward_difference", "central_difference"]


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def turned(about, angle):
    """Rodrigues' formula."""
    x, y, z = np.asarray(about) / np.linalg.norm(about)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def rotation_vector(rotation):
    angle = np.arccos((np.trace(rotation) - 1) / 2)
    skew = rotation - rotation.T
    return angle / (2 * np.sin(angle)) * np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


TARGET = np.array([0.4, -0.2, 0.5])
POSE = np.eye(4)
POSE[:3, :3], POSE[:3, 3] = turned([1, 2, 3], 0.7), TARGET
TOOL = np.eye(4)
TOOL[:3, :3], TOOL[:3, 3] = turned([0, 1, 1], 0.3), [0.0, 0.1, 0.2]
CAMERA = tasks.Camera.pinhole(np.eye(4), [500.0, 510.0], [320.0, 240.0])


MASSES = {"link2": 3.0, "link3": (2.0, [0.1, 0.0, 0.2]), "tool": (1.5, (0.0, 0.1, 0.0))}


def centre(frames):
    positions = frames["link2"][:3, 3], (frames["link3"] @ [0.1, 0, 0.2, 1])[:3], (frames["tool"] @ [0, 0.1, 0, 1])[:3]
    return np.average(positions, axis=0, weights=[3.0, 2.0, 1.5])


def beyond(value, lower, upper):
    return value - np.clip(value, lower, upper)


def cases(robot):
    """Each task with its residual in numpy, from placements by name and the configuration."""
    lower, upper = robot.lower, robot.upper
    rest = (lower + upper) / 2

    def pose(placement):
        return np.r_[placement[:3, 3] - TARGET, rotation_vector(placement[:3, :3] @ POSE[:3, :3].T)]

    def ray(at):
        along = np.array([1.0, 0.5, -0.2])
        along /= np.linalg.norm(along)
        return at - TARGET - along * (along @ (at - TARGET))

    def pixel(at):
        return np.array([500 * at[0] / at[2] + 320, 510 * at[1] / at[2] + 240]) - [300, 200]

    def look(placement):
        axis, sight = placement[:3, :3] @ [0, 0, 1], TARGET - placement[:3, 3]
        sight /= np.linalg.norm(sight)
        turn = np.cross(axis, sight)
        return np.arctan2(np.linalg.norm(turn), axis @ sight) * turn / np.linalg.norm(turn)

    def angle_beyond(placement, aim):
        return np.arccos(np.clip(placement[:3, :3] @ [0, 0, 1] @ aim / np.linalg.norm(aim), -1, 1))

    def measure(q):
        jacobian = kinopt.frame_jacobian(robot, "tool", q)
        return np.sqrt(np.linalg.det(jacobian @ jacobian.T))

    def against(q):
        # In the axes of link2, relative to its motion.
        tool, base = (kinopt.frame_jacobian(robot, frame, q) for frame in ("tool", "link2"))
        away = (kinopt.frame_placement(robot, "tool", q) - kinopt.frame_placement(robot, "link2", q))[:3, 3]
        linear = tool[:3] - base[:3] - np.cross(base[3:], away, axis=0)
        return np.sqrt(np.linalg.det(linear @ linear.T))

    normal = np.array([0.0, 3.0, 4.0]) / 5
    weights = np.linspace(0.2, 2.0, len(rest))
    return {
        "point": (tasks.Point("tool", TARGET), lambda f, q: f["tool"][:3, 3] - TARGET),
        "point at, in a base": (
            tasks.Point("tool", TARGET, at=[0.1, 0.0, 0.2], base="link3"),
            lambda f, q: (np.linalg.inv(f["link3"]) @ f["tool"] @ [0.1, 0.0, 0.2, 1])[:3] - TARGET,
        ),
        "pose": (tasks.Pose("tool", POSE), lambda f, q: pose(f["tool"])),
        "pose of a tool": (
            tasks.Pose("flange", POSE, tool=TOOL, base="link2"),
            lambda f, q: pose(np.linalg.inv(f["link2"]) @ f["flange"] @ TOOL),
        ),
        "pose with a free axis": (
            tasks.Pose("tool", POSE, goal=kinopt.PoseBounds.within([0.1, 0, np.inf, 0, 0, np.pi])),
            None,
        ),
        "orientation": (
            tasks.Orientation("tool", POSE[:3, :3]),
            lambda f, q: rotation_vector(f["tool"][:3, :3] @ POSE[:3, :3].T),
        ),
        "look at": (tasks.LookAt("tool", [0, 0, 1], TARGET), lambda f, q: look(f["tool"])),
        "distance": (
            tasks.Distance("tool", "link3", 0.4),
            lambda f, q: [np.linalg.norm(f["tool"][:3, 3] - f["link3"][:3, 3]) - 0.4],
        ),
        "plane": (
            tasks.Plane("tool", TARGET, [0, 3, 4]),
            lambda f, q: [normal @ (f["tool"][:3, 3] - TARGET)],
        ),
        "ray": (
            tasks.Ray("tool", TARGET + [1, 0.5, -0.2], TARGET),
            lambda f, q: ray(f["tool"][:3, 3]),
        ),
        "pixel": (tasks.Pixel("tool", CAMERA, [300, 200]), lambda f, q: pixel(f["tool"][:3, 3])),
        "posture": (tasks.Posture(rest), lambda f, q: q - rest),
        "posture of some": (
            tasks.Posture({"joint2": 0.3, "joint5": -0.1}),
            lambda f, q: q[[1, 4]] - [0.3, -0.1],
        ),
        "smoothness": (tasks.Smoothness(rest, 0.02), lambda f, q: (q - rest) / 0.02),
        "limit centring": (
            tasks.LimitCentring(),
            lambda f, q: (q - rest) / ((upper - lower) / 2),
        ),
        "bounded": (
            tasks.Bounded(tasks.Point("tool", TARGET), 0.2),
            lambda f, q: beyond(f["tool"][:3, 3] - TARGET, -0.2, 0.2),
        ),
        "relative pose": (
            tasks.RelativePose("flange", "link2", POSE, tool=TOOL),
            lambda f, q: pose(np.linalg.inv(f["link2"]) @ f["flange"] @ TOOL),
        ),
        "centre of mass": (
            tasks.CenterOfMass(TARGET, masses=MASSES),
            lambda f, q: centre(f) - TARGET,
        ),
        "centre of mass over a point": (
            tasks.CenterOfMass(TARGET[:2], masses=MASSES),
            lambda f, q: (centre(f) - TARGET)[:2],
        ),
        "centre of mass in a base": (
            tasks.CenterOfMass(TARGET, free="xz", base="flange", masses=MASSES),
            lambda f, q: [(np.linalg.inv(f["flange"]) @ np.r_[centre(f), 1])[1] - TARGET[1]],
        ),
        "support polygon": (
            # A square: outside means outside in x and in y.
            tasks.SupportPolygon([[-0.1, -0.1, 5], [0.1, -0.1, 1], [0.1, 0.1, 2]], on={"base": [-0.1, 0.1, 3]},
                                 margin=0.02, masses=MASSES),
            lambda f, q: beyond(centre(f)[:2], -0.08, 0.08),
        ),
        "gaze": (
            tasks.Gaze("tool", [0, 0, 2], 0.3, target=TARGET),
            lambda f, q: [max(0, angle_beyond(f["tool"], TARGET - f["tool"][:3, 3]) - 0.3)],
        ),
        "gaze along": (
            tasks.Gaze("tool", [0, 0, 2], 0.3, direction=[0, 3, 4]),
            lambda f, q: [max(0, angle_beyond(f["tool"], normal) - 0.3)],
        ),
        "frame velocity": (
            tasks.FrameVelocity("tool", POSE, 0.5, linear=[0.1, 0.2, 0.3], angular=[0.3, 0.2, 0.1]),
            lambda f, q: pose(f["tool"]) / 0.5 - [0.1, 0.2, 0.3, 0.3, 0.2, 0.1],
        ),
        "joint coupling": (
            tasks.JointCoupling({"joint2": 2.0, "joint4": -0.5}, 0.1),
            lambda f, q: [2 * q[1] - 0.5 * q[3] - 0.1],
        ),
        "manipulability": (
            tasks.Manipulability("tool", 0.5),
            lambda f, q: [max(0, 1 - measure(q) / 0.5)],
        ),
        "manipulability of a position": (
            tasks.Manipulability("tool", 0.5, base="link2", of="position"),
            lambda f, q: [max(0, 1 - against(q) / 0.5)],
        ),
        "posture with weights": (
            tasks.Posture(rest, joint_weights=weights),
            lambda f, q: weights * (q - rest),
        ),
        "posture with a weight": (
            tasks.Posture({"joint2": 0.3, "joint5": -0.1}, joint_weights={"joint5": 0.2}),
            lambda f, q: [q[1] - 0.3, 0.2 * (q[4] + 0.1)],
        ),
        "smoothness by range": (
            tasks.Smoothness(rest, 0.02, joint_weights="by range"),
            lambda f, q: (q - rest) / 0.02 / ((upper - lower) / 2),
        ),
        "at least": (
            tasks.Bounded.at_least(tasks.Plane("tool", TARGET, [0, 3, 4]), 0.3),
            lambda f, q: beyond(np.array([normal @ (f["tool"][:3, 3] - TARGET)]), 0.3, np.inf),
        ),
    }


NAMES = list(cases(kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")))


@pytest.mark.parametrize("name", NAMES)
def test_residuals_match_numpy(robot, name):
    task, expected = cases(robot)[name]
    if expected is None:
        pytest.skip("has no short formula: its derivatives are held against each other")
    # Every joint is free, so that x is q.
    problem = kinopt.Problem(robot.model, [replace(task, weight=1.0)])
    assert problem.variables == robot.degrees_of_freedom
    for q in robot.random_configuration(20, seed=5):
        frames = {f: kinopt.frame_placement(robot, f, q) for f in ("tool", "flange", "link2", "link3")}
        assert np.allclose(problem.residual(q), expected(frames, q), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_derivative_routes_agree(robot, name):
    task, _ = cases(robot)[name]
    problem = kinopt.Problem(robot.model, [task])
    for x in robot.random_configuration(5, seed=6):
        jacobians = [problem.with_derivatives(route).jacobian(x) for route in ROUTES]
        size = max(1.0, np.abs(jacobians[0]).max())
        assert jacobians[0].shape == (problem.rows, problem.variables)
        for jacobian, tolerance in zip(jacobians, [0, 1e-12, 1e-5, 1e-7]):
            assert np.abs(jacobian - jacobians[0]).max() <= tolerance * size
        gradient = jacobians[0].T @ problem.residual(x)
        assert np.allclose(problem.gradient(x), gradient, rtol=1e-9, atol=1e-12 * size**2)


@pytest.mark.parametrize("name", NAMES)
def test_tasks_are_pickled(robot, name):
    task, _ = cases(robot)[name]
    x = robot.random_configuration(seed=7)
    expected = kinopt.Problem(robot.model, [task]).residual(x)
    for twin in (pickle.loads(pickle.dumps(task)), copy.deepcopy(task)):
        assert repr(twin) == repr(task)
        assert np.array_equal(kinopt.Problem(robot.model, [twin]).residual(x), expected)


def test_weights_tolerances_roles_and_names_apply():
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    q = robot.random_configuration(seed=1)
    placement = kinopt.frame_placement(robot, "tool", q)
    whole = tasks.Pose("tool", placement, name="hand", weight={"metres": 2.0, "radians": 0.5}, scale=3.0)
    problem = kinopt.Problem(robot.model, [whole])
    x = robot.random_configuration(seed=2)
    plain = kinopt.Problem(robot.model, [tasks.Pose("tool", placement, weight=1.0)]).residual(x)
    assert np.allclose(problem.residual(x), plain * [6, 6, 6, 1.5, 1.5, 1.5], rtol=1e-14)
    assert problem.task_names == ["hand"]
    moved = placement.copy()
    moved[0, 3] += 0.01
    near = tasks.Pose("tool", moved, tolerance={"metres": 0.011})
    look = kinopt.Solver(max_iterations=0, attempts=1)
    assert look.solve(kinopt.Problem(robot.model, [near]), q).reached
    strict = tasks.Pose("tool", moved, tolerance=0.009)
    assert not look.solve(kinopt.Problem(robot.model, [strict]), q).reached
    assert look.solve(kinopt.Problem(robot.model, [tasks.Pose("tool", moved)], tolerance=0.011), q).reached
    wish = tasks.Pose("tool", moved, role="preference")
    [report] = look.solve(kinopt.Problem(robot.model, [wish]), q).tasks
    assert report.role == "preference" and not report.reached
    assert report.position_error == pytest.approx(0.01)
    [report] = look.solve(kinopt.Problem(robot.model, [tasks.Posture(q)]), q).tasks
    assert report.role == "preference"
    assert report.error("joint units") == 0.0 and report.error("metres") is None
    with pytest.raises(kinopt.UnknownNameError, match="no quantity named `miles`"):
        report.error("miles")
    unasked = tasks.Pose("tool", moved, weight={"metres": 0.0})
    assert look.solve(kinopt.Problem(robot.model, [unasked]), q).reached


def test_arguments_are_copied(robot):
    target = np.array([0.1, 0.2, 0.3])
    point = tasks.Point("tool", target)
    target[0] = 9.0
    assert point.target[0] == 0.1
    with pytest.raises(ValueError, match="read-only"):
        point.target[0] = 1.0
    with pytest.raises(AttributeError):
        point.target = target
    assert tasks.Point("tool", target.astype(np.float32)).target.dtype == np.float64
    assert "at=" not in repr(point) and "target=[0.1, 0.2, 0.3]" in repr(point)


def test_cameras_project_and_invert():
    camera = tasks.Camera.pinhole(POSE, [500, 500], [320, 240])
    point = (POSE @ [0.1, -0.2, 2.0, 1.0])[:3]
    assert np.allclose(camera.project(point), [320 + 25, 240 - 50])
    eye, through = camera.viewing_ray([345, 190])
    assert np.allclose(eye, TARGET)
    assert np.allclose(np.cross(point - eye, through - eye), 0, atol=1e-12)
    twin = pickle.loads(pickle.dumps(camera))
    assert np.array_equal(twin.pixel_from_world, camera.pixel_from_world)
    parallel = tasks.Camera([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    assert parallel.viewing_ray([0, 0]) is None


INVALID_TASKS = {
    "no such frame": lambda: [tasks.Point("paw", [0, 0, 0])],
    "no such joint": lambda: [tasks.Posture({"elbow": 1.0})],
    "no frame": lambda: [tasks.Point(3, [0, 0, 0])],
    "shape of a target": lambda: [tasks.Point("tool", [0, 0])],
    "dtype of a target": lambda: [tasks.Point("tool", ["a", "b", "c"])],
    "complex": lambda: [tasks.Point("tool", [1j, 0, 0])],
    "nan": lambda: [tasks.Point("tool", [np.nan, 0, 0])],
    "no rotation": lambda: [tasks.Pose("tool", np.diag([2.0, 2, 2, 1]))],
    "last row": lambda: [tasks.Pose("tool", np.ones((4, 4)))],
    "shape of a pose": lambda: [tasks.Pose("tool", np.eye(3))],
    "no axes": lambda: [tasks.Orientation("tool", np.eye(2))],
    "mirrored axes": lambda: [tasks.Orientation("tool", -np.eye(3))],
    "goal": lambda: [tasks.Pose("tool", np.eye(4), goal="free")],
    "all free": lambda: [tasks.Pose("tool", np.eye(4), goal=kinopt.PoseBounds.within([np.inf] * 6))],
    "axis": lambda: [tasks.LookAt("tool", [0, 0, 0], [1, 1, 1])],
    "negative distance": lambda: [tasks.Distance("tool", "base", -1.0)],
    "distance of words": lambda: [tasks.Distance("tool", "base", "far")],
    "normal": lambda: [tasks.Plane("tool", [0, 0, 0], [0, 0, 0])],
    "line": lambda: [tasks.Ray("tool", [1, 2, 3], [1, 2, 3])],
    "camera": lambda: [tasks.Pixel("tool", "camera", [1, 2])],
    "camera of nan": lambda: [tasks.Pixel("tool", tasks.Camera(np.full((3, 4), np.nan)), [1, 2])],
    "length of a posture": lambda: [tasks.Posture([0.0, 1.0])],
    "time step": lambda: [tasks.Smoothness(np.zeros(9), 0.0)],
    "no masses": lambda: [tasks.CenterOfMass([0, 0, 0])],
    "shape of a centre": lambda: [tasks.CenterOfMass([0], masses=MASSES)],
    "free axes": lambda: [tasks.CenterOfMass([0, 0, 0], free="w", masses=MASSES)],
    "no axis left": lambda: [tasks.CenterOfMass([0, 0, 0], free="xyz", masses=MASSES)],
    "negative mass": lambda: [tasks.CenterOfMass([0, 0, 0], masses={"tool": -1.0})],
    "zero mass": lambda: [tasks.CenterOfMass([0, 0, 0], masses={"tool": 0.0})],
    "mass in the world": lambda: [tasks.CenterOfMass([0, 0, 0], masses={"base": 5.0})],
    "mass on nothing": lambda: [tasks.CenterOfMass([0, 0, 0], masses={"paw": 1.0})],
    "masses of words": lambda: [tasks.CenterOfMass([0, 0, 0], masses={"tool": "heavy"})],
    "masses in a list": lambda: [tasks.CenterOfMass([0, 0, 0], masses=[1.0])],
    "no support": lambda: [tasks.SupportPolygon(masses=MASSES)],
    "shape of support": lambda: [tasks.SupportPolygon([[0, 0]], masses=MASSES)],
    "support of words": lambda: [tasks.SupportPolygon("here", masses=MASSES)],
    "support on a list": lambda: [tasks.SupportPolygon(on=[[0, 0, 0]], masses=MASSES)],
    "margin": lambda: [tasks.SupportPolygon([[0, 0, 0], [1, 0, 0]], margin=0.1, masses=MASSES)],
    "vertical": lambda: [tasks.SupportPolygon([0, 0, 0], up=[0, 0, 0], masses=MASSES)],
    "no cone": lambda: [tasks.Gaze("tool", [0, 0, 1], 0.0, target=[1, 1, 1])],
    "no aim": lambda: [tasks.Gaze("tool", [0, 0, 1], 0.1)],
    "two aims": lambda: [tasks.Gaze("tool", [0, 0, 1], 0.1, target=[1, 1, 1], direction=[1, 1, 1])],
    "velocity": lambda: [tasks.FrameVelocity("tool", POSE, 0.1, linear=[np.nan, 0, 0])],
    "step of a velocity": lambda: [tasks.FrameVelocity("tool", POSE, -0.1)],
    "no coupling": lambda: [tasks.JointCoupling({})],
    "coupling of a list": lambda: [tasks.JointCoupling(["joint1"])],
    "coupling of words": lambda: [tasks.JointCoupling({"joint1": "half"})],
    "coupling of what is not there": lambda: [tasks.JointCoupling({"elbow": 1.0})],
    "measure": lambda: [tasks.Manipulability("tool", 0.0)],
    "measure of few joints": lambda: [tasks.Manipulability("tool", 0.1, base="link4")],
    "measure of": lambda: [tasks.Manipulability("tool", 0.1, of="speed")],
    "weights of joints": lambda: [tasks.Posture(np.zeros(9), joint_weights=[1.0])],
    "weight of no joint": lambda: [tasks.Posture(np.zeros(9), joint_weights={"elbow": 1.0})],
    "weight of another joint": lambda: [tasks.Posture({"joint1": 0.0}, joint_weights={"joint2": 1.0})],
    "negative weight of a joint": lambda: [tasks.Posture({"joint1": 0.0}, joint_weights=[-1.0])],
    "weights by words": lambda: [tasks.Posture(np.zeros(9), joint_weights="evenly")],
    "empty interval": lambda: [tasks.Bounded(tasks.Point("tool", [0, 0, 0]), -1.0)],
    "two intervals": lambda: [tasks.Bounded(tasks.Point("tool", [0, 0, 0]), 1.0, lower=0.0)],
    "bounds in bounds": lambda: [tasks.Bounded(tasks.Bounded(tasks.Point("tool", [0, 0, 0]), 1.0), 1.0)],
    "weight": lambda: [tasks.Point("tool", [0, 0, 0], weight=-1.0)],
    "weight of words": lambda: [tasks.Point("tool", [0, 0, 0], weight="much")],
    "weight of what is not there": lambda: [tasks.Point("tool", [0, 0, 0], weight={"radians": 1.0})],
    "unknown quantity": lambda: [tasks.Point("tool", [0, 0, 0], weight={"miles": 1.0})],
    "weights of words": lambda: [tasks.Point("tool", [0, 0, 0], weight={"metres": "much"})],
    "weights by numbers": lambda: [tasks.Point("tool", [0, 0, 0], weight={3: 1.0})],
    "scale of words": lambda: [tasks.Point("tool", [0, 0, 0], scale="often")],
    "scale": lambda: [tasks.Point("tool", [0, 0, 0], scale=np.inf)],
    "tolerance": lambda: [tasks.Point("tool", [0, 0, 0], tolerance=np.nan)],
    "role": lambda: [tasks.Point("tool", [0, 0, 0], role="wish")],
    "name": lambda: [tasks.Point("tool", [0, 0, 0], name=5)],
    "no list": lambda: tasks.Point("tool", [0, 0, 0]),
    "no task": lambda: ["point"],
    "the base class": lambda: [tasks.Task()],
}


@pytest.mark.parametrize("name", INVALID_TASKS)
def test_invalid_arguments_raise(robot, name):
    with pytest.raises(kinopt.KinoptError):
        kinopt.Problem(robot, INVALID_TASKS[name]())


LEANING_ROBOT = Path(__file__).parents[2] / "tests" / "kinematics" / "leaning.urdf"


def test_centres_of_mass_match_pinocchio():
    """The numbers of tests/kinematics/centre_of_mass.rs, of pin 4.1.0."""
    robot = kinopt.Robot.from_urdf(LEANING_ROBOT)
    q = [0.3, -0.7, 1.9, 0.12]
    assert robot.mass == pytest.approx(27.8, abs=1e-12)
    expected = [0.11374155910125018, 0.0678258025247298, 0.6952314836559549]
    assert np.allclose(robot.center_of_mass(q), expected, rtol=0, atol=1e-12)
    jacobian = robot.center_of_mass_jacobian(q)
    expected = [0.5675655769443422, 0.2389193886500207, 0.006839545927028303, 0.013563571405989388]
    assert jacobian.shape == (3, 4) and np.allclose(jacobian[0], expected, rtol=0, atol=1e-12)
    problem = kinopt.Problem(robot, [tasks.CenterOfMass([0.05, 0.1]), tasks.Posture(np.zeros(4))])
    solution = kinopt.Solver().solve(problem, q)
    assert solution.reached, solution.explain()
    assert np.allclose(robot.center_of_mass(solution.q)[:2], [0.05, 0.1], atol=2e-6)
    targets = {problem.task_names[0]: [0.02, 0.1, 0.0]}
    moved = kinopt.Solver().solve(problem, q, targets=targets)
    assert np.allclose(robot.center_of_mass(moved.q)[:2], [0.02, 0.1], atol=2e-6)
    for wrong in ([0.0] * 3, [np.nan] * 4, "q"):
        with pytest.raises(kinopt.InvalidValueError):
            robot.center_of_mass(wrong)
    with pytest.raises(kinopt.InvalidValueError, match="no centre of mass"):
        kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf").center_of_mass(np.zeros(9))


def test_one_sided_task_is_zero_within_bounds():
    robot = kinopt.Robot.from_urdf(LEANING_ROBOT)
    q = np.array([0.1, 0.1, 0.1, 0.1])
    x, y, _ = robot.center_of_mass(q)
    sole = [[x + i, y + j, 0.0] for i in (-0.1, 0.1) for j in (-0.1, 0.1)]
    problem = kinopt.Problem(robot, [tasks.SupportPolygon(sole, margin=0.05)])
    assert np.array_equal(problem.residual(q), [0, 0]) and not problem.jacobian(q).any()
    # A custom residual may be one-sided too.
    low = tasks.Residual(lambda placements: placements[0, 2, 3], frames=["trunk"], rows=1)
    height = kinopt.frame_placement(robot, "trunk", q)[2, 3]
    for limit, left in ((height + 0.1, 0.0), (height - 0.1, 0.1)):
        problem = kinopt.Problem(robot, [tasks.Bounded.at_most(low, limit)])
        assert np.allclose(problem.residual(q), left, atol=1e-12)


def test_free_bases_balance_and_couple_joints():
    robot = kinopt.Robot.from_urdf(LEANING_ROBOT, base_joint="free")
    q = np.asarray(robot.random_configuration(seed=4))
    # The plate is not fixed in the world here.
    assert robot.mass == pytest.approx(67.8) and len(q) == 11
    assert robot.center_of_mass_jacobian(q).shape == (3, 10)
    weights = np.linspace(0.5, 2.0, len(robot.joint_names))
    posture = tasks.Posture(q, joint_weights=weights, name="posture")
    problem = kinopt.Problem(robot, [tasks.CenterOfMass([0.1, 0.2, 0.7], name="centre"), posture])
    solution = kinopt.Solver().solve(problem, q)
    assert solution.reached, solution.explain()
    assert np.allclose(robot.center_of_mass(solution.q), [0.1, 0.2, 0.7], atol=2e-6)
    other = np.asarray(robot.random_configuration(seed=5))
    targets = {"posture": other, "centre": robot.center_of_mass(other)}
    moved = kinopt.Solver().solve(problem, q, targets=targets)
    # Both are met at the new reference.
    assert moved.reached and max(abs(robot.difference(moved.q, other))) < 1e-3
    with pytest.raises(kinopt.InvalidValueError, match=r"shape \(9,\), expected \(11,\)"):
        kinopt.Solver().solve(problem, q, targets={"posture": other[:9]})
