"""Robots from xacro files and from the package robot_descriptions, without network."""

import re
import sys
from pathlib import Path

import pytest

import kinopt

xacrodoc = pytest.importorskip("xacrodoc", reason="SKIPPED LOUDLY: xacrodoc is not installed: pip install 'kinopt[xacro]'")

LINK = """<link name="{name}"><collision><geometry><mesh filename="package://{package}/meshes/corner.stl"/></geometry></collision></link>"""
# A robot of `count` links, each 0.2 m above the other, with a mesh of its package.
XACRO = """<robot name="tower" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="count" default="2"/>
  <xacro:arg name="bent" default="true"/>
  <xacro:include filename="$(find {package})/urdf/parts.xacro"/>
  <xacro:include filename="more/parts.xacro"/>
  <link name="base"/>
  <xacro:property name="type" value="fixed"/>
  <xacro:if value="$(arg bent)"><xacro:property name="type" value="revolute"/></xacro:if>
  <xacro:tower n="${{int($(arg count))}}" below="base" type="${{type}}"/>
</robot>
"""
PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="tower" params="n below type">
    <xacro:if value="${{n > 0}}">
      {link}
      <xacro:storey number="${{n}}" below="${{below}}" type="${{type}}"/>
      <xacro:tower n="${{n - 1}}" below="link${{n}}" type="${{type}}"/>
    </xacro:if>
  </xacro:macro>
</robot>
"""
MORE = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="storey" params="number below type">
    <joint name="joint${number}" type="${type}">
      <origin xyz="0 0 ${2 * 0.1}"/><parent link="${below}"/><child link="link${number}"/>
      <axis xyz="1 0 0"/><limit lower="${-pi / 2}" upper="${pi / 2}" velocity="1" effort="1"/>
    </joint>
  </xacro:macro>
</robot>
"""
PAGE = (Path(__file__).parents[2] / "docs" / "guide" / "interoperation.md").read_text()
STL = b"\0" * 80 + (4).to_bytes(4, "little")


def corner():
    """A tetrahedron of 10 cm as binary STL."""
    import numpy as np

    points = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], dtype="<f4")
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    return STL + b"".join(np.zeros(3, "<f4").tobytes() + points[face].tobytes() + b"\0\0" for face in faces)


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def write_xacro(folder, package, file):
    """Writes a package of xacro files; returns its main file."""
    write(folder / "package.xml", f"<package><name>{package}</name></package>")
    write(folder / "urdf" / "parts.xacro", PARTS.format(link=LINK.format(name="link${n}", package=package)))
    write((folder / file).parent / "more" / "parts.xacro", MORE)
    write(folder / "meshes" / "corner.stl", corner())
    write(folder / file, XACRO.format(package=package))
    return folder / file


def test_xacro_is_expanded_with_arguments_and_meshes(tmp_path):
    path = write_xacro(tmp_path / "checkout" / "tower_description", "tower_description", "robots/tower.urdf.xacro")
    robot = kinopt.Robot.from_xacro(path)
    assert robot.name == "tower"
    assert robot.joint_names == ["joint2", "joint1"]
    assert robot.upper.round(12).tolist() == [1.570796326795] * 2
    assert [shape.kind for shape in robot.collision_model().shapes] == ["convex"] * 2
    taller = kinopt.Robot.from_xacro(path, {"count": 5}, base_joint="free")
    assert taller.configuration_len == 7 + 5
    assert kinopt.frame_placement(taller, "link1", taller.neutral())[2, 3] == pytest.approx(5 * 0.2)
    assert kinopt.Robot.from_xacro(path, {"bent": False}).joint_names == []


def test_xacro_packages_can_be_folders_of_any_name(tmp_path):
    path = write_xacro(tmp_path / "parts-1.2", "separate_parts", "tower.xacro")
    path = path.rename(tmp_path / "tower.xacro")
    (tmp_path / "parts-1.2" / "more").rename(tmp_path / "more")
    with pytest.raises(kinopt.InvalidFileError, match=r"tower.xacro: no ROS package `separate_parts`: add its folder to `packages`"):
        kinopt.Robot.from_xacro(path)
    robot = kinopt.Robot.from_xacro(path, packages={"separate_parts": tmp_path / "parts-1.2"})
    assert robot.joint_names == ["joint2", "joint1"]


