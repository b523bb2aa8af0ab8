"""For any input the library returns a result or raises a named exception, and never ends the interpreter.

Every public class, function, method and property is called with arguments of all kinds, including valid ones. So calls
with a single invalid argument occur as often as others.
"""

import gc
import inspect
import random
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"
CALLS = 6000
# These write files, or block.
EXCLUDED_MEMBERS = {"write", "save", "run", "serve", "show", "wait", "main"}


def things():
    """Several valid arguments of each kind."""
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    arm = kinopt.Arm(robot, "base", "flange", atlas=False, attempts=2)
    q = np.array([0.1, -1.2, 1.0, -1.3, -1.5, 0.2])
    pose = arm.base_from_tool(q)
    some = [
        robot,
        robot.model,
        arm,
        arm.solve(pose, q),
        arm.solve_batch([pose, pose], q),
        arm.track([pose, pose], q),
        arm.follower(q),
        arm.servo(q, 1e-3),
        kinopt.PoseBounds.position(),
        kinopt.ForwardKinematics(robot),
        kinopt.Jacobian(robot, ["flange"]),
        kinopt.ModelBuilder("model"),
        q,
        pose,
        np.stack([pose] * 3),
        np.stack([q] * 3),
        "flange",
        "base",
        "shoulder_pan_joint",
        0.01,
        3,
    ]
    if hasattr(kinopt, "Rig"):
        rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
        some += [rig, rig.skeleton, "left_hand"]
    return some


def junk(draw):
    """Invalid arguments of every kind."""
    shape = draw.choice([(), (0,), (3,), (4, 4), (6,), (2, 6), (2, 4, 4), (1, 1, 1, 1), (4, 0)])
    dtype = draw.choice(["f8", "f4", "i8", "c16", "U3", "O", "?", "M8[s]"])
    kind = draw.randrange(10)
    if kind == 0:
        return np.full(shape, draw.choice([np.nan, np.inf, -np.inf, 1e308, -0.0, 5e-324]))
    if kind == 1:
        return np.zeros(shape, dtype)
    if kind == 2:
        array = np.ones((8, 8))[:: draw.choice([2, -1]), :: draw.choice([2, -2])]
        array.flags.writeable = False
        return array
    if kind == 3:
        return draw.choice([None, True, b"bytes", "", "no such name", "\0", "ä" * 1000, object(), {}, set(), ()])
    if kind == 4:
        return draw.choice([-1, 0, 2**31, 2**63, 2**64, -(2**70), 1e400, float("nan"), 1j])
    if kind == 5:
        return [draw.random() for _ in range(draw.randrange(9))]
    if kind == 6:
        return {"joint": draw.choice([1.0, "a", None])}
    if kind == 7:
        return lambda *_: draw.choice([None, "text", np.nan, np.zeros(3)])
    if kind == 8:
        return [[1.0, 2.0], [3.0]]
    return iter([])


def members(value):
    for name in dir(value):
        if name.strip("_") not in EXCLUDED_MEMBERS and not name.startswith("_"):
            yield name


def public(module):
    for name in getattr(module, "__all__", []):
        found = getattr(module, name)
        if name not in EXCLUDED_MEMBERS and not inspect.ismodule(found):
            if not (inspect.isclass(found) and issubclass(found, BaseException)):
                yield found


def attempt(call):
    """Calls, and returns the result or the named exception."""
    try:
        return call()
    except (kinopt.KinoptError, TypeError, OverflowError, ValueError, AttributeError, IndexError):
        return None
    except OSError as error:
        assert isinstance(error, (kinopt.FileError, FileNotFoundError, IsADirectoryError)), error
        return None


def test_random_arguments_never_crash():
    draw = random.Random(12)
    right = things()
    doors = list(public(kinopt))
    for name in ("tasks", "animation", "skinning"):
        doors += list(public(getattr(kinopt, name, kinopt.errors)))
    doors = [door for door in doors if callable(door)]
    made = list(right)
    for _ in range(CALLS):
        if draw.random() < 0.4:
            door = draw.choice(doors)
        else:
            owner = draw.choice(made)
            if isinstance(owner, (np.ndarray, str, int, float)):
                continue
            name = draw.choice(list(members(owner)) or ["__class__"])
            door = attempt(lambda owner=owner, name=name: getattr(owner, name))
            if not callable(door):
                continue
        arguments = [
            draw.choice(right) if draw.random() < 0.6 else junk(draw) for _ in range(draw.randrange(5))
        ]
        found = attempt(lambda door=door, arguments=arguments: door(*arguments))
        if type(found).__module__.startswith("kinopt") and len(made) < 300:
            made.append(found)
        attempt(lambda found=found: repr(found))
    assert len(made) > len(right) + 20


