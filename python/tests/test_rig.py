"""Rigs, skeletons and meshes: read, posed, written again, and sent to other processes."""

import copy
import pickle
import threading
from pathlib import Path

import numpy as np
import pytest

import kinopt

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def rig():
    return kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")


def poses(rig, n, seed=1):
    q = rig.model.random_configuration(n, seed=seed)
    return 0.3 * np.clip(q, -1.5, 1.5)


def rotation_about(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
    return turn


def test_rig_has_skeleton_mesh_weights_and_keys(rig):
    skeleton = rig.skeleton
    bones = len(skeleton.bones)
    assert skeleton.angles == rig.model.degrees_of_freedom == 3 * bones
    assert rig.mesh.positions.dtype == np.float32 and rig.mesh.triangles.dtype == np.uint32
    vertices = len(rig.mesh.positions)
    assert rig.mesh.positions.shape == (vertices, 3)
    assert rig.mesh.triangles.shape[1] == 3 and rig.mesh.triangles.max() < vertices
    assert (rig.weights.vertex_count, rig.weights.bone_count) == (vertices, bones)
    assert rig.mesh.is_closed() and rig.mesh.signed_volume() > 0
    assert set(rig.constrained) <= set(skeleton.bone_names)
    assert rig.notes == []


def test_bones_match_a_chain_of_rotations(rig):
    """W_bone = W_parent R̂_parent⁻¹ R̂_bone X(θ₃) Z(θ₂) X(θ₁), in numpy."""
    skeleton = rig.skeleton
    q = poses(rig, 3)
    posed = skeleton.pose(q)
    rest = [bone.model_from_rest for bone in skeleton.bones]
    for row, placed in zip(q, posed):
        expected = []
        for i, parent in enumerate(skeleton.parents):
            first, bend, second = row[3 * i : 3 * i + 3]
            rotation = rotation_about(0, second) @ rotation_about(2, bend) @ rotation_about(0, first)
            if parent < 0:
                start = rest[i]
            else:
                start = expected[parent] @ np.linalg.inv(rest[parent]) @ rest[i]
            expected.append(start @ rotation)
        assert np.abs(placed - np.array(expected)).max() < 1e-12
    transforms = skeleton.skinning_transforms(q)
    assert np.allclose(transforms @ np.array(rest), posed, atol=1e-12)


def test_frame_and_joint_names_are_the_models(rig):
    skeleton = rig.skeleton
    hand = skeleton.bone("left_hand")
    assert skeleton.tail("left_hand") == "left_hand"
    assert skeleton.tip("left_hand") == "left_hand/tip"
    assert skeleton.bone_of_frame("left_hand/tip") == ("left_hand", True)
    joints = ["left_hand/twist1", "left_hand/bend", "left_hand/twist2"]
    assert skeleton.joints("left_hand") == joints
    at = skeleton.bone_names.index("left_hand")
    assert skeleton.model.joint_names[3 * at : 3 * at + 3] == joints
    assert np.array_equal(skeleton.limits[at], hand.limits)
    assert np.array_equal(skeleton.limits.reshape(-1, 2)[:, 0], skeleton.model.lower)
    tip = hand.model_from_rest @ [hand.length, 0, 0, 1]
    assert np.allclose(hand.rest_tip, tip[:3], atol=1e-12)
    assert set(skeleton.tips) <= set(skeleton.model.frame_names)
    held = skeleton.holds(["left_hand"])
    assert "left_hand" not in held["ends"] and held["ends"]
    with pytest.raises(kinopt.UnknownNameError, match="no bone named `left_hnad`"):
        skeleton.bone("left_hnad")


def linear_blend(rig, q):
    """Σ_j w_j T_j v̂ in numpy, double precision."""
    transforms = rig.skeleton.skinning_transforms(q)
    rest = np.c_[rig.mesh.positions.astype(float), np.ones(len(rig.mesh.positions))]
    by_bone = np.einsum("bij,vj->bvi", transforms, rest)[..., :3]
    return np.einsum("vb,bvi->vi", rig.weights.to_table(), by_bone)


def test_skin_is_the_weighted_mean_of_bone_transforms(rig):
    q = poses(rig, 2)
    posing = rig.posing()
    for row in q:
        positions = posing.positions(row)
        assert positions.dtype == np.float32
        assert np.abs(positions - linear_blend(rig, row)).max() < 1e-5
        assert np.array_equal(rig.posed_mesh(row).positions, positions)
        assert np.array_equal(posing.mesh(row).triangles, rig.mesh.triangles)
    many = posing.positions(q)
    assert many.shape == (2, len(rig.mesh.positions), 3)
    assert np.array_equal(many[1], posing.positions(q[1]))


def test_rest_pose_keeps_the_mesh(rig):
    rest = np.zeros(rig.skeleton.angles)
    for method in ("lbs", "dqs"):
        posing = rig.posing(method)
        assert posing.method == method
        assert np.abs(posing.positions(rest) - rig.mesh.positions).max() < 1e-5
        if rig.mesh.normals is not None:
            lengths = np.linalg.norm(posing.normals(rest), axis=1)
            assert np.abs(lengths - 1).max() < 1e-5


def test_out_receives_result_without_a_copy(rig):
    q = poses(rig, 4)
    posing = rig.posing("dqs")
    buffer = np.full((4, len(rig.mesh.positions), 3), np.nan, np.float32)
    assert posing.positions(q, out=buffer) is buffer
    assert np.array_equal(buffer, posing.positions(q))
    assert posing.positions(q[2], out=buffer[0]).base is not None
    assert np.array_equal(buffer[0], buffer[2])
    for unfit in (buffer.astype(float), buffer[:, ::2], buffer[:3], [1, 2]):
        with pytest.raises(kinopt.InvalidValueError, match="out must be a writable float32 array"):
            posing.positions(q, out=unfit)
    buffer.flags.writeable = False
    with pytest.raises(kinopt.InvalidValueError, match="writable"):
        posing.positions(q, out=buffer)
    frames = np.empty((4, len(rig.skeleton.bones), 4, 4))
    assert rig.skeleton.pose(q, out=frames) is frames
    assert np.array_equal(frames[1], rig.skeleton.pose(q[1]))


def test_posing_is_shared_by_threads(rig):
    q = poses(rig, 8)
    posing = rig.posing()
    expected = posing.positions(q)
    results = [None] * 8
    def work(i):
        for _ in range(5):
            results[i] = posing.positions(q[i])
    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(result, one) for result, one in zip(results, expected))


