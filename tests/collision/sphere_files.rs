//! Promise: sphere models are read and written in the formats of other tools.

use kinopt::Arm;
use kinopt::collision::{Checker, CollisionModel, Resolution, Shape, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::checked_arms::add_boxes;
use support::fault_tables::ExpectedError;
use support::random::{Random, cases};

use crate::sphere_covers::one_link;

/// As in cuRobo's files: nested, with comments, flow and block style, and a disabled sphere.
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
    let [note] = spheres.notes() else {
        panic!("{:?}", spheres.notes());
    };
    assert!(
        note.contains("`hand`") && note.contains("1 sphere") && note.contains("cuRobo"),
        "{note}"
    );
    assert_eq!(hand.spheres[0].centre.to_array(), [0.0, 0.01, 0.03]);
    assert_eq!(spheres.pairs(), [[0, 1]]);
    // The hand is a capsule of radius 0.033 along y at z = 0.03: 0.05 - 0.033. The base is a box 0.14 high and 0.19
    // wide, centred at x = -0.035 and z = 0.07: 0.05 from the bottom, 0.12 - 0.05.
    assert!(
        (spheres.max_protrusion() - 0.07).abs() < 1e-12,
        "{}",
        spheres.max_protrusion()
    );
}

#[test]
fn errors_name_the_line() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    let reported = |text: &str, file: &str| {
        let read = SphereModel::parse(text.as_bytes(), file, &shapes);
        read.unwrap_err().to_string()
    };
    let head = "collision_spheres:\n";
    assert!(reported("a: 1\n", "s.yml").contains("s.yml: has no `collision_spheres`"));
    assert!(
        reported(
            &format!("{head}  palm:\n    - {{center: [0, 0, 0], radius: 1}}\n"),
            "s.yml"
        )
        .contains("`palm`")
    );
    assert!(
        reported(
            &format!("{head}  hand:\n    - center: [0, 0]\n      radius: 1\n"),
            "s.yml"
        )
        .contains("line 3")
    );
    assert!(
        reported(
            &format!("{head}  hand:\n    - center: [0, 0, .nan]\n      radius: 1\n"),
            "s.yml"
        )
        .contains("three finite")
    );
    assert!(
        reported(
            &format!("{head}  hand:\n    - center: [0, 0, 0]\n"),
            "s.yml"
        )
        .contains("needs a `radius`")
    );
    assert!(reported("", "s.txt").contains(".yaml or .urdf"));
    let cylinder = r#"<robot name="r"><link name="hand"><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"#;
    assert!(
        reported(cylinder, "s.urdf").contains("`hand` has a collision shape that is not a sphere")
    );
}

#[test]
fn both_formats_round_trip() {
    let path = "../models/franka_panda.urdf";
    let robot = robot("franka_panda");
    let shapes = CollisionModel::of(&robot).unwrap();
    let spheres = SphereModel::of(&shapes, Resolution::MaxProtrusion(0.05)).unwrap();
    let yaml = spheres.to_yaml();
    let again = SphereModel::parse(yaml.as_bytes(), "s.yaml", &shapes).unwrap();
    assert_eq!(again.groups(), spheres.groups());
    assert_eq!(again.pairs(), spheres.pairs());

    let urdf = std::fs::read_to_string(path).unwrap();
    let spherised = spheres.spherised(&urdf, path).unwrap();
    let again = SphereModel::parse(spherised.as_bytes(), "s.urdf", &shapes).unwrap();
    assert_eq!(again.groups(), spheres.groups());
    // Everything else is unchanged.
    let read = Robot::parse(&spherised, "s.urdf").unwrap();
    assert_eq!(read.mimics(), robot.mimics());
    for frame in robot.model().frame_ids() {
        let links = [&robot, &read].map(|robot| robot.link(frame).unwrap());
        assert_eq!(links[0].visuals, links[1].visuals);
        assert_eq!(links[0].inertial, links[1].inertial);
    }
}

