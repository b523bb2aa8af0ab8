//! Promise: a path of an arm that avoids collisions is collision-free at its points, and reports steps that are not
//! certainly free.

use kinopt::Arm;
use kinopt::arm::PoseBounds;
use kinopt::collision::{Checker, CollisionModel, Resolution, SphereModel, World};
use kinopt::motion::path::{CartesianPath, MissReason, PathError, PathSolver};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::checked_arms::panda_in;

const Q: [f64; 7] = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];

fn sideways(arm: &Arm, steps: u32) -> Vec<Placement<f64>> {
    let begin = arm.base_from_tool(&Q).unwrap();
    let along = |k: u32| Vector3::new(0.0, 0.3 * f64::from(k) / f64::from(steps) - 0.15, 0.0);
    let point = |k: u32| Placement::new(begin.rotation, begin.translation + along(k));
    (0..=steps).map(point).collect()
}

/// True if none of 11 samples between two configurations is in collision.
fn is_free_between(arm: &Arm, from: &[f64], to: &[f64]) -> bool {
    (0..=10).all(|k| {
        let share = f64::from(k) / 10.0;
        let moves = from.iter().zip(to);
        let q: Vec<f64> = moves.map(|(a, b)| a + share * (b - a)).collect();
        arm.collisions(&q).unwrap().is_empty()
    })
}

#[test]
fn elbow_avoids_an_obstacle() {
    let alone = panda_in(&World::new());
    let points = sideways(&alone, 60);
    let path = CartesianPath::new(points).unwrap();
    let plain = PathSolver::new(&alone).solve(&path).unwrap();
    assert!(plain.reached());
    // A ball at the elbow's position, for the whole path.
    let mut world = World::new();
    world
        .add_sphere("ball", 0.08, Vector3::new(-0.25, 0.0, 0.65))
        .unwrap();
    let arm = panda_in(&world);
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert!(solution.report.missed.is_empty() && solution.report.blocked.is_empty());
    let rows: Vec<&[f64]> = solution.rows().collect();
    for (row, pair) in rows.windows(2).enumerate() {
        let jumps = solution
            .jumps
            .iter()
            .any(|reported| reported.index == row + 1);
        assert!(jumps || is_free_between(&arm, pair[0], pair[1]), "{row}");
    }
}

/// A path does not begin or end in a given configuration that is in collision.
#[test]
fn end_in_collision_is_rejected() {
    let alone = panda_in(&World::new());
    let path = CartesianPath::new(sideways(&alone, 2)).unwrap();
    let rows = PathSolver::new(&alone).solve(&path).unwrap();
    let ends = [rows.rows().next().unwrap(), rows.rows().last().unwrap()];
    let mut world = World::new();
    world
        .add_sphere("ball", 0.3, Vector3::new(0.0, 0.0, 0.8))
        .unwrap();
    let arm = panda_in(&world);
    for end in ends {
        assert!(!arm.collisions(end).unwrap().is_empty());
    }
    let begun = |arm: &Arm| {
        PathSolver::new(arm)
            .with_start(ends[0])
            .solve(&path)
            .map(|_| ())
    };
    let ended = |arm: &Arm| {
        PathSolver::new(arm)
            .with_end(ends[1])
            .solve(&path)
            .map(|_| ())
    };
    assert!(begun(&alone).is_ok() && ended(&alone).is_ok());
    assert!(matches!(
        begun(&arm),
        Err(PathError::End { which: "start", .. })
    ));
    assert!(matches!(
        ended(&arm),
        Err(PathError::End { which: "end", .. })
    ));
}

/// Three prismatic joints and a cube of 20 cm.
const GANTRY: &str = r#"<robot name="gantry"><link name="base"/><link name="bridge"/><link name="trolley"/>
    <link name="cube"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
    <joint name="x" type="prismatic"><parent link="base"/><child link="bridge"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="y" type="prismatic"><parent link="bridge"/><child link="trolley"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="z" type="prismatic"><parent link="trolley"/><child link="cube"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    </robot>"#;