def test_counts_are_non_negative_integers():
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    arm = kinopt.Arm(robot, "base", "flange", atlas=False)
    pose = arm.base_from_tool(np.zeros(6))
    for wrong in (-1, 1.5, "two", 2**70):
        for call in (
            lambda wrong=wrong: arm.solve_batch([pose], threads=wrong),
            lambda wrong=wrong: robot.random_configuration(wrong, seed=1),
            lambda wrong=wrong: kinopt.Solver(max_iterations=wrong),
            lambda wrong=wrong: kinopt.Solver(attempts=wrong),
        ):
            with pytest.raises(kinopt.InvalidValueError, match="no whole number of at least 0"):
                call()


def test_objects_outlive_their_sources():
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    arm = kinopt.Arm(robot, "base", "flange", atlas=False)
    q = np.array([0.1, -1.2, 1.0, -1.3, -1.5, 0.2])
    targets = arm.base_from_tool(np.stack([q] * 3))
    batch, track = arm.solve_batch(targets, q), arm.track(targets, q)
    servo, follower = arm.servo(q, 1e-3), arm.follower(q)
    target = targets[0].copy()
    del robot, arm, targets
    gc.collect()
    assert batch[1].reached and track.report[2].reached
    assert servo.step(target).reached
    assert follower.advance(target)[0].reached


def test_servo_is_shared_by_threads():
    arm = kinopt.Arm(kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf"), "base", "flange", atlas=False)
    q = np.array([0.1, -1.2, 1.0, -1.3, -1.5, 0.2])
    servo, target = arm.servo(q, 1e-3), arm.base_from_tool(q + 0.1)
    failures = []

    def push():
        try:
            for _ in range(200):
                servo.step(target)
        except Exception as error:  # noqa: BLE001
            failures.append(error)

    threads = [threading.Thread(target=push) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
    assert servo.step(target).reached


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="SKIPPED: no timers here; Ctrl-C was not tried")
def test_interrupt_stops_a_long_batch():
    arm = kinopt.Arm(kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf"), "base", "flange")
    q = np.random.default_rng(1).uniform(-3, 3, (200_000, 6))
    targets = arm.base_from_tool(q)
    targets[:, :3, 3] *= 3  # Misses, which take long.

    def stop(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            arm.solve_batch(targets, q)
        assert time.monotonic() - begun < 60
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda b: b.joint("s", axis="x"), "axis must be three numbers, not 'x'"),
        (lambda b: b.ball("s", axis="x"), "axis must be three numbers, not 'x'"),
        (lambda b: b.ball("s", about=[1.0]), "about must be three numbers"),
        (lambda b: b.ball("s", twist=1.0), "twist must be"),
        (lambda b: b.ball("s", angle="a"), "angle must be a number"),
        (lambda b: b.free("s", bounds=1.0), "bounds must be .* 3 times"),
        (lambda b: b.planar("s", normal="z"), "normal must be"),
        (lambda b: b.planar("s", bounds=[(0.0, 1.0)]), "bounds must be .* 2 times"),
        (lambda b: b.planar("s", yaw="far"), "yaw must be"),
        (lambda b: b.universal("s", axes="xy"), "axes must be"),
        (lambda b: b.universal("s", limits=3), "limits must be"),
        (lambda b: b.close("x", ["f"]), "frames must be the names of two frames"),
        (lambda b: b.close("x", ["f", "f"], places=["g"]), "places must be two"),
    ],
)
def test_builders_name_the_argument(
    call: Callable[[Any], object], words: str
) -> None:
    builder = kinopt.ModelBuilder("m")
    builder.frame("f")
    with pytest.raises(kinopt.InvalidValueError, match=words):
        call(builder)


def test_ball_joint_with_one_number_is_named() -> None:
    builder = kinopt.ModelBuilder("m")
    builder.ball("hip")
    builder.joint("knee", "revolute", "hip")
    builder.frame("foot", "knee")
    model = builder.build()
    q = model.neutral()
    for call in (
        lambda: kinopt.Problem(model, [kinopt.tasks.Posture({"hip": 1.0})]),
        lambda: kinopt.Problem(model, [kinopt.tasks.JointCoupling({"hip": 1.0, "knee": 1.0})]),
        lambda: kinopt.Problem(
            model, [kinopt.tasks.Point("foot", [0.0, 0.0, 0.0])], bounds={"hip": (-0.1, 0.1)}
        ),
    ):
        with pytest.raises(kinopt.InvalidValueError, match="`hip` is a ball"):
            call()
    with pytest.raises(kinopt.InvalidValueError, match="the interpolation parameter .* NaN"):
        model.interpolate(q, q, float("nan"))
