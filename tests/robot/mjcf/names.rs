//! Promise: unnamed elements are named after their bodies, and attributes come from classes. The root element
//! distinguishes MJCF from URDF.

use kinopt::robot::{Geometry, MissingInertia, Robot};
use kinopt::spatial::Vector3;

#[test]
fn unnamed_elements_are_named_after_their_body() {
    let text = r#"<mujoco><worldbody>
        <body><freejoint/><body name="arm"><joint/><joint/><joint type="slide"/><site/><site/><site name="arm"/></body></body>
        <body name="body/1"/></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "unnamed.xml").unwrap();
    let joints: Vec<&str> = robot
        .model()
        .joints()
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    let free = ["x", "y", "z", "rotation"].map(|part| format!("body/1/2/free/{part}"));
    assert_eq!(joints[..4], free);
    assert_eq!(joints[4..], ["arm/hinge", "arm/hinge/2", "arm/slide"]);
    let frames: Vec<&str> = robot
        .model()
        .frames()
        .iter()
        .map(|frame| frame.name.as_str())
        .collect();
    assert_eq!(
        frames,
        [
            "world",
            "body/1/2",
            "arm",
            "body/1",
            "arm/site",
            "arm/site/2",
            "site/arm"
        ]
    );
    assert_eq!(robot.name(), "MuJoCo Model");
}

#[test]
fn robot_readers_detect_mjcf() {
    let text =
        "<!-- by hand -->\n<mujoco model=\"m\"><worldbody><body name=\"b\"/></worldbody></mujoco>";
    let robot = Robot::parse(text, "robot.urdf").unwrap();
    assert_eq!(robot.name(), "m");
}

#[test]
fn geoms_become_shapes_by_group_and_contact() {
    let text = r#"<mujoco><compiler meshdir="meshes/"/>
        <default><mesh scale="2 2 2"/><default class="seen"><geom contype="0" conaffinity="0" group="2"/></default>
        <default class="felt"><geom group="3"/></default></default>
        <asset><mesh file="parts/hull.obj" refpos="1 0 0"/></asset>
        <worldbody><geom type="plane" size="1 1 1"/><body name="b" childclass="seen"><geom type="mesh" mesh="hull" pos="0 1 0"/>
        <geom class="felt" name="box" type="box" size="1 2 3"/><geom class="main" type="sphere" size="0.5"/>
        <geom class="felt" type="mesh" mesh="hill"/></body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "shapes.xml").unwrap();
    let link = robot.link(robot.model().frame("b").unwrap()).unwrap();
    let visuals: Vec<&Geometry> = link.visuals.iter().map(|shape| &shape.geometry).collect();
    let mesh = Geometry::Mesh {
        file: "meshes/parts/hull.obj".to_owned(),
        scale: [2.0; 3],
    };
    assert_eq!(visuals, [&mesh, &Geometry::Sphere { radius: 0.5 }]);
    // The file's point (1, 0, 0) is at the geom, scaled.
    assert_eq!(
        link.visuals[0].link_from_shape.translation.to_array(),
        [-2.0, 1.0, 0.0]
    );
    let collisions: Vec<&Geometry> = link
        .collisions
        .iter()
        .map(|shape| &shape.geometry)
        .collect();
    let size = [2.0, 4.0, 6.0];
    assert_eq!(
        collisions,
        [&Geometry::Box { size }, &Geometry::Sphere { radius: 0.5 }]
    );
    let messages: Vec<String> = robot.repairs().iter().map(ToString::to_string).collect();
    assert!(
        messages.iter().any(|messages| messages.contains("hill")),
        "{messages:?}"
    );
    // The mass of a mesh needs its file.
    assert_eq!(link.inertial, None);
    assert_eq!(link.left_to_meshes, Some(MissingInertia::Mass));
}

