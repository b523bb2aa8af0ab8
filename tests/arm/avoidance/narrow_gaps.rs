//! Promise: null-space motion finds collision-free intervals between obstacles that are too narrow for random attempts.

use kinopt::Arm;
use kinopt::arm::Search;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::kinematics::ForwardKinematics;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::{Random, case_count};

/// Clearance of the arm from both spheres, metres.
const CLEARANCE: f64 = 3e-4;
const BALL_RADIUS: f64 = 0.6;

#[test]
fn elbow_fits_between_two_spheres() {
    let robot = robot("franka_panda");
    let model = robot.model();
    let bodies = CollisionModel::of(&robot).unwrap();
    let checker = Checker::covered(bodies.with_pairs_sampled(200, 1).unwrap());
    let rest = model.neutral();
    let plain = Arm::builder(&robot, "base", "flange").with_search(Search::Start);
    let plain = plain.build().unwrap();
    let mut random = Random::new(21);
    let (mut count, mut reached) = (0, 0);
    while count < case_count(200, 25) {
        let [goal, start] = [(); 2].map(|()| random.configuration(&plain));
        let mut q = rest.clone();
        plain.configuration(&goal, &mut q).unwrap();
        let mut kinematics = ForwardKinematics::<f64>::new(model);
        let placed = kinematics.place(&q).unwrap();
        let [shoulder, elbow, wrist] = ["link2", "link4", "link6"]
            .map(|name| placed[model.frame(name).unwrap().index()].translation);
        let away = (wrist - shoulder).cross(elbow - shoulder);
        // A stretched arm has no defined elbow direction.
        if away.norm() < 0.02 || !checker.collisions(&q).unwrap().is_empty() {
            continue;
        }
        let away = away * (1.0 / away.norm());
        let ball_position = |sign: f64| {
            let ball = |distance: f64| {
                let mut world = World::new();
                let at = elbow + away * (sign * distance);
                world
                    .add_sphere("ball", BALL_RADIUS, Placement::translation(at))
                    .unwrap();
                world
            };
            // Nearest distance with the required clearance.
            let (mut inner, mut outer) = (0.0, 2.0);
            for _ in 0..40 {
                let middle = 0.5 * (inner + outer);
                let among = checker.clone().with_world(&ball(middle)).unwrap();
                let among = among.with_margin(CLEARANCE).unwrap();
                let reported = among.collisions(&q).unwrap();
                match reported.iter().any(|pair| pair.second == "ball") {
                    true => inner = middle,
                    false => outer = middle,
                }
            }
            elbow + away * (sign * outer)
        };
        let mut world = World::new();
        for (name, sign) in [("left", -1.0), ("right", 1.0)] {
            let position: Vector3<f64> = ball_position(sign);
            world
                .add_sphere(name, BALL_RADIUS, Placement::translation(position))
                .unwrap();
        }
        let among = checker.clone().with_world(&world).unwrap();
        let arm = plain.with_search(Search::Start).unwrap();
        let arm = arm.with_checker(&among, &rest).unwrap();
        let target = arm.base_from_tool(&goal).unwrap();
        let solution = arm.solve(target, &start).unwrap();
        count += 1;
        reached += usize::from(solution.reached);
        assert_eq!(
            solution.reached,
            arm.collisions(&solution.q).unwrap().is_empty()
        );
        assert!(solution.reached || solution.goals_reached());
    }
    assert!(10 * reached >= 9 * count, "{reached} of {count}");
}
