"""Viewer scenes: drawn poses equal those of the library, and only changes are sent."""

from pathlib import Path

import numpy as np
import pytest

import kinopt

viser = pytest.importorskip(
    "viser", reason="SKIPPED: the viewer's tests need viser (pip install 'kinopt[view]')"
)

from kinopt.view import Scene, solids  # noqa: E402
from kinopt.view.posing import Posing  # noqa: E402
from kinopt.view.balance import BALANCED, UNBALANCED  # noqa: E402
from kinopt.view.transforms import between, hull_2d, matrix_of, wxyz_of  # noqa: E402

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture
def scene():
    with Scene(port=8200) as scene:
        yield scene


def panda():
    return kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")


def random_rotations(count, seed=0):
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(count, 3, 3)))
    q *= np.sign(np.diagonal(r, axis1=1, axis2=2))[:, None]
    q[np.linalg.det(q) < 0.0, :, 0] *= -1.0
    return q


def half_turns():
    axes = np.random.default_rng(1).normal(size=(50, 3))
    axes = np.concatenate([axes, np.eye(3), [[1, -1, 0], [0, 1, -1], [-1, 0, 1]]])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return 2.0 * axes[:, :, None] * axes[:, None, :] - np.eye(3)


@pytest.mark.parametrize("rotations", [random_rotations(500), half_turns(), np.eye(3)[None]])
def test_quaternions_match_rotations_near_pi(rotations):
    wxyz = wxyz_of(rotations)
    assert np.allclose(np.linalg.norm(wxyz, axis=1), 1.0, atol=1e-15)
    back = np.stack([matrix_of(one, np.zeros(3))[:3, :3] for one in wxyz])
    assert np.abs(back - rotations).max() < 1e-14


def test_interpolation_is_straight_and_uniform():
    first, second = np.eye(4), np.eye(4)
    second[:3, :3] = random_rotations(1, 5)[0]
    second[:3, 3] = [1.0, 2.0, 3.0]
    middle = between(first, second, 0.5)
    assert np.allclose(middle[:3, 3], [0.5, 1.0, 1.5])
    assert np.allclose(middle[:3, :3] @ middle[:3, :3], second[:3, :3], atol=1e-12)
    assert np.array_equal(between(first, second, 1.0), second)


def volume(solid):
    a, b, c = (solid.vertices[solid.triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0


def area(solid):
    a, b, c = (solid.vertices[solid.triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0


def test_simple_bodies_enclose_their_volumes():
    ball = 4.0 / 3.0 * np.pi * 0.2**3
    assert volume(solids.sphere(0.2)) == pytest.approx(ball, rel=0.02)
    assert volume(solids.capsule(0.7, 0.2)) == pytest.approx(ball + 0.7 * np.pi * 0.2**2, rel=0.01)
    assert volume(solids.cylinder(0.7, 0.2)) == pytest.approx(0.7 * np.pi * 0.2**2, rel=0.01)
    assert volume(solids.box([0.1, 0.2, 0.3])) == pytest.approx(0.006)
    assert volume(solids.box([0.1, 0.2, 0.3]).scaled([-2.0, 1.0, 1.0])) == pytest.approx(0.012)
    # Two half spheres, a frustum between their tangent circles, and the parts of the spheres up to those.
    low, high, length = 0.2, 0.1, 0.5
    slope = (low - high) / length
    rings = [radius * np.sqrt(1.0 - slope**2) for radius in (low, high)]
    frustum = np.pi / 3.0 * length * (1.0 - slope**2) * (rings[0] ** 2 + rings[0] * rings[1] + rings[1] ** 2)
    caps = np.pi / 3.0 * (low**3 * (1.0 + slope) ** 2 * (2.0 - slope) + high**3 * (1.0 - slope) ** 2 * (2.0 + slope))
    assert volume(solids.capsule(length, low, high)) == pytest.approx(frustum + caps, rel=0.01)
    centres = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, length]])
    assert volume(solids.hull(centres, np.array([low, high]))) == pytest.approx(frustum + caps, rel=0.05)
    moved = solids.capsule_between(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.5]), 0.1)
    middle = (moved.vertices.min(axis=0) + moved.vertices.max(axis=0)) / 2
    assert np.allclose(middle, [1.0, 0.25, 0.25])


def test_creases_split_sharp_edges_and_leave_smooth_ones():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    box = solids.box([1.0, 1.0, 1.0]).moved(matrix_of(np.array([1.0, 0, 0, 0]), np.full(3, 0.5)))
    shared = np.array([[np.abs(corners - vertex).sum(axis=1).argmin() for vertex in box.vertices]]).reshape(
        -1
    )
    welded = solids.Solid(corners, shared[box.triangles].astype(np.uint32))
    split = solids.creased(welded)
    assert len(split.vertices) == 24
    assert volume(split) == pytest.approx(1.0)
    ball = solids.sphere(1.0)
    smooth = solids.creased(ball)
    assert len(smooth.vertices) <= len(ball.vertices)
    assert area(smooth) == pytest.approx(area(ball))


