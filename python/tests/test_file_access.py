"""Readers open no files outside their folder and the folders of the caller; malformed files raise `KinoptError`
only."""

import json
import os
import pickle
import random
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import FileError, InvalidFileError, InvalidValueError, KinoptError

MODELS = Path(__file__).parents[2] / "models"
SECRET = "SECRET7f3a91c05be2"
NUMBER = "48151.62"
OBJ = f"# {SECRET}\nv 0 0 0\nv {NUMBER} 0 0\nv 0 1 1\nf 1 2 3\n"
URDF = (
    "<robot name='r'><link name='a'><collision><geometry><mesh filename='FILE'/></geometry></collision></link></robot>"
)


def world(file: str) -> str:
    return json.dumps({"meshes": [{"name": "mesh", "file": file}]})


def scene(kind: str, uri: str) -> str:
    entry = {"uri": uri, "byteLength": 1} if kind == "buffers" else {"uri": uri}
    return json.dumps({"asset": {"version": "2.0"}, kind: [entry], "nodes": [{"name": "n"}]})


@pytest.fixture
def inside(tmp_path: Path) -> Path:
    outside, inside = tmp_path / "outside", tmp_path / "inside"
    outside.mkdir()
    (inside / "sub").mkdir(parents=True)
    (outside / "good.obj").write_text(OBJ)
    (outside / "bad.ply").write_text(SECRET + "\n")
    (outside / "good.png").write_bytes(b"\x89PNG\r\n\x1a\n\0" + SECRET.encode())
    for name in ("good.obj", "bad.ply", "good.png"):
        os.symlink(outside / name, inside / f"link_{name}")
    os.symlink("../outside", inside / "elsewhere")
    return inside


def references(inside: Path, name: str) -> list[str]:
    whole = str(inside.parent / "outside" / name)
    plain = [
        whole,
        f"../outside/{name}",
        f"sub/../../outside/{name}",
        f"link_{name}",
        f"elsewhere/{name}",
        f"file://{whole}",
        f"//{whole}",
        f"..\\outside\\{name}",
    ]
    draw = random.Random(5)
    encoded = ["".join(f"%{ord(c):02x}" if draw.random() < 0.4 else c for c in one) for one in plain]
    return plain + encoded + [one.replace("..", "%2e%2E") for one in plain]


def silent(error: BaseException) -> None:
    assert SECRET not in str(error) and NUMBER not in str(error), error


def test_references_outside_the_folder_raise(inside: Path, tmp_path: Path) -> None:
    for name in ("good.obj", "bad.ply", "good.png"):
        for file in references(inside, name):
            (inside / "world.json").write_text(world(file))
            with pytest.raises(KinoptError) as raised:
                kinopt.World.read(inside / "world.json")
            silent(raised.value)
            (inside / "scene.gltf").write_text(scene("buffers", file))
            with pytest.raises(KinoptError) as raised:
                kinopt.Scene.read(inside / "scene.gltf")
            silent(raised.value)
            (inside / "scene.gltf").write_text(scene("images", file))
            out = tmp_path / "copy.gltf"
            try:
                kinopt.SceneFile.read(inside / "scene.gltf").write(out)
                assert "base64" not in out.read_text()
            except KinoptError as error:
                silent(error)
            robot = kinopt.Robot.from_urdf_text(URDF.replace("FILE", file), str(inside / "robot.urdf"), confine=True)
            assert robot.confined and pickle.loads(pickle.dumps(robot)).confined
            with pytest.raises(KinoptError) as raised:
                robot.collision_model()
            silent(raised.value)


def test_listed_folders_are_opened(inside: Path) -> None:
    outside = inside.parent / "outside"
    (inside / "world.json").write_text(world("../outside/good.obj"))
    kinopt.World.read(inside / "world.json", folders=[outside])
    with pytest.raises(InvalidFileError, match="outside of the folders"):
        kinopt.World.read(inside / "world.json", folders=[inside / "sub"])
    (inside / "robot.urdf").write_text(URDF.replace("FILE", "../outside/good.obj"))
    kinopt.Robot.from_urdf(inside / "robot.urdf").collision_model(meshes="triangles")
    confined = kinopt.Robot.from_urdf(inside / "robot.urdf", confine=True)
    with pytest.raises(InvalidFileError, match="outside of the folders"):
        confined.collision_model(meshes="triangles")
    confined.collision_model(meshes="triangles", packages=[outside])


def test_callbacks_get_names_below_the_folder(inside: Path) -> None:
    opened: list[str] = []

    def give(name: str) -> bytes:
        opened.append(name)
        raise KeyError(name)

    for file in references(inside, "good.obj"):
        with pytest.raises(KinoptError):
            kinopt.Scene.from_bytes(scene("buffers", file), open=give)
    assert opened
    assert not any(name.startswith(("/", "\\")) or ".." in name for name in opened if "%" not in name)


def test_large_files_are_not_read(inside: Path) -> None:
    path = inside / "long.gltf"
    with path.open("wb") as file:
        file.truncate((1 << 30) + 1)
    for read in (kinopt.Scene.read, kinopt.SceneFile.read, kinopt.Rig.read):
        with pytest.raises(InvalidFileError, match="1073741824 bytes"):
            read(path)
    with pytest.raises(InvalidFileError, match=" 10 bytes"):
        kinopt.Rig.read(MODELS / "humanoid" / "humanoid.json", max_bytes=10)
    with pytest.raises(InvalidFileError, match="1073741824 bytes"):
        kinopt.Robot.from_urdf(path)


