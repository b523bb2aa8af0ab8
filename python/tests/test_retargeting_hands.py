"""Fingertips of a robot hand follow a captured hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt.retargeting import HandRetargetFollower

FINGERS = {"thumb": "0.02 0.05 -0.03", "index": "0.09 0.03 0", "middle": "0.09 -0.03 0"}
JOINTS = ["wrist", *(f"{finger}_{end}" for finger in FINGERS for end in ("base", "tip"))]


@pytest.fixture
def hand() -> kinopt.Robot:
    links = "".join(
        f"""<link name="{name}"/><link name="{name}_tip"/><joint name="{name}_joint" type="revolute"><parent link="palm"/>
        <child link="{name}"/><origin xyz="{at}"/><axis xyz="0 1 0"/><limit lower="-0.1" upper="1.6" velocity="10" effort="1"/></joint>
        <joint name="{name}_end" type="fixed"><parent link="{name}"/><child link="{name}_tip"/><origin xyz="0.08 0 0"/></joint>"""
        for name, at in FINGERS.items()
    )
    return kinopt.Robot.from_urdf_text(f'<robot name="hand"><link name="palm"/>{links}</robot>')


def curling() -> np.ndarray:
    """A hand of twice the size whose fingers curl, shape (40, 7, 3)."""
    curl = np.linspace(0.0, 1.2, 40)
    tip = np.stack([0.16 * np.cos(curl), 0 * curl, -0.16 * np.sin(curl)], axis=1)
    bases = [2 * np.array([float(x) for x in at.split()]) for at in FINGERS.values()]
    return np.concatenate([np.zeros((40, 1, 3)), np.stack([at for base in bases for at in (base + 0 * tip, base + tip)], axis=1)], axis=1)


def test_fingertips_follow_the_subject(hand: kinopt.Robot, tmp_path: Path) -> None:
    points = curling()
    motion = kinopt.retarget_hand(points, hand, joints=JOINTS, fps=30)
    assert motion.q.shape == (40, 3) and motion.report.tip_error < 2e-3
    assert np.allclose(motion.report.scales, 0.5, atol=1e-6)
    assert all(hand.is_within_limits(q) for q in motion.q)
    (tmp_path / "map.json").write_text(json.dumps(motion.report.map))
    again = kinopt.retarget_hand(points, hand, tmp_path / "map.json", joints=JOINTS, fps=30)
    assert np.array_equal(again.q, motion.q)
    follower = HandRetargetFollower(points, hand, motion.report.map, joints=JOINTS, fps=30)
    assert np.array_equal([follower.step(frame) for frame in points], motion.q)


def test_hand_without_a_thumb_is_rejected(hand: kinopt.Robot) -> None:
    with pytest.raises(kinopt.KinoptError, match="thumb"):
        kinopt.retarget_hand(curling(), hand, joints=[name.replace("thumb", "claw") for name in JOINTS], fps=30)
