"""Configurations in the order of Pinocchio and MuJoCo: frames have the poses of those libraries."""

import numpy as np
import pytest

import kinopt

# Joints not in the order of their names: a fixed one with children, continuous, planar, floating and mimic ones.
URDF = """<robot name="tree"><link name="base"/><link name="z_hip"/><link name="foot"/><link name="a_arm"/><link name="hand"/>
  <link name="plate"/><link name="finger"/><link name="drone"/><link name="sled"/>
  <joint name="leg" type="continuous"><parent link="base"/><child link="z_hip"/><origin xyz="0 0.2 0"/><axis xyz="0 1 0"/></joint>
  <joint name="ankle" type="revolute"><parent link="z_hip"/><child link="foot"/><origin xyz="0 0 -0.5" rpy="0.2 0 0"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="base"/><child link="plate"/><origin xyz="0.1 0 0.3" rpy="0 0 1"/></joint>
  <joint name="shoulder" type="continuous"><parent link="plate"/><child link="a_arm"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="prismatic"><parent link="a_arm"/><child link="hand"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
  <joint name="beside" type="revolute"><parent link="plate"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="air" type="floating"><parent link="base"/><child link="drone"/><origin xyz="0 0 1"/></joint>
  <joint name="ground" type="planar"><parent link="base"/><child link="sled"/><axis xyz="0 0 1"/></joint></robot>"""
INERTIA = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def weighed(text):
    """The links with masses, which MuJoCo requires."""
    return text.replace("<link name=", "<link  name=").replace('"/><link', f'">{INERTIA}</link><link').replace(
        '"/>\n  <link', f'">{INERTIA}</link>\n  <link'
    ).replace('"/>\n  <joint name="leg"', f'">{INERTIA}</link>\n  <joint name="leg"')


@pytest.mark.parametrize("base", [None, "free", "planar"])
def test_configuration_of_pinocchio_places_equal_frames(base):
    pin = pytest.importorskip("pinocchio")
    robot = kinopt.Robot.from_urdf_text(URDF, base_joint=base)
    roots = {None: [], "free": [pin.JointModelFreeFlyer()], "planar": [pin.JointModelPlanar()]}
    model = pin.buildModelFromXML(URDF, *roots[base])
    data = model.createData()
    for seed in range(10):
        q = robot.random_configuration(seed=seed)
        other = robot.to_pinocchio(q)
        assert other.shape == (model.nq,)
        pin.framesForwardKinematics(model, data, other)
        for frame in robot.frame_names:
            placed = data.oMf[model.getFrameId(frame)].homogeneous
            np.testing.assert_allclose(placed, kinopt.frame_placement(robot, frame, q), atol=1e-12)
        np.testing.assert_allclose(robot.from_pinocchio(other), q, atol=1e-12)
    many = robot.random_configuration(4, seed=3)
    np.testing.assert_array_equal(robot.to_pinocchio(many)[2], robot.to_pinocchio(many[2]))


def test_configuration_of_mujoco_places_equal_frames():
    mujoco = pytest.importorskip("mujoco")
    # MuJoCo supports floating joints of the root only.
    text = "".join(line for line in URDF.splitlines(True) if 'name="air"' not in line)
    text = text.replace('<link name="drone"/>', "")
    robot = kinopt.Robot.from_urdf_text(text)
    options = '<mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco></robot>'
    model = mujoco.MjModel.from_xml_string(weighed(text).replace("</robot>", options))
    data = mujoco.MjData(model)
    for seed in range(10):
        q = robot.random_configuration(seed=seed)
        data.qpos[:] = robot.to_mujoco(q)
        mujoco.mj_kinematics(model, data)
        for body in range(2, model.nbody):
            placement = kinopt.frame_placement(robot, model.body(body).name, q)
            np.testing.assert_allclose(data.xpos[body], placement[:3, 3], atol=1e-9)
            np.testing.assert_allclose(data.xmat[body].reshape(3, 3), placement[:3, :3], atol=1e-9)
        np.testing.assert_allclose(robot.from_mujoco(data.qpos), q, atol=1e-15)


def test_mjcf_configuration_is_that_of_mujoco(tmp_path):
    file = tmp_path / "ball.xml"
    file.write_text(
        '<mujoco><worldbody><body name="b"><freejoint/><geom size="0.1"/><body name="c"><joint type="ball"/>'
        '<geom size="0.1"/></body></body></worldbody></mujoco>'
    )
    robot = kinopt.Robot.from_mjcf(file)
    q = robot.random_configuration(seed=1)
    np.testing.assert_array_equal(robot.to_mujoco(q), q)
    with pytest.raises(kinopt.InvalidValueError, match="to_mujoco"):
        robot.to_pinocchio(q)
    with pytest.raises(kinopt.InvalidValueError):
        robot.to_mujoco(q[1:])