def test_document_type_raises(inside: Path) -> None:
    entities = "".join(f"<!ENTITY e{k} '{f'&e{k - 1};' * 10 if k else 'x' * 100}'>" for k in range(9))
    (inside / "bomb.dae").write_text(f"<!DOCTYPE x [{entities}]><COLLADA>&e8;</COLLADA>")
    with pytest.raises(InvalidFileError, match="DTD"):
        kinopt.World().add_mesh("mesh", inside / "bomb.dae")


def test_every_damaged_array_is_an_invalid_file(tmp_path: Path) -> None:
    path = tmp_path / "damaged.npy"
    np.save(path, np.zeros((4, 3, 3)))
    good = path.read_bytes()
    draw = random.Random(3)
    for _ in range(1500):
        bytes_ = bytearray(good)
        for _ in range(draw.randint(1, 4)):
            at = draw.randrange(128)
            bytes_[at] = draw.choice([draw.randrange(256), *b"(){}[],'9<>|OVUf"])
        path.write_bytes(bytes(bytes_[: draw.choice([len(bytes_), draw.randrange(len(bytes_))])]))
        try:
            kinopt.retargeting.read_capture(path, joints=["a", "b", "c"])
        except KinoptError:
            pass


def test_errors_about_a_map_name_its_file(tmp_path: Path) -> None:
    text = (MODELS / "aldebaran_nao.urdf").read_text().replace('velocity="0"', 'velocity="3"')
    nao = kinopt.Robot.from_urdf_text(text, "aldebaran_nao.urdf", base_joint="free")
    positions = np.zeros((5, 3, 3))
    positions[:, 0, 2], positions[:, 1, 1], positions[:, 2, 1] = 0.9, 0.15, -0.15
    drives = {"hips": "torso", "left": "left_sole", "right": "right_sole"}
    path = tmp_path / "map.json"

    def message(**change: object) -> str:
        path.write_text(json.dumps({"joints": ["hips", "left", "right"], "drives": drives, **change}))
        with pytest.raises(InvalidValueError) as raised:
            kinopt.retarget(positions, nao, path)
        return str(raised.value)

    assert str(path) in message(drives={"hips": "torso", "left": "left_soul"})
    assert str(path) in message(drives={"lift": "left_sole"})
    for wrong in ({"weight": 1e308}, {"scale": 1e308}, {"scale": 1e-308}, {"offset": [1e308, 0, 0]}):
        assert str(path) in message(drives={**drives, "left": {"frame": "left_sole", **wrong}})
    assert str(path) in message(drives={"hips": {"frame": 3}})


def test_sphere_models_of_huge_numbers_raise(tmp_path: Path) -> None:
    robot = kinopt.Robot.from_urdf(MODELS / "franka_panda.urdf")
    model = robot.collision_model()
    path = tmp_path / "spheres.yml"
    for centre, radius in (("1e308, 0, 0", "0.1"), ("0, 0, 0", "1e308"), ("-1e200, 0, 0", "1e200")):
        path.write_text(f"collision_spheres:\n  hand:\n    - center: [{centre}]\n      radius: {radius}\n")
        with pytest.raises(InvalidFileError, match="sphere 0"):
            kinopt.SphereModel.read(path, model)


def test_writers_follow_links_and_leave_no_files(tmp_path: Path) -> None:
    rig = kinopt.Rig.read(MODELS / "robot-arm" / "robot-arm.json")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "rig.json").write_text("{}")
    os.symlink("own/rig.json", tmp_path / "rig.json")
    rig.write(tmp_path / "rig.json")
    assert (tmp_path / "rig.json").is_symlink() and (tmp_path / "own" / "rig.json").stat().st_size > 2
    os.symlink("own/map.json", tmp_path / "map.json")
    kinopt.retargeting.MapGuess({}, None, None, []).save(tmp_path / "map.json")
    assert (tmp_path / "own" / "map.json").read_text() == "{}\n" and (tmp_path / "map.json").is_symlink()
    assert not [name for name in os.listdir(tmp_path) if name.startswith(".")]
    with pytest.raises(FileError):
        kinopt.retargeting.MapGuess({}, None, None, []).save(tmp_path / "none" / "map.json")


def test_viewer_opens_no_mesh_outside_the_folder(inside: Path) -> None:
    pytest.importorskip("trimesh", reason="SKIPPED: trimesh is not installed; the viewer's meshes are not read")
    from kinopt.view.mesh_files import MeshFiles

    (inside / "own.obj").write_text("mtllib ../outside/bad.ply\nusemtl x\n" + OBJ)
    for file in references(inside, "good.obj"):
        files = MeshFiles(inside, confine=True)
        assert files.read(file) is None and SECRET not in str(files.missing)
    assert MeshFiles(inside).read("../outside/good.obj") is not None
    files = MeshFiles(inside, confine=True)
    assert files.read("own.obj") is not None and not files.missing
    files = MeshFiles(inside)
    assert files.read("../outside/bad.ply") is None and SECRET not in str(files.missing)