/// `meshdir` applies to meshes, `assetdir` to all assets without a folder of their own.
#[test]
fn mesh_folder_precedes_the_asset_folder() {
    for (folders, expected) in [
        (r#"meshdir="meshes" assetdir="assets""#, "meshes/hull.obj"),
        (r#"assetdir="assets" meshdir="meshes""#, "meshes/hull.obj"),
        (
            r#"assetdir="assets" texturedir="textures""#,
            "assets/hull.obj",
        ),
        (r#"texturedir="textures""#, "hull.obj"),
    ] {
        let text = format!(
            r#"<mujoco><compiler {folders}/><asset><mesh file="hull.obj"/></asset><worldbody><body name="b">
            <geom type="mesh" mesh="hull"/></body></worldbody></mujoco>"#
        );
        let robot = Robot::parse_mjcf(&text, "folders.xml").unwrap();
        let link = robot.link(robot.model().frame("b").unwrap()).unwrap();
        let file = link
            .collisions
            .iter()
            .find_map(|shape| match &shape.geometry {
                Geometry::Mesh { file, .. } => Some(file.as_str()),
                _ => None,
            });
        assert_eq!(file, Some(expected), "{folders}");
    }
}

/// A file's points are translated by −`refpos`, rotated by the inverse of `refquat` and then scaled.
#[test]
fn mesh_reference_pose_is_applied() {
    let text = r#"<mujoco><asset><mesh file="hull.obj" refpos="1 0.5 0" refquat="0.6 0 0 0.8" scale="2 2 2"/></asset>
        <worldbody><body name="b"><geom type="mesh" mesh="hull" pos="0 1 0"/></body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "turned.xml").unwrap();
    let link = robot.link(robot.model().frame("b").unwrap()).unwrap();
    let shape = &link.visuals[0];
    let to_link = |file: Vector3<f64>| shape.link_from_shape.apply(file * 2.0);
    let reference = Vector3::new(1.0, 0.5, 0.0);
    let geom = Vector3::new(0.0, 1.0, 0.0);
    assert!((to_link(reference) - geom).norm() < 1e-15);
    // By 2 atan(0.8 / 0.6) about z: cosine -0.28, sine 0.96. A direction rotated so in the file becomes straight.
    let turned = Vector3::new(-0.28, 0.96, 0.0);
    let straight = to_link(reference + turned) - geom;
    assert!(
        (straight - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-14,
        "{straight:?}"
    );
}

/// Either contact bit enables collisions. A box along a line is as thick as stated, on both axes if one number is
/// given.
#[test]
fn contact_bits_and_fromto_boxes_are_read() {
    let text = r#"<mujoco><worldbody><body name="b">
        <geom type="sphere" size="0.1" contype="0"/><geom type="sphere" size="0.2" conaffinity="0"/>
        <geom type="sphere" size="0.3" contype="0" conaffinity="0"/>
        <geom type="box" size="0.1" fromto="0 0 0 0 0 1"/><geom type="box" size="0.1 0.2" fromto="0 0 0 0 0 1"/>
        </body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "contacts.xml").unwrap();
    let link = robot.link(robot.model().frame("b").unwrap()).unwrap();
    let collisions = link.collisions.iter().map(|shape| shape.geometry.clone());
    let sphere = |radius| Geometry::Sphere { radius };
    let along = |x, y| Geometry::Box { size: [x, y, 1.0] };
    let expected = [sphere(0.1), sphere(0.2), along(0.2, 0.2), along(0.2, 0.4)];
    assert_eq!(collisions.collect::<Vec<_>>(), expected);
}

/// A document written with its includes is equivalent, whatever characters its names have.
#[test]
fn quoted_names_survive_includes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/robot/mjcf/files/quoted.xml");
    let text = Robot::mjcf_reader().text_with_includes(path).unwrap();
    let [whole, read] = [
        Robot::parse_mjcf(&text, "whole.xml").unwrap(),
        Robot::read(path).unwrap(),
    ];
    assert!(read.model().frame("a \"b\" <c> &quot;").is_ok());
    assert_eq!(
        whole.model().joint("say 'when'"),
        read.model().joint("say 'when'")
    );
    let names = |robot: &Robot| -> Vec<String> {
        let frames = robot.model().frames().iter();
        frames.map(|frame| frame.name.clone()).collect()
    };
    assert_eq!(names(&whole), names(&read));
}