#[test]
fn disabled_pairs_round_trip_through_srdf() {
    let robot = robot("franka_panda");
    let shapes = CollisionModel::of(&robot).unwrap();
    let edited = shapes.clone().with_pairs_sampled(300, 3).unwrap();
    let edited = edited.with_ignored("base", "link5").unwrap();
    let text = edited.to_srdf();
    assert!(
        text.contains(r#"link1="link1" link2="link2" reason="Adjacent""#),
        "{text}"
    );
    // Pairs that are disabled without being neighbours have the reason `User`.
    assert!(
        text.contains(r#"link1="base" link2="link5" reason="User""#),
        "{text}"
    );
    let srdf = kinopt::robot::Srdf::parse(&text, "panda.srdf", &robot).unwrap();
    assert_eq!(shapes.with_srdf(&srdf).pairs(), edited.pairs());
}

/// Sphere file of a Panda, each sphere a third too small.
fn small_spheres(shapes: &CollisionModel) -> String {
    let spheres = SphereModel::of(shapes, Resolution::MaxProtrusion(0.03)).unwrap();
    let mut text = "collision_spheres:\n".to_owned();
    for group in spheres.groups() {
        text.push_str(&format!("  {}:\n", group.name));
        for ball in &group.spheres {
            let [x, y, z] = ball.centre.to_array();
            let radius = 0.67 * ball.radius;
            text.push_str(&format!(
                "    - {{center: [{x}, {y}, {z}], radius: {radius}}}\n"
            ));
        }
    }
    text
}

#[test]
fn reported_gap_bounds_the_uncovered_part() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    let text = small_spheres(&shapes);
    let small = SphereModel::parse(text.as_bytes(), "s.yml", &shapes).unwrap();
    let mut random = Random::new(5);
    for group in small.groups() {
        let mut farthest = f64::NEG_INFINITY;
        for object in shapes.objects_of(group.link) {
            let bounds = object.shape.bounding_sphere();
            for _ in cases(20_000, 2_000) {
                // Nearest points of the shape to random points around it.
                let about = [(); 3].map(|()| bounds.radius * random.within(-1.2, 1.2));
                let point = bounds.centre + Vector3::from(about);
                let depth = -object.shape.signed_distance(point);
                if depth < 0.0 {
                    continue;
                }
                let at = object.link_from_shape.apply(point);
                let each = group.spheres.iter();
                let out = each.map(|ball| (at - ball.centre).norm() - ball.radius);
                farthest = farthest.max(out.fold(f64::INFINITY, f64::min));
            }
        }
        assert!(
            farthest <= group.gap,
            "{}: {farthest} {}",
            group.name,
            group.gap
        );
        assert!(
            group.gap < farthest + 0.02,
            "{}: {farthest} {}",
            group.name,
            group.gap
        );
    }
    assert!(small.gap() > 0.01);
    // Spheres that cover a shape leave no gap, for any shape.
    for name in ["franka_panda", "universal_ur5e", "kuka_iiwa14"] {
        let shapes = CollisionModel::of(&robot(name)).unwrap();
        let spheres = SphereModel::of(&shapes, Resolution::MaxProtrusion(0.03)).unwrap();
        let again = SphereModel::parse(spheres.to_yaml().as_bytes(), "s.yml", &shapes).unwrap();
        assert_eq!((again.gap(), spheres.gap()), (0.0, 0.0), "{name}");
    }
}

#[test]
fn arm_with_incomplete_spheres_uses_shapes() {
    let robot = robot("franka_panda");
    let shapes = CollisionModel::of(&robot).unwrap();
    let shapes = shapes.with_pairs_sampled(300, 1).unwrap();
    let text = small_spheres(&shapes);
    let small = SphereModel::parse(text.as_bytes(), "s.yml", &shapes).unwrap();
    // Gaps are stored with the spheres.
    assert!(small.gap() > 0.0);
    let json = serde_json::to_string(&small).unwrap();
    let again: SphereModel = serde_json::from_str(&json).unwrap();
    assert_eq!(again, small);
    assert_eq!(again.gap(), small.gap());
    let alone = Checker::new(shapes);
    let rest = robot.model().neutral();
    let mut random = Random::new(11);
    let (mut reached, mut workspace) = (0, alone.workspace());
    for _ in cases(60, 15) {
        let mut world = World::new();
        add_boxes(&mut world, &mut random);
        let by_shapes = alone.clone().with_world(&world).unwrap();
        let covered = by_shapes.clone().with_spheres(small.clone());
        let arm = Arm::new(&robot, "base", "flange").unwrap();
        let arm = arm.with_checker(&covered, &rest).unwrap();
        for _ in 0..4 {
            let [goal, start] = [(); 2].map(|()| random.configuration(&arm));
            let target = arm.base_from_tool(&goal).unwrap();
            let solution = arm.solve(target, &start).unwrap();
            if solution.reached {
                let mut q = rest.clone();
                arm.configuration(&solution.q, &mut q).unwrap();
                assert!(by_shapes.is_free(&mut workspace, &q).unwrap());
                reached += 1;
            }
        }
    }
    assert!(reached > 20, "{reached}");
}

/// Spheres on a capsule's axis that cover its side need not cover its ends.
#[test]
fn uncovered_capsule_ends_are_reported() {
    let text = r#"<robot name="rod"><link name="rod"><collision><geometry><capsule radius="0.1" length="0.4"/></geometry></collision></link></robot>"#;
    let robot = Robot::parse(text, "rod.urdf").unwrap();
    let shapes = CollisionModel::of(&robot).unwrap();
    let spheres = |out: f64| {
        let each =
            [-out, 0.0, out].map(|z| format!("    - {{center: [0, 0, {z}], radius: 0.16}}\n"));
        let text = format!("collision_spheres:\n  rod:\n{}", each.concat());
        SphereModel::parse(text.as_bytes(), "rod.yml", &shapes).unwrap()
    };
    // Each covers 0.125 of the axis on either side, so the whole axis. The ends are at 0.3, and the outer spheres reach
    // 0.27 or 0.31.
    assert!(
        (spheres(0.11).gap() - 0.03).abs() < 1e-3,
        "{}",
        spheres(0.11).gap()
    );
    assert_eq!(spheres(0.15).gap(), 0.0);
}

/// A mesh of two grains 1 m apart, whose centre is nearer to the covered one.
#[test]
fn far_uncovered_mesh_part_is_reported() {
    let grain = |base: f64, tip: f64| {
        let base = [[0.01, -0.01], [-0.01, -0.01], [0.0, 0.01]].map(|[y, z]| [base, y, z]);
        [base[0], base[1], base[2], [tip, 0.0, 0.0]].map(Vector3::from)
    };
    let corners = [grain(-0.5, -0.46), grain(0.5, 0.52)].concat();
    let sides = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
    let both = [0, 4].map(|first| sides.map(|side| side.map(|corner| corner + first)));
    let mesh = Shape::mesh(corners, both.concat()).unwrap();
    let shapes = one_link([(mesh, Placement::identity())]);
    let text = "collision_spheres:\n  link:\n    - {center: [-0.48, 0, 0], radius: 0.92}\n";
    let spheres = SphereModel::parse(text.as_bytes(), "s.yml", &shapes).unwrap();
    let gap = spheres.gap();
    assert!((0.08 - 1e-12..0.083).contains(&gap), "{gap}");
}

/// A row of spheres that covers a capsule exactly does so in any order.
#[test]
fn sphere_order_does_not_matter() {
    let text = r#"<robot name="rod"><link name="rod"><collision><geometry><capsule radius="0.1" length="0.9"/></geometry></collision></link></robot>"#;
    let robot = Robot::parse(text, "rod.urdf").unwrap();
    let shapes = CollisionModel::of(&robot).unwrap();
    let row = SphereModel::of(&shapes, Resolution::MaxProtrusion(0.02)).unwrap();
    let mut balls = row.groups()[0].spheres.clone();
    assert!(balls.len() > 5);
    for turned in 0..2 {
        balls.reverse();
        balls.rotate_left(2 * turned);
        let mut text = String::from("collision_spheres:\n  rod:\n");
        for ball in &balls {
            let ([x, y, z], radius) = (ball.centre.to_array(), ball.radius);
            text.push_str(&format!(
                "    - {{center: [{x}, {y}, {z}], radius: {radius}}}\n"
            ));
        }
        let read = SphereModel::parse(text.as_bytes(), "rod.yml", &shapes).unwrap();
        assert_eq!(read.gap(), 0.0, "{text}");
    }
}

/// A checker enlarges the spheres of a file to cover their gaps. The bounding sphere of a link contains the enlarged
/// spheres.
#[test]
fn enlarged_spheres_stay_in_their_bound() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    let text = small_spheres(&shapes);
    let small = SphereModel::parse(text.as_bytes(), "s.yml", &shapes).unwrap();
    let gaps: Vec<f64> = small.groups().iter().map(|group| group.gap).collect();
    let checker = Checker::new(shapes).with_spheres(small.clone());
    let grown = checker.spheres().unwrap();
    assert_eq!(grown.gap(), 0.0);
    let sticks_out = small.max_protrusion() + small.gap();
    assert!((grown.max_protrusion() - sticks_out).abs() < 1e-12 && small.gap() > 0.0);
    for ((group, small), gap) in grown.groups().iter().zip(small.groups()).zip(gaps) {
        for (ball, before) in group.spheres.iter().zip(&small.spheres) {
            assert_eq!(
                (ball.centre, ball.radius),
                (before.centre, before.radius + gap)
            );
            let out = (ball.centre - group.bound.centre).norm() + ball.radius;
            assert!(out <= group.bound.radius + 1e-12, "{}: {out}", group.name);
        }
    }
}

