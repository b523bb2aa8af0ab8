//! Promise: sphere models are read and written as others have them.

use kinopt::collision::{CollisionModel, Fineness, SphereModel};
use kinopt::robot::Robot;
use support::arms::robot;

/// As in cuRobo's own files: nested, with comments, flow and block style, and a sphere that is turned off.
const CUROBO: &str = "
robot_cfg:
  kinematics:
    collision_link_names: [base, hand]
    collision_spheres: # by link
      base:
        - \"center\": [0.0, -0.01, 0.05]
          \"radius\": 0.12
      hand:
        - center:
          - 0.0
          - 1e-2
          - .03
          radius: 5.0e-2
        - {center: [0, 0, 0.1], radius: -0.01}
";

#[test]
fn curobo_spheres_are_read() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    let spheres = SphereModel::parse(CUROBO.as_bytes(), "franka.yml", &shapes).unwrap();
    let [base, hand] = spheres.groups() else {
        panic!("{spheres:?}");
    };
    assert_eq!((base.name.as_str(), base.spheres[0].radius), ("base", 0.12));
    assert_eq!(hand.spheres.len(), 1);
    assert_eq!(hand.spheres[0].centre.to_array(), [0.0, 0.01, 0.03]);
    assert_eq!(spheres.pairs(), [[0, 1]]);
    // The hand is a capsule of radius 0.033 along y at z = 0.03: 0.05 - 0.033. The base is a box 0.14 high and 0.19
    // wide, its middle at x = -0.035 and z = 0.07: 0.05 from the bottom, 0.12 - 0.05.
    assert!(
        (spheres.overhang() - 0.07).abs() < 1e-12,
        "{}",
        spheres.overhang()
    );
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    let told = |text: &str, file: &str| {
        let read = SphereModel::parse(text.as_bytes(), file, &shapes);
        read.unwrap_err().to_string()
    };
    let head = "collision_spheres:\n";
    assert!(told("a: 1\n", "s.yml").contains("s.yml: has no `collision_spheres`"));
    assert!(
        told(
            &format!("{head}  palm:\n    - {{center: [0, 0, 0], radius: 1}}\n"),
            "s.yml"
        )
        .contains("`palm`")
    );
    assert!(
        told(
            &format!("{head}  hand:\n    - center: [0, 0]\n      radius: 1\n"),
            "s.yml"
        )
        .contains("line 3")
    );
    assert!(
        told(
            &format!("{head}  hand:\n    - center: [0, 0, .nan]\n      radius: 1\n"),
            "s.yml"
        )
        .contains("three finite")
    );
    assert!(
        told(
            &format!("{head}  hand:\n    - center: [0, 0, 0]\n"),
            "s.yml"
        )
        .contains("needs a `radius`")
    );
    assert!(told("", "s.txt").contains(".yaml or .urdf"));
    let cylinder = r#"<robot name="r"><link name="hand"><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"#;
    assert!(told(cylinder, "s.urdf").contains("`hand` has a collision shape that is no sphere"));
}

#[test]
fn both_formats_give_back_the_same_spheres() {
    let path = "models/franka_panda.urdf";
    let robot = robot("franka_panda");
    let shapes = CollisionModel::of(&robot).unwrap();
    let spheres = SphereModel::of(&shapes, Fineness::Overhang(0.05)).unwrap();
    let yaml = spheres.to_yaml();
    let again = SphereModel::parse(yaml.as_bytes(), "s.yaml", &shapes).unwrap();
    assert_eq!(again.groups(), spheres.groups());
    assert_eq!(again.pairs(), spheres.pairs());

    let urdf = std::fs::read_to_string(path).unwrap();
    let spherised = spheres.spherised(&urdf, path).unwrap();
    let again = SphereModel::parse(spherised.as_bytes(), "s.urdf", &shapes).unwrap();
    assert_eq!(again.groups(), spheres.groups());
    // All else is as it was.
    let read = Robot::parse(&spherised, "s.urdf").unwrap();
    assert_eq!(read.mimics(), robot.mimics());
    for frame in robot.model().frame_ids() {
        let links = [&robot, &read].map(|robot| robot.link(frame).unwrap());
        assert_eq!(links[0].visuals, links[1].visuals);
        assert_eq!(links[0].inertial, links[1].inertial);
    }
}

#[test]
fn disabled_pairs_go_through_srdf() {
    let robot = robot("franka_panda");
    let shapes = CollisionModel::of(&robot).unwrap();
    let edited = shapes.clone().with_pairs_sampled(300, 3).unwrap();
    let edited = edited.with_ignored("base", "link5").unwrap();
    let text = edited.to_srdf();
    assert!(
        text.contains(r#"link1="link1" link2="link2" reason="Adjacent""#),
        "{text}"
    );
    let srdf = kinopt::robot::Srdf::parse(&text, "panda.srdf", &robot).unwrap();
    assert_eq!(shapes.with_srdf(&srdf).pairs(), edited.pairs());
}