def test_invalid_arguments_raise_named_errors(rig):
    posing = rig.posing()
    q = poses(rig, 1)[0]
    with pytest.raises(kinopt.InvalidValueError, match=r"q has shape \(3,\), expected"):
        posing.positions(q[:3])
    with pytest.raises(kinopt.InvalidValueError, match="not finite"):
        posing.positions(np.full_like(q, np.nan))
    with pytest.raises(kinopt.UnknownNameError, match="lbs"):
        rig.posing("ribs")
    with pytest.raises(kinopt.FileError):
        kinopt.Rig.read("no such rig.json")
    with pytest.raises(kinopt.InvalidFileError, match=r"bones"):
        kinopt.Rig.parse("{}")
    bones = kinopt.Rig(rig.skeleton)
    with pytest.raises(kinopt.InvalidValueError, match="no mesh"):
        bones.posing()
    with pytest.raises(kinopt.InvalidValueError, match="weights are of"):
        kinopt.Rig(rig.skeleton, rig.mesh, kinopt.skinning.SkinWeights([0], [0], [1.0], 1, 1))
    with pytest.raises(kinopt.InvalidValueError, match="out of range"):
        kinopt.TriangleMesh(np.zeros((2, 3)), [[0, 1, 2]])
    with pytest.raises(kinopt.InvalidValueError, match="no index"):
        kinopt.TriangleMesh(np.zeros((2, 3)), [[0, 1, -1]])
    with pytest.raises(kinopt.InvalidValueError, match="not finite"):
        kinopt.TriangleMesh(np.full((3, 3), np.inf), [[0, 1, 2]])
    with pytest.raises(kinopt.InvalidValueError, match="whole numbers"):
        kinopt.TriangleMesh(np.zeros((3, 3)), [[0, 1, 1.5]])


def test_copies_are_bitwise_equal(rig):
    q = poses(rig, 3)
    for twin in (pickle.loads(pickle.dumps(rig)), copy.deepcopy(rig)):
        assert np.array_equal(twin.skeleton.pose(q), rig.skeleton.pose(q))
        assert np.array_equal(twin.posing("dqs").positions(q), rig.posing("dqs").positions(q))
        assert twin.constrained == rig.constrained
        times = np.linspace(0, 1, 7)
        assert np.array_equal(twin.clip.sample(times), rig.clip.sample(times))
    posing = pickle.loads(pickle.dumps(rig.posing("dqs")))
    assert np.array_equal(posing.positions(q), rig.posing("dqs").positions(q))


