"""An arm without a start uses a state of its SRDF file or the middle of its limits; `bool(solution)` is `reached`."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"
SRDF = """<robot name="panda"><group name="arm"><chain base_link="base" tip_link="flange"/></group>
  <group_state name="home" group="arm"><joint name="joint1" value="0.5"/><joint name="joint4" value="-2.0"/></group_state>
</robot>"""


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def test_solve_without_start_begins_at_the_middle_of_limits(robot):
    arm = kinopt.Arm(robot, "base", "flange", atlas=False)
    middle = (arm.lower + arm.upper) / 2
    np.testing.assert_allclose(arm.default_start, middle, atol=1e-15)
    targets = arm.base_from_tool(middle + np.random.default_rng(2).uniform(-0.2, 0.2, (20, 7)))
    for target in targets:
        q = arm.solve(target).q
        np.testing.assert_array_equal(q, arm.solve(target, arm.default_start).q)
        assert np.abs(q - middle).max() < 0.6
    np.testing.assert_array_equal(arm.solve_batch(targets).q, arm.solve_batch(targets, arm.default_start).q)
    np.testing.assert_array_equal(arm.track(targets).q, arm.track(targets, arm.default_start).q)


def test_solve_without_start_begins_at_the_srdf_state(robot):
    srdf = kinopt.Srdf.parse(SRDF, robot)
    arm = kinopt.Arm(robot, "base", "flange", srdf=srdf, atlas=False)
    middle = (arm.lower + arm.upper) / 2
    expected = [0.5, *middle[1:3], -2.0, *middle[4:]]
    for twin in (arm, pickle.loads(pickle.dumps(arm)), arm.with_tool(np.eye(4))):
        np.testing.assert_allclose(twin.default_start, expected, atol=1e-15)
    with pytest.raises(kinopt.InvalidValueError, match="srdf"):
        kinopt.Arm(robot, "base", "flange", srdf="home")


def test_bool_of_solution_is_reached(robot):
    arm = kinopt.Arm(robot, "base", "flange", atlas=False, attempts=2)
    near, unreachable = arm.base_from_tool(arm.default_start), np.eye(4)
    unreachable[:3, 3] = 9.0
    assert arm.solve(near) and not arm.solve(unreachable)
    assert bool(arm.solve(unreachable)) is arm.solve(unreachable).reached is False