def test_page_reads_a_xacro_file(tmp_path, monkeypatch, capsys):
    joint = '<joint name="$(arg prefix)pan" type="fixed"><parent link="a"/><child link="b"/></joint>'
    arm = f'<xacro:arg name="prefix" default=""/><xacro:include filename="$(find arm_description)/b.xacro"/><link name="a"/>{joint}'
    write(tmp_path / "arm.urdf.xacro", f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{arm.replace("fixed", "continuous")}</robot>')
    write(tmp_path / "arm" / "b.xacro", '<robot><link name="b"/></robot>')
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"^<!-- with xacrodoc -->\n```python\n(.*?)^```", PAGE, re.S | re.M)
    exec(block, {})  # noqa: S102
    assert capsys.readouterr().out == "['left_pan']\n"


def test_xacro_errors_name_the_file(tmp_path):
    with pytest.raises(kinopt.FileError, match="nowhere.xacro"):
        kinopt.Robot.from_xacro(tmp_path / "nowhere.xacro")
    write(tmp_path / "broken.xacro", "<robot")
    with pytest.raises(kinopt.InvalidFileError, match="broken.xacro"):
        kinopt.Robot.from_xacro(tmp_path / "broken.xacro")
    wrong = '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${nothing}"/></robot>'
    write(tmp_path / "wrong.xacro", wrong)
    with pytest.raises(kinopt.InvalidFileError, match="wrong.xacro: xacro: .*nothing"):
        kinopt.Robot.from_xacro(tmp_path / "wrong.xacro")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache of robot_descriptions: repositories at a tag, which it prefers to its own commits."""
    pytest.importorskip("robot_descriptions", reason="SKIPPED LOUDLY: pip install 'kinopt[descriptions]'")
    import git

    def commit(repository):
        folder = tmp_path / f"{repository}-tested" / repository
        repo = git.Repo.init(folder)
        repo.git.add(all=True)
        repo.git(c=["user.name=kinopt", "user.email=kinopt@example.org"]).commit(message="robot")
        repo.create_tag("tested")

    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path))
    monkeypatch.setenv("ROBOT_DESCRIPTION_COMMIT", "tested")
    for name in [name for name in sys.modules if name.startswith("robot_descriptions.") and name.endswith("_description")]:
        monkeypatch.delitem(sys.modules, name)
    return lambda repository: tmp_path / f"{repository}-tested" / repository, commit


def test_descriptions_are_read_in_each_format(cache, capsys):
    folder, commit = cache
    panda = folder("example-robot-data") / "robots" / "panda_description"
    write(panda / "urdf" / "panda.urdf", f'<robot name="p">{LINK.format(name="hand", package="example-robot-data")}</robot>')
    write(folder("example-robot-data") / "meshes" / "corner.stl", corner())
    commit("example-robot-data")
    robot = kinopt.Robot.from_description("panda_description", base_joint="planar")
    assert robot.frame_names == ["hand"] and robot.configuration_len == 3
    assert [shape.kind for shape in robot.collision_model().shapes] == ["convex"]
    capsys.readouterr()
    (block,) = re.findall(r"^<!-- with robot_descriptions -->\n```python\n(.*?)^```", PAGE, re.S | re.M)
    exec(block, {})  # noqa: S102
    assert capsys.readouterr().out == "['hand'] []\n"

    write(folder("mujoco_menagerie") / "franka_emika_panda" / "panda.xml", "<mujoco><worldbody><body name='b'><joint/><geom size='1'/></body></worldbody></mujoco>")
    commit("mujoco_menagerie")
    assert kinopt.Robot.from_description("panda_mj_description").frame_names == ["world", "b"]

    write_xacro(folder("ros2_kortex") / "kortex_description", "kortex_description", "robots/gen3.xacro")
    commit("ros2_kortex")
    assert len(kinopt.Robot.from_description("gen3_description", {"count": 7}).joint_names) == 7


def test_description_errors_name_the_remedy(cache):
    with pytest.raises(kinopt.UnknownNameError, match="no description named `panda`; similar: panda_description"):
        kinopt.Robot.from_description("panda")
    folder, commit = cache
    write(folder("example-robot-data") / "robots" / "panda_description" / "urdf" / "panda.urdf", '<robot name="p"><link name="a"/></robot>')
    commit("example-robot-data")
    with pytest.raises(kinopt.InvalidValueError, match="`arguments` must be empty"):
        kinopt.Robot.from_description("panda_description", {"hand": True})
