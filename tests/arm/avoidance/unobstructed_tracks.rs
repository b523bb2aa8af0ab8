//! Promise: with unobstructed paths a track with a world equals one without in quality. This includes branches that end
//! at a limit with a detour. A far first target is solved without contact.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot};
use support::random::{Random, case_count};

const STEPS: usize = 80;

struct Arms {
    plain: Arm,
    clear: Arm,
}

fn arms(robot: &Robot) -> Arms {
    let bodies = CollisionModel::of(robot).unwrap();
    let checker = Checker::covered(bodies.with_pairs_sampled(200, 1).unwrap());
    let plain = Arm::new(robot, "base", "flange").unwrap();
    let clear = plain.clone();
    let rest = robot.model().neutral();
    Arms {
        clear: clear.with_checker(&checker, &rest).unwrap(),
        plain,
    }
}

/// Configurations along a path whose joints oscillate over their whole range, some to their limits.
fn to_the_limits(random: &mut Random, arm: &Arm) -> Vec<Vec<f64>> {
    let swings: Vec<_> = (arm.limits())
        .map(|limits| {
            let (lower, upper) = (limits.lower.max(-2.5), limits.upper.min(2.5));
            let from = random.within(lower, upper);
            let step = random.within(-1.2, 1.2);
            let to = (from + step).clamp(lower, upper);
            (from, to, random.within(1.5, 4.5))
        })
        .collect();
    let at = |share: f64| {
        let value = |(from, to, turn): &(f64, f64, f64)| {
            from + (to - from) * 0.5 * (1.0 - (turn * share).cos())
        };
        swings.iter().map(value).collect()
    };
    (0..=STEPS).map(|k| at(k as f64 / STEPS as f64)).collect()
}

/// True if no sample between two configurations is in contact.
fn is_free_between(arm: &Arm, from: &[f64], to: &[f64]) -> bool {
    (0..4).all(|k| {
        let share = f64::from(k) / 4.0;
        let between = from.iter().zip(to).map(|(a, b)| a + share * (b - a));
        let q: Vec<f64> = between.collect();
        arm.collisions(&q).unwrap().is_empty()
    })
}

fn is_free(arm: &Arm, path: &[&[f64]]) -> bool {
    path.windows(2)
        .all(|two| is_free_between(arm, two[0], two[1]))
}

#[test]
fn free_track_is_as_complete_as_a_plain_one() {
    let Arms { plain, clear } = arms(&robot("franka_panda"));
    let (mut seen, mut fallen) = (0, Vec::new());
    let case_count = case_count(300, 60);
    let mut seed = 0;
    while seen < case_count {
        seed += 1;
        let mut random = Random::new(seed);
        let path = to_the_limits(&mut random, &plain);
        let poses = path.iter().map(|q| plain.base_from_tool(q).unwrap());
        let poses: Vec<Placement<f64>> = poses.collect();
        let track = plain.track(&poses, &path[0]).unwrap();
        let ways: Vec<&[f64]> = track.rows().collect();
        if !track.reached() || !is_free(&clear, &ways) {
            continue;
        }
        seen += 1;
        let track = clear.track(&poses, &path[0]).unwrap();
        let ways: Vec<&[f64]> = track.rows().collect();
        assert!(is_free(&clear, &ways), "{seed}");
        if !track.reached() {
            fallen.push(seed);
        }
    }
    assert!(fallen.is_empty(), "{fallen:?} of {seen} paths");
}

/// A sphere at the elbow of the nearby solution of the first target; another solution avoids it.
#[test]
fn far_first_target_is_solved_without_contact() {
    let robot = robot("franka_panda");
    let Arms { plain, clear } = arms(&robot);
    let start = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let begin = plain.base_from_tool(&start).unwrap();
    let offset = Vector3::new(0.0, 0.3, 0.0);
    let target = Placement::new(begin.rotation, begin.translation + offset);
    let in_collision = plain.track(&[target], &start).unwrap();
    assert!(in_collision.report[0].reached && distance(&start, &in_collision.report[0].q) > 0.2);
    let mut q = robot.model().neutral();
    plain
        .configuration(&in_collision.report[0].q, &mut q)
        .unwrap();
    let mut frames = kinopt::kinematics::ForwardKinematics::<f64>::new(robot.model());
    let elbow = robot.model().frame("link4").unwrap();
    let elbow = frames.place(&q).unwrap()[elbow.index()].translation;
    let mut world = World::new();
    world.add_sphere("ball", 0.05, elbow).unwrap();
    let clear = clear.with_world(&world, None).unwrap();
    assert!(
        !clear
            .collisions(&in_collision.report[0].q)
            .unwrap()
            .is_empty()
    );
    let track = clear.track(&[target], &start).unwrap();
    let solution = &track.report[0];
    assert!(clear.collisions(&solution.q).unwrap().is_empty() == solution.reached);
    assert!(solution.reached, "{}", solution.explain());
}

/// Ten spheres, one of which blocks the branch: the null space leads around it in small steps or not at all.
#[test]
fn blocked_track_does_not_jump() {
    let Arms { plain, clear } = arms(&robot("franka_panda"));
    let mut random = Random::new(1369);
    let mut world = World::new();
    for ball in 0..10 {
        let around = random.within(-3.1, 3.1);
        let (distance, high) = (random.within(0.35, 0.8), random.within(0.1, 1.0));
        let position = Vector3::new(distance * around.cos(), distance * around.sin(), high);
        let (name, radius) = (format!("ball {ball}"), random.within(0.03, 0.1));
        world.add_sphere(&name, radius, position).unwrap();
    }
    let clear = clear.with_world(&world, None).unwrap();
    let path = to_the_limits(&mut random, &plain);
    let poses = path.iter().map(|q| plain.base_from_tool(q).unwrap());
    let poses: Vec<Placement<f64>> = poses.collect();
    let track = clear.track(&poses, &path[0]).unwrap();
    let ways: Vec<&[f64]> = track.rows().collect();
    assert!(is_free(&clear, &ways));
    assert!(track.jumps.is_empty(), "{:?}", track.jumps);
    assert!(track.report.iter().any(|solution| !solution.reached));
}