/// A capsule is covered only if both caps are.
#[test]
fn capsule_with_an_uncovered_cap_has_a_gap() {
    let robot = r#"<robot name="r"><link name="rod">
        <collision><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
        <collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.1"/></geometry></collision>
        <collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"#;
    let robot = Robot::parse(robot, "rod.urdf").unwrap();
    let shapes = CollisionModel::of(&robot).unwrap();
    // The middle sphere covers everything between the caps, each other one a cap.
    let middle = 0.05_f64.sqrt() + 1e-9;
    for ends in [vec![-0.2], vec![0.2], vec![-0.2, 0.2]] {
        let mut text = String::from("collision_spheres:\n  rod:\n");
        let balls = ends.iter().map(|at| (*at, 0.1)).chain([(0.0, middle)]);
        for (at, radius) in balls {
            text.push_str(&format!(
                "    - {{center: [0, 0, {at}], radius: {radius}}}\n"
            ));
        }
        let spheres = SphereModel::parse(text.as_bytes(), "rod.yml", &shapes).unwrap();
        let gap = if ends.len() == 2 { 0.0 } else { 0.3 - middle };
        let reported = spheres.gap();
        assert!(
            reported >= gap && reported < gap + 2e-3,
            "{ends:?}: {reported} {gap}"
        );
    }
}

#[test]
fn spheres_beyond_1e9_are_rejected() {
    let shapes = CollisionModel::of(&robot("franka_panda")).unwrap();
    for (from, to) in [
        ("0.12", "1e308"),
        ("0.12", "1e10"),
        ("-0.01", "-1e308"),
        ("0.05", "1e200"),
    ] {
        let text = CUROBO.replacen(from, to, 1);
        SphereModel::parse(text.as_bytes(), "franka.yml", &shapes).says("link ` | sphere 0");
    }
    let urdf = "<robot name='r'><link name='hand'><collision><origin xyz='1e300 0 0'/><geometry><sphere radius='1'/></geometry></collision></link></robot>";
    assert!(SphereModel::parse(urdf.as_bytes(), "spheres.urdf", &shapes).is_err());
}
