"""Folders of motion captures: complete files or none, done once, by threads or by Ray's workers."""

from __future__ import annotations

import importlib.util
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidValueError
from kinopt.retargeting import retarget_folder
from test_retargeting import BVH, JOINTS, MAP, NAO, sway


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    source = tmp_path / "from"
    (source / "deeper").mkdir(parents=True)
    for name, frames in (("one.npy", 10), ("two.npy", 12), ("deeper/three.npy", 8)):
        np.save(source / name, sway(frames))
    (source / "notes.txt").write_text("not read")
    return source


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_folder_resumes(folder: Path, tmp_path: Path) -> None:
    into = tmp_path / "into"
    lost = sway(5)
    lost[2, 1] = np.nan
    np.save(folder / "lost.npy", lost)
    seen: list[tuple[int, int]] = []
    reports = retarget_folder(folder, NAO, into, MAP, progress=lambda done, total: seen.append((done, total)))
    assert [Path(report.source).name for report in reports] == ["three.npy", "lost.npy", "one.npy", "two.npy"]
    assert seen[-1] == (4, 4)
    failed = reports[1]
    assert failed.error is not None and "lost.npy" in failed.error and "frame 2" in failed.error
    assert not Path(failed.out).exists()
    first = files(into)
    assert set(first) == {"one.npz", "two.npz", "deeper/three.npz", "retarget.json"}
    with np.load(into / "one.npz") as read:
        assert np.array_equal(read["q"], kinopt.retarget(sway(10), NAO, MAP).q)
    # The state of an interrupted job: one file is missing, and a part of it exists under another name.
    (into / "two.npz").rename(into / ".part.two.npz")
    np.save(folder / "lost.npy", sway(5))
    again = retarget_folder(folder, NAO, into, MAP)
    assert [report.done_before for report in again] == [True, False, True, False]
    second = files(into)
    assert set(second) == {*first, "lost.npz"} and second["one.npz"] == first["one.npz"]
    assert not any(report.done_before for report in retarget_folder(folder, NAO, into, MAP, overwrite=True))
    with pytest.raises(InvalidValueError, match="results of other settings"):
        retarget_folder(folder, NAO, into, MAP, whole=True)


def test_options_apply_to_every_movement(folder: Path, tmp_path: Path) -> None:
    into = tmp_path / "into"
    options: dict[str, Any] = {"contact_speed": 0.3, "contact_height": 0.2, "acceleration": 1e-3, "keep_clear": 0.001, "world": kinopt.World()}
    reports = retarget_folder(folder / "deeper", NAO, into, MAP, **options)
    assert [report.error for report in reports] == [None]
    with np.load(into / "three.npz") as read:
        assert np.array_equal(read["q"], kinopt.retarget(sway(8), NAO, MAP, **options).q)
    with pytest.raises(InvalidValueError, match="results of other settings"):
        retarget_folder(folder / "deeper", NAO, into, MAP)
    options["world"].add_sphere("ball", 0.1, (3, 0, 0))
    with pytest.raises(InvalidValueError, match=r"results of other settings.*\(world\)"):
        retarget_folder(folder / "deeper", NAO, into, MAP, **options)


def test_changed_map_is_another_job(folder: Path, tmp_path: Path) -> None:
    into, file = tmp_path / "into", tmp_path / "map.json"
    file.write_text(json.dumps(MAP))
    retarget_folder(folder / "deeper", NAO, into, file)
    # An equal job, in another notation.
    assert all(report.done_before for report in retarget_folder(folder / "deeper", NAO, into, dict(MAP)))
    file.write_text(json.dumps({**MAP, "drives": {"left": "left_sole", "right": "right_sole"}}))
    with pytest.raises(InvalidValueError, match=r"results of other settings.*\(map\)"):
        retarget_folder(folder / "deeper", NAO, into, file)


def test_interrupt_starts_no_more_movements(tmp_path: Path) -> None:
    source, into = tmp_path / "many", tmp_path / "into"
    source.mkdir()
    for number in range(40):
        np.save(source / f"{number:02}.npy", sway(100))

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        retarget_folder(source, NAO, into, MAP, threads=1, progress=stop)
    done = len(list(into.glob("*.npz")))
    assert 0 < done < 40 and not list(into.glob(".part.*"))
    again = retarget_folder(source, NAO, into, MAP)
    assert sum(report.done_before for report in again) == done


def test_invalid_folders_are_named(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="not a folder"):
        retarget_folder(tmp_path / "none", NAO, tmp_path / "into")
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="no motion file found"):
        retarget_folder(tmp_path / "empty", NAO, tmp_path / "into")
    (folder / "one.bvh").write_text(BVH)
    with pytest.raises(InvalidValueError, match="would both be written"):
        retarget_folder(folder, NAO, tmp_path / "into")
    with pytest.raises(InvalidValueError, match="threads"):
        retarget_folder(folder / "deeper", NAO, tmp_path / "into", MAP, threads=0)
    assert JOINTS


@pytest.mark.skipif(
    importlib.util.find_spec("ray") is None, reason="SKIPPED LOUDLY: ray is not installed: pip install 'kinopt[ray]'"
)
def test_ray_writes_equal_files(folder: Path, tmp_path: Path) -> None:
    import kinopt.ray

    from ray_cluster import ray_cluster

    with ray_cluster():
        expected, into = tmp_path / "expected", tmp_path / "into"
        robot = kinopt.Robot.from_urdf(NAO, base_joint="free")
        retarget_folder(folder, robot, expected, MAP)
        reports = kinopt.ray.retarget_files(folder, robot, into, MAP)
        assert all(report.error is None and report.frames for report in reports)
        for name in ("one.npz", "two.npz", "deeper/three.npz"):
            with np.load(expected / name) as one, np.load(into / name) as other:
                assert all(np.array_equal(one[key], other[key]) for key in one.files)
        # Either function continues the job of the other.
        os.remove(into / "two.npz")
        assert [report.done_before for report in retarget_folder(folder, robot, into, MAP)] == [True, True, False]
        assert all(report.done_before for report in kinopt.ray.retarget_files(folder, robot, into, MAP))
