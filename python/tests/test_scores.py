"""Promise: ``kinopt.score`` has equal figures for a trajectory, its array and its files, and ranks spoiled motions last.
Motions of SMPL are read from .npz files."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinopt
from kinopt.errors import InvalidFileError, InvalidValueError, UnknownNameError

STEPS = Path(__file__).parents[2] / "models" / "captures" / "steps.bvh"


@pytest.fixture(scope="module")
def nao() -> kinopt.Robot:
    return kinopt.models.nao(base_joint="free")


@pytest.fixture(scope="module")
def steps(nao: kinopt.Robot) -> kinopt.Trajectory[Any]:
    return kinopt.retarget(STEPS, nao, fps=30)


def figures(score: kinopt.MotionScore) -> list[float]:
    """All figures that are numbers, in a fixed order."""
    spreads = [*score.limbs.values(), *score.ends.values(), score.penetration, score.joint_jerk, score.end_jerk]
    numbers = [number for spread in spreads for number in asdict(spread).values()]
    return [score.total, *(term.value for term in score.terms), *numbers, score.limits.share]


def test_scores_of_files_are_equal(steps: kinopt.Trajectory[Any], nao: kinopt.Robot, tmp_path: Path) -> None:
    expected = kinopt.score(steps, nao, STEPS, fps=30, subject_fps=30)
    assert set(expected.limbs) >= {"spine", "left_thigh", "right_forearm"} and len(expected.ends) == 4
    assert np.isclose(expected.total, sum(term.points for term in expected.terms))
    # The report has the score of the motion itself.
    assert np.allclose(figures(steps.report.score), figures(expected), rtol=1e-9)
    for file, precision in (("steps.npz", 1e-12), ("steps.json", 1e-12), ("steps.csv", 1e-12), ("steps.glb", 5e-3)):
        steps.save(tmp_path / file)
        found = kinopt.score(tmp_path / file, nao, STEPS, subject_fps=30)
        assert np.allclose(figures(found), figures(expected), rtol=precision, atol=precision), file
    # Bare rows of two layouts, and the keys of MuJoCo and of GMR.
    steps.save(tmp_path / "lafan1.csv", header=False)
    steps.save(tmp_path / "mujoco.csv", header=False, layout="mujoco")
    steps.save(tmp_path / "qpos.npz", layout="mujoco")
    q = steps.q
    parts = {"root_pos": q[:, :3], "root_rot": q[:, [4, 5, 6, 3]], "dof_pos": q[:, 7:]}
    np.savez_compressed(tmp_path / "gmr.npz", fps=30, **parts)
    assert np.array_equal(np.loadtxt(tmp_path / "mujoco.csv", delimiter=","), q)
    for file, order in (("lafan1.csv", None), ("mujoco.csv", "wxyz"), ("qpos.npz", None), ("gmr.npz", None)):
        found = kinopt.score(tmp_path / file, nao, STEPS, fps=30, subject_fps=30, quaternion=order)  # type: ignore[arg-type]
        assert np.allclose(figures(found), figures(expected), rtol=1e-9, atol=1e-9), file


def test_spoiled_motions_rank_last(steps: kinopt.Trajectory[Any], nao: kinopt.Robot) -> None:
    best = kinopt.score(steps.q, nao, STEPS, fps=30).total
    times = np.arange(len(steps)) / 30
    sliding, jitter = steps.q.copy(), steps.q.copy()
    sliding[:, 0] += 0.1 * times
    jitter[:, 7:] += np.random.default_rng(5).uniform(-0.03, 0.03, jitter[:, 7:].shape)
    late = np.vstack([steps.q[20:], np.repeat(steps.q[-1:], 20, axis=0)])
    for spoiled in (sliding, jitter, late):
        assert kinopt.score(spoiled, nao, STEPS, fps=30).total > best
    shifted = kinopt.score(steps.q[20:], nao, STEPS, fps=30, start=20 / 30)
    assert abs(shifted.total - best) < 0.1 * best
    weighted = kinopt.score(steps.q, nao, STEPS, fps=30, weights={"limbs": 0.0, "jerk": 2})
    assert {term.name: term.weight for term in weighted.terms}["limbs"] == 0.0


def test_score_without_subject(steps: kinopt.Trajectory[Any], nao: kinopt.Robot) -> None:
    score = kinopt.score(steps, nao, collisions=True)
    assert score.limbs == {} and score.ends == {} and score.subject_end_jerk is None
    assert score.feet is not None and not score.feet.of_subject
    assert score.collision_share is not None and 0 <= score.collision_share <= 1
    assert [term.name for term in score.terms] == ["sliding", "penetration", "jerk", "limits", "collisions"]


def test_invalid_scores_are_reported(steps: kinopt.Trajectory[Any], nao: kinopt.Robot, tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="did you mean `limbs`"):
        kinopt.score(steps, nao, weights={"limb": 1})
    with pytest.raises(InvalidValueError, match="motion has shape"):
        kinopt.score(steps.q[:, 1:], nao)
    with pytest.raises(InvalidValueError, match="quaternion"):
        kinopt.score(steps, nao, quaternion="xywz")  # type: ignore[arg-type]
    with pytest.raises(InvalidValueError, match="unsupported motion"):
        kinopt.score(STEPS, nao)
    np.savez(tmp_path / "other.npz", angles=np.zeros(3))
    with pytest.raises(InvalidFileError, match="the file has angles"):
        kinopt.score(tmp_path / "other.npz", nao)


def amass(path: Path, **more: Any) -> Path:
    """A motion of SMPL-H as AMASS has it: an upright person with hanging arms, z up."""
    poses = np.zeros((12, 52, 3))
    poses[:, 0, 0] = np.pi / 2
    poses[:, 16, 2], poses[:, 17, 2] = -1.3, 1.3
    trans = np.tile([0.0, 0.0, 0.92], (12, 1))
    arrays = {"poses": poses.reshape(12, 156), "trans": trans, "mocap_framerate": 30.0, "gender": "neutral"}
    np.savez_compressed(path, **{**arrays, **more})
    return path


def test_smpl_motions_are_read(nao: kinopt.Robot, tmp_path: Path) -> None:
    path = amass(tmp_path / "stand.npz")
    capture = kinopt.MotionCapture.read_smpl(path, height=2.0)
    assert capture.frames == 12 and np.isclose(capture.frame_time, 1 / 30)
    assert capture.armature.names[:5] == ["pelvis", "left_hip", "right_hip", "spine1", "left_knee"]
    assert "default skeleton of 2 m" in capture.notes[0]
    motion = kinopt.retarget(path, nao)
    assert motion.q.shape == (12, nao.configuration_len) and "default skeleton of 1.7 m" in motion.report.notes[0]
    assert motion.report.capture.up == "z" and motion.report.score.limbs["left_thigh"].mean < 15
    # A body model with one vertex a joint, twice as large by its first shape component.
    rest = np.random.default_rng(2).normal(size=(52, 3))
    body = tmp_path / "body.npz"
    np.savez(body, J_regressor=np.eye(52), v_template=rest, shapedirs=rest[:, :, None])
    shaped = kinopt.MotionCapture.read_smpl(amass(tmp_path / "shaped.npz", betas=np.ones(1)), body_model=body)
    given = kinopt.MotionCapture.read_smpl(amass(tmp_path / "given.npz", jtr=2 * rest))
    assert shaped.notes == [] and given.notes == [] and shaped.to_text() == given.to_text()
    with pytest.raises(InvalidValueError, match="give one of them"):
        kinopt.MotionCapture.read_smpl(path, body_model=body, height=1.7)
    with pytest.raises(InvalidFileError, match="expected 72"):
        kinopt.MotionCapture.read_smpl(amass(tmp_path / "other.npz", poses=np.zeros((12, 30))))
