"""Worlds: obstacles by name, from and to files, distances between them."""

from __future__ import annotations

import copy
import json
import pickle

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidFileError, InvalidValueError, UnknownNameError

TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def turned(angle: float, position: tuple[float, float, float]) -> np.ndarray:
    """Rotation about z, then translation."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[:3, 3] = position
    return pose


def everything() -> kinopt.World:
    world = kinopt.World()
    world.add_points("cloud", TETRAHEDRON, 0.01)
    world.add_box("table", (1, 0.6, 0.04), turned(0.3, (0.5, 0, 0.4)))
    world.add_sphere("ball", 0.1, (0.5, 0, 0.6))
    world.add_cylinder("can", 0.03, 0.14, turned(1, (2, 0, 0)))
    world.add_capsule("pole", 0.02, 1, (3, 0, 0))
    world.add_plane("floor")
    world.add_convex("wedge", TETRAHEDRON, (4, 0, 0))
    world.add_mesh("shell", np.array(TETRAHEDRON, np.float32), np.array(FACES[:3]), (5, 0, 0))
    world.add_height_field("ground", [[0.1, 0.2, 0.3], [0.4, 0.5, 0.7]], (0.5, 0.25), (6, 0, 0))
    world.attach("can", "hand", turned(2, (0, 0, 0.1)))
    return world


def test_repr_counts_obstacles() -> None:
    world = kinopt.World()
    assert repr(world) == "World(0 obstacles)"
    world.add_box("table", (1, 0.6, 0.04))
    assert repr(world) == "World(1 obstacle)"
    assert len(repr(everything())) < 40 and repr(len(everything())) in repr(everything())


def test_obstacles_match_the_added_shapes() -> None:
    world = everything()
    assert len(world) == 9 and "table" in world and "chair" not in world
    kinds = [world[name].kind for name in world.names]
    assert kinds == [
        "points", "box", "sphere", "cylinder", "capsule", "plane", "convex", "mesh", "height field",
    ]
    assert np.array_equal(world["table"].placement, turned(0.3, (0.5, 0, 0.4)))
    assert np.array_equal(world["table"].measures["size"], [1, 0.6, 0.04])
    assert world["can"].measures == {"radius": 0.03, "length": 0.14}
    assert world["can"].attached == "hand" and world["ball"].attached is None
    assert np.array_equal(world["cloud"].measures["positions"], TETRAHEDRON)
    shell = world["shell"].measures
    assert np.array_equal(shell["vertices"][shell["triangles"]], np.array(TETRAHEDRON)[FACES[:3]])
    assert np.array_equal(world["ground"].measures["heights"], [[0.1, 0.2, 0.3], [0.4, 0.5, 0.7]])
    assert "open at 3 edges" in world["shell"].notes[0]
    assert [note for note in world.notes if "shell" in note and "open at 3 edges" in note]


def test_world_is_pickled_copied_and_written(tmp_path) -> None:
    world = everything()
    world.write(tmp_path / "world.json")
    assert list(world) == world.names
    for unread in ("world.yaml", "world.txt", "world"):
        with pytest.raises(InvalidValueError, match="json"):
            world.write(tmp_path / unread)
    for again in (
        pickle.loads(pickle.dumps(world)),
        copy.deepcopy(world),
        kinopt.World.from_json(world.to_json()),
        kinopt.World.read(tmp_path / "world.json"),
    ):
        assert again.names == world.names
        assert again.to_json() == world.to_json()
        for name in world.names:
            assert np.array_equal(again[name].placement, world[name].placement)
    # A copy is independent.
    again.remove("ball")
    assert "ball" in world


def test_meshes_are_read_next_to_the_world_file(tmp_path) -> None:
    lines = [f"v {x} {y} {z}" for x, y, z in TETRAHEDRON]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in FACES]
    (tmp_path / "corner.obj").write_text("\n".join(lines))
    mesh = {"name": "corner", "file": "corner.obj", "scale": [2, 1, 1]}
    (tmp_path / "world.json").write_text(json.dumps({"meshes": [mesh]}))
    world = kinopt.World.read(tmp_path / "world.json")
    world.add_sphere("ball", 0.25, (2.5, 0, 0))
    assert world.separation("corner", "ball").distance == pytest.approx(0.25, abs=1e-15)
    (tmp_path / "corner.obj").unlink()
    with pytest.raises(InvalidFileError, match=r"meshes\[0\].*corner.obj"):
        kinopt.World.read(tmp_path / "world.json")


def test_distances_and_depths_match_geometry() -> None:
    world = kinopt.World()
    world.add_box("box", (2, 2, 2))
    world.add_sphere("ball", 0.5, (3, 0, 0))
    apart = world.separation("box", "ball")
    assert apart.distance == pytest.approx(1.5, abs=1e-15)
    assert np.allclose(apart.on_first, [1, 0, 0]) and np.allclose(apart.on_second, [2.5, 0, 0])
    assert np.allclose(apart.normal, [1, 0, 0])
    world.move("ball", (0.75, 0, 0))
    assert world.separation("ball", "box").distance == pytest.approx(-0.75, abs=1e-15)
    world.add_cylinder("pole", 0.25, 10, turned(0, (0, 4, 0)))
    assert world.separation("pole", "box").distance == pytest.approx(2.75, abs=1e-15)
    world.attach("pole", "hand")
    with pytest.raises(InvalidValueError, match="attached to \"hand\""):
        world.separation("pole", "box")
    world.detach("pole", (0, 0, 6.5))
    assert world.separation("pole", "box").distance == pytest.approx(0.5, abs=1e-15)


def test_only_edits_raise_the_revision() -> None:
    world = everything()
    before = world.revision
    world.separation("ball", "table")
    assert world.revision == before
    world.move("ball", (1, 1, 1))
    assert world.revision > before
    world.remove("ball")
    assert "ball" not in world


def test_invalid_arguments_are_named(tmp_path) -> None:
    world = everything()
    before = world.to_json()
    for fails, error, match in (
        (lambda: world.add_box("table", (1, 1, 1)), InvalidValueError, "table"),
        (lambda: world.add_box("b", (1, 0, 1)), InvalidValueError, "along y is 0"),
        (lambda: world.add_box("b", (1, 1)), InvalidValueError, "size"),
        (lambda: world.add_sphere("b", float("nan")), InvalidValueError, "radius"),
        (lambda: world.add_sphere("b", 1, (1, 2)), InvalidValueError, "pose"),
        (lambda: world.add_sphere("b", 1, -np.eye(4)), InvalidValueError, "last row"),
        (lambda: world.add_sphere("b", 1, (1, 2, 3, 1, 0, 0, 0, 0)), InvalidValueError, r"\(8,\).*\(4, 4\)"),
        (lambda: world.add_points("b", np.zeros((0, 3)), 1), InvalidValueError, "at least 1 point,"),
        (lambda: world.add_mesh("b", TETRAHEDRON, [[0, 1, 4]]), InvalidValueError, "vertex 4"),
        (lambda: world.add_points("b", [[0, 0, np.inf]], 1), InvalidValueError, "point 0"),
        (lambda: world.add_convex("b", TETRAHEDRON[:3]), InvalidValueError, "at least 4"),
        (lambda: world.add_height_field("b", [[1, 2]], (1, 1)), InvalidValueError, "rows"),
        (lambda: world.move("chair", (0, 0, 0)), UnknownNameError, "chair.*table"),
        (lambda: world.remove("chair"), UnknownNameError, "chair"),
        (lambda: world["chair"], UnknownNameError, "chair"),
        (lambda: world.separation("chair", "table"), UnknownNameError, "chair"),
        (lambda: kinopt.World.read(tmp_path / "none.json"), FileError, "none.json"),
        (lambda: kinopt.World.read(tmp_path / "world.txt"), (InvalidFileError, FileError), "world"),
        (lambda: kinopt.World.from_json("{"), InvalidFileError, "world.json"),
    ):
        with pytest.raises(error, match=match):
            fails()
    assert world.to_json() == before


def test_mesh_is_read_from_a_file(tmp_path) -> None:
    faces = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in np.multiply(TETRAHEDRON, 1000)) + faces
    file = tmp_path / "shard.obj"
    file.write_text(text)
    world = kinopt.World()
    world.add_mesh("arrays", TETRAHEDRON, FACES)
    world.add_mesh("file", file, pose=(3, 0, 0), scale=0.001)
    world.add_mesh("name", str(file), scale=(0.001, 0.001, 0.002))
    vertices = [world[name].measures["vertices"] for name in world.names]
    assert np.allclose(vertices[1], vertices[0], atol=1e-12)
    assert np.allclose(vertices[2], np.multiply(vertices[0], (1, 1, 2)), atol=1e-12)
    assert np.allclose(world["file"].placement[:3, 3], (3, 0, 0))
    for fails, error, match in (
        (lambda: world.add_mesh("b", tmp_path / "none.stl"), FileError, "none.stl"),
        (lambda: world.add_mesh("b", tmp_path / "b.step"), (FileError, InvalidFileError), "b.step"),
        (lambda: world.add_mesh("b", file, FACES), InvalidValueError, "must be omitted"),
        (lambda: world.add_mesh("b", TETRAHEDRON), InvalidValueError, "triangles are missing"),
        (lambda: world.add_mesh("b", file, scale=0), InvalidValueError, "b"),
        (lambda: world.add_mesh("b", file, scale=(1, 2)), InvalidValueError, "scale"),
        (lambda: world.add_mesh("b", file, scale=np.nan), InvalidValueError, "b"),
    ):
        with pytest.raises(error, match=match):
            fails()
    assert len(world) == 3


def test_million_triangles_are_one_obstacle() -> None:
    n = 708
    u, v = np.meshgrid(*2 * [np.arange(n) * (2 * np.pi / n)], indexing="ij")
    r = 1 + 0.3 * np.cos(v)
    positions = np.stack([r * np.cos(u), r * np.sin(u), 0.3 * np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a, b, c, d = (
        ((i + di) % n * n + (j + dj) % n).ravel() for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    world = kinopt.World()
    world.add_mesh("torus", positions, triangles)
    assert len(triangles) > 1_000_000 and not world["torus"].notes
    world.add_sphere("hole", 0.1)
    world.add_sphere("inside", 0.1, (1, 0, 0))
    assert world.separation("torus", "hole").distance == pytest.approx(0.6, abs=1e-4)
    assert world.separation("torus", "inside").distance == pytest.approx(-0.4, abs=1e-4)
