"""Hinges, held postures and standing drags."""

import kinopt
import numpy as np
import pytest
from kinopt import tasks


@pytest.fixture(scope="module")
def rig():
    return kinopt.models.humanoid()


def test_guessed_hinges_are_editable(rig):
    hinges = rig.skeleton.guess_hinges()
    assert set(hinges) == {"left_shin", "right_shin", "left_forearm", "right_forearm"}
    assert all(abs(np.linalg.norm(hinge["axis"]) - 1) < 1e-9 for hinge in hinges.values())
    del hinges["left_shin"]
    hinges["right_shin"]["range"] = (0.0, 1.0)
    hinged = rig.skeleton.with_hinges(hinges)
    assert set(hinged.hinges) == set(hinges)
    assert hinged.hinges["right_shin"]["range"] == (0.0, 1.0)
    assert not rig.skeleton.hinges and not hinged.with_hinges({}).hinges
    assert set(rig.skeleton.with_hinges().hinges) == set(rig.skeleton.guess_hinges())


def test_hinges_survive_json_and_pickle(rig):
    import pickle

    hinged = rig.skeleton.with_hinges()
    for copy in (kinopt.Skeleton.from_json(hinged.to_json()), pickle.loads(pickle.dumps(hinged))):
        assert copy.hinges == hinged.hinges
        assert copy.with_hinges({}).to_json() == rig.skeleton.to_json()


def test_wrong_hinges_are_named(rig):
    hinge = {"axis": (0, 1, 0), "range": (0, 1)}
    with pytest.raises(kinopt.UnknownNameError, match="knee"):
        rig.skeleton.with_hinges({"knee": hinge})
    with pytest.raises(kinopt.UnknownNameError, match="axes"):
        rig.skeleton.with_hinges({"left_shin": {"axes": (0, 1, 0), "range": (0, 1)}})
    with pytest.raises(kinopt.InvalidValueError, match="range"):
        rig.skeleton.with_hinges({"left_shin": {"axis": (0, 1, 0)}})
    with pytest.raises(kinopt.InvalidValueError, match="left_shin.*axis"):
        rig.skeleton.with_hinges({"left_shin": {**hinge, "axis": (0, 0, 0)}})


def test_held_postures_make_a_problem(rig):
    skeleton = rig.skeleton
    rest = skeleton.model.neutral()
    hand = kinopt.frame_placement(skeleton, "left_hand/tip", rest)[:3, 3]
    held = skeleton.hold_parameters(["left_hand"], rest)
    soft = skeleton.hold_postures(["left_hand"], rest)
    assert [task.name for task in soft] == ["posture", "posture of the back"]
    assert soft[1].scale == 5.0
    problem = kinopt.Problem(skeleton, [tasks.Point("left_hand/tip", hand, name="hand"), *soft], parameters=held)
    solution = kinopt.Drag(problem, rest).settle({"hand": hand + [0.1, -0.1, 0.1]})
    assert solution.reached
    pelvis = [skeleton.model.joint_names.index(joint) for joint in skeleton.joints("pelvis")]
    assert np.all(solution.q[pelvis] == 0)


def test_character_stays_on_its_feet(rig):
    scene = kinopt.Scene.of_skeleton(rig.skeleton, rig.mesh, rig.weights)
    total = sum(mass for mass, _ in scene.masses.values())
    assert total == pytest.approx(sum(mass for mass, _ in rig.masses.values()), rel=0.01)
    for character in (rig, scene):
        drag = kinopt.StandingDrag(character, ["left_hand"])
        assert sorted(drag.feet) == ["left_foot", "right_foot"]
        before = drag.positions["left_foot"]
        solution = drag.settle({"left_hand": [0.5, 0.4, 1.0]}, frames=60)
        assert drag.balance_margin > -1e-6
        assert np.allclose(drag.positions["left_foot"], before, atol=1e-5)
        assert solution.q.shape == drag.q.shape
        assert drag.pose.rotations_xyzw.shape[1] == 4
    with pytest.raises(kinopt.UnknownNameError, match="right_hand"):
        drag.advance({"right_hand": [0, 0, 0]})
    with pytest.raises(kinopt.InvalidValueError, match="legs"):
        builder = kinopt.Skeleton.builder("stick")
        builder.add("stick", length=1.0)
        kinopt.StandingDrag(builder.build(), [])
