"""Clips, poses and blends, compared with interpolation in numpy."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.animation import (
    Armature,
    BoneMask,
    Clip,
    EulerCurve,
    KeyedCurve,
    Layer,
    Playhead,
    Pose,
    Poses,
    RotationCurve,
    blend_poses,
    easing,
)

MODELS = Path(__file__).parents[2] / "models"


def about_z(angle):
    """Quaternion x, y, z, w of a rotation about z."""
    zero = np.zeros_like(angle)
    return np.stack([zero, zero, np.sin(angle / 2), np.cos(angle / 2)], axis=-1)


@pytest.fixture(scope="module")
def chain():
    """Three bones along x, one metre each."""
    return Armature(
        ["hips", "chest", "head"],
        [-1, 0, 1],
        translations=[[0, 0, 0], [1, 0, 0], [1, 0, 0]],
        morph_targets=["smile", "blink"],
    )


def nod(chain):
    builder = Clip.builder("nod", chain)
    builder.channel("chest", "rotation", RotationCurve.slerp([0, 1], xyzw=about_z(np.array([0, 1.0]))))
    builder.channel("hips", "translation", KeyedCurve.linear([0, 2], [[0, 0, 0], [0, 2, 0]]))
    builder.morph_weight("smile", KeyedCurve.linear([0.0, 2.0], [0.0, 1.0]))
    builder.event(0.5, "left")
    builder.event(1.5, "right")
    return builder.build()


def test_clip_is_sampled_at_and_between_keys(chain):
    clip = nod(chain)
    assert clip.span == (0, 2) and clip.duration == 2 and clip.name == "nod"
    times = np.linspace(0, 2, 9)
    poses = clip.sample(times)
    angle = np.minimum(times, 1.0)
    assert poses.rotations_xyzw.shape == (9, 3, 4)
    assert np.abs(poses.rotations_xyzw[:, 1] - about_z(angle)).max() < 1e-6
    assert np.allclose(poses.translations[:, 0, 1], times, atol=1e-6)
    assert np.allclose(poses.morph_weights, np.c_[times / 2, 0 * times], atol=1e-6)
    assert np.array_equal(poses.rotations_wxyz[..., [1, 2, 3, 0]], poses.rotations_xyzw)
    for time, pose in zip(times, poses):
        one = clip.sample(float(time))
        assert np.array_equal(one.rotations_xyzw, pose.rotations_xyzw)
        out = chain.rest
        assert clip.sample(float(time), out=out) is out
        assert np.array_equal(out.translations, one.translations)
    head = chain.local_to_model(poses)[:, 2]
    expected = np.c_[1 + np.cos(angle), times + np.sin(angle), 0 * angle]
    assert np.abs(head[:, :3, 3] - expected).max() < 1e-5


def test_playback_repeats(chain):
    clip = nod(chain)
    at = lambda time, playback: clip.sample(time, playback).translations[0, 1]
    assert at(2.5, "hold") == 2 and np.isclose(at(2.5, "loop"), 0.5)
    assert np.isclose(at(2.5, "ping_pong"), 1.5)
    with pytest.raises(kinopt.UnknownNameError, match="playback"):
        clip.sample(1.0, "backwards")


def test_events_fire_once_per_passage(chain):
    clip = nod(chain)
    for steps in (1, 7, 100):
        playhead, events = Playhead(), []
        for _ in range(steps):
            events += clip.fired(playhead.advance(6 / steps), "loop")
        assert [name for name, _ in events] == ["left", "right"] * 3
        assert np.allclose([at for _, at in events], [0.5, 1.5, 2.5, 3.5, 4.5, 5.5], atol=1e-6)
    assert len(clip.fired(Playhead().advance(1e6), "loop", most=5)) == 5


def test_channels_rebuild_the_clip(chain):
    clip = nod(chain)
    builder = Clip.builder("twin", chain)
    builder.span(*clip.span)
    for bone, prop, curve in clip.channels():
        builder.channel(bone, prop, curve)
    for target, curve in clip.morph_channels():
        builder.morph_weight(target, curve)
    times = np.linspace(0, 2, 23)
    ours, theirs = clip.sample(times), builder.build().sample(times)
    assert np.array_equal(ours.rotations_xyzw, theirs.rotations_xyzw)
    assert np.array_equal(ours.morph_weights, theirs.morph_weights)


def test_copies_are_bitwise_equal(chain):
    clip = nod(chain)
    twin = pickle.loads(pickle.dumps(clip))
    times = np.random.default_rng(3).uniform(-1, 5, 200)
    for playback in ("hold", "loop"):
        assert np.array_equal(
            clip.sample(times, playback).rotations_xyzw, twin.sample(times, playback).rotations_xyzw
        )
    assert twin.events == clip.events
    pose = clip.sample(0.37)
    for same in (pickle.loads(pickle.dumps(pose)), copy.deepcopy(pose), copy.copy(pose)):
        assert np.array_equal(same.rotations_xyzw, pose.rotations_xyzw)
        assert np.array_equal(same.morph_weights, pose.morph_weights)
    poses = clip.sample(times)
    assert np.array_equal(
        pickle.loads(pickle.dumps(poses)).translations, poses.translations
    )
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    armature = Armature.of_skeleton(rig.skeleton)
    again = pickle.loads(pickle.dumps(armature))
    assert np.array_equal(again.rest_from_model, armature.rest_from_model)
    assert again.names == armature.names and np.array_equal(again.parents, armature.parents)
    builder = Clip.builder("keys", armature)
    builder.euler_clip(rig.clip)
    keys = builder.build()
    same = pickle.loads(pickle.dumps(keys))
    assert np.array_equal(same.sample(times).rotations_xyzw, keys.sample(times).rotations_xyzw)


def test_curves_match_formulas():
    times, values = np.array([0.0, 1.0, 3.0]), np.array([1.0, 2.0, -1.0])
    inside = np.linspace(0, 3, 31)
    linear = KeyedCurve.linear(times, values)
    assert np.allclose(linear.at(inside), np.interp(inside, times, values), atol=1e-6)
    assert np.allclose(linear.rate([0.5, 2.0]), [1, -1.5], atol=1e-6)
    step = KeyedCurve.step(times, values)
    assert np.array_equal(step.at([0.99, 1.0, 2.99, 3.0]), np.float32([1, 2, 2, -1]))
    spline = KeyedCurve.catmull_rom(times, values)
    assert np.array_equal(spline.at(times), values.astype(np.float32))
    same = KeyedCurve.kochanek_bartels(times, values, np.zeros((3, 3)))
    assert np.allclose(same.at(inside), spline.at(inside), atol=1e-5)
    rates = np.array([1.0, -2.0, 0.5])
    cubic = KeyedCurve.cubic(times, values, np.c_[rates, rates])
    u = inside[inside <= 1]
    hermite = (
        (2 * u**3 - 3 * u**2 + 1) * 1 + (u**3 - 2 * u**2 + u) * 1
        + (-2 * u**3 + 3 * u**2) * 2 + (u**3 - u**2) * -2
    )
    assert np.allclose(cubic.at(u), hermite, atol=1e-5)
    straight = KeyedCurve.bezier([0, 3], [0, 3], [[0, 1], [-1, 0]], [[0, 1], [-1, 0]])
    assert np.allclose(straight.at(inside), inside, atol=1e-5)
    vectors = KeyedCurve.linear([0, 1], [[0, 1, 2], [1, 1, 0]])
    assert vectors.at(0.5).shape == (3,) and vectors.at([0.5, 0.6]).shape == (2, 3)
    assert np.allclose(vectors.at(0.5), [0.5, 1, 1])
    eased = KeyedCurve.eased([0, 1], [0, 1], ["cubic_in", "linear"])
    assert np.allclose(eased.at(0.5), 0.125)
    assert np.allclose(easing("quadratic_in", np.array([0.0, 0.5, 1.0])), [0, 0.25, 1])
    assert np.allclose(easing(((0.3, 0.3), (0.6, 0.6)), 0.4), 0.4, atol=1e-6)
    for curve in (linear, step, spline, cubic, straight, eased):
        twin = pickle.loads(pickle.dumps(curve))
        assert np.array_equal(twin.at(inside), curve.at(inside))


def test_rotations_have_constant_speed_and_pass_keys():
    times, angles = np.array([0.0, 1.0, 2.5]), np.array([0.0, 1.0, 0.2])
    inside = np.linspace(0, 2.5, 26)
    slerp = RotationCurve.slerp(times, xyzw=about_z(angles))
    assert np.abs(slerp.at_xyzw(inside) - about_z(np.interp(inside, times, angles))).max() < 1e-6
    same = RotationCurve.slerp(times, wxyz=about_z(angles)[:, [3, 0, 1, 2]])
    assert np.array_equal(same.at_wxyz(inside)[:, [1, 2, 3, 0]], slerp.at_xyzw(inside))
    curves = [
        RotationCurve.squad(times, xyzw=about_z(angles)),
        RotationCurve.smooth(times, xyzw=about_z(angles)),
        RotationCurve.step(times, xyzw=about_z(angles)),
        RotationCurve.eased(times, ["linear"] * 3, xyzw=about_z(angles)),
        RotationCurve.cubic(times, np.zeros((3, 2, 4)), xyzw=about_z(angles)),
    ]
    for curve in curves:
        assert np.abs(curve.at_xyzw(times) - about_z(angles)).max() < 1e-6
        assert np.abs(np.linalg.norm(curve.at_xyzw(inside), axis=1) - 1).max() < 1e-5
        twin = pickle.loads(pickle.dumps(curve))
        assert np.array_equal(twin.at_xyzw(inside), curve.at_xyzw(inside))
    turns = EulerCurve("zxy", KeyedCurve.linear([0, 1], [[0, 0, 0], [1.0, 0, 0]]))
    assert np.abs(turns.at_xyzw(0.5) - about_z(np.array(0.5))).max() < 1e-6


def test_blends_are_weighted_means(chain):
    still, turned = chain.rest, chain.rest
    turned.set_local("chest", rotation_xyzw=about_z(np.array(1.0)), translation=[3, 0, 0])
    turned.set_morph_weight("smile", 1.0)
    for share in (0.0, 0.3, 1.0):
        faded = still.copy()
        faded.cross_fade(turned, share)
        assert np.abs(faded.rotations_xyzw[1] - about_z(np.array(share))).max() < 1e-5
        assert np.allclose(faded.translations[1], [1 + 2 * share, 0, 0])
        assert np.allclose(faded.morph_weights, [share, 0])
        mean = blend_poses([still, turned], [1 - share, share])
        assert np.allclose(mean.translations, faded.translations, atol=1e-6)
    mask = BoneMask.all(chain).with_subtree("chest", 0.0)
    assert np.array_equal(mask.bones, [1, 0, 0])
    masked = still.copy()
    masked.cross_fade(turned, 1.0, mask)
    assert np.array_equal(masked.translations, still.translations)
    assert np.allclose(masked.morph_weights, [1, 0])
    twin = pickle.loads(pickle.dumps(mask.with_bone("head", 0.25)))
    assert np.array_equal(twin.bones, [1, 0, 0.25])


def test_additive_layers_add_difference_from_reference(chain):
    base, lean = chain.rest, chain.rest
    base.set_local("hips", translation=[0, 5, 0], rotation_xyzw=about_z(np.array(0.4)))
    lean.set_local("hips", translation=[0, 1, 0], rotation_xyzw=about_z(np.array(0.2)))
    layer = Layer(BoneMask.all(chain), 0.5, reference=chain.rest)
    layer = pickle.loads(pickle.dumps(layer))
    layer.apply(base, lean)
    assert np.allclose(base.translations[0], [0, 5.5, 0])
    assert np.abs(base.rotations_xyzw[0] - about_z(np.array(0.5))).max() < 1e-6
    over = Layer(BoneMask.none(chain).with_bone("hips"), 1.0)
    over.apply(base, lean)
    assert np.allclose(base.translations[0], [0, 1, 0])


def test_poses_are_built_from_arrays(chain):
    angles = np.linspace(0, 1, 12).reshape(4, 3)
    poses = Poses(chain, rotations_xyzw=about_z(angles), morph_weights=np.ones((4, 2)))
    assert len(poses) == 4
    assert np.abs(poses.rotations_xyzw - about_z(angles)).max() < 1e-6
    assert np.array_equal(poses.translations, np.repeat(chain.rest.translations[None], 4, 0))
    assert np.array_equal(Poses(chain, list(poses)).rotations_wxyz, poses.rotations_wxyz)
    total = angles.cumsum(axis=1)
    heads = chain.local_to_model(poses)[:, 2, :3, 3]
    expected = np.c_[
        np.cos(total[:, 0]) + np.cos(total[:, 1]), np.sin(total[:, 0]) + np.sin(total[:, 1])
    ]
    assert np.abs(heads[:, :2] - expected).max() < 1e-5
    buffer = np.empty((4, 3, 4, 4), np.float32)
    assert chain.local_to_model(poses, out=buffer) is buffer
    at_rest = chain.skinning_transforms(chain.local_to_model(chain.rest))
    assert np.allclose(at_rest, np.eye(4), atol=1e-6)


def test_bones_are_placed_in_model_space(chain):
    pose = chain.rest
    chain.set_model_rotation(pose, "chest", xyzw=about_z(np.array(1.0)))
    assert np.allclose(chain.model_rotation_xyzw(pose, "head"), about_z(np.array(1.0)), atol=1e-6)
    chain.set_model_translation(pose, "head", [5, 5, 5])
    assert np.allclose(chain.model_from_bone(pose, "head")[:3, 3], [5, 5, 5], atol=1e-5)
    assert np.allclose(chain.model_rotation_wxyz(pose, "head"), about_z(np.array(1.0))[[3, 0, 1, 2]])
    moved = chain.at_rest_in(pose)
    assert np.allclose(moved.rest.translations, pose.translations)


def test_invalid_arguments_raise_named_errors(chain):
    clip = nod(chain)
    wrong = [
        (kinopt.UnknownNameError, lambda: chain.rest.local("tail")),
        (kinopt.UnknownNameError, lambda: chain.rest.set_morph_weight("frown", 1.0)),
        (kinopt.UnknownNameError, lambda: EulerCurve("xxy", KeyedCurve.linear([0], [[0, 0, 0]]))),
        (kinopt.InvalidValueError, lambda: chain.rest.set_local("head", scale=[np.nan, 1, 1])),
        (kinopt.InvalidValueError, lambda: chain.rest.set_local("head", rotation_xyzw=[0, 0, 0, 0])),
        (kinopt.InvalidValueError, lambda: Pose(chain, translations=np.zeros((2, 3)))),
        (kinopt.InvalidValueError, lambda: Pose(chain, rotations_xyzw=np.eye(4)[:3], rotations_wxyz=np.eye(4)[:3])),
        (kinopt.InvalidValueError, lambda: KeyedCurve.linear([1, 0], [0, 1])),
        (kinopt.InvalidValueError, lambda: KeyedCurve.linear([], [])),
        (kinopt.InvalidValueError, lambda: KeyedCurve.linear([0, 1], [0, np.inf])),
        (kinopt.InvalidValueError, lambda: KeyedCurve.linear([0, 1], np.zeros((2, 2)))),
        (kinopt.InvalidValueError, lambda: RotationCurve.slerp([0, 1])),
        (kinopt.InvalidValueError, lambda: RotationCurve.slerp([0], xyzw=[[0, 0, 0, 0]])),
        (kinopt.InvalidValueError, lambda: Armature(["a", "b"], [1, -1])),
        (kinopt.InvalidValueError, lambda: Armature(["a", "a"], [-1, 0])),
        (kinopt.InvalidValueError, lambda: Armature(["a"], [-1, -1])),
        (kinopt.InvalidValueError, lambda: BoneMask.all(chain).with_bone("head", 2.0)),
        (kinopt.InvalidValueError, lambda: blend_poses([chain.rest], [-1.0])),
        (kinopt.InvalidValueError, lambda: blend_poses([], [])),
        (kinopt.InvalidValueError, lambda: chain.local_to_model("a pose")),
        (kinopt.InvalidValueError, lambda: chain.rest.cross_fade(Armature(["a"], [-1]).rest, 1.0)),
        (kinopt.InvalidValueError, lambda: chain.skinning_transforms(np.zeros((2, 4, 4)))),
        (kinopt.InvalidValueError, lambda: clip.sample(np.zeros((2, 2)))),
    ]
    for error, call in wrong:
        with pytest.raises(error):
            call()
    builder = Clip.builder("twice", chain)
    for _ in range(2):
        builder.channel("hips", "translation", KeyedCurve.step([0], [[0, 0, 0]]))
    with pytest.raises(kinopt.InvalidValueError, match="`hips`: a translation channel exists already"):
        builder.build()
    with pytest.raises(kinopt.InvalidValueError, match="a rotation channel has"):
        builder.channel("hips", "rotation", KeyedCurve.step([0], [[0, 0, 0]]))
    odd = pickle.dumps(clip)
    with pytest.raises(ValueError):
        pickle.loads(odd.replace(b'"span":[0.0,2.0]', b'"span":[9.0,2.0]'))


def test_morph_targets_are_added_and_mixed():
    from kinopt.skinning import BlendShapes, MorphTarget, MorphTargets

    rest = np.random.default_rng(1).normal(size=(10, 3)).astype(np.float32)
    deltas = [MorphTarget("a", [1, 4], [[1, 0, 0], [0, 1, 0]]), MorphTarget("b", [4], [[0, 0, 2]])]
    targets = pickle.loads(pickle.dumps(MorphTargets(10, deltas)))
    positions = rest.copy()
    targets.apply([0.5, 0.25], positions)
    expected = rest.copy()
    expected[1, 0] += 0.5
    expected[4] += [0, 0.5, 0.5]
    assert np.allclose(positions, expected, atol=1e-6)
    triangles = [[0, 1, 4]]
    between = MorphTarget.between(
        "c", kinopt.TriangleMesh(rest, triangles), kinopt.TriangleMesh(expected, triangles)
    )
    assert list(between.vertices) == [1, 4]
    shapes = pickle.loads(pickle.dumps(BlendShapes({"calm": rest, "other": expected})))
    buffer = np.empty_like(rest)
    assert shapes.blend([0.5, 0.5], out=buffer) is buffer
    assert np.allclose(buffer, (rest + expected) / 2, atol=1e-6)
    for wrong in ([1.0], [np.nan, 0], [0.5, 0.6]):
        with pytest.raises(kinopt.InvalidValueError):
            shapes.blend(wrong)
    with pytest.raises(kinopt.InvalidValueError):
        targets.apply([1.0, np.nan], positions)
    with pytest.raises(kinopt.InvalidValueError):
        targets.apply([1.0, 1.0], positions.astype(float))
    with pytest.raises(kinopt.InvalidValueError):
        targets.apply([1.0, 1.0], positions, positions)
    with pytest.raises(kinopt.InvalidValueError, match="vertices must increase"):
        MorphTarget("a", [4, 1], np.zeros((2, 3)))


def test_without_scale_drops_the_rest_scales():
    translations = [[0, 0, 0], [1, 0, 0], [1, 0, 0]]
    scaled = Armature(["hips", "chest", "head"], [-1, 0, 1], translations=translations, scales=[[2, 1, 1], [1, 1, 1], [1, 1, 1]])
    plain = scaled.without_scale()
    assert len(scaled.scale_notes) == 1 and plain.scale_notes == []
    for armature, x in ((scaled, 4.0), (plain, 2.0)):
        placed = armature.local_to_model(armature.rest)
        assert np.allclose(placed[2, :3, 3], [x, 0, 0])
        assert np.allclose(armature.rest_from_model @ placed, np.eye(4))
    assert np.array_equal(plain.rest.translations, scaled.rest.translations)


def test_sample_uses_seconds_of_the_file():
    armature = Armature(["a"], [-1])
    builder = Clip.builder("late", armature)
    builder.channel("a", "translation", KeyedCurve.linear([1, 2], [[0, 0, 0], [1, 0, 0]]))
    clip = builder.build()
    assert clip.span == (1.0, 2.0)
    assert np.allclose(clip.sample(1.5).translations[0], [0.5, 0, 0])
    assert np.allclose(clip.sample(2.25, "loop").translations[0], [0.25, 0, 0])
    assert np.allclose(clip.sample([0.0, 1.75, 3.0]).translations[:, 0, 0], [0, 0.75, 1])
