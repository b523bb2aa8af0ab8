//! Promise: shapes and masses are kept as in the file. Faults in them are noted and do not reject the robot.

use kinopt::robot::{Geometry, Link, Robot};
use kinopt::spatial::Placement;

const BODY: &str = r#"<robot name="one">
  <link name="body">
    <inertial><origin xyz="0.1 0 0.2" rpy="0 0 0"/><mass value="3.5"/>
      <inertia ixx="1" ixy="0.1" ixz="0.2" iyy="2" iyz="0.3" izz="3"/></inertial>
    <visual name="shell"><origin xyz="0 0 1"/>
      <geometry><mesh filename="package://robot/shell.dae" scale="0.001 0.001 0.001"/></geometry>
    </visual>
    <visual><geometry><sphere radius="0.5"/></geometry></visual>
    <collision><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
      <geometry><box size="1 2 3"/></geometry></collision>
    <collision><geometry><cylinder radius="0.1" length="2"/></geometry></collision>
    <collision><geometry><capsule radius="0.2" length="1"/></geometry></collision>
    <collision><geometry><mesh filename="hull.stl"/></geometry></collision>
  </link>
  <link name="bare"/>
  <joint name="j" type="continuous"><parent link="body"/><child link="bare"/></joint>
</robot>"#;

fn link(robot: &Robot, name: &str) -> Link {
    let frame = robot.model().frame(name).unwrap();
    robot.link(frame).unwrap().clone()
}

#[test]
fn shapes_and_masses_are_those_of_the_file() {
    let robot = Robot::parse(BODY, "one.urdf").unwrap();
    assert_eq!(robot.repairs(), []);
    let body = link(&robot, "body");
    let [shell, ball] = &body.visuals[..] else {
        unreachable!("two visuals")
    };
    assert_eq!(shell.name.as_deref(), Some("shell"));
    let at = shell.link_from_shape.translation.to_array();
    assert_eq!(at, [0.0, 0.0, 1.0]);
    let mesh = Geometry::Mesh {
        file: "package://robot/shell.dae".into(),
        scale: [0.001; 3],
    };
    assert_eq!(shell.geometry, mesh);
    assert_eq!(ball.geometry, Geometry::Sphere { radius: 0.5 });
    assert_eq!(
        (&ball.name, ball.link_from_shape),
        (&None, Placement::identity())
    );

    let shapes: Vec<_> = body.collisions.iter().map(|s| s.geometry.clone()).collect();
    let size = [1.0, 2.0, 3.0];
    let (file, scale) = ("hull.stl".to_owned(), [1.0; 3]);
    let expected = [
        Geometry::Box { size },
        Geometry::Cylinder {
            radius: 0.1,
            length: 2.0,
        },
        Geometry::Capsule {
            radius: 0.2,
            length: 1.0,
        },
        Geometry::Mesh { file, scale },
    ];
    assert_eq!(shapes, expected);
    // A quarter turn about z takes x to y.
    let turned = body.collisions[0].link_from_shape;
    assert_eq!(turned.rotation.x.to_array(), [0.0, 1.0, 0.0]);

    let inertial = body.inertial.unwrap();
    assert_eq!(inertial.mass, 3.5);
    let centre = inertial.link_from_inertia.translation.to_array();
    assert_eq!(centre, [0.1, 0.0, 0.2]);
    let moments = [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]];
    assert_eq!(inertial.moments, moments);
    assert_eq!(link(&robot, "bare"), Link::default());
}

/// As in other programs.
#[test]
fn first_of_two_inertials_applies() {
    let more = r#"<inertial><mass value="9"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual name="shell">"#;
    let text = BODY.replace(r#"<visual name="shell">"#, more);
    let robot = Robot::parse(&text, "two.urdf").unwrap();
    assert_eq!(link(&robot, "body").inertial.unwrap().mass, 3.5);
}

/// Relative mesh paths start from its folder.
#[test]
fn robot_knows_its_file() {
    let path = std::env::temp_dir().join(format!("kinopt-links-{}.urdf", std::process::id()));
    std::fs::write(&path, BODY).unwrap();
    for reader in [Robot::reader(), Robot::reader().lenient()] {
        assert_eq!(reader.read(&path).unwrap().file(), Some(path.as_path()));
        assert_eq!(reader.parse(BODY, "one.urdf").unwrap().file(), None);
    }
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn tool_is_not_a_link() {
    let robot = Robot::parse(BODY, "one.urdf").unwrap();
    let robot = robot
        .with_tool("tip", "bare", Placement::identity())
        .unwrap();
    let tip = robot.model().frame("tip").unwrap();
    assert_eq!(robot.link(tip), None);
    assert_eq!(link(&robot, "body").visuals.len(), 2);
}

#[test]
fn invalid_shapes_are_dropped_with_a_note() {
    for (from, to, note) in [
        (
            "<sphere radius=\"0.5\"/>",
            "<torus/>",
            "8: link `body`, <visual>: left out: <geometry> must contain one of box, cylinder, capsule, sphere, mesh",
        ),
        (
            "<sphere radius=\"0.5\"/>",
            "<sphere/>",
            "8: link `body`, <visual>: left out: attribute `radius` is missing or empty",
        ),
        (
            "<geometry><sphere radius=\"0.5\"/></geometry>",
            "",
            "8: link `body`, <visual>: left out: <geometry> is missing",
        ),
        (
            "value=\"3.5\"",
            "value=\"heavy\"",
            "3: link `body`, <inertial>: left out: attribute `value` must be 1 finite number(s), not `heavy`",
        ),
    ] {
        assert!(BODY.contains(from));
        let text = BODY.replacen(from, to, 1);
        for reader in [Robot::reader(), Robot::reader().lenient()] {
            let robot = reader.parse(&text, "one.urdf").unwrap();
            let notes: Vec<_> = robot.repairs().iter().map(ToString::to_string).collect();
            assert_eq!(notes, [note]);
            let body = link(&robot, "body");
            let shapes = body.visuals.len() + body.collisions.len();
            let complete = shapes == 6 && body.inertial.is_some();
            assert!(!complete && shapes + usize::from(body.inertial.is_some()) == 6);
        }
    }
}
