//! Promise: motions at a tiny distance along a ceiling, box, sphere or hull are reported as free only as far as they
//! are. A few hundred samples check them.

use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_exp};
use support::random::Random;

/// An obstacle that is approached from 3 m, with its near side towards the arm.
fn world(round: usize, random: &mut Random) -> World {
    let mut world = World::new();
    let at = Placement::identity();
    match round % 4 {
        0 => world.add_plane("near", at),
        1 => world.add_box("near", [0.6, 0.5, 0.4], at),
        2 => world.add_sphere("near", 0.4, at),
        _ => {
            let points = (0..200).map(|_| Vector3::from(random.direction().into_inner() * 0.5));
            let hull = Shape::convex(&points.collect::<Vec<_>>()).unwrap();
            world.add("near", hull, at)
        }
    }
    .unwrap();
    world
}

#[test]
fn grazing_motion_is_free_as_reported() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let plain = Checker::of(&robot).unwrap();
    let limits: Vec<_> = robot.model().limits().collect();
    let mut random = Random::new(5);
    let mut workspace = plain.workspace();
    let (mut free, mut blocked) = (0, 0);
    for round in 0..48 {
        let q: Vec<f64> = (limits.iter())
            .map(|joint| random.within(0.6 * joint.lower, 0.6 * joint.upper))
            .collect();
        let by = [0.02, 0.1, 0.4][round % 3];
        let to: Vec<f64> = (q.iter().zip(&limits))
            .map(|(q, joint)| (q + random.within(-by, by)).clamp(joint.lower, joint.upper))
            .collect();
        let mut world = world(round, &mut random);
        let side = random.direction().into_inner();
        let side = Vector3::new(side.x, side.y, 0.5 * side.z.abs());
        let over = Vector3::new(0.0, 0.0, 0.4);
        // Upside down: below it is what is above it.
        let down = Matrix3::identity().rotated_about_x((0.0, -1.0));
        let mut nearer_by = |metres: f64| {
            let at = match round % 4 {
                0 => Placement::new(down, Vector3::new(0.0, 0.0, 3.0 - metres)),
                _ => Placement::translation(side * (3.0 - metres) + over),
            };
            world.move_to("near", at).unwrap();
            plain.clone().with_world(&world).unwrap()
        };
        if !plain.is_free(&mut workspace, &q).unwrap() {
            continue;
        }
        let (mut low, mut high) = (0.0, 3.0);
        for _ in 0..22 {
            let middle = 0.5 * (low + high);
            match nearer_by(middle).is_free(&mut workspace, &q).unwrap() {
                true => low = middle,
                false => high = middle,
            }
        }
        let checker = nearer_by(low - 1e-5);
        let motion = checker.check_motion(&mut workspace, &q, &to).unwrap();
        let mut between = q.clone();
        for step in 0..=300 {
            let share = motion.free * f64::from(step) / 300.0;
            (robot.model().interpolate(&q, &to, share, &mut between)).unwrap();
            let is_free = checker.is_free(&mut workspace, &between).unwrap();
            assert!(is_free, "round {round}: {motion:?}, {share}");
        }
        match &motion.blocked_by {
            None => free += 1,
            Some(pair) => {
                assert!(pair.distance < 1e-6, "round {round}: {pair:?}");
                blocked += 1;
            }
        }
    }
    assert!(free > 3 && blocked > 3, "{free} free, {blocked} blocked");
}

/// A revolute joint with a prismatic joint on it, with a sphere at its end or a paddle about its centre.
fn polar(paddle: bool) -> Checker {
    let mut builder = Model::builder("polar");
    let (at, turns) = (Placement::identity(), Limits::new(-3.0, 3.0));
    let [x, _, z] = Vector3::UNITS;
    let turn = builder.revolute("turn", None, at, z, turns);
    let out = builder.prismatic("out", Some(turn), at, x, Limits::new(0.0, 2.0));
    let link = builder.frame("link", Some(out), at);
    let model = builder.build().unwrap();
    let shape = match paddle {
        true => Shape::cuboid([0.6, 0.05, 0.05]),
        false => Shape::sphere(0.05),
    };
    let object = CollisionObject::new("end", link, at, shape.unwrap());
    Checker::new(CollisionModel::new(&model, vec![object]).unwrap())
}

/// While the prismatic joint extends, the rotation lowers its end to the ground and raises it again. The end is 0.5 mm
/// above the ground at both ends, and as much below in between. The curvature comes from the prismatic motion on the
/// rotation.
#[test]
fn motion_dipping_into_the_ground_is_stopped() {
    let plain = polar(false);
    let height = |t: f64| (0.3 + t) * (0.02 * t - 0.026).sin();
    let lowest = (0..=1000).map(|k| height(f64::from(k) / 1000.0));
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let (from, to) = ([-0.026, 0.3], [-0.006, 1.3]);
    // The plane's z axis is up, along y.
    let up = Matrix3::identity().rotated_about_x((-1.0, 0.0));
    for (deep, is_free) in [(4e-4, false), (1e-5, false), (-1e-5, true)] {
        let mut world = World::new();
        let ground = Vector3::new(0.0, lowest - 0.05 + deep, 0.0);
        world
            .add_plane("ground", Placement::new(up, ground))
            .unwrap();
        let checker = plain.clone().with_world(&world).unwrap();
        let mut workspace = checker.workspace();
        for (from, to) in [(from, to), (to, from)] {
            assert!(checker.is_free(&mut workspace, &from).unwrap(), "{deep}");
            let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
            assert_eq!(motion.blocked_by.is_none(), is_free, "{deep}: {motion:?}");
        }
    }
}