def sent(scene, kind):
    """Transforms in the queue for the page, by the name of the node."""
    messages = scene.server._websock_server._broadcast_buffer.message_from_id.values()
    return {m.name: m for m in messages if type(m).__name__ == kind}


@pytest.mark.parametrize("style", ["auto", "file", "capsules"])
def test_robot_is_placed_by_kinematics(scene, style):
    robot = panda()
    at = np.eye(4)
    at[:3, 3] = [0.5, -1.0, 0.2]
    body = scene.add(robot, at=at, style=style)
    q = robot.random_configuration(seed=3)
    body.q = q
    assert np.array_equal(body.q, q)
    assert np.allclose(body.frame("tool"), at @ kinopt.frame_placement(robot, "tool", q))
    joint5 = body.frame("joint/joint5")
    assert np.allclose(joint5, at @ kinopt.frame_placement(robot, "link5", q))
    low, high = body.box()
    assert (low < body.frame("hand")[:3, 3]).all() and (body.frame("hand")[:3, 3] < high).all()
    positions = [m.position for m in sent(scene, "SetPositionMessage").values()]
    origin = at @ kinopt.frame_placement(robot, "link6", q)
    assert np.abs(np.array(positions) - origin[:3, 3]).sum(axis=1).min() < 1e-9


def rig():
    return kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")


def test_character_and_mesh_are_placed_by_kinematics(scene):
    character = rig()
    at = np.eye(4)
    at[:3, 3] = [0.5, -1.0, 0.2]
    body = scene.add(character, at=at)
    q = character.model.random_configuration(seed=5)
    body.q = q
    for frame in ("head/tip", "left_hand", "right_toes/tip"):
        assert np.allclose(body.frame(frame), at @ kinopt.frame_placement(character, frame, q), atol=1e-12)
    (piece,) = body.pieces()
    posed = np.asarray(character.posed_mesh(q).positions)
    assert np.abs(piece.solid.vertices - posed - at[:3, 3]).max() < 2e-6


def test_page_blends_as_library_except_cut_weights(scene):
    character = rig()
    body = scene.add(character)
    assert 0.0 < body.cut < 0.2
    whole = character.weights.to_table()
    from kinopt.view.skin import fewer_influences

    strongest, cut = fewer_influences(whole)
    assert cut == body.cut
    assert np.count_nonzero(strongest, axis=1).max() == 4
    assert np.abs(strongest.sum(axis=1) - 1.0).max() < 1e-6
    few = np.count_nonzero(whole, axis=1) <= 3
    assert np.abs(strongest - whole)[few].max() < 1e-9


def test_bones_without_a_mesh_have_bodies(scene):
    skeleton = rig().skeleton
    body = scene.add(skeleton)
    body.q = skeleton.model.random_configuration(seed=2)
    low, high = body.box()
    tips = np.array([body.frame(tip)[:3, 3] for tip in skeleton.tips])
    assert (tips > low - 1e-9).all() and (tips < high + 1e-9).all()


def test_page_is_announced_and_opened(opened_addresses, capsys):
    with Scene(port=8200, open=False):
        pass
    assert opened_addresses == [] and capsys.readouterr().out == ""
    with Scene(port=8200) as scene:
        assert opened_addresses == [scene.url] and scene.url in capsys.readouterr().out


def test_convex_hull_contains_its_points_only():
    grid = np.array([[x, y] for x in range(4) for y in range(3)], dtype=float)
    corners, inside = hull_2d(grid, np.array([1.5, 1.9]))
    assert inside and grid[corners].tolist() == [[0, 0], [3, 0], [3, 2], [0, 2]]
    assert not hull_2d(grid, np.array([1.5, 2.1]))[1]
    assert not hull_2d(grid[:2], grid[0])[1] and hull_2d(grid[:0], grid[0]) == ([], False)


