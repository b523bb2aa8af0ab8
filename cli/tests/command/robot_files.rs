//! Promise: errors in a robot's file are rejected, or repaired and reported with `--lenient`. Soft limits bind on
//! request, and shapes and masses are counted.

use serde_json::json;

use crate::forked_rig::*;

const DOOR: &str = r#"<robot name="door"><link name="frame"/>
<link name="leaf"><inertial><mass value="12.5"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
  <visual><geometry><mesh filename="package://door/leaf.stl"/></geometry></visual></link>
<joint name="hinge" type="revolute"><parent link="frame"/><child link="leaf"/><axis xyz="0 0 1"/>
  <limit lower="1.5" upper="-1" velocity="2" effort="30"/>
  <safety_controller k_velocity="1" soft_lower_limit="-0.5"/></joint>
<joint name="bolt" type="prismatic"><parent link="leaf"/><child link="tip"/><origin xyz="1 0 0"/>
  <limit upper="0.1"/></joint><link name="tip"/></robot>"#;

fn door(folder: &Folder, text: &str) -> String {
    folder.text("door.urdf", text)
}

#[test]
fn damaged_robot_is_rejected_or_repaired_on_request() {
    let folder = Folder::new("lenient");
    let file = door(&folder, DOOR);
    let words = "door.urdf:5: joint `hinge` | lower limit 1.5 | --lenient";
    refused!("info {file}" => 1, "{words}");
    let (info, notes) = answer!(with_messages "info {file} --lenient");
    says!(notes => "note:  | door.urdf:5: joint `hinge`, <limit>: limits out of order, taken as -1 to 1.5 | \
         door.urdf:8: joint `bolt`, <limit>: `lower` is not given and taken as 0, the default");
    has!(info, {"repairs/0/line": 5, "repairs/0/element": "joint `hinge`, <limit>"});
    assert_eq!(list(&info["repairs"]).len(), 2);
    assert_eq!(info["joints"][0]["lower"], -1.0);
}

#[test]
fn defaulted_attributes_need_no_option() {
    let folder = Folder::new("defaults");
    let sound = DOOR.replace("lower=\"1.5\" upper=\"-1\"", "lower=\"-1\" upper=\"1.5\"");
    let file = door(&folder, &sound);
    let (_, messages) = answer!(with_messages "fk {file} --frame tip");
    says!(messages => "`lower` is not given");
}

#[test]
fn shapes_masses_and_limits_are_reported() {
    let folder = Folder::new("bodies");
    let file = door(&folder, DOOR);
    let info = answer!("info {file} --lenient");
    assert_eq!(info["mass"], 12.5);
    let leaf = json!({"name": "leaf", "mass": 12.5, "visuals": 1, "collisions": 0,
                      "meshes": ["package://door/leaf.stl"]});
    assert_eq!(info["links"][1], leaf);
    assert_eq!(info["links"][0]["mass"], json!(null));
    has!(info["joints"][0], {"velocity": 2.0, "effort": 30.0, "soft_limits": [-0.5, null]});
    has!(info["joints"][1], {"velocity": null, "soft_limits": null});
    let text = text!("info {file} --lenient");
    says!(text => "1 visual, 0 collision, 1 file of meshes | 12.5 | kg");
}

#[test]
fn soft_limits_apply_on_request() {
    let folder = Folder::new("soft");
    let file = door(&folder, DOOR);
    // Quarter turn to the right, which the soft limit stops.
    let target = "--target=tip=0.5403,-0.8415,0";
    let hinge = |more: &str| number(&answer!("solve {file} {target} --lenient {more}")["q"][0]);
    assert!(hinge("") < -0.9);
    assert_eq!(hinge("@model.soft_limits=true"), -0.5);
    let info = answer!("info {file} --lenient @model.soft_limits=true");
    assert_eq!(info["joints"][0]["lower"], -0.5);
}

#[test]
fn robot_options_are_rejected_for_rigs() {
    let (_folder, rig) = Folder::with_rig("rig");
    for (option, name) in [
        ("--lenient", "--lenient"),
        ("@model.soft_limits=true", "`soft_limits`"),
    ] {
        refused!("info {rig} {option}" => 2, "{name}");
        refused!("fk {rig} {option}" => 2, "{name}");
    }
}
