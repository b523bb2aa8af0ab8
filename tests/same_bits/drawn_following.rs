//! Promise: so it is for tracks, followers and servos of arms under options that are drawn at random: along limits, out of reach and
//! back, at rest, over leaps, past obstacles and over targets that are none.
#![allow(clippy::unwrap_used)]

use kinopt::Solution;
use kinopt::arm::{Arm, Servo};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::one_of;
use crate::drawn_arms::start;
use crate::every_joint::vector;
use crate::mixed_arms::{INF, checker, described, rarely, robot};

/// A way of so many targets from where the tool stands, with rests, leaps, ways back and, if asked for, one that is no place.
fn way(arm: &Arm, from: &[f64], steps: usize, random: &mut Random) -> Vec<Placement<f64>> {
    let mut at = arm.base_from_tool(from).unwrap();
    let length = one_of(random, &[0.004, 0.02, 0.05, 0.12]);
    let (mut by, mut turn) = (vector(random, length), vector(random, length));
    let mut all = Vec::new();
    for _ in 0..steps {
        match random.below(12) {
            0 => by = vector(random, length),
            1 => (by, turn) = (by * -1.0, turn * -1.0),
            2 => turn = vector(random, 2.0 * length),
            3 if rarely(random, 6) => at.translation += vector(random, 0.6),
            4 | 5 => {
                all.push(at);
                continue;
            }
            _ => {}
        }
        at = Placement::new(rotation_exp(turn) * at.rotation, at.translation + by);
        all.push(at);
    }
    all
}

/// A place that is none.
fn nowhere(random: &mut Random) -> Placement<f64> {
    one_of(
        random,
        &[
            Placement::translation(Vector3::new(0.0, f64::NAN, 0.0)),
            Placement::translation(Vector3::new(INF, 0.0, 0.0)),
        ],
    )
}

fn track(digest: &mut Digest, arm: &Arm, targets: &[Placement<f64>], from: &[f64]) {
    match arm.track(targets, from) {
        Ok(track) => {
            track.solutions.iter().for_each(|own| digest.solution(own));
            digest.noted(&track.jumps);
            if let Some(own) = track.solutions.last() {
                digest.told(own);
            }
        }
        Err(error) => digest.text(error.to_string()),
    }
}

fn follow(
    digest: &mut Digest,
    arm: &Arm,
    targets: &[Placement<f64>],
    from: &[f64],
    random: &mut Random,
) {
    let mut follower = match arm.follower(from) {
        Ok(follower) => follower,
        Err(error) => return digest.text(error.to_string()),
    };
    let mut solution = Solution::default();
    for target in targets {
        if rarely(random, 12) {
            digest.refusal(follower.advance(nowhere(random), &mut solution));
        }
        if rarely(random, 12) {
            follower = follower.clone();
        }
        match follower.advance(*target, &mut solution) {
            Ok(jump) => digest.noted(&jump),
            Err(error) => digest.text(error.to_string()),
        }
        digest.solution(&solution);
        digest.noted(&solution.collisions());
        digest.doubles(follower.q().iter().copied());
    }
    digest.told(&solution);
}

/// With another damping and other limits of speed, now and then refused.
fn tuned<'a>(mut servo: Servo<'a>, random: &mut Random, digest: &mut Digest) -> Servo<'a> {
    for _ in 0..random.below(3) {
        let n = servo.q().len();
        let own = servo.clone();
        let other = match random.below(2) {
            0 => own.with_damping(one_of(random, &[0.0, 0.001, 0.1, 1.0, -1.0])),
            _ => {
                let mut speeds: Vec<f64> = (0..n)
                    .map(|_| one_of(random, &[0.2, 1.0, INF, 0.0, 5.0]))
                    .collect();
                if rarely(random, 8) {
                    speeds[n - 1] = f64::NAN;
                }
                own.with_velocity_limits(&speeds)
            }
        };
        match other {
            Ok(other) => servo = other,
            Err(error) => digest.text(error.to_string()),
        }
    }
    servo
}

fn servo(
    digest: &mut Digest,
    arm: &Arm,
    targets: &[Placement<f64>],
    from: &[f64],
    random: &mut Random,
) {
    let servo = arm.servo(from, one_of(random, &[0.002, 0.01, 0.05, 0.3, 0.05, 0.0]));
    let servo = match servo {
        Ok(servo) => servo,
        Err(error) => return digest.text(error.to_string()),
    };
    let mut servo = tuned(servo, random, digest);
    digest.doubles(servo.q().iter().chain(servo.velocity_limits()).copied());
    let still = one_of(random, &[0, 3, 6]);
    let last = targets.last().copied();
    for target in targets
        .iter()
        .copied()
        .chain((0..still).filter_map(|_| last))
    {
        if rarely(random, 12) {
            digest.refusal(servo.step(nowhere(random)));
        }
        if rarely(random, 12) {
            servo = tuned(servo, random, digest);
        }
        match servo.step(target) {
            Ok(step) => {
                digest.doubles(step.q.iter().chain(step.velocity).copied());
                digest.doubles([step.position_error, step.orientation_error]);
                digest.word(step.reached().into());
                let held: Vec<_> = step.held().collect();
                digest.noted(&(step.status, step.collisions, held));
            }
            Err(error) => digest.text(error.to_string()),
        }
        digest.doubles(servo.q().iter().copied());
    }
}

/// Arms that are asked one after the other, each for several ways from several places.
fn mixes(seed: u64, cases: usize, clear: bool) -> [Value; 3] {
    let mut digests = [(); 3].map(|()| Digest::new());
    let mut random = Random::new(seed);
    for case in 0..cases {
        let joints = one_of(&mut random, &[2, 3, 5, 6, 7, 8]);
        let robot = robot(&mut random, joints);
        let Ok(mut arm) = described(&robot, joints, &mut random).build() else {
            continue;
        };
        if clear {
            let rest = robot.model().neutral();
            arm = arm
                .with_checker(&checker(&robot, &mut random), &rest)
                .unwrap();
        }
        for turn in 0..3 {
            let from = start(&arm, &mut random);
            let good = from.len() == arm.joint_count() && from.iter().all(|q| q.is_finite());
            let steps = one_of(
                &mut random,
                if clear {
                    &[1, 4, 7]
                } else {
                    &[0, 1, 9, 14, 20]
                },
            );
            let targets = match good {
                true => way(&arm, &from, steps, &mut random),
                false => vec![Placement::identity(); 2],
            };
            let [tracks, followers, servos] = &mut digests;
            match (case + turn) % 3 {
                0 => {
                    track(tracks, &arm, &targets, &from);
                    if rarely(&mut random, 4) {
                        let some = [&targets[..], &[nowhere(&mut random)]].concat();
                        track(tracks, &arm, &some, &from);
                    }
                }
                1 => follow(followers, &arm, &targets, &from, &mut random),
                _ => servo(servos, &arm, &targets, &from, &mut random),
            }
        }
    }
    digests.map(|digest| digest.value())
}

#[test]
fn of_ways_in_the_open() {
    let [tracks, followers, servos] = mixes(1211, 90, false);
    check(&[
        ("drawn tracks", tracks),
        ("drawn followers", followers),
        ("drawn servos", servos),
    ]);
}

#[test]
fn of_ways_among_obstacles() {
    let [tracks, followers, servos] = mixes(1212, 20, true);
    check(&[
        ("drawn tracks among obstacles", tracks),
        ("drawn followers among obstacles", followers),
        ("drawn servos among obstacles", servos),
    ]);
}
