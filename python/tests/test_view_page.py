"""Pages without a browser: mouse actions are called directly, and their effects are verified."""

import io
import json
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest

import kinopt

pytest.importorskip("viser", reason="SKIPPED: the viewer's tests need viser (pip install 'kinopt[view]')")

from kinopt.view import Scene  # noqa: E402
from kinopt.view.__main__ import main  # noqa: E402
from kinopt.view.balance import BALANCED  # noqa: E402
from kinopt.view.opening import open_page  # noqa: E402
from kinopt.view.saving import saved  # noqa: E402
from waiting import wait_until  # noqa: E402

MODELS = Path(__file__).parents[2] / "models"
HUMANOID = MODELS / "humanoid" / "humanoid.json"
NAO = MODELS / "aldebaran_nao.urdf"
PANDA = MODELS / "franka_panda.urdf"


@pytest.fixture
def opened():
    pages = []

    def open_one(path, **options):
        pages.append(open_page(path, port=8220, **options))
        return pages[-1]

    yield open_one
    for page in pages:
        page.scene.close()


def drag(page, frame, displacement, moves=20):
    """Drags a frame's gizmo by `displacement`, and waits until all motion ends."""
    target = page.targets[frame]
    start = target.placement

    def move(placement, phase):
        page.call(lambda: target._hear(placement, phase, time.perf_counter()))

    move(start, "start")
    for k in range(1, moves + 1):
        placement = start.copy()
        placement[:3, 3] += np.asarray(displacement) * k / moves
        move(placement, "update")
    move(placement, "end")
    wait_until(lambda: not page.scene.loop._tickers)
    assert not page.scene.loop._tickers and page.scene.loop.failure is None
    return placement


def target_distance(page, frame):
    return np.linalg.norm(page.body.frame(frame)[:3, 3] - page.targets[frame].placement[:3, 3])


BODY = """<mujoco model="body"><worldbody><body name="torso" pos="0 0 1"><freejoint name="float"/><geom type="box" size="0.1 0.1 0.2" mass="9"/>
<body name="leg" pos="0 0 -0.2"><joint name="hip" axis="0 1 0"/><geom type="sphere" size="0.05" mass="2"/>
<body name="foot" pos="0 0 -0.7"><joint name="ankle" axis="0 1 0"/></body></body>
<body name="arm" pos="0 0.2 0.2"><joint name="shoulder" type="ball"/><geom type="sphere" size="0.05" mass="1"/>
<body name="hand" pos="0.5 0 0"><joint name="wrist"/></body></body>
</body></worldbody></mujoco>"""


def test_free_joint_of_file_is_the_base(opened, tmp_path):
    (tmp_path / "body.xml").write_text(BODY)
    page = opened(tmp_path / "body.xml", hold=["foot"])
    assert list(page.targets) == ["foot", "hand"]
    assert page.body.stands and page.body.can_hold and not page.turns
    foot = page.body.frame("foot")
    drag(page, "hand", [-0.2, 0.0, 0.1])
    assert target_distance(page, "hand") < 1e-4 and np.abs(page.body.frame("foot") - foot).max() < 1e-5
    same = opened(tmp_path / "body.xml", base_joint="free")
    assert same.body.model.free_joints == ["float"]


def test_fixed_links_share_one_gizmo(opened, tmp_path):
    links = ["palm", "foot", "thumb", "finger", "toe", "heel", "camera", "body"]
    ends = [("body", "palm"), ("body", "foot")]
    fixed = [("palm", "thumb"), ("palm", "finger"), ("foot", "toe"), ("foot", "heel"), ("body", "camera")]
    kinds = [("revolute", pair) for pair in ends] + [("fixed", pair) for pair in fixed]
    joints = [
        f"""<joint name="{child} joint" type="{kind}"><origin xyz="{k * 0.3 - 1} {k * 0.2} 0.2"/><parent link="{parent}"/>
        <child link="{child}"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>"""
        for k, (kind, (parent, child)) in enumerate(kinds)
    ]
    parts = [f'<link name="{link}"/>' for link in links] + joints
    (tmp_path / "body.urdf").write_text(f'<robot name="body">{"".join(parts)}</robot>')
    page = opened(tmp_path / "body.urdf", base_joint="free", hold=["foot"])
    assert list(page.targets) == ["foot", "thumb", "camera"]


