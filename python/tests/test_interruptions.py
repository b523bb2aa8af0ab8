"""Long calls end, or react to Ctrl-C within half a second; threads and memory are bounded."""

import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import InvalidValueError
from kinopt.animation import Clip, Playhead
from kinopt.tasks import Point

MODELS = Path(__file__).parents[2] / "models"


def interrupted(call: Callable[[], object], after: float = 0.3) -> float | None:
    """Seconds from the signal to the exception of the call; None if the call ended before."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, after)
        begun = time.monotonic()
        try:
            call()
        except KeyboardInterrupt:
            return time.monotonic() - begun - after
        return None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="SKIPPED: no timers here; Ctrl-C was not tried")
def test_long_calls_react_to_an_interrupt() -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    model = robot.collision_model()
    unreachable = np.eye(4)
    unreachable[:3, 3] = 5.0
    arm = kinopt.Arm(robot, "base", "flange", attempts=100_000_000, atlas=False)
    for name, call in {
        "solve": lambda: arm.solve(unreachable),
        "with_pairs_sampled": lambda: model.with_pairs_sampled(10_000_000_000),
        "spheres": lambda: model.spheres(per_link=100_000_000),
    }.items():
        late = interrupted(call)
        assert late is not None, f"{name} ended"
        # Some milliseconds on an idle machine; the limit allows for other load.
        assert late < 5.0, f"{name}: {late} s"
    # No exception is left for the next call.
    assert kinopt.Arm(robot, "base", "flange").solve(arm.base_from_tool(np.full(7, -0.3))).reached


def test_events_of_a_short_span_end() -> None:
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    armature = kinopt.animation.Armature.of_skeleton(rig.skeleton)
    builder = Clip.builder("short", armature)
    builder.event(0.5, "late")
    builder.span(0.0, 1e-9)
    clip = builder.build()
    begun = time.monotonic()
    assert clip.fired(Playhead().advance(1e6), "loop", most=2**62) == []
    assert time.monotonic() - begun < 5.0


def test_threads_are_limited_by_targets_and_cores() -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    arm = kinopt.Arm(robot, "base", "flange", atlas=False)
    targets = arm.base_from_tool(np.random.default_rng(1).uniform(-2, 2, (3, 6)))
    before = threads()
    arm.solve_batch(targets, np.zeros(6), threads=10_000)
    assert threads() - before <= 3
    problem = kinopt.Problem(robot, [Point("flange", targets[0, :3, 3])])
    kinopt.Solver().solve_batch(problem, robot.random_configuration(3, seed=1), threads=10_000)
    assert threads() - before <= 6


def threads() -> int:
    status = Path("/proc/self/status")
    if not status.exists():
        pytest.skip("SKIPPED: nothing here counts threads")
    return int(status.read_text().split("Threads:")[1].split()[0])


def test_arrays_of_wrong_size_raise() -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    for count in (2**40, 2**61, 2**63):
        for model in (robot, robot.model):
            with pytest.raises((MemoryError, InvalidValueError)):
                model.random_configuration(count, seed=1)
    assert threading.active_count() >= 1


def test_non_finite_values_raise() -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")
    world = kinopt.World()
    world.add_box("box", [0.1, 0.1, 0.1])
    arm = kinopt.Arm(robot, "base", "flange", world=world)
    for wrong in (np.nan, np.inf):
        q = np.zeros(6)
        q[3] = wrong
        with pytest.raises(InvalidValueError, match="finite"):
            arm.collisions(q)
        with pytest.raises(InvalidValueError, match="finite"):
            arm.joint_values(q)
        text = "<robot name='r'><group name='g'><joint name='JOINT'/></group><group_state name='s' group='g'><joint name='JOINT' value='0.1'/></group_state></robot>"
        srdf = kinopt.Srdf.parse(text.replace("JOINT", robot.joint_names[0]), robot)
        with pytest.raises(InvalidValueError, match="finite"):
            srdf.state("s", q)
    problem = kinopt.Problem(robot, [Point("flange", [0.3, 0.2, 0.4])])
    drag = kinopt.Drag(problem, np.zeros(6))
    for call in (drag.settle, drag.follow):
        with pytest.raises(InvalidValueError, match="frames is 0"):
            call(frames=0)
