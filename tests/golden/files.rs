//! Robots, rigs, captures, scenes and worlds from their files.

use kinopt::collision::World;
use kinopt::io::gltf::{self, Scene, WriteOptions};
use kinopt::io::{bvh, ply};
use kinopt::robot::{Robot, Srdf};
use support::bones::humanoid;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::double("files_urdf", urdf),
    Case::double("files_mjcf", mjcf),
    Case::double("files_srdf", srdf),
    Case::single("files_bvh", motion_capture),
    Case::single("files_gltf", scene),
    Case::single("files_rig", rig),
    Case::double("files_world", world),
];

/// Names, placements, axes, limits, mass and repairs of a robot.
fn robot(record: &mut Record, name: &str, robot: &Robot) {
    let (joints, frames) = (robot.model().joints(), robot.model().frames());
    let named = |part: &str| format!("{name}.{part}");
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    record.text(&named("joints"), &names.join(" "));
    let names: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
    record.text(&named("frames"), &names.join(" "));
    let placements = joints.iter().map(|joint| joint.parent_from_joint);
    let placements = placements.chain(frames.iter().map(|frame| frame.joint_from_frame));
    record.placements(&named("placements"), &placements.collect::<Vec<_>>());
    let axes = joints.iter().flat_map(|joint| joint.axis.to_array());
    record.numbers(&named("axes"), axes);
    let limits = robot.model().limits().flat_map(|l| [l.lower, l.upper]);
    record.numbers(&named("limits"), limits);
    let masses = robot.masses().map(|masses| masses.total());
    record.numbers(&named("mass"), masses.ok());
    let repairs: Vec<String> = robot.repairs().iter().map(ToString::to_string).collect();
    record.text(&named("repairs"), &repairs.join("\n"));
}

fn urdf(record: &mut Record) {
    for name in [
        "franka_panda",
        "universal_ur5e",
        "rethink_baxter",
        "aldebaran_nao",
    ] {
        robot(
            record,
            name,
            &Robot::read(format!("../models/{name}.urdf")).unwrap(),
        );
    }
    let broken = std::fs::read_to_string("../models/universal_ur5e.urdf").unwrap();
    let broken = broken.replace(r#"type="revolute""#, r#"type="hinge""#);
    record.text(
        "error",
        &Robot::parse(&broken, "broken.urdf")
            .unwrap_err()
            .to_string(),
    );
}

fn mjcf(record: &mut Record) {
    for name in ["gripper", "walker"] {
        robot(
            record,
            name,
            &Robot::read_mjcf(format!("robot/mjcf/files/{name}.xml")).unwrap(),
        );
    }
    robot(
        record,
        "knee",
        &Robot::read_mjcf("solver/loops/files/knee.xml").unwrap(),
    );
}

fn srdf(record: &mut Record) {
    let panda = Robot::read("../models/franka_panda.urdf").unwrap();
    let text = r#"<robot name="panda"><group name="arm"><chain base_link="base" tip_link="link7"/></group>
      <group name="hand"><link name="finger_left"/></group><group name="all"><group name="arm"/><group name="hand"/></group>
      <group_state name="ready" group="arm"><joint name="joint2" value="-0.5"/><joint name="joint4" value="-2"/></group_state>
      <passive_joint name="joint7"/><disable_collisions link1="link1" link2="link2" reason="Adjacent"/></robot>"#;
    let srdf = Srdf::parse(text, "panda.srdf", &panda).unwrap();
    let neutral = panda.model().neutral();
    for group in &srdf.groups {
        let joints = group.joints.iter().map(|joint| joint.index());
        record.counts(&group.name, joints);
    }
    record.numbers("ready", srdf.state("ready", &neutral).unwrap());
    let pairs = srdf.disabled_pairs.iter().flat_map(|pair| pair.links);
    record.counts("disabled pairs", pairs.map(|link| link.index()));
    record.counts(
        "passive joints",
        srdf.passive_joints.iter().map(|joint| joint.index()),
    );
}

fn motion_capture(record: &mut Record) {
    let capture = bvh::read("../models/captures/steps.bvh").unwrap();
    record.text("bones", &capture.armature.names().join(" "));
    record.poses("rest", [capture.armature.rest()]);
    let written = bvh::to_text(&capture.armature, &capture.clip, 1.0 / capture.frame_time);
    record.text("written", &written.unwrap());
}

fn scene(record: &mut Record) {
    let rig = humanoid();
    let parts = rig.mesh.as_ref().zip(rig.weights.as_ref());
    let scene = Scene::of_skeleton(&rig.skeleton, parts).unwrap();
    let bytes = gltf::to_bytes(&scene, &WriteOptions::default()).unwrap();
    record.counts("bytes", bytes.iter().map(|&byte| usize::from(byte)));
    let again = gltf::from_bytes(&bytes, "humanoid.glb", |_| unreachable!()).unwrap();
    record.text("bones", &again.armature.names().join(" "));
    record.poses("rest", [again.armature.rest()]);
}

fn rig(record: &mut Record) {
    let rig = humanoid();
    record.text("written", &rig.to_json("humanoid.ply", "humanoid.dmat"));
    let mesh = ply::to_bytes(rig.mesh.as_ref().unwrap(), ply::PlyEncoding::Ascii);
    record.text("mesh", &String::from_utf8(mesh).unwrap());
    record.counts(
        "constrained",
        rig.constrained.iter().map(|bone| bone.index()),
    );
}

fn world(record: &mut Record) {
    let world = World::read("../models/worlds/table.json").unwrap();
    record.text("written", &world.to_json());
}
