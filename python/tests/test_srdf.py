"""SRDF: groups, group states and passive joints of a robot."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import kinopt
from kinopt.errors import FileError, InvalidFileError, UnknownNameError

DOOR = """<robot name="door"><link name="frame"/><link name="leaf"/><link name="handle"/>
  <joint name="hinge" type="continuous"><parent link="frame"/><child link="leaf"/></joint>
  <joint name="latch" type="continuous"><parent link="leaf"/><child link="handle"/></joint></robot>"""
SEMANTICS = """<robot name="door">
  <group name="opening"><chain base_link="frame" tip_link="leaf"/></group>
  <group name="all"><joint name="hinge"/><joint name="latch"/></group>
  <group_state name="ajar" group="opening"><joint name="hinge" value="0.25"/></group_state>
  <end_effector name="grip" parent_link="leaf" group="all" parent_group="opening"/>
  <virtual_joint name="wall" type="fixed" parent_frame="house" child_link="frame"/>
  <passive_joint name="latch"/>
  <disable_collisions link1="frame" link2="leaf" reason="Adjacent"/></robot>"""


@pytest.fixture
def door() -> kinopt.Robot:
    return kinopt.Robot.from_urdf_text(DOOR)


def test_groups_states_and_pairs_are_read(door: kinopt.Robot) -> None:
    semantics = kinopt.Srdf.parse(SEMANTICS, door)
    for srdf in (semantics, pickle.loads(pickle.dumps(semantics))):
        assert srdf.groups == {"opening": ["hinge"], "all": ["hinge", "latch"]}
        assert srdf.states == [("ajar", "opening")]
        assert srdf.passive_joints == ["latch"]
        assert srdf.end_effectors == [("grip", "all", "leaf", "opening")]
        assert srdf.virtual_joints == [("wall", "fixed", "house", "frame")]
        assert srdf.disabled_pairs == [("frame", "leaf", "Adjacent")]
        assert np.array_equal(srdf.state("ajar"), [0.25, 0.0])
        assert np.array_equal(srdf.state("ajar", [1.0, 0.5]), [0.25, 0.5])


def test_groups_and_passive_joints_are_parameter_maps(door: kinopt.Robot) -> None:
    srdf = kinopt.Srdf.parse(SEMANTICS, door)
    opening = srdf.only("opening", [0.1, 0.7])
    assert opening.variable_names == ["hinge"]
    assert np.array_equal(opening.expand([0.3]), [0.3, 0.7])
    driven = srdf.driven([0.1, 0.7])
    assert driven.variable_names == ["hinge"] and np.array_equal(driven.expand([0.3]), [0.3, 0.7])


def test_lenient_reading_omits_unknown_names(door: kinopt.Robot, tmp_path) -> None:
    text = SEMANTICS.replace('passive_joint name="latch"', 'passive_joint name="bolt"')
    with pytest.raises(InvalidFileError, match="bolt"):
        kinopt.Srdf.parse(text, door)
    path = tmp_path / "door.srdf"
    path.write_text(text)
    read = kinopt.Srdf.read(path, door, lenient=True)
    parsed = kinopt.Srdf.parse(text, door, lenient=True)
    for srdf in (read, parsed, pickle.loads(pickle.dumps(read))):
        assert srdf.passive_joints == [] and list(srdf.groups) == ["opening", "all"]
        (repair,) = srdf.repairs
        assert repair.startswith("7: passive_joint `bolt`: left out: ")
    assert kinopt.Srdf.parse(SEMANTICS, door, lenient=True).repairs == []


def test_invalid_arguments_are_named(door: kinopt.Robot, tmp_path) -> None:
    srdf = kinopt.Srdf.parse(SEMANTICS, door)
    with pytest.raises(UnknownNameError, match="opening"):
        srdf.only("closing")
    with pytest.raises(UnknownNameError, match="ajar"):
        srdf.state("shut")
    with pytest.raises(InvalidFileError, match="hing"):
        kinopt.Srdf.parse(SEMANTICS.replace('joint name="hinge"/>', 'joint name="hing"/>'), door)
    with pytest.raises(FileError):
        kinopt.Srdf.read(tmp_path / "none.srdf", door)