/// Of two elbow branches, the one nearer to the middle of its limits is in collision. The other is free by its shapes,
/// but not by its spheres.
#[test]
fn branch_free_by_its_shapes_is_found() {
    let link = |name: &str| {
        format!(
            r#"<link name="{name}"><collision><origin xyz="0.25 0 0"/><geometry><box size="0.4 0.04 0.04"/></geometry></collision></link>"#
        )
    };
    let turns = |name: &str, parent: &str, child: &str, x: f64, [low, high]: [f64; 2]| {
        format!(
            r#"<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="{x} 0 0"/><axis xyz="0 0 1"/>
            <limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint>"#
        )
    };
    let text = [
        r#"<robot name="elbow"><link name="base"/><link name="tool"/>"#,
        &link("upper"),
        &link("fore"),
        &turns("shoulder", "base", "upper", 0.0, [-2.0, 2.0]),
        &turns("elbow", "upper", "fore", 0.5, [-2.0, 2.8]),
        r#"<joint name="wrist" type="fixed"><parent link="fore"/><child link="tool"/><origin xyz="0.5 0 0"/></joint></robot>"#,
    ];
    let robot = Robot::parse(&text.concat(), "elbow.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.05)).unwrap();
    let arm = Arm::builder(&robot, "base", "tool").with_goal(PoseBounds::position());
    let arm = arm.build().unwrap();
    let points = (0..5).map(|k| {
        let x = 0.8 + 0.002 * f64::from(k);
        Placement::translation(Vector3::new(x, 0.0, 0.0))
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let mut world = World::new();
    // Below the elbow that is bent to the left, and one millimetre from the elbow bent to the right.
    world
        .add_box("below", [0.1, 0.05, 0.1], Vector3::new(0.4, -0.3, 0.0))
        .unwrap();
    world
        .add_box("above", [0.3, 0.2, 0.1], Vector3::new(0.4, 0.387, 0.0))
        .unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let checker = checker.with_world(&world).unwrap();
    let arm = arm.with_checker(&checker, &[0.0; 2]).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    let q: Vec<&[f64]> = solution.rows().collect();
    let mut clear = [false; 5];
    arm.clear_by_spheres(&q.concat(), &mut clear).unwrap();
    assert!(
        solution.reached(),
        "{:?} {q:?} {clear:?}",
        solution.report.missed
    );
    assert_eq!(clear, [false; 5]);
}

/// The spheres around a cube penetrate a wall that the cube passes at a distance of a millimetre.
#[test]
fn shapes_decide_where_spheres_touch() {
    let robot = Robot::parse(GANTRY, "gantry.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
    let arm = Arm::builder(&robot, "base", "cube").with_goal(PoseBounds::position());
    let arm = arm.build().unwrap();
    let along = (0..=40).map(|k| {
        let y = 0.015 * f64::from(k) - 0.3;
        Placement::translation(Vector3::new(0.5, y, 0.1))
    });
    let path = CartesianPath::new(along.collect::<Vec<_>>()).unwrap();
    for (gap, free) in [(0.001, true), (-0.001, false)] {
        let mut world = World::new();
        let wall = Vector3::new(0.5 + 0.1 + gap + 0.05, 0.0, 0.0);
        world.add_box("wall", [0.1, 4.0, 4.0], wall).unwrap();
        let checker = Checker::new(bodies.clone()).with_spheres(spheres.clone());
        let checker = checker.with_world(&world).unwrap();
        let arm = arm.clone().with_checker(&checker, &[0.0; 3]).unwrap();
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert_eq!(solution.reached(), free, "{:?}", solution.report.missed);
        let mut clear = [false];
        arm.clear_by_spheres(&[0.5, 0.0, 0.1], &mut clear).unwrap();
        assert_eq!(clear, [false]);
    }
}

#[test]
fn unavoidable_contact_is_reported() {
    let alone = panda_in(&World::new());
    let points = sideways(&alone, 60);
    let middle = points[30].translation;
    let mut world = World::new();
    world.add_sphere("stone", 0.02, middle).unwrap();
    let arm = panda_in(&world);
    let path = CartesianPath::new(points).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    let at_stone = solution
        .report
        .missed
        .iter()
        .find(|missed| missed.index == 30)
        .unwrap();
    assert!(matches!(&at_stone.reason, MissReason::Touches(pair) if pair.second == "stone"));
    assert!(
        solution
            .report
            .missed
            .iter()
            .all(|missed| missed.index.abs_diff(30) < 25)
    );
    for (row, q) in solution.rows().enumerate() {
        let reported = solution
            .report
            .missed
            .iter()
            .any(|missed| missed.index == row);
        assert_eq!(arm.collisions(q).unwrap().is_empty(), !reported, "{row}");
    }
}

/// Small balls next to the links of an arm that follows a path in steps of a millimetre. Some balls are touched only at
/// points between those at which branches are compared.
#[test]
fn reported_contacts_have_no_easily_found_solution() {
    let alone = panda_in(&World::new());
    let points = sideways(&alone, 300);
    let path = CartesianPath::new(points.clone()).unwrap();
    let plain = PathSolver::new(&alone).solve(&path).unwrap();
    let model = robot("franka_panda").model().clone();
    let mut kinematics = kinopt::kinematics::ForwardKinematics::new(&model);
    let mut random = support::random::Random::new(15);
    let mut reported = 0;
    for _ in 0..12 {
        let row = random.below(300);
        let q = plain.rows().nth(row).unwrap();
        let placed = kinematics.place(&[q, &[0.0; 2]].concat()).unwrap();
        let link = model
            .frame(["link3", "link4", "link5"][random.below(3)])
            .unwrap();
        let direction = Vector3::from([(); 3].map(|()| random.within(-1.0, 1.0)));
        let direction = direction * direction.norm().recip();
        let at = placed[link.index()].translation + direction * (0.07 + 0.04 * random.unit());
        let mut world = World::new();
        world.add_sphere("ball", 0.01, at).unwrap();
        let arm = panda_in(&world);
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        for missed in &solution.report.missed {
            reported += 1;
            let free = arm.solve(points[missed.index], &Q).unwrap();
            assert!(
                !free.reached,
                "row {} of a ball beside row {row} at {at:?}",
                missed.index
            );
        }
    }
    assert!(reported > 0);
}

/// Walls between two points that cannot be avoided: the first one is reported, and the path is not whole.
#[test]
fn wall_between_two_points_is_reported() {
    use kinopt::arm::PoseBounds;
    use kinopt::model::{Limits, Model};
    use kinopt::robot::Robot;
    let mut builder = Model::builder("gantry");
    let origin = Placement::identity();
    let [x, y, _] = Vector3::UNITS;
    let rail = Limits::new(0.0, 1.0);
    builder.frame("base", None, origin);
    let along = builder.prismatic("along", None, origin, x, rail);
    let aside = builder.prismatic("aside", Some(along), origin, y, rail);
    builder.frame("tool", Some(aside), origin);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let mut world = World::new();
    world.add_sphere("ball", 0.004, Vector3::zero()).unwrap();
    world.attach("ball", "tool", Vector3::zero()).unwrap();
    for (wall, x) in [("near wall", 0.493), ("far wall", 0.507)] {
        let wall_at = Vector3::new(x, 0.5, 0.0);
        world.add_box(wall, [0.004, 2.0, 1.0], wall_at).unwrap();
    }
    let checker = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    let arm = Arm::builder(&robot, "base", "tool").with_goal(PoseBounds::position());
    let arm = arm.with_atlas(false).build().unwrap();
    let arm = arm.with_checker(&checker, &[0.0; 2]).unwrap();
    let points = |from: f64, by: f64| -> CartesianPath {
        let position_at = |k: u32| Vector3::new(from + by * f64::from(k), 0.3, 0.0);
        let points = (0..10).map(|k| Placement::translation(position_at(k)));
        CartesianPath::new(points.collect::<Vec<_>>()).unwrap()
    };
    let free = PathSolver::new(&arm).solve(&points(0.05, 0.04)).unwrap();
    assert!(free.reached(), "{free:?}");
    // From 0.48 to 0.52 m in the seventh step, and back in the third.
    for (path, index, wall) in [
        (points(0.24, 0.04), 7, "near wall"),
        (points(0.6, -0.04), 3, "far wall"),
    ] {
        let through = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(through.report.missed.is_empty() && through.jumps.is_empty());
        let [blocked] = &through.report.blocked[..] else {
            panic!("{:?}", through.report.blocked)
        };
        assert_eq!(blocked.index, index);
        let mut names = [&*blocked.by.first, &*blocked.by.second];
        names.sort_unstable();
        assert_eq!(names, ["ball", wall]);
        assert!(!through.reached());
    }
}