def humanoid_urdf():
    """A robot with the link names of Unitree's G1, and fixed links at the ends of its limbs."""
    links = [("torso_link", "pelvis", "revolute", "0 0 0.3"), ("imu_link", "torso_link", "fixed", "0 0 -0.1")]
    links += [("camera_link", "torso_link", "fixed", "0 0 0.4")]
    for side, y in (("left", 0.1), ("right", -0.1)):
        limb = ["pelvis", "hip_pitch_link", "knee_link", "ankle_pitch_link", "ankle_roll_link"]
        arm = ["torso_link", "shoulder_roll_link", "elbow_link", "wrist_yaw_link"]
        for names, step in ((limb, "0.05 0 -0.3"), (arm, "0.05 0 -0.2")):
            for parent, link in zip(names, names[1:]):
                start = f"0 {y} 0" if parent in ("pelvis", "torso_link") else step
                # The axes of an ankle are close together.
                start = "0 0 -0.02" if link == "ankle_roll_link" else start
                owner = parent if parent in ("pelvis", "torso_link") else f"{side}_{parent}"
                links.append((f"{side}_{link}", owner, "revolute", start))
        links += [(f"{side}_ankle_roll_sphere_3_link", f"{side}_ankle_roll_link", "fixed", "0.1 0 0")]
        links += [(f"{side}_thumb_link", f"{side}_wrist_yaw_link", "fixed", "0.1 0 0")]
        links += [(f"{side}_rubber_hand_link", f"{side}_wrist_yaw_link", "fixed", "0.05 0 0")]
    mass = '<inertial><mass value="1"/></inertial>'
    parts = [f'<link name="{name}">{mass}</link>' for name in ["pelvis", *(link for link, *_ in links)]]
    for link, parent, kind, xyz in links:
        parts.append(
            f'''<joint name="{link} joint" type="{kind}"><origin xyz="{xyz}"/><parent link="{parent}"/><child link="{link}"/>
            <axis xyz="{"1 0 0" if "roll" in link else "0 1 0"}"/><limit lower="-2" upper="2"/></joint>'''
        )
    return f'<robot name="humanoid">{"".join(parts)}</robot>'


def test_humanoid_has_gizmos_on_its_parts(opened, tmp_path):
    (tmp_path / "body.urdf").write_text(humanoid_urdf())
    feet = ["left_ankle_roll_link", "right_ankle_roll_link"]
    others = ["left_rubber_hand_link", "right_rubber_hand_link", "pelvis", "camera_link"]
    page = opened(tmp_path / "body.urdf", base_joint="free")
    assert list(page.targets) == [*feet, *others] and page.pinned == set(feet)
    # A pelvis that is fixed in the world is not dragged.
    assert list(opened(tmp_path / "body.urdf").targets) == [*feet, *(name for name in others if name != "pelvis")]


def test_robot_on_free_base_is_dragged_as_a_whole(opened):
    page = opened(MODELS / "universal_ur5e.urdf", base_joint="free")
    before = page.body.q.copy()
    # Farther than the arm is long: the base follows.
    drag(page, "flange", [2.0, 0.0, 0.0], moves=60)
    assert target_distance(page, "flange") < 1e-4
    assert abs(np.linalg.norm(page.body.q[3:7]) - 1.0) < 1e-12
    assert np.linalg.norm(page.body.q[:3] - before[:3]) > 0.5
    sliders = [page.body.model.coordinate_names[index] for index in page.joints._sliders]
    assert "root_joint/x" in sliders and not any(name.endswith(" w") for name in sliders)
    with pytest.raises(kinopt.InvalidValueError, match="robots only"):
        open_page(HUMANOID, base_joint="free")