def test_rig_is_equal_from_text_and_file(rig, tmp_path):
    folder = MODELS / "humanoid"
    text = (folder / "humanoid.json").read_text()
    files = {p.name: p.read_bytes() for p in folder.iterdir()}
    twin = kinopt.Rig.parse(text, "humanoid", files.__getitem__)
    q = poses(rig, 2)
    assert np.array_equal(twin.posing().positions(q), rig.posing().positions(q))
    del files["humanoid.dmat"]
    bare = kinopt.Rig.parse(text.encode(), open=files.__getitem__)
    assert bare.weights is None and len(bare.notes) == 1
    assert bare.posing().has_automatic_weights
    def broken(name):
        raise RuntimeError(f"no {name} today")
    with pytest.raises(RuntimeError, match="today"):
        kinopt.Rig.parse(text, open=broken)
    rig.write(tmp_path / "again.json")
    again = kinopt.Rig.read(tmp_path / "again.json")
    assert np.array_equal(again.mesh.positions, rig.mesh.positions)
    assert np.abs(again.posing().positions(q) - rig.posing().positions(q)).max() < 1e-6


def test_skeleton_is_built_bone_by_bone():
    builder = kinopt.Skeleton.builder("arm")
    limits = [[-1, 1], [0, 2.5], [-1, 1]]
    builder.add("upper", length=0.3, limits=limits)
    placement = np.eye(4)
    placement[0, 3] = 0.3
    builder.add("fore", "upper", length=0.3, model_from_rest=placement, limits=limits)
    skeleton = builder.build()
    twin = kinopt.Skeleton("arm", skeleton.bones)
    for built in (skeleton, twin, pickle.loads(pickle.dumps(skeleton))):
        assert built.tips == ["fore/tip"]
        assert list(built.parents) == [-1, 0]
        q = np.zeros(6)
        q[1] = np.pi / 2
        fore = built.pose(q)[1]
        assert np.allclose(fore[:3, 3], [0, 0.3, 0], atol=1e-15)
    shifted = np.eye(4)
    shifted[:3, 3] = [1, 2, 3]
    moved = skeleton.placed(shifted)
    assert np.allclose(moved.pose(np.zeros(6)), shifted @ skeleton.pose(np.zeros(6)))
    with pytest.raises(kinopt.UnknownNameError, match="no bone named `forearm`"):
        kinopt.Skeleton("arm", [kinopt.Bone("hand", "forearm")])
    with pytest.raises(kinopt.InvalidValueError, match="length"):
        kinopt.Skeleton("arm", [kinopt.Bone("hand", length=-1)])
    with pytest.raises(kinopt.InvalidValueError, match="rigid"):
        kinopt.Skeleton("arm", [kinopt.Bone("hand", model_from_rest=np.diag([2.0, 1, 1, 1]))])


def test_weights_are_a_table_or_coordinates(rig):
    table = rig.weights.to_table()
    assert np.abs(table.sum(axis=1) - 1).max() < 1e-5
    twin = kinopt.skinning.SkinWeights.from_table(table)
    assert np.array_equal(twin.to_table(), table)
    starts, bones = rig.weights.starts, rig.weights.bones
    assert starts[-1] == len(bones) == len(rig.weights.weights)
    vertex = 7
    row = list(zip(bones, rig.weights.weights))[starts[vertex] : starts[vertex + 1]]
    assert row == rig.weights.influences(vertex)
    pruned, lost = rig.weights.pruned(4)
    assert pruned.max_influences <= 4 and 0 <= lost["largest_lost"] < 0.2
    with pytest.raises(kinopt.InvalidValueError, match="sum to 0.5"):
        kinopt.skinning.SkinWeights([0], [0], [0.5], 1, 1)
    mended, repair = kinopt.skinning.SkinWeights.repaired([0], [0], [0.5], 1, 1)
    assert mended.to_table().item() == 1 and repair["worst"] == (0, 0.5)
    with pytest.raises(kinopt.InvalidValueError, match="may be"):
        kinopt.skinning.SkinWeights([0], [0], [1.0], 1, 1 << 60)


