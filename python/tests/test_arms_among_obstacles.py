"""An arm with a world returns collision-free solutions, or names the colliding pairs."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt.errors import InvalidValueError, UnknownNameError

MODELS = Path(__file__).parents[2] / "models"
Q = np.array([0.3, 0.2, 0.1, -1.8, 0.1, 2.0, 0.5])


@pytest.fixture(scope="module")
def panda() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def table() -> kinopt.World:
    world = kinopt.World()
    world.add_box("table", (0.8, 1.2, 0.05), pose=(0.7, 0.0, 0.15))
    world.add_cylinder("post", 0.05, 1.0, pose=(0.35, 0.35, 0.5))
    return world


@pytest.fixture(scope="module")
def arm(panda: kinopt.Robot) -> kinopt.Arm:
    return kinopt.Arm(panda, "base", "flange", world=table(), margin=0.005)


def test_solutions_are_collision_free(arm: kinopt.Arm) -> None:
    random = np.random.default_rng(4)
    count = reached = 0
    while count < 40:
        q = random.uniform(arm.lower, arm.upper)
        if arm.collisions(q):
            continue
        count += 1
        solution = arm.solve(arm.base_from_tool(q), random.uniform(arm.lower, arm.upper))
        reached += solution.reached
        assert solution.reached == (arm.collisions(solution.q) == [])
        assert solution.reached == (solution.collisions == [])
        assert solution.goals_reached
    assert reached >= 38


def test_pairs_in_contact_are_named(arm: kinopt.Arm) -> None:
    target = arm.base_from_tool(Q)
    target[:3, 3] = [0.6, 0.0, 0.15]
    solution = arm.solve(target, Q)
    assert not solution.reached and solution.goals_reached
    worst = solution.collisions[0]
    assert isinstance(worst, kinopt.Collision)
    assert worst.first_kind == "link" and not worst.on_the_way
    assert str(worst) == f"link `{worst.first}` and {worst.second_kind} `{worst.second}`"
    assert pickle.loads(pickle.dumps(worst)) == worst
    assert any(pair.second == "table" for pair in solution.collisions)
    assert worst.distance < 0 and worst.depth == -worst.distance
    assert "`table`" in solution.explain()
    assert all(pair.distance < 0.005 for pair in solution.collisions)


def test_arm_accepts_another_world(arm: kinopt.Arm) -> None:
    target = arm.base_from_tool(Q)
    crate = table()
    crate.add_box("crate", (0.3, 0.3, 0.3), pose=target[:3, 3])
    blocked = arm.with_world(crate)
    assert not blocked.solve(target, Q).reached
    assert arm.solve(target, Q).reached
    # The arm keeps the world at the time of its creation.
    crate.remove("crate")
    assert not blocked.solve(target, Q).reached
    assert blocked.with_world(crate, margin=0.0).solve(target, Q).reached


def test_configurations_are_checked_by_spheres(arm: kinopt.Arm) -> None:
    q = np.random.default_rng(2).uniform(arm.lower, arm.upper, (100, 7))
    clear = arm.clear_by_spheres(q)
    assert clear.shape == (100,) and 0 < clear.sum() < 100
    assert all(arm.collisions(one) == [] for one in q[clear])
    with pytest.raises(InvalidValueError):
        arm.clear_by_spheres(q[:, :6])
    q[3, 2] = np.nan
    with pytest.raises(InvalidValueError):
        arm.clear_by_spheres(q)


def test_paths_stop_before_contact(panda: kinopt.Robot) -> None:
    arm = kinopt.Arm(panda, "base", "flange", world=kinopt.World())
    begin = arm.base_from_tool(Q)
    wall = kinopt.World()
    wall.add_box("wall", (0.6, 0.5, 0.6), pose=begin[:3, 3] + [0, 0.45, 0])
    path = np.repeat(begin[None], 81, axis=0)
    path[:, 1, 3] += 0.3 * (1 - abs(np.linspace(-1, 1, 81)))
    track = arm.with_world(wall).track(path, Q)
    solutions = list(track.report)
    assert not solutions[40].reached and solutions[40].collisions[0].second == "wall"
    assert solutions[0].reached and solutions[-1].reached
    for solution in solutions:
        assert arm.with_world(wall).collisions(solution.q) == []


def test_arm_with_world_is_pickled(arm: kinopt.Arm) -> None:
    again = pickle.loads(pickle.dumps(arm))
    target = arm.base_from_tool(Q)
    assert np.array_equal(again.solve(target, Q).q, arm.solve(target, Q).q)
    target[:3, 3] = [0.6, 0.0, 0.15]
    assert again.solve(target, Q).collisions == arm.solve(target, Q).collisions


def test_invalid_worlds_and_margins_raise(panda: kinopt.Robot, arm: kinopt.Arm) -> None:
    bad: list[Any] = [-1.0, float("nan"), "wide"]
    for margin in bad:
        with pytest.raises(InvalidValueError, match="margin"):
            kinopt.Arm(panda, "base", "flange", margin=margin)
    with pytest.raises(InvalidValueError, match="World"):
        kinopt.Arm(panda, "base", "flange", world="scene.json")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError, match="Robot"):
        kinopt.Arm(panda.model, "base", "flange", world=table())
    plain = kinopt.Arm(panda, "base", "flange")
    with pytest.raises(InvalidValueError, match="built without a world or a margin"):
        plain.with_world(table())
    with pytest.raises(InvalidValueError, match="unknown: the arm was built without a world"):
        plain.collisions(Q)
    with pytest.raises(InvalidValueError, match="unknown"):
        plain.clear_by_spheres(np.array([Q]))
    held = table()
    held.attach("post", "claw", (0, 0, 0))
    with pytest.raises(UnknownNameError, match="claw"):
        kinopt.Arm(panda, "base", "flange", world=held)
    assert arm.collisions(Q) == []


def test_allowed_collisions_are_ignored(panda: kinopt.Robot) -> None:
    world = table()
    arm = kinopt.Arm(panda, "base", "flange", world=world)
    position = arm.base_from_tool(Q)[:3, 3]
    world.add_sphere("ball", 0.1, pose=position)
    touching = {pair.first for pair in arm.with_world(world).collisions(Q)}
    assert touching
    for link in sorted(touching):
        world.allow_collision(link, "ball")
    assert sorted(touching) == sorted(world["ball"].allowed_collisions)
    assert world.is_collision_allowed("ball", min(touching))
    assert arm.with_world(world).collisions(Q) == []
    assert arm.with_world(pickle.loads(pickle.dumps(world))).collisions(Q) == []
    world.forbid_collision("ball", min(touching))
    assert [pair.first for pair in arm.with_world(world).collisions(Q)] == [min(touching)]
    with pytest.raises(InvalidValueError, match="no allowed collision"):
        world.forbid_collision("ball", min(touching))
    with pytest.raises(UnknownNameError, match="neither"):
        world.allow_collision("hand", "bal")
    world.allow_collision("ball", "hnad")
    with pytest.raises(UnknownNameError, match="did you mean `hand`"):
        arm.with_world(world)


def test_collision_model_selects_checked_shapes(panda: kinopt.Robot) -> None:
    model = panda.collision_model()
    alone = kinopt.Arm(panda, "base", "flange")
    inside = kinopt.World()
    inside.add_sphere("ball", 0.05, pose=alone.base_from_tool(Q)[:3, 3])
    arm = kinopt.Arm(panda, "base", "flange", world=inside, collision_model=model)
    assert any(pair.second == "ball" for pair in arm.collisions(Q))


def test_servo_in_contact_is_not_on_target(panda: kinopt.Robot) -> None:
    plain = kinopt.Arm(panda, "base", "flange")
    q = np.array([0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8])
    pose = plain.base_from_tool(q)
    world = kinopt.World()
    # Its top is 2 cm above the flange.
    world.add_box("table", (0.4, 0.4, 1.0), pose=pose[:3, 3] - (0, 0, 0.48))
    arm = kinopt.Arm(panda, "base", "flange", world=world)
    deep = arm.collisions(q)[0].distance
    servo = arm.servo(q, 0.01)
    step = servo.step(pose)
    assert step.status == "touching" and not step.reached
    assert step.collisions[0].second == "table" and np.isclose(step.collisions[0].distance, deep)
    # An upward motion leads out of it.
    for _ in range(100):
        pose[2, 3] += 0.002
        step = servo.step(pose)
        assert not step.collisions or step.collisions[0].distance >= deep - 1e-9
    for _ in range(40):
        step = servo.step(pose)
    assert step.reached and step.collisions == []