def test_robot_starts_crouched_over_its_feet(opened):
    page = opened(NAO, base_joint="free", hold=["left_sole", "right_sole"])
    assert page.pinned == {"left_sole", "right_sole"} and not page.turns
    assert set(opened(NAO, base_joint="free").targets) == set(page.targets) == page.pinned | {"left_hand", "right_hand", "torso", "head"}
    stood = {foot: page.body.frame(foot) for foot in page.pinned}
    knee = page.body.model.coordinate_names.index("left_knee_pitch")
    assert page.body.q[knee] > 0.2
    drag(page, "left_hand", [-0.05, 0.0, -0.25], moves=60)
    assert target_distance(page, "left_hand") < 1e-4
    assert page.body.q[knee] > 0.6
    for foot, placement in stood.items():
        np.testing.assert_allclose(page.body.frame(foot), placement, atol=1e-5)
    # The pulled pelvis crouches further; the drawn centre of mass stays over the feet.
    drag(page, "torso", [0.0, 0.0, -0.03])
    assert page.body.q[knee] > 0.8 and tuple(page.balance._ball.color) == BALANCED
    with pytest.raises(kinopt.UnknownNameError, match="left_sole"):
        open_page(NAO, base_joint="free", hold=["left_sol"], port=8229)


def test_feet_stay_with_an_unreachable_hand_target(opened):
    page = opened(NAO, base_joint="free", hold=["left_sole", "right_sole"])
    stood = {foot: page.body.frame(foot) for foot in page.pinned}
    drag(page, "left_hand", [0.8, 0.3, 0.2], moves=60)
    assert target_distance(page, "left_hand") > 0.2
    for foot, placement in stood.items():
        np.testing.assert_allclose(page.body.frame(foot), placement, atol=1e-5)
    assert "Level 2 gives way" in page.answer.solution.explain()


def test_every_solver_follows_the_drag(opened):
    page = opened(PANDA)
    assert list(page.targets) == ["tool"]
    for solver in page.posing.solvers():
        page.call(lambda solver=solver: page.posing.choose(solver=solver))
        page.call(lambda solver=solver: page.set_turns(solver != "fabrik"))
        for step in (0.05, -0.05):
            drag(page, "tool", [0.0, step, -step])
        if solver not in ("ccd", "projected-gradient"):
            assert page.answer.solution.reached, solver
        assert target_distance(page, "tool") < 1e-2
        assert page.status.text.startswith(("Reached", "Missed"))
    assert (page.body.q >= page.body.model.lower).all() and (page.body.q <= page.body.model.upper).all()


def test_solver_error_is_shown(opened, monkeypatch):
    page = opened(PANDA)

    def refuse(goals):
        raise kinopt.InvalidValueError("there is no answer for this")

    with monkeypatch.context() as patch:
        patch.setattr(page.posing, "solve", refuse)
        drag(page, "tool", [0.0, 0.0, 0.01])
        assert page.status.text == "No solution\nthere is no answer for this"
    drag(page, "tool", [0.0, 0.0, 0.01])
    assert page.status.text.startswith("Reached")


def test_robot_starts_in_a_movable_configuration(opened):
    page = opened(PANDA)
    for axis in np.concatenate([np.eye(3), -np.eye(3)]):
        drag(page, "tool", 0.1 * axis)
        assert page.answer.solution.reached
        drag(page, "tool", -0.1 * axis)


def test_several_tips_stay_pinned_while_another_is_dragged(opened):
    page = opened(HUMANOID)
    assert page.pinned == set(page.targets) and len(page.pinned) == 5
    hand = "left_hand/tip"
    positions = {frame: page.body.frame(frame)[:3, 3] for frame in page.pinned - {hand}}
    drag(page, hand, [0.1, 0.0, 0.4])
    assert page.answer.solution.reached and target_distance(page, hand) < 1e-5
    for frame, position in positions.items():
        assert np.linalg.norm(page.body.frame(frame)[:3, 3] - position) < 1e-5
    page.call(lambda: page.pin("head/tip", False))
    drag(page, hand, [0.0, 0.3, 0.0])
    assert np.linalg.norm(page.body.frame("head/tip")[:3, 3] - positions["head/tip"]) > 1e-4


def test_character_drag_has_no_jumps(opened):
    page = opened(HUMANOID)
    shown = []
    draw = page.body._place
    page.body._place = lambda q: (shown.append(np.array(q)), draw(q))[1]
    drag(page, "right_hand/tip", [1.5, 1.5, 1.5], moves=3)
    steps = np.abs(np.diff(np.array(shown), axis=0)).max(axis=1)
    assert len(shown) > 5 and steps.max() <= 0.15 + 1e-9
    assert not page.answer.solution.reached
    assert page.status.text.startswith("Missed") and "misses by" in page.status.text
    assert "right_hand/tip" in page.status.marks and page.status.marks["right_hand/tip"].text.endswith(" off")
    page.call(page.let_go)
    page.call(lambda: page._slow(np.inf))
    assert page.status.marks == {}


