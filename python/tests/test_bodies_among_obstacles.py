"""A problem with a world returns collision-free solutions, and drags slide along obstacles."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import tasks
from kinopt.errors import InvalidValueError

MODELS = Path(__file__).parents[2] / "models"
START = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.02, 0.02])


@pytest.fixture(scope="module")
def panda() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def table(height: float = 0.15) -> kinopt.World:
    world = kinopt.World()
    world.add_box("table", (0.8, 1.2, 0.05), pose=(0.7, 0.0, height))
    return world


def problem(panda: kinopt.Robot, world: kinopt.World | None = None, margin: float = 0.005) -> kinopt.Problem:
    stated_tasks = [tasks.Point("tool", [0.5, 0.1, 0.5], name="tool")]
    return kinopt.Problem(panda, stated_tasks, world=world or table(), margin=margin)


def test_solutions_are_collision_free_or_name_pairs(panda: kinopt.Robot) -> None:
    stated, solver = problem(panda), kinopt.Solver()
    random = np.random.default_rng(5)
    for _ in range(20):
        position = random.uniform([0.3, -0.4, 0.2], [0.6, 0.4, 0.7])
        solution = solver.solve(stated, START, {"tool": position})
        assert (stated.collisions(solution.q) == []) == (solution.collisions == [])
        assert solution.reached == (solution.goals_reached and solution.collisions == [])
    inside = solver.solve(stated, START, {"tool": [0.7, 0.0, 0.15]})
    assert not inside.reached
    assert "table" in inside.explain()


def test_drag_slides_along_the_table(panda: kinopt.Robot) -> None:
    stated = problem(panda)
    drag = kinopt.Drag(stated, START)
    checked = kinopt.Problem(panda, world=table(), margin=0.0)
    positions = []
    for x in np.linspace(0.45, 0.6, 60):
        solution = drag.advance({"tool": [x, 0.1, 0.1]})
        assert checked.collisions(drag.q) == []
        positions.append(kinopt.frame_placement(panda, "tool", drag.q)[:3, 3])
    assert not solution.reached
    assert any(pair.second == "table" or pair.first == "table" for pair in solution.collisions)
    # It slides along the table.
    assert positions[-1][2] > 0.17
    assert positions[-1][0] > positions[0][0] - 0.05


def test_problem_copies_the_world(panda: kinopt.Robot) -> None:
    world = table()
    stated = problem(panda, world)
    q = START.copy()
    before = stated.collisions(q)
    world.add_sphere("ball", 0.5, pose=kinopt.frame_placement(panda, "tool", q)[:3, 3])
    assert stated.collisions(q) == before
    assert any("ball" in (pair.first, pair.second) for pair in stated.with_world(world).collisions(q))
    again: kinopt.Problem
    for again in (copy.deepcopy(stated), pickle.loads(pickle.dumps(stated))):
        assert len(again.collisions(q)) == len(before)
    with pytest.raises(InvalidValueError, match="no collision avoidance"):
        kinopt.Problem(panda).collisions(q)


def test_rig_avoids_self_collision() -> None:
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    rest = rig.skeleton.model.neutral()
    belly = tasks.Point("left_hand/tip", [0.0, 0.0, 1.0], name="hand")
    stated, free = kinopt.Problem(rig, [belly], margin=0.0), kinopt.Problem(rig, [belly])
    through = kinopt.Solver().solve(free, rest)
    assert stated.collisions(through.q) != []
    solution = kinopt.Solver().solve(stated, rest)
    assert solution.reached == (stated.collisions(solution.q) == [] and solution.goals_reached)
    assert not solution.reached


def test_model_without_shapes_raises(panda: kinopt.Robot) -> None:
    with pytest.raises(InvalidValueError, match="collision_model"):
        kinopt.Problem(panda.model, world=table())
    with pytest.raises(InvalidValueError, match="kinopt.World"):
        kinopt.Problem(panda, world="table.json")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError):
        kinopt.Problem(panda, world=table(), margin=-1.0)
    shapes = panda.collision_model().with_touching_ignored(panda.neutral())
    given = kinopt.Problem(panda.model, world=table(), collision_model=shapes)
    assert all("table" not in (pair.first, pair.second) for pair in given.collisions(START))
