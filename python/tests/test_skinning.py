"""Skinning, compared with numpy and with invariants of every method."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.skinning import (
    AutomaticWeights,
    BoneBoxes,
    CageBinding,
    HeatWeights,
    MeshWeights,
    MorphTargets,
    PointHandle,
    SkinWeights,
)

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def rig():
    return kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")


def transforms(rig, n, seed=3):
    q = 0.3 * np.clip(rig.model.random_configuration(n, seed=seed), -1.5, 1.5)
    return rig.skeleton.skinning_transforms(q)


def cube():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return kinopt.TriangleMesh(corners, faces)


def test_linear_blend_is_the_weighted_mean_of_transforms(rig):
    weights = MeshWeights(rig.weights)
    rest = rig.mesh.positions
    table = rig.weights.to_table()
    homogeneous = np.c_[rest, np.ones(len(rest))]
    posed = transforms(rig, 3)
    ours = weights.positions("lbs", posed, rest)
    for transform, actual in zip(posed, ours):
        blended = np.einsum("vb,bij->vij", table, transform)
        expected = np.einsum("vij,vj->vi", blended, homogeneous)[:, :3]
        assert np.abs(actual - expected).max() < 1e-5


def test_packed_and_unpacked_agree(rig):
    pruned, _ = rig.weights.pruned(4)
    packed, plain = MeshWeights(pruned, packed=True), MeshWeights(pruned, packed=False)
    assert packed.is_packed and not plain.is_packed and MeshWeights(pruned).is_packed
    posed = transforms(rig, 2)
    for method in ("lbs", "dqs"):
        for part, rest in (("positions", rig.mesh.positions), ("normals", rig.mesh.normals)):
            if rest is None:
                continue
            ours, theirs = (getattr(w, part)(method, posed, rest) for w in (packed, plain))
            assert np.abs(ours - theirs).max() < 1e-5
        twin = pickle.loads(pickle.dumps(plain))
        ours, theirs = (w.positions(method, posed, rig.mesh.positions) for w in (plain, twin))
        assert np.array_equal(ours, theirs) and not twin.is_packed
    if rig.weights.max_influences > 4:
        with pytest.raises(kinopt.InvalidValueError, match="influences"):
            MeshWeights(rig.weights, packed=True)


def test_rigid_motion_moves_the_mesh_rigidly(rig):
    turn = np.eye(4)
    turn[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    turn[:3, 3] = [1, 2, 3]
    all_alike = np.repeat(turn[None], rig.weights.bone_count, axis=0)
    rest = rig.mesh.positions
    expected = rest @ turn[:3, :3].T + turn[:3, 3]
    weights = MeshWeights(rig.weights)
    tangents = np.c_[np.tile([1.0, 0, 0], (len(rest), 1)), np.full(len(rest), -1.0)]
    for method in ("lbs", "dqs"):
        assert np.abs(weights.positions(method, all_alike, rest) - expected).max() < 1e-4
        turned = weights.tangents(method, all_alike, tangents)
        assert np.abs(turned - [0, 1, 0, -1]).max() < 1e-4
        mesh = weights.mesh(method, rig.mesh, all_alike)
        assert mesh.signed_volume() == pytest.approx(rig.mesh.signed_volume(), rel=1e-4)


def test_dual_quaternions_stretch_about_pivots_only(rig):
    tails = np.array([bone.rest_tail for bone in rig.skeleton.bones])
    grown = np.repeat(np.diag([2.0, 2, 2, 1])[None], len(tails), axis=0)
    rest = rig.mesh.positions
    one = np.repeat(np.eye(4)[None], len(tails), axis=0)
    one[0] = grown[0]
    with pytest.raises(kinopt.InvalidValueError, match="dual quaternion cannot represent"):
        MeshWeights(rig.weights).positions("dqs", one, rest)
    weights = MeshWeights(rig.weights, pivots=tails)
    assert np.isfinite(weights.positions("dqs", one, rest)).all()
    # A common scale of all bones scales the whole mesh.
    assert np.abs(weights.positions("dqs", grown, rest) - 2 * rest).max() < 1e-3


def test_out_receives_the_result(rig):
    weights = MeshWeights(rig.weights)
    posed, rest = transforms(rig, 2), rig.mesh.positions
    buffer = np.empty((2, len(rest), 3), np.float32)
    assert weights.positions("lbs", posed, rest, out=buffer) is buffer
    assert np.array_equal(buffer[1], weights.positions("lbs", posed[1], rest))
    for wrong in (posed[:, :-1], posed[..., :3], np.full_like(posed, np.nan)):
        with pytest.raises(kinopt.InvalidValueError):
            weights.positions("lbs", wrong, rest)
    with pytest.raises(kinopt.InvalidValueError, match="rest positions given, expected"):
        weights.positions("lbs", posed, rest[1:])
    with pytest.raises(kinopt.UnknownNameError):
        weights.positions("ribs", posed, rest)
    # Neither strides nor misaligned memory matter.
    strided = np.repeat(rest, 2, axis=0)[::2]
    raw = np.frombuffer(b"x" + rest.tobytes(), np.uint8)[1:].view(np.float32).reshape(-1, 3)
    assert not raw.flags.aligned
    for same in (strided, raw, rest.astype(float), rest.tolist()):
        assert np.array_equal(weights.positions("lbs", posed[0], same), buffer[0])


def test_point_handles_move_nearby_vertices():
    handles = [PointHandle([0, 0, 0]), PointHandle([1, 0, 0], [1, 2, 0], np.diag([3.0, 1, 1]))]
    handles = [pickle.loads(pickle.dumps(handle)) for handle in handles]
    weights = MeshWeights(SkinWeights.from_table([[1, 0], [0.5, 0.5], [0, 1]]))
    rest = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    posed = weights.positions("lbs", PointHandle.transforms(handles), rest)
    assert np.allclose(posed, [[0, 0, 0], [1, 1, 0], [4, 2, 0]])
    assert np.allclose(handles[1].transform[:3, 3], [-2, 2, 0])
    with pytest.raises(kinopt.InvalidValueError, match="finite"):
        PointHandle([0, 0, np.nan])


def test_cages_reproduce_affine_maps():
    cage = cube()
    points = np.random.default_rng(5).uniform(0.1, 0.9, (30, 3))
    binding = pickle.loads(pickle.dumps(CageBinding(cage, points)))
    assert binding.point_count == 30
    assert np.abs(binding.positions(cage.positions) - points).max() < 1e-5
    linear = np.array([[1, 0.3, 0], [0, 2, 0], [-0.1, 0, 1]])
    buffer = np.empty((30, 3), np.float32)
    assert binding.positions(cage.positions @ linear.T + [1, 2, 3], out=buffer) is buffer
    assert np.abs(buffer - (points @ linear.T + [1, 2, 3])).max() < 1e-5
    assert binding.coordinates(-1).sum() == pytest.approx(1, abs=1e-5)
    with pytest.raises(IndexError):
        binding.coordinates(30)
    with pytest.raises(kinopt.InvalidValueError, match="corners"):
        binding.positions(cage.positions[:7])
    open_cage = kinopt.TriangleMesh(cage.positions, cage.triangles[1:])
    with pytest.raises(kinopt.InvalidValueError, match="not closed"):
        CageBinding(open_cage, points)


def test_boxes_contain_the_skinned_mesh(rig):
    boxes = pickle.loads(pickle.dumps(BoneBoxes(rig.weights, rig.mesh.positions)))
    for posed in transforms(rig, 5, seed=9):
        low, high = boxes.linear_blend(posed)
        vertices = MeshWeights(rig.weights).positions("lbs", posed, rig.mesh.positions)
        assert (vertices >= low).all() and (vertices <= high).all()


def test_weights_are_computed_by_distance_and_heat():
    rig = kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json")
    bones = rig.skeleton.bones
    segments = np.array([[bone.rest_tail, bone.rest_tip] for bone in bones])
    for made in (AutomaticWeights(most=4), HeatWeights(most=4)):
        made = pickle.loads(pickle.dumps(made))
        weights = made.for_skeleton(rig.mesh, rig.skeleton)
        assert weights.max_influences <= 4
        assert np.abs(weights.to_table().sum(axis=1) - 1).max() < 1e-9
        same = made.for_segments(rig.mesh, segments)
        assert np.array_equal(same.weights, weights.weights)
        # Most vertices have their largest weight at the nearest bone.
        near = np.array([distances(rig.mesh.positions, *segment) for segment in segments]).argmin(0)
        assert (weights.to_table().argmax(axis=1) == near).mean() > 0.7
    for wrong in (AutomaticWeights(falloff=0.0), AutomaticWeights(most=0), HeatWeights(heat=-1.0)):
        with pytest.raises(kinopt.InvalidValueError):
            wrong.for_skeleton(rig.mesh, rig.skeleton)
    with pytest.raises(kinopt.InvalidValueError, match="no bones"):
        HeatWeights().for_segments(rig.mesh, np.zeros((0, 2, 3)))


def distances(points, tail, tip):
    along = tip - tail
    share = np.clip((points - tail) @ along / max(along @ along, 1e-12), 0, 1)
    return np.linalg.norm(points - tail - share[:, None] * along, axis=1)


def test_shared_scale_keeps_the_point_of_the_joint():
    """A mesh in centimetres under a root of scale 0.01; both bones map (100, 0, 0) to (1, 0, 0)."""
    weights = SkinWeights.from_table(np.array([[1, 0], [0.5, 0.5], [0, 1.0]]))
    rest = np.array([[0, 0, 0], [100, 0, 0], [200, 0, 0]], np.float32)
    first = np.diag([0.01, 0.01, 0.01, 1.0])
    second = np.eye(4)
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    second[:3, :3] = 0.01 * np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    second[:3, 3] = [1, 0, 0] - second[:3, :3] @ [100, 0, 0]
    transforms = np.array([first, second], np.float32)
    pivots = np.array([[0, 0, 0], [100, 0, 0]], np.float32)
    for mesh in (MeshWeights(weights, pivots=pivots), MeshWeights(weights)):
        for method in ("lbs", "dqs"):
            assert np.allclose(mesh.positions(method, transforms, rest)[1], [1, 0, 0], atol=1e-6)


@pytest.mark.parametrize("count", [2**31, 2**40, 2**62, 2**63, 2**64])
def test_absurd_counts_of_vertices_raise(count):
    wrong = (kinopt.InvalidValueError, MemoryError, OverflowError)
    for make in (SkinWeights, SkinWeights.repaired):
        with pytest.raises(wrong):
            make([0], [0], [1.0], count, 1)
        with pytest.raises(wrong):
            make([0], [0], [1.0], 1, count)
    with pytest.raises(wrong):
        targets = MorphTargets(count, [])
        targets.apply([], positions=np.zeros((1, 3), np.float32))
