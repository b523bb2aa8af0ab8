//! Promise: of a way along a ceiling, a box, a ball or a hull, a hair's breadth away, no more is said to be free than is: it is looked at in a
//! few hundred places.

use kinopt::collision::{Checker, Shape, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::random::Random;

/// What comes near, three metres away, turned towards the arm.
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
fn what_slides_along_something_is_free_as_far_as_is_said() {
    let robot = Robot::read("models/franka_panda.urdf").unwrap();
    let own = Checker::of(&robot).unwrap();
    let limits: Vec<_> = robot.model().limits().collect();
    let mut random = Random::new(5);
    let mut workspace = own.workspace();
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
            own.clone().with_world(&world).unwrap()
        };
        if !own.is_free(&mut workspace, &q).unwrap() {
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
        let way = checker.way(&mut workspace, &q, &to).unwrap();
        let mut between = q.clone();
        for step in 0..=300 {
            let share = way.free * f64::from(step) / 300.0;
            (robot.model().interpolate(&q, &to, share, &mut between)).unwrap();
            let is_free = checker.is_free(&mut workspace, &between).unwrap();
            assert!(is_free, "round {round}: {way:?}, {share}");
        }
        match &way.blocked_by {
            None => free += 1,
            Some(by) => {
                assert!(by.distance < 1e-6, "round {round}: {by:?}");
                blocked += 1;
            }
        }
    }
    assert!(free > 3 && blocked > 3, "{free} free, {blocked} blocked");
}
