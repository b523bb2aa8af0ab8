"""Collision models: shapes of a robot, enabled collision pairs, and spheres that cover the shapes."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidFileError, InvalidValueError, UnknownNameError

MODELS = Path(__file__).parents[2] / "models"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


@pytest.fixture(scope="module")
def ur5e() -> kinopt.Robot:
    return kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")


def test_pairs_are_read_edited_and_sampled(ur5e: kinopt.Robot) -> None:
    model = ur5e.collision_model()
    assert model.links == ["base", "link1", "link2", "link3", "link4", "link5", "link6"]
    # All but neighbours: 7 · 6 / 2 - 6.
    assert len(model.pairs) == 15 and model.is_checked("base", "link6")
    assert ("link1", "link2") not in model.pairs
    sampled = model.with_pairs_sampled(500, seed=1)
    assert set(sampled.pairs) < set(model.pairs)
    assert sampled.pairs == model.with_pairs_sampled(500, seed=1).pairs
    edited = sampled.with_ignored("link6", "base").with_checked("link1", "link2")
    assert not edited.is_checked("base", "link6") and edited.is_checked("link2", "link1")
    assert sampled.is_checked("base", "link6")
    with pytest.raises(UnknownNameError, match="link6"):
        model.with_ignored("base", "link7")
    srdf = kinopt.Srdf.parse(sampled.to_srdf(), ur5e)
    assert ur5e.collision_model(srdf=srdf).pairs == sampled.pairs


def test_spheres_hold_points_of_shapes(ur5e: kinopt.Robot) -> None:
    model = ur5e.collision_model()
    spheres = model.spheres(0.03)
    assert len(spheres) == spheres.count == sum(len(link_spheres) for link_spheres in spheres.spheres.values())
    assert 0 < spheres.max_protrusion <= 0.03
    assert spheres.pairs == model.pairs
    # The base's cylinder of radius 0.075 from z = 0 to 0.09.
    random = np.random.default_rng(3)
    angle, share = random.uniform(0, 2 * np.pi, 2000), np.sqrt(random.uniform(0, 1, 2000))
    points = np.stack(
        [0.075 * share * np.cos(angle), 0.075 * share * np.sin(angle), random.uniform(0, 0.09, 2000)], axis=1
    )
    link_spheres, bound = spheres.spheres["base"], spheres.bounds["base"]
    away = np.linalg.norm(points[:, None] - link_spheres[None, :, :3], axis=2) - link_spheres[:, 3]
    assert away.min(axis=1).max() <= 1e-12
    assert (np.linalg.norm(link_spheres[:, :3] - bound[:3], axis=1) + link_spheres[:, 3] <= bound[3] + 1e-12).all()
    assert all(len(link_spheres) <= 5 for link_spheres in model.spheres(per_link=5).spheres.values())


def test_spheres_are_computed_once_per_model(ur5e: kinopt.Robot) -> None:
    model = ur5e.collision_model()
    assert not model._is_covered
    kinopt.Problem(ur5e, world=kinopt.World(), collision_model=model)
    # The spheres of a model are computed once; a model with other pairs computes its own.
    assert model._is_covered
    assert not model.with_ignored("base", "link6")._is_covered
    world = kinopt.World()
    world.add_box("table", (1, 1, 0.1), pose=(0.5, 0, 0.3))
    arms = [kinopt.Arm(ur5e, "base", "flange", world=each, collision_model=model) for each in (kinopt.World(), world)]
    q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    anew = kinopt.Arm(ur5e, "base", "flange", world=world, collision_model=ur5e.collision_model())
    assert str(arms[1].collisions(q)) == str(anew.collisions(q))


def test_spheres_round_trip_through_files(ur5e: kinopt.Robot, tmp_path: Path) -> None:
    model = ur5e.collision_model()
    spheres = model.spheres(per_link=4)
    (tmp_path / "ur5e.yml").write_text(spheres.to_yaml())
    urdf = spheres.spherised((MODELS / "universal_ur5e.urdf").read_text())
    (tmp_path / "ur5e.urdf").write_text(urdf)
    for name in ("ur5e.yml", "ur5e.urdf"):
        read = kinopt.SphereModel.read(tmp_path / name, model)
        assert read.pairs == spheres.pairs
        assert all(np.array_equal(read.spheres[link], link_spheres) for link, link_spheres in spheres.spheres.items())
        assert read.max_protrusion == pytest.approx(spheres.max_protrusion, abs=1e-12)
    link_spheres = kinopt.Robot.from_urdf(tmp_path / "ur5e.urdf").collision_model().spheres(0.1)
    assert link_spheres.max_protrusion == 0.0 and link_spheres.count == spheres.count
    with pytest.raises(FileError):
        kinopt.SphereModel.read(tmp_path / "none.yml", model)
    (tmp_path / "bad.yml").write_text("collision_spheres:\n  palm:\n    - {center: [0, 0, 0], radius: 1}\n")
    with pytest.raises(InvalidFileError, match="palm"):
        kinopt.SphereModel.read(tmp_path / "bad.yml", model)


def test_arm_uses_spheres_enlarged_by_their_gap(tmp_path: Path) -> None:
    panda = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    shapes = panda.collision_model().with_pairs_sampled(300)
    spheres = shapes.spheres(0.03)
    assert spheres.gap == 0.0
    lines = ["collision_spheres:"]
    for link, link_spheres in spheres.spheres.items():
        lines.append(f"  {link}:")
        lines += [f"    - {{center: [{x}, {y}, {z}], radius: {0.7 * radius}}}" for x, y, z, radius in link_spheres]
    (tmp_path / "small.yml").write_text("\n".join(lines))
    small = kinopt.SphereModel.read(tmp_path / "small.yml", shapes)
    assert 0.01 < small.gap < 0.1
    world = kinopt.World()
    world.add_box("post", (0.1, 0.1, 0.6), (0.45, 0.0, 0.3))
    random = np.random.default_rng(3)
    arms = [
        kinopt.Arm(panda, "base", "flange", world=world, collision_model=shapes.with_spheres(link_spheres))
        for link_spheres in (spheres, small)
    ]
    by_shapes = kinopt.Arm(panda, "base", "flange", world=world, collision_model=shapes)
    start = np.array([0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8])
    for q in random.uniform(arms[0].lower, arms[0].upper, (40, 7)):
        # Free means free of all contacts, and a configuration that passes the sphere check is free.
        is_free = not by_shapes.collisions(q)
        assert all(is_free or not arm.clear_by_spheres(q[None])[0] for arm in arms)
        solved = arms[1].solve(arms[1].base_from_tool(q), start)
        assert not solved.reached or not by_shapes.collisions(solved.q)
    # Spheres stay with the shapes when pairs change, and in pickles.
    changed = shapes.with_spheres(small).with_ignored("base", "hand")
    poses = random.uniform(arms[0].lower, arms[0].upper, (200, 7))
    clear = [
        kinopt.Arm(panda, "base", "flange", world=world, collision_model=link_spheres).clear_by_spheres(poses)
        for link_spheres in (changed, pickle.loads(pickle.dumps(changed)))
    ]
    assert (clear[0] == clear[1]).all() and 0 < clear[0].sum() < 200


def test_missing_meshes_raise(tmp_path: Path) -> None:
    mesh = '<collision><geometry><mesh filename="package://lamp/meshes/arm.obj"/></geometry></collision>'
    text = f'<robot name="lamp"><link name="arm">{mesh}</link></robot>'
    robot = kinopt.Robot.from_urdf_text(text)
    with pytest.raises(FileError, match=r"package://lamp/meshes/arm\.obj"):
        robot.collision_model()
    left_out = robot.collision_model(leave_out_missing=True)
    assert left_out.links == [] and "arm.obj" in left_out.notes[0]
    (tmp_path / "lamp" / "meshes").mkdir(parents=True)
    (tmp_path / "lamp" / "meshes" / "arm.obj").write_text(TETRAHEDRON)
    assert robot.collision_model(packages=[tmp_path]).links == ["arm"]
    (tmp_path / "lamp" / "robot.urdf").write_text(text)
    robot = kinopt.Robot.from_urdf(tmp_path / "lamp" / "robot.urdf")
    model = pickle.loads(pickle.dumps(robot)).collision_model(meshes="triangles")
    # Pickles do not need the mesh file.
    pickled = pickle.dumps(model)
    (tmp_path / "lamp" / "meshes" / "arm.obj").unlink()
    again = pickle.loads(pickled)
    assert np.array_equal(again.spheres(0.2).spheres["arm"], model.spheres(0.2).spheres["arm"])
    with pytest.raises(FileError):
        robot.collision_model()


def test_models_and_spheres_are_pickled(ur5e: kinopt.Robot) -> None:
    model = ur5e.collision_model().with_ignored("base", "link6")
    spheres = model.spheres(0.05)
    again, spheres_again = pickle.loads(pickle.dumps((model, spheres)))
    assert again.pairs == model.pairs and repr(again) == repr(model)
    assert spheres_again.spheres.keys() == spheres.spheres.keys()
    assert all(np.array_equal(spheres_again.spheres[k], link_spheres) for k, link_spheres in spheres.spheres.items())


def test_invalid_arguments_raise(ur5e: kinopt.Robot) -> None:
    model = ur5e.collision_model()
    for bad in (0.0, -1.0, float("nan")):
        with pytest.raises(InvalidValueError, match="max_protrusion"):
            model.spheres(bad)
    with pytest.raises(InvalidValueError, match="either"):
        model.spheres()
    with pytest.raises(InvalidValueError, match="hull"):
        ur5e.collision_model(meshes="boxes")


def test_skeletons_get_capsules_from_their_skin() -> None:
    rig = kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json")
    model = kinopt.CollisionModel.of_skin(rig)
    assert model.is_checked("left_hand", "spine") and not model.is_checked("left_hand", "left_forearm")
    assert model.pairs == pickle.loads(pickle.dumps(model)).pairs
    assert model.with_touching_ignored(np.zeros(model.model.configuration_len)).pairs == model.pairs
    with pytest.raises(InvalidValueError):
        model.with_touching_ignored([0.0])
