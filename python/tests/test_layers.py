"""State machines, limbs, aims, reach layers and crowds, verified by geometry."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.animation import (
    Aim,
    AimGoal,
    Armature,
    Clip,
    Crowd,
    KeyedCurve,
    Limb,
    LimbGoal,
    PlayingClip,
    Pose,
    EulerPoseMap,
    ReachLayer,
    StateMachine,
    StateMachineRun,
)

MODELS = Path(__file__).parents[2] / "models"

MACHINE = """{
  "parameters": {"speed": 0.0, "jump": "trigger", "grounded": true},
  "initial": "idle",
  "states": [{"name": "idle", "clip": "stand"}, {"name": "move", "clip": "walk"}],
  "transitions": [
    {"from": "idle", "to": "move", "seconds": 0.5, "when": [{"parameter": "speed", "above": 0.1}]},
    {"from": "move", "to": "idle", "seconds": 0.0, "when": [{"parameter": "jump"}]}
  ]
}"""


@pytest.fixture(scope="module")
def leg():
    """A thigh, a shin and a foot hanging down, half a metre each."""
    down = [0, -0.5, 0]
    return Armature(["thigh", "shin", "foot"], [-1, 0, 1], translations=[[0, 1, 0], down, down])


def slide(armature, name, height, event=None):
    builder = Clip.builder(name, armature)
    builder.channel("thigh", "translation", KeyedCurve.linear([0, 1], [[0, height, 0]] * 2))
    builder.span(0, 1)
    if event:
        builder.event(0.25, event)
    return builder.build()


def test_state_machine_follows_parameters(leg):
    clips = [slide(leg, "stand", 0.0), slide(leg, "walk", 2.0, "step")]
    machine = pickle.loads(pickle.dumps(StateMachine.from_bytes(MACHINE, clips)))
    assert machine.states == ["idle", "move"]
    run = StateMachineRun(machine)
    height = lambda: run.pose.translations[0, 1]
    assert run.update(0.1) == [] and run.state == "idle" and height() == 0
    run.set_number("speed", 1.0)
    run.update(0.25)
    assert (run.state, run.leaving) == ("move", "idle") and 0 < run.fading < 1
    assert height() == pytest.approx(2 * run.fading, abs=1e-5)
    events = run.update(1.1)
    assert run.fading is None and height() == 2
    assert [(state, clip, name) for state, clip, name, _, _ in events] == [("move", "walk", "step")]
    assert run.playing == [("walk", 1.0)]
    run.trigger("jump")
    assert run.parameters == {"speed": 1.0, "jump": True, "grounded": True}
    run.set_number("speed", 0.0)
    run.update(0.01)
    assert run.state == "idle" and run.parameters["jump"] is False
    with pytest.raises(kinopt.UnknownNameError, match="speed"):
        run.set_number("sped", 1.0)
    with pytest.raises(kinopt.InvalidValueError, match="not finite"):
        run.set_number("speed", np.nan)
    with pytest.raises(kinopt.InvalidFileError, match=r"states\[1\].clip"):
        StateMachine.from_bytes(MACHINE, clips[:1])
    with pytest.raises(kinopt.InvalidValueError, match="at least one clip"):
        StateMachine.from_bytes(MACHINE, [])


def test_long_and_short_steps_end_equally(leg):
    clips = [slide(leg, "stand", 0.0), slide(leg, "walk", 2.0, "step")]
    machine = StateMachine.from_bytes(MACHINE, clips)
    ends = []
    for steps in (1, 50):
        run = StateMachineRun(machine)
        run.set_number("speed", 1.0)
        events = [event for _ in range(steps) for event in run.update(3.3 / steps)]
        ends.append((run.state, len(events), run.pose.translations))
    assert ends[0][:2] == ends[1][:2]
    assert np.allclose(ends[0][2], ends[1][2], atol=1e-5)


def test_limb_reaches_and_bends_about_its_hinge(leg):
    limb = pickle.loads(pickle.dumps(Limb(leg, "thigh", "shin", "foot", hinge=[1, 0, 0])))
    rng = np.random.default_rng(2)
    for _ in range(20):
        target = np.array([0, 1, 0]) + 0.9 * rng.uniform(0.2, 1) * unit(rng.normal(size=3))
        pose = leg.rest
        limb.reach(pose, pickle.loads(pickle.dumps(LimbGoal(target))))
        placed = leg.local_to_model(pose)
        assert np.abs(placed[2, :3, 3] - target).max() < 1e-5
        lengths = np.linalg.norm(np.diff(placed[:, :3, 3], axis=0), axis=1)
        assert np.abs(lengths - 0.5).max() < 1e-5
    far = leg.rest
    limb.reach(far, LimbGoal([3, 1, 0]))
    assert np.allclose(leg.local_to_model(far)[2, :3, 3], [1, 1, 0], atol=1e-4)
    half = leg.rest
    limb.reach(half, LimbGoal([0, 0.4, 0], weight=0.0))
    assert np.array_equal(half.rotations_xyzw, leg.rest.rotations_xyzw)
    flat = leg.rest
    limb.reach(flat, LimbGoal([0, 0.5, 0.2], hold=1.0))
    assert np.allclose(np.abs(leg.model_rotation_wxyz(flat, "foot")), [1, 0, 0, 0], atol=1e-5)
    turned = leg.rest
    half_turn = np.array([0, 0, np.sqrt(0.5), np.sqrt(0.5)])
    limb.reach(turned, LimbGoal([0, 0.5, 0.2], rotation_xyzw=half_turn))
    assert abs(leg.model_rotation_xyzw(turned, "foot") @ half_turn) > 1 - 1e-5
    tip = Limb(leg, "thigh", "shin", [0, -0.5, 0])
    pose = leg.rest
    tip.reach(pose, LimbGoal([0.3, 0.4, 0], pole=[0, 1, 5]))
    assert np.allclose(leg.local_to_model(pose)[2, :3, 3], [0.3, 0.4, 0], atol=1e-5)


def test_aim_points_at_its_target(leg):
    aim = pickle.loads(pickle.dumps(Aim(leg, "foot", [0, 0, 1], up=[0, 1, 0])))
    rng = np.random.default_rng(3)
    for _ in range(20):
        target = rng.normal(size=3) * 2
        pose = leg.rest
        assert aim.turn(pose, AimGoal(target, up=[0, 1, 0]))
        placed = leg.local_to_model(pose)[2]
        direction = unit(target - placed[:3, 3])
        assert np.abs(placed[:3, 2] - direction).max() < 1e-5
        # The up axis stays in the plane of the direction to the target and the requested direction.
        assert abs(placed[:3, 0] @ [0, 1, 0]) < 1e-5
    for wrong in (lambda: AimGoal([np.nan, 0, 0]), lambda: AimGoal([1, 0, 0], weight=np.nan), lambda: LimbGoal([0, np.inf, 0])):
        with pytest.raises(kinopt.InvalidValueError, match="not finite"):
            wrong()
    with pytest.raises(kinopt.InvalidValueError, match="not finite"):
        LimbGoal([0, 0, 0], rotation_xyzw=[0, 0, 0, np.nan])


def test_reach_layer_reaches_goals_within_limits():
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    skeleton = rig.skeleton
    armature = Armature.of_skeleton(skeleton)
    angles = EulerPoseMap(skeleton)
    layer = ReachLayer(skeleton, ["left_hand", "right_foot"], held=["head"])
    pose = armature.rest
    assert layer.apply(pose) is None
    tips = kinopt.ForwardKinematics(rig, [skeleton.tip("left_hand"), skeleton.tip("right_foot")])
    q = angles.angles_of(pose)
    target = tips.place(q)[0, :3, 3] + [-0.05, 0.1, 0.1]
    layer.set_goal("left_hand", target)
    solution = layer.apply(pose)
    assert solution.reached
    q = angles.angles_of(pose)
    placed = tips.place(q)
    assert np.abs(placed[0, :3, 3] - target).max() < 1e-4
    assert (q >= rig.model.lower - 1e-5).all() and (q <= rig.model.upper + 1e-5).all()
    moved = armature.rest
    layer.set_rotation("head", 1.0, wxyz=[1, 0, 0, 0])
    layer.set_goal("left_hand", target, 0.0)
    layer.apply(moved)
    with pytest.raises(kinopt.UnknownNameError, match="effector"):
        layer.set_goal("left_foot", target)
    with pytest.raises(kinopt.InvalidValueError, match="bones"):
        layer.apply(Armature(["a"], [-1]).rest)


def test_angles_and_poses_convert():
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    angles = pickle.loads(pickle.dumps(EulerPoseMap(rig.skeleton)))
    armature = Armature.of_skeleton(rig.skeleton)
    q = 0.3 * np.clip(rig.model.random_configuration(5, seed=4), -1, 1)
    poses = angles.pose_of(q)
    placed = armature.local_to_model(poses)
    assert np.abs(placed - rig.skeleton.pose(q)).max() < 1e-5
    again = rig.skeleton.pose(angles.angles_of(poses))
    assert np.abs(again - rig.skeleton.pose(q)).max() < 1e-5
    assert isinstance(angles.pose_of(q[0]), Pose)
    buffer = np.empty_like(q)
    assert angles.angles_of(poses, out=buffer) is buffer
    with pytest.raises(kinopt.InvalidValueError, match="finite"):
        angles.pose_of(np.full_like(q[0], np.inf))


def test_crowd_is_bitwise_equal_on_any_threads(leg):
    low, high = slide(leg, "low", 0.0), slide(leg, "high", 2.0)
    limb = Limb(leg, "thigh", "shin", "foot", hinge=[1, 0, 0])
    crowds = [Crowd(leg, [limb]) for _ in range(2)]
    for crowd, threads in zip(crowds, (1, 2)):
        for i in range(40):
            fast = pickle.loads(pickle.dumps(PlayingClip(low, speed=1 + 0.1 * i)))
            crowd.add([fast, PlayingClip(high, share=i / 39)])
        crowd.set_goal(7, 0, LimbGoal([0, 0.2, 0.3]))
        crowd.set_clip(3, 1, share=1.0)
        crowd.advance(0.3, threads=threads)
    ours, theirs = (crowd.model_from_bone() for crowd in crowds)
    assert ours.shape == (40, 3, 4, 4) and np.array_equal(ours, theirs)
    heights = crowds[0].poses.translations[:, 0, 1]
    expected = 2 * np.arange(40) / 39
    expected[3] = 2
    assert np.abs(heights - expected).max() < 1e-5
    assert np.allclose(ours[7, 2, :3, 3], [0, 0.2, 0.3], atol=1e-4)
    buffer = np.empty((40, 3, 4, 4), np.float32)
    assert crowds[0].model_from_bone(out=buffer) is buffer
    with pytest.raises(IndexError):
        crowds[0].set_goal(40, 0, LimbGoal([0, 0, 0]))
    with pytest.raises(kinopt.InvalidValueError, match="bones"):
        crowds[0].add([PlayingClip(Clip.builder("a", Armature(["a"], [-1])).build())])


def unit(v):
    return v / np.linalg.norm(v)


def test_invalid_arguments_raise_named_errors(leg):
    wrong = [
        (kinopt.UnknownNameError, lambda: Limb(leg, "thigh", "shin", "toe")),
        (kinopt.InvalidValueError, lambda: Limb(leg, "shin", "thigh", "foot")),
        (kinopt.InvalidValueError, lambda: Limb(leg, "thigh", "shin", "foot", hinge=[0, 0, 0])),
        (kinopt.InvalidValueError, lambda: Limb(leg, "thigh", "shin", "foot", softening=2.0)),
        (kinopt.InvalidValueError, lambda: Limb(leg, "thigh", "shin", [np.nan, 0, 0])),
        (kinopt.InvalidValueError, lambda: LimbGoal([0, 0, 0], hold=1.0, rotation_xyzw=[0, 0, 0, 1])),
        (kinopt.InvalidValueError, lambda: LimbGoal([0, 0])),
        (kinopt.InvalidValueError, lambda: Aim(leg, "foot", [0, 0, 0])),
        (kinopt.InvalidValueError, lambda: Aim(leg, "foot", [0, 0, 1], up=[0, 0, 2])),
        (kinopt.InvalidValueError, lambda: Aim(leg, "foot", [0, 0, 1], offset=[np.inf, 0, 0])),
        (kinopt.InvalidValueError, lambda: Crowd(leg).advance(0.1, threads=0)),
    ]
    for error, call in wrong:
        with pytest.raises(error):
            call()