def test_other_tips_are_held_by_option(opened):
    moved = {}
    for holds in (True, False):
        page = opened(HUMANOID)
        page.call(page.let_go)
        page.call(lambda holds=holds: page.posing.choose(holds=holds, posture="none"))
        foot = page.body.frame("right_toes/tip")[:3, 3]
        drag(page, "left_hand/tip", [-0.5, 0.1, 0.5])
        moved[holds] = np.linalg.norm(page.body.frame("right_toes/tip")[:3, 3] - foot)
    assert moved[True] < 1e-5 < moved[False]


def test_slider_moves_one_joint_and_pins_adapt(opened):
    page = opened(PANDA)
    model = page.body.model
    page.call(lambda: page.pin("tool", True))
    held = page.body.frame("tool")
    page.call(lambda: page.set_joint("joint1", page.body.q[0] + 0.2))
    assert page.body.q[0] == pytest.approx(0.2)
    assert np.abs(page.body.frame("tool") - held).max() < 1e-4
    page.call(page.let_go)
    page.call(lambda: page.set_joint("finger_left_slide", 0.03))
    follower = next(iter(page.body.thing.mimics))
    assert page.body.q[model.joint_names.index(follower)] == pytest.approx(0.03)
    assert follower not in {model.joint_names[i] for i in page.joints._sliders}


def test_any_frame_gets_and_loses_a_gizmo(opened):
    page = opened(PANDA)
    page.call(lambda: page.add_target("link4"))
    page.call(lambda: page.set_turns(False))
    before = page.body.frame("link4")[:3, 3]
    drag(page, "link4", [0.0, 0.05, 0.0])
    assert np.linalg.norm(page.body.frame("link4")[:3, 3] - before) > 0.03 and target_distance(page, "link4") < 0.02
    page.call(lambda: page.remove_target("link4"))
    assert list(page.targets) == ["tool"] and page.dragged is None
    with pytest.raises(kinopt.UnknownNameError):
        page.call(lambda: page.add_target("nowhere"))


def test_keyframes_play_and_pause(opened):
    page = opened(HUMANOID)
    assert page.play_bar.clip.span == (0.0, 3.0)
    page.call(lambda: page.play_bar.show(1.0))
    # Pinned targets follow the clip, and hold their frames there during a drag.
    assert all(target_distance(page, frame) == 0.0 for frame in page.pinned)
    rig = page.body.thing
    expected = np.asarray(rig.clip.sample(1.0)).reshape(-1)
    assert np.abs(page.body.q - np.clip(expected, page.body.model.lower, page.body.model.upper)).max() < 1e-12
    # It starts again after its end; slow, for machines with other load.
    page.play_bar._speed.value = "0.1"
    page.call(page.play_bar.play)
    wait_until(lambda: page.play_bar.now != 1.0)
    page.call(page.play_bar.pause)
    assert 1.0 < page.play_bar.now < 3.0 and page.scene.loop.failure is None
    drag(page, "left_hand/tip", [0.0, 0.0, 0.05])
    assert page.answer.solution.reached


@pytest.mark.parametrize("path", [PANDA, HUMANOID])
def test_pose_is_saved(opened, path):
    import trimesh

    page = opened(path)
    body = page.body
    page.call(lambda: page.set_configuration(body.model.random_configuration(seed=4)))
    document = json.loads(saved(body, "json"))
    assert document["q"] == body.q.tolist()
    assert list(document["joints"]) == body.model.joint_names
    for name, frame in document["frames"].items():
        assert frame["position"] == body.frame(name)[:3, 3].tolist()
    vertices = np.concatenate([piece.solid.vertices for piece in body.pieces()])
    obj = saved(body, "obj").decode().splitlines()
    written = np.array([line.split()[1:] for line in obj if line.startswith("v ")], dtype=float)
    assert np.abs(written - vertices).max() < 1e-7
    faces = np.array([line.split()[1:] for line in obj if line.startswith("f ")], dtype=int)
    assert faces.min() == 1 and faces.max() == len(vertices)
    assert b"<html" in saved(body, "html")[:1000]
    glb = trimesh.load_scene(io.BytesIO(saved(body, "glb")), file_type="glb")
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    # In glTF y is up and -z to the left.
    assert np.allclose(glb.bounds, [[low[0], low[2], -high[1]], [high[0], high[2], -low[1]]], atol=1e-5)


