//! Promise: a path of an arm that keeps clear touches nothing, at its points and between them; a step that would is cut
//! short and says what is in the way, and the arm comes back as the path leaves.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot};
use support::sample::cases;

const Q: [f64; 7] = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];

fn panda(world: &World) -> Arm {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::new(bodies).with_world(world).unwrap();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let rest = vec![0.0; robot.model().configuration_len()];
    arm.with_checker(&checker, &rest).unwrap()
}

/// From where the tool stands to the side and back, in so many steps each way.
fn out_and_back(arm: &Arm, by: Vector3<f64>, steps: usize) -> Vec<Placement<f64>> {
    let begin = arm.base_from_tool(&Q).unwrap();
    let there = (0..=steps).chain((0..steps).rev());
    let at = |k: usize| {
        Placement::new(
            begin.rotation,
            begin.translation + by * (k as f64 / steps as f64),
        )
    };
    there.map(at).collect()
}

/// No sample between two configurations touches.
fn is_free_between(arm: &Arm, from: &[f64], to: &[f64]) -> bool {
    (0..=20).all(|k| {
        let share = f64::from(k) / 20.0;
        let q: Vec<f64> = from
            .iter()
            .zip(to)
            .map(|(a, b)| a + share * (b - a))
            .collect();
        arm.collisions(&q).unwrap().is_empty()
    })
}

/// A wall to the left of the tool, nearer or farther.
fn wall(arm: &Arm, gap: f64) -> World {
    let tool = arm.base_from_tool(&Q).unwrap().translation;
    let mut world = World::new();
    let place = Vector3::new(tool.x, tool.y + gap + 0.25, tool.z);
    world.add_box("wall", [0.6, 0.5, 0.6], place).unwrap();
    world
}

#[test]
fn a_path_into_a_wall_stops_before_it_and_comes_back() {
    let alone = panda(&World::new());
    for case in 0..cases(10, 2) {
        let arm = panda(&wall(&alone, 0.16 + 0.01 * case as f64));
        let path = out_and_back(&arm, Vector3::new(0.0, 0.3, 0.0), 60);
        let track = arm.track(&path, &Q).unwrap();
        assert!(track.jumps.is_empty(), "{:?}", track.jumps);
        let mut last = Q.to_vec();
        for solution in &track.solutions {
            assert!(is_free_between(&arm, &last, &solution.q));
            assert!(distance(&last, &solution.q) < 0.2);
            last.clone_from(&solution.q);
        }
        // In the wall it misses and names it; out of it, it is on its way again.
        let deepest = &track.solutions[60];
        assert!(!deepest.reached);
        assert_eq!(deepest.collisions()[0].second, "wall");
        let missed = track.solutions.iter().filter(|s| !s.reached).count();
        assert!(
            track.solutions[0].reached && track.solutions[120].reached,
            "{missed}"
        );
    }
}

#[test]
fn a_servo_stops_before_a_wall_and_leaves_it() {
    let alone = panda(&World::new());
    let arm = panda(&wall(&alone, 0.18));
    let path = out_and_back(&arm, Vector3::new(0.0, 0.3, 0.0), 60);
    let mut servo = arm.servo(&Q, 0.01).unwrap();
    let (mut last, mut blocked) = (Q.to_vec(), 0);
    for target in path.iter().chain(std::iter::repeat_n(&path[0], 40)) {
        let step = servo.step(*target).unwrap();
        blocked += usize::from(step.status == kinopt::arm::ServoStatus::Blocked);
        assert!(is_free_between(&arm, &last, step.q));
        last = step.q.to_vec();
    }
    assert!(blocked > 10, "{blocked}");
    assert!(servo.step(path[0]).unwrap().reached());
}