def test_support_polygon_is_green_in_balance(scene):
    nao = kinopt.Robot.from_urdf(MODELS / "aldebaran_nao.urdf", base_joint="free")
    body = scene.add(nao)
    shown = scene.add_balance(body)
    soles = [(body.frame(foot) @ [*corner, 1.0])[:2] for foot in ("left_sole", "right_sole") for corner in nao.sole(foot)]
    outline = shown._lines.points[:-1, 0, :2] / scene.drawn
    assert np.allclose([outline.min(axis=0), outline.max(axis=0)], [np.min(soles, axis=0), np.max(soles, axis=0)], atol=1e-6)
    assert np.allclose(shown._ball.position / scene.drawn, nao.center_of_mass(body.q), atol=1e-6)
    assert tuple(shown._ball.color) == BALANCED
    # Leans forward by 30 degrees: the centre of mass, 0.3 m above the feet, is in front of the toes.
    q = body.q
    q[3:7] = [np.cos(np.pi / 12), 0.0, np.sin(np.pi / 12), 0.0]
    body.q = q
    assert tuple(shown._ball.color) == UNBALANCED
    shown.remove()
    with pytest.raises(kinopt.InvalidValueError, match="feet"):
        scene.add_balance(scene.add(panda()))
    with pytest.raises(kinopt.UnknownNameError, match="nowhere"):
        scene.add_balance(body, ["nowhere"])


def test_only_moved_parts_are_sent(scene):
    body = scene.add(panda())
    q = body.q
    body.q = q
    before = scene.server._websock_server._broadcast_buffer.message_counter
    body.q = q
    assert scene.server._websock_server._broadcast_buffer.message_counter == before
    q[6] += 0.3
    body.q = q
    # The seventh joint carries the hand only.
    moved = scene.server._websock_server._broadcast_buffer.message_counter - before
    assert 0 < moved < len(sent(scene, "SetPositionMessage"))


def test_invalid_arguments_raise(scene):
    body = scene.add(panda())
    with pytest.raises(kinopt.InvalidValueError):
        body.q = [0.0, 1.0]
    with pytest.raises(kinopt.InvalidValueError):
        body.q = np.full(9, np.nan)
    with pytest.raises(kinopt.UnknownNameError, match="nowhere"):
        body.frame("nowhere")
    with pytest.raises(ValueError, match="placement has shape"):
        scene.target("goal", np.eye(3))