/// The ends of a paddle that rotates about its fixed centre sweep an area.
#[test]
fn rotation_about_the_centre_sweeps() {
    let plain = polar(true);
    let mut world = World::new();
    let pole = Vector3::new(0.2, 0.2, 0.0);
    world.add_cylinder("pole", 0.02, 1.0, pole).unwrap();
    let checker = plain.with_world(&world).unwrap();
    let mut workspace = checker.workspace();
    let (from, to) = ([0.0, 0.0], [std::f64::consts::FRAC_PI_2, 0.0]);
    for (from, to) in [(from, to), (to, from)] {
        assert!(checker.is_free(&mut workspace, &from).unwrap());
        let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
        assert_eq!(motion.blocked_by.unwrap().second, "pole");
        assert!(motion.free < 0.5, "{}", motion.free);
    }
}

/// The same on a ball joint, about an axis of its frame and about others.
#[test]
fn rotation_of_a_ball_joint_sweeps() {
    let mut builder = Model::builder("ball");
    let at = Placement::identity();
    let ball = builder.ball("ball", None, at, Vector3::UNITS[0], None);
    let link = builder.frame("link", Some(ball), at);
    let model = builder.build().unwrap();
    let paddle = Shape::cuboid([0.6, 0.05, 0.05]).unwrap();
    let paddle = CollisionObject::new("paddle", link, at, paddle);
    let plain = Checker::new(CollisionModel::new(&model, vec![paddle]).unwrap());
    let up = [0.0, 0.0, 1.0];
    for (axis, turn) in [(up, 0.5), (up, 1.6), (up, 3.0), ([0.3, 0.2, 0.9], 3.0)] {
        let axis = Vector3::from(axis);
        let axis = axis * (1.0 / axis.norm());
        let turned = |angle: f64| -> [f64; 4] {
            let (v, w) = (axis * (0.5 * angle).sin(), (0.5 * angle).cos());
            [w, v.x, v.y, v.z]
        };
        let end = |angle: f64| rotation_exp(axis * angle) * Vector3::UNITS[0];
        let mut world = World::new();
        let pole = end(0.5 * turn) * 0.25;
        world.add_sphere("pole", 0.02, pole).unwrap();
        let checker = plain.clone().with_world(&world).unwrap();
        let mut workspace = checker.workspace();
        for (from, to) in [(0.0, turn), (turn, 0.0)] {
            let (from, to) = (turned(from), turned(to));
            assert!(checker.is_free(&mut workspace, &from).unwrap());
            let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
            assert!(
                motion.blocked_by.is_some() && motion.free < 0.5,
                "{turn}: {motion:?}"
            );
        }
    }
}

/// A hub on its pin rotates with an arm on it. Its penetration is constant up to rounding, while the arm sweeps far.
#[test]
fn motion_in_deep_contact_proceeds_slightly() {
    let mut builder = Model::builder("hub");
    let turns = Limits::new(-3.0, 3.0);
    let (up, at) = (Vector3::UNITS[2], Placement::identity());
    let pin = builder.frame("pin", None, at);
    let first = builder.revolute("first", None, at, up, turns);
    let second = builder.revolute("second", Some(first), at, up, turns);
    let hub = builder.frame("hub", Some(second), at);
    let model = builder.build().unwrap();
    let ball = |link, x: f64, radius: f64| {
        let at = Vector3::new(x, 0.0, 0.0);
        CollisionObject::new(format!("{x}"), link, at, Shape::sphere(radius).unwrap())
    };
    let shapes = vec![
        ball(pin, 0.0, 0.2),
        ball(pin, -1.0, 0.1),
        ball(hub, 0.0, 0.1),
        ball(hub, 3.0, 0.1),
    ];
    let bodies = CollisionModel::new(&model, shapes).unwrap();
    let checker = Checker::new(bodies.with_checked("pin", "hub").unwrap());
    let mut workspace = checker.workspace();
    let (from, to) = ([0.0, 0.0], [1.5, 1.5]);
    assert!(
        checker
            .check_motion(&mut workspace, &from, &to)
            .unwrap()
            .free
            == 0.0
    );
    let motion = checker
        .way_from_contact(&mut workspace, &from, &to)
        .unwrap();
    assert!(
        (motion.initial_penetration - 0.3).abs() < 1e-9,
        "{motion:?}"
    );
    assert!(
        motion.free > 1e-4 && motion.blocked_by.is_some(),
        "{motion:?}"
    );
    // As far as an arm moves in a cycle the motion is free.
    let near = [1e-4, 1e-4];
    let motion = checker
        .way_from_contact(&mut workspace, &from, &near)
        .unwrap();
    assert!(
        motion.free == 1.0 && motion.blocked_by.is_none(),
        "{motion:?}"
    );
}