def test_clips_of_angles_pass_their_keys(rig):
    skeleton = rig.skeleton
    times = [0.0, 1.0, 3.0]
    angles = np.array([[0, 0, 0], [0.1, 0.5, -0.2], [0.3, 1.0, 0]])
    tracks = {"left_hand": (times, angles)}
    at = 3 * skeleton.bone_names.index("left_hand")
    controls = np.zeros((3, 3))
    for between in (None, "linear", "catmull-rom", controls, {"left_hand": "linear"}):
        clip = kinopt.animation.EulerClip(skeleton, tracks, between)
        q = clip.sample(times)
        assert q.shape == (3, skeleton.angles)
        assert np.array_equal(q[:, at : at + 3], angles)
        assert np.array_equal(clip.sample(1.0), q[1])
        assert clip.time_span == (0, 3) and clip.bones == ["left_hand"]
        twin = pickle.loads(pickle.dumps(clip))
        assert np.array_equal(twin.sample(0.77), clip.sample(0.77))
        assert np.array_equal(clip.sample(3.77, "loop"), clip.sample(3.77 - 3.0, "loop"))
    linear = kinopt.animation.EulerClip(skeleton, tracks, "linear")
    assert np.allclose(linear.sample(2.0)[at : at + 3], angles[1:].mean(axis=0))
    with pytest.raises(kinopt.UnknownNameError, match="playback"):
        linear.sample(1.0, "backwards")
    with pytest.raises(kinopt.InvalidValueError, match="not finite"):
        linear.sample(np.nan)
    with pytest.raises(kinopt.InvalidValueError, match="not after"):
        kinopt.animation.EulerClip(skeleton, {"left_hand": ([1, 0], np.zeros((2, 3)))})


def test_kinematics_accept_rigs_and_skeletons(rig):
    for thing in (rig, rig.skeleton, rig.model):
        kinematics = kinopt.ForwardKinematics(thing, ["left_hand"])
        assert kinematics is not None


def test_rig_balances_by_mesh_volume():
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    q = np.zeros(len(rig.model.joint_names))
    corners = rig.mesh.positions
    low, high = corners.min(axis=0), corners.max(axis=0)
    centre = rig.center_of_mass(q)
    # In the middle from side to side, because the rig is symmetric.
    assert abs(centre[1] - (low + high)[1] / 2) < 0.01 * (high - low).max()
    assert np.all(centre > low) and np.all(centre < high)
    aim = centre + [0.02, -0.03, 0.01]
    problem = kinopt.Problem(rig, [kinopt.tasks.CenterOfMass(aim, tolerance=1e-4)])
    solution = kinopt.Solver().solve(problem, q)
    assert solution.reached and np.allclose(rig.center_of_mass(solution.q), aim, atol=2e-4)
    bare = kinopt.Rig(rig.skeleton)
    with pytest.raises(kinopt.InvalidValueError, match="has no mesh"):
        bare.center_of_mass(q)


def test_ball_skeleton_has_masses_of_its_rig():
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    masses = rig.masses
    rest = rig.skeleton.model.neutral()
    kilograms = np.array([kg for kg, _ in masses.values()])
    assert kilograms.min() > 0 and 40 < kilograms.sum() < 110
    placed = [kinopt.frame_placement(rig, frame, rest) for frame in masses]
    positions = [at[:3, :3] @ position + at[:3, 3] for at, (_, position) in zip(placed, masses.values(), strict=True)]
    centre = kilograms @ np.array(positions) / kilograms.sum()
    assert np.allclose(centre, rig.center_of_mass(rest), atol=1e-12)
    figure = kinopt.BallSkeleton(rig.skeleton, root="free")
    aim = centre + [0.02, -0.03, 0.01]
    task = kinopt.tasks.CenterOfMass(aim, masses=masses, tolerance=1e-4)
    hold = [
        kinopt.tasks.Point(figure.tip(foot), kinopt.frame_placement(rig, rig.skeleton.tip(foot), rest)[:3, 3])
        for foot in ("left_foot", "right_foot")
    ]
    solution = kinopt.Solver().solve(kinopt.Problem(figure.model, [task, *hold]), figure.model.neutral())
    assert solution.reached
    placed = [kinopt.frame_placement(figure.model, frame, solution.q) for frame in masses]
    positions = [at[:3, :3] @ position + at[:3, 3] for at, (_, position) in zip(placed, masses.values(), strict=True)]
    assert np.allclose(kilograms @ np.array(positions) / kilograms.sum(), aim, atol=2e-4)
    with pytest.raises(kinopt.InvalidValueError, match="has no mesh"):
        _ = kinopt.Rig(rig.skeleton).masses