URDF = """<robot name="one"><link name="a"><visual><geometry><mesh filename="{file}" scale="2 2 2"/></geometry>
</visual></link><link name="b"/><joint name="j" type="revolute"><origin xyz="0 0 1"/><parent link="a"/>
<child link="b"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


@pytest.mark.parametrize(
    "file", ["package://parts/meshes/cube.stl", "meshes/cube.stl", "../parts/meshes/cube.stl"]
)
def test_available_meshes_are_drawn(scene, tmp_path, file):
    import trimesh

    folder = tmp_path / "parts" / "meshes"
    folder.mkdir(parents=True)
    trimesh.creation.box((1.0, 1.0, 1.0)).export(folder / "cube.stl")
    robot = kinopt.Robot.from_urdf_text(URDF.format(file=file))
    body = scene.add(robot, beside=tmp_path / "parts")
    assert body.missing == []
    assert sum(volume(piece.solid) for piece in body.pieces()) == pytest.approx(8.0)


def test_missing_meshes_are_replaced_by_collision_shapes(scene, tmp_path):
    box = '<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link><link name="b"/>'
    text = URDF.format(file="package://parts/meshes/cube.stl").replace('</link><link name="b"/>', box)
    (piece,) = scene.add(kinopt.Robot.from_urdf_text(text), beside=tmp_path).pieces()
    assert piece.name == "a" and volume(piece.solid) == pytest.approx(0.006)


def test_robot_without_meshes_is_a_closed_body(scene):
    nao = kinopt.Robot.from_urdf(MODELS / "aldebaran_nao.urdf")
    shapes = scene.add(nao)
    assert {piece.name for piece in shapes.pieces()} == set(nao.collision_model().links)
    # The trunk is one body about neck, shoulders and hips.
    trunk = next(piece.solid for piece in scene.add(nao, style="capsules").pieces() if piece.name == "world")
    joints = kinopt.ForwardKinematics(nao).place(nao.neutral())[:, :3, 3]
    shoulders = [joints[nao.frame_names.index(name), 2] for name in ("left_shoulder", "left_thigh") if name in nao.frame_names]
    low, high = trunk.vertices.min(axis=0), trunk.vertices.max(axis=0)
    assert all(low[2] < height < high[2] for height in shoulders)
    assert volume(trunk) > 0.3 * np.prod(high - low)


def test_missing_meshes_are_replaced_by_capsules(scene, tmp_path):
    (tmp_path / "broken.stl").write_text("no mesh at all")
    for file in ("package://parts/meshes/cube.stl", "broken.stl"):
        body = scene.add(kinopt.Robot.from_urdf_text(URDF.format(file=file)), beside=tmp_path)
        assert len(body.missing) == 1 and file.split("/")[-1] in body.missing[0]
        assert body.pieces()


def test_large_and_small_models_are_scaled():
    for factor in (1e-3, 1.0, 100.0):
        builder = kinopt.ModelBuilder("chain", "units")
        placement = np.eye(4)
        placement[2, 3] = factor
        builder.joint("one", axis=[1.0, 0.0, 0.0])
        builder.joint("two", parent="one", parent_from_joint=placement, axis=[1.0, 0.0, 0.0])
        builder.frame("tip", "two", placement)
        with Scene(port=8210) as scene:
            body = scene.add(builder.build())
            assert 0.4 <= scene.drawn * 2.0 * factor <= 4.0
            body.q = [0.0, np.pi / 2]
            assert np.allclose(body.frame("tip")[:3, 3], [0.0, -factor, factor])


def test_target_interpolates_between_positions(scene):
    body = scene.add(panda())
    target = scene.target("goal", body.frame("tool"))
    placements = []
    target.on_move(placements.append)
    end = body.frame("tool")
    end[:3, 3] += [0.3, 0.0, 0.0]
    scene.loop.call(lambda: target._hear(end, "start"))
    assert target.held and placements == []
    scene.loop.call(lambda: target._hear(end, "update"))
    while not placements or not np.array_equal(placements[-1], end):
        scene.loop.call(lambda: None)
    positions = np.array([placement[0, 3] for placement in placements])
    assert len(positions) >= 3 and (np.diff(positions) >= 0.0).all()
    scene.loop.call(lambda: target._hear(end, "end"))
    assert not target.held
    assert np.array_equal(target.placement, end)


def test_script_error_is_shown_and_page_continues(scene, capsys):
    body = scene.add(panda())
    target = scene.target("goal", body.frame("tool"))
    target.on_move(lambda placement: 1 / 0)
    scene.loop.post(lambda: target._hear(np.eye(4), "end"))
    assert scene.loop.call(lambda: 7) == 7
    assert "ZeroDivisionError" in scene.loop.failure
    assert "ZeroDivisionError" in capsys.readouterr().err


def test_equal_name_replaces_and_removal_deletes(scene):
    first = scene.add(panda(), "robot")
    second = scene.add(panda(), "robot", color=(200, 100, 50))
    assert repr(scene).count("robot") == 1 and first is not second
    second.remove()
    assert "empty" in repr(scene)


def test_frames_points_and_paths_are_drawn(scene):
    scene.frame("axes", np.eye(4))
    scene.points("cloud", np.zeros((5, 3)), np.tile([255, 0, 0], (5, 1)))
    scene.path("way", np.tile(np.eye(4), (4, 1, 1)))
    scene.label("note", "here", [0.0, 0.0, 1.0])
    assert "iframe" in scene._repr_html_() and scene.url in scene._repr_html_()
    assert len(scene.snapshot()) > 10_000


def test_invalid_position_or_colour_is_named(scene):
    for wrong in (np.zeros((3, 2)), np.zeros(3), np.full((2, 3), np.nan), "abc", [[1, 2, "x"]], np.zeros((2, 3, 4))):
        for draw in (scene.points, scene.path):
            with pytest.raises(kinopt.InvalidValueError, match="positions"):
                draw("wrong", wrong)
    with pytest.raises(kinopt.InvalidValueError, match=r"colors has shape \(2, 2\)"):
        scene.points("wrong", np.zeros((2, 3)), np.zeros((2, 2)))
    for wrong in (np.zeros(2), "abc", np.full(3, np.nan)):
        with pytest.raises(kinopt.InvalidValueError, match="position"):
            scene.label("wrong", "text", wrong)


def test_scene_repr_and_embedding_without_ipython(scene):
    body = scene.add(panda(), "arm")
    target = scene.target("goal", [0.1, 0.2, 0.3])
    assert repr(body) == "RobotBody('arm', 9 joints)"
    assert repr(target) == "Target('goal' at 0.1, 0.2, 0.3)"
    assert "arm" in repr(scene) and scene.bodies == [body]
    shown = scene.show(height=300)._repr_html_()
    assert scene.url in shown and 'height="300"' in shown and scene.url in scene._repr_html_()


def test_sliders_keep_loops_of_robot_closed(scene):
    robot = kinopt.Robot.from_mjcf(Path(__file__).parents[2] / "tests" / "solver" / "loops" / "files" / "knee.xml")
    body = scene.add(robot)
    gaps = kinopt.LoopClosure(robot).gaps
    names = robot.coordinate_names

    def is_closed(q):
        return max(gap for _, gap, _ in gaps(q)) <= 1e-9

    assert is_closed(body.q)
    posing = Posing(body)
    for joint, value, follows in [("knee_motor", 0.5, "knee"), ("knee", 0.4, "knee_motor")]:
        solution = posing.with_joint(joint, value, [])
        assert solution.q[names.index(joint)] == value
        assert is_closed(solution.q) and abs(solution.q[names.index(follows)]) > 0.2
    # Not farther than the rod allows.
    np.testing.assert_array_equal(posing.with_joint("knee_motor", 1.6, []).q, body.q)