def test_script_shows_a_robot_in_ten_lines():
    text = Scene.__doc__.split("```python")[1].split("```")[0]
    script = textwrap.dedent(text)
    assert len(script.strip().splitlines()) <= 12
    script = script.replace("models/franka_panda.urdf", str(PANDA)).replace("scene.wait()", "")
    names = {}
    exec(script, names)
    scene, body, target = names["scene"], names["body"], names["target"]
    placement = target.placement
    placement[:3, 3] += [-0.2, 0.1, -0.2]
    scene.loop.call(lambda: target._hear(placement, "end"))
    assert np.abs(body.frame("tool") - placement).max() < 1e-5
    assert scene.loop.failure is None
    scene.close()


def test_command_reports_errors(capsys, tmp_path):
    assert main([str(tmp_path / "no such.urdf")]) == 1
    assert "no such.urdf" in capsys.readouterr().err
    (tmp_path / "model.step").write_text("")
    assert main([str(tmp_path / "model.step")]) == 1
    assert ".urdf" in capsys.readouterr().err


def test_tool_dragged_into_a_table_slides(opened):
    world = kinopt.World.read(MODELS / "worlds" / "table.json")
    page = opened(PANDA, world=world, margin=0.002)
    stated = kinopt.Problem(page.body.thing, world=world)
    start = page.body.frame("tool")[:3, 3]
    requested = drag(page, "tool", [0.1, -0.2, -0.9], moves=40)
    assert stated.collisions(page.body.q) == []
    placed = page.body.frame("tool")[:3, 3]
    # It slides along the obstacle, which is named and red.
    assert np.linalg.norm(placed[:2] - start[:2]) > 0.05
    assert placed[2] > requested[2, 3] + 0.02
    assert "Missed" in page.status.text and page.obstacles._marked
    # A moved obstacle is drawn at its new position, and avoided.
    name = world.names[0]
    world.move(name, [5.0, 5.0, 5.0])
    page.call(page.pose)
    assert np.allclose(page.obstacles._handles[name].position, np.full(3, 5.0) * page.scene.drawn)


def test_every_kind_of_obstacle_is_drawn(opened):
    world = kinopt.World()
    world.add_box("box", (0.1, 0.2, 0.3), pose=(1, 0, 0))
    world.add_sphere("ball", 0.1, pose=(1, 1, 0))
    world.add_cylinder("can", 0.05, 0.2, pose=(1, 1, 1))
    world.add_capsule("pole", 0.05, 0.2, pose=(-1, 1, 1))
    world.add_plane("floor", pose=(0, 0, -0.5))
    corners = [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]]
    world.add_convex("ramp", corners, pose=(-1, -1, 0))
    world.add_mesh("shard", corners[:3], [[0, 1, 2]], pose=(-1, 1, 0))
    world.add_height_field("ground", [[0, 0, 0.1], [0, 0.1, 0.2]], (1, 1), pose=(0, 0, -1))
    world.add_points("cloud", [[2, 2, 2], [2, 2, 2.1]], 0.01)
    world.add_sphere("held", 0.02)
    world.attach("held", "tool", [0, 0, 0.1])
    page = opened(PANDA, world=world)
    handles = page.obstacles._handles
    assert sorted(handles) == sorted(world.names)
    position = page.body.frame("tool") @ np.array([0, 0, 0.1, 1.0])
    assert np.allclose(handles["held"].position, position[:3] * page.scene.drawn)
    world.remove("ball")
    page.call(page.obstacles.refresh)
    assert "ball" not in page.obstacles._handles


def test_world_without_robot_shapes_raises(tmp_path):
    (tmp_path / "nod.gltf").write_text('{"asset":{"version":"2.0"},"nodes":[{"name":"a"}],"scenes":[{"nodes":[0]}]}')
    with pytest.raises(kinopt.InvalidValueError, match="shapes"):
        open_page(tmp_path / "nod.gltf", port=8220, world=MODELS / "worlds" / "table.json")
    assert main([str(PANDA), "--no-browser", "--world", "nowhere.json"]) == 1
