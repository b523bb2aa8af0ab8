//! Promise: so it is for arms under options that are drawn at random, many at once, whatever they are asked one after the other: poses
//! near and far, alone and in batches, by other tools, goals and searches, among obstacles, and what is no question.
#![allow(clippy::unwrap_used)]

use std::fmt::Display;

use kinopt::Solution;
use kinopt::arm::{Arm, PoseBounds, PoseOutcome, Search};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::one_of;
use crate::every_joint::{place, vector};
use crate::mixed_arms::{INF, checker, described, rarely, robot, world};

impl Digest {
    pub(crate) fn answered<E: Display>(&mut self, solution: Result<Solution, E>) {
        match solution {
            Ok(solution) => self.told(&solution),
            Err(error) => self.text(error.to_string()),
        }
    }

    /// What a batch came to; a wrong answer of an array's first or last place changes it as well.
    fn batch(&mut self, q: &[f64], outcomes: &[PoseOutcome]) {
        self.doubles(q.iter().copied());
        self.noted(&outcomes);
    }
}

/// Within limits mostly, on them, beyond them, far away, of another length or no number.
pub(crate) fn start(arm: &Arm, random: &mut Random) -> Vec<f64> {
    let within = |random: &mut Random, lower: f64, upper: f64| {
        random.within(lower.max(-3.0), upper.min(3.0))
    };
    let limits: Vec<_> = arm.limits().collect();
    let case = random.below(24);
    let mut q: Vec<f64> = limits
        .iter()
        .map(|own| match case {
            0 => own.lower.max(-4.0),
            1 => own.clamp(0.0),
            2 => own.upper + 0.5,
            3 => random.within(-40.0, 40.0),
            4 => 3e6,
            _ => within(random, own.lower, own.upper),
        })
        .collect();
    let last = q.len() - 1;
    match (case, random.below(4)) {
        (5, 0) => q[last] = f64::NAN,
        (5, 1) => q.push(0.0),
        _ => {}
    }
    q
}

/// Where the tool can stand mostly; beside that, beyond reach, nowhere.
pub(crate) fn target(arm: &Arm, near: &[f64], random: &mut Random) -> Placement<f64> {
    let mut q: Vec<f64> = (arm.limits())
        .map(|own| random.within(own.lower.max(-3.0), own.upper.min(3.0)))
        .collect();
    let case = random.below(18);
    if !(6..16).contains(&case)
        && near.len() == q.len()
        && near.iter().all(|value| value.abs() < 1e3)
    {
        for ((q, near), own) in q.iter_mut().zip(near).zip(arm.limits()) {
            let by = if case > 15 {
                0.0
            } else {
                one_of(random, &[0.0, 0.1, 0.4])
            };
            *q = own.clamp(near + by * random.within(-1.0, 1.0));
        }
    }
    let mut at = arm.base_from_tool(&q).unwrap();
    match case {
        6 => at.translation = at.translation * 1.2,
        7 => at.translation = at.translation * 4.0 + Vector3::UNITS[0],
        8 => at.rotation = place(random, 0.1).rotation,
        9 => at.translation += vector(random, 0.05),
        10 if rarely(random, 3) => at.rotation.x = at.rotation.x * one_of(random, &[1.1, -1.0]),
        11 if rarely(random, 4) => at.translation.y = f64::NAN,
        _ => {}
    }
    at
}

/// One question to an arm; a solution and arrays are used again.
fn ask(digest: &mut Digest, arm: &Arm, robot: &Robot, random: &mut Random, used: &mut Solution) {
    let n = arm.joint_count();
    let from = start(arm, random);
    let at = target(arm, &from, random);
    match random.below(9) {
        0 => digest.answered(arm.solve(at, &from)),
        1 | 2 => {
            digest.refusal(arm.solve_into(at, &from, used));
            digest.told(used);
        }
        3 => match arm.solve_all(at, &from) {
            Ok(all) => all.iter().for_each(|solution| digest.told(solution)),
            Err(error) => digest.text(error.to_string()),
        },
        4 | 5 => {
            let count = one_of(random, &[0, 1, 2, 5, 9]);
            let mut starts = from.repeat(count);
            let targets: Vec<_> = (0..count).map(|_| target(arm, &from, random)).collect();
            if count > 2 && from.len() == n {
                starts.truncate(n * (count - 1));
                starts.extend(start(arm, random));
            }
            match arm.solve_batch(&targets, &starts) {
                Ok(all) => all.iter().for_each(|solution| digest.told(solution)),
                Err(error) => digest.text(error.to_string()),
            }
            let told = if rarely(random, 9) { count + 1 } else { count };
            let (mut q, mut outcomes) = (vec![7.0; n * count], vec![PoseOutcome::default(); told]);
            digest.refusal(arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes));
            digest.batch(&q, &outcomes);
        }
        6 => {
            digest.refusal(arm.base_from_tool(&from));
            let Ok(solution) = arm.solve(at, &from) else {
                return;
            };
            for q in [&solution.q, &from] {
                match arm.derivative(at, q) {
                    Ok(own) => {
                        digest.noted(&own.differentiability);
                        digest.doubles(own.by_target.iter().copied());
                    }
                    Err(error) => digest.text(error.to_string()),
                }
            }
            let mut jacobian = arm.jacobian().unwrap();
            match jacobian.at(&solution.q) {
                Ok(matrix) => digest.doubles(matrix.iter().copied()),
                Err(error) => digest.text(error.to_string()),
            }
        }
        7 => {
            let mut whole = robot.model().neutral();
            digest.refusal(arm.configuration(&from, &mut whole));
            digest.doubles(whole.iter().copied());
            let mut own = vec![0.5; n];
            digest.refusal(arm.joint_values(&whole, &mut own[..]));
            digest.doubles(own);
        }
        _ => match arm.collisions(&from) {
            Ok(all) => digest.noted(&all),
            Err(error) => digest.text(error.to_string()),
        },
    }
}

/// The arm with something else about it.
fn changed(arm: &Arm, random: &mut Random) -> Result<Arm, kinopt::arm::ArmError> {
    match random.below(6) {
        0 | 1 => arm.with_tool(place(random, 0.15)),
        2 => arm.with_goal(one_of(
            random,
            &[
                PoseBounds::pose(),
                PoseBounds::position(),
                PoseBounds::within([0.0, 0.1, 0.0, 0.0, INF, 0.2]),
            ],
        )),
        3 => arm.with_search(one_of(
            random,
            &[
                Search::Start,
                Search::First,
                Search::Nearest,
                Search::Distinct {
                    k: 2,
                    distance: 0.3,
                },
            ],
        )),
        4 => arm.with_world(
            &world(random),
            one_of(random, &[None, Some(0.02), Some(-1.0)]),
        ),
        _ => Ok(arm.clone()),
    }
}

fn mixes(seed: u64, cases: usize, clear: bool) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(seed));
    let mut used = Solution::default();
    for _ in 0..cases {
        let joints = one_of(&mut random, &[2, 4, 6, 6, 7, 8]);
        let robot = robot(&mut random, joints);
        for _ in 0..3 {
            let builder = described(&robot, joints, &mut random);
            // Checks take their time.
            let built = match clear {
                true => builder.with_attempts(4).build(),
                false => builder.build(),
            };
            let mut arm = match built {
                Ok(arm) => arm,
                Err(error) => {
                    digest.text(error.to_string());
                    continue;
                }
            };
            if clear {
                let rest = robot.model().neutral();
                let length = rest.len() - usize::from(rarely(&mut random, 20));
                let kept = arm
                    .clone()
                    .with_checker(&checker(&robot, &mut random), &rest[..length]);
                match kept {
                    Ok(kept) => arm = kept,
                    Err(error) => digest.text(error.to_string()),
                }
            }
            digest.noted(&(arm.joints().collect::<Vec<_>>(), arm.limits().len()));
            for turn in 0..8 {
                if clear && turn == 3 && rarely(&mut random, 2) {
                    let rest = robot.model().neutral();
                    let other = checker(&robot, &mut random);
                    arm = arm.with_checker(&other, &rest).unwrap();
                }
                if turn == 4 {
                    match changed(&arm, &mut random) {
                        Ok(other) => arm = other,
                        Err(error) => digest.text(error.to_string()),
                    }
                }
                ask(&mut digest, &arm, &robot, &mut random, &mut used);
            }
        }
    }
    digest.value()
}

/// More questions than are handed out together, of which some are missed and one is none.
fn many() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1203));
    for joints in [3, 6] {
        let robot = robot(&mut random, joints);
        let arm = Arm::builder(&robot, "l0", format!("l{joints}").as_str()).with_atlas(false);
        let arm = arm.with_attempts(3).build().unwrap();
        let n = arm.joint_count();
        let targets: Vec<_> = (0..140).map(|_| target(&arm, &[], &mut random)).collect();
        let targets: Vec<_> = (targets.into_iter())
            .filter(|at| at.check_rigid(1e-9).is_ok())
            .collect();
        let mut starts: Vec<f64> = (targets.iter())
            .flat_map(|_| (arm.limits()).map(|own| own.clamp(0.3)).collect::<Vec<_>>())
            .collect();
        let (mut q, mut outcomes) = (
            vec![0.0; starts.len()],
            vec![PoseOutcome::default(); targets.len()],
        );
        for _ in 0..2 {
            let found = arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes);
            digest.refusal(found);
            digest.batch(&q, &outcomes);
            match arm.solve_batch(&targets, &starts) {
                Ok(all) => all.iter().for_each(|solution| digest.solution(solution)),
                Err(error) => digest.text(error.to_string()),
            }
            let parallel = arm.solve_batch_into_parallel(&targets, &starts, &mut q, &mut outcomes);
            digest.refusal(parallel);
            digest.batch(&q, &outcomes);
            starts[131 * n - 1] = f64::NAN;
        }
    }
    digest.value()
}

#[test]
fn of_arms_in_the_open() {
    check(&[("drawn arms", mixes(1201, 24, false))]);
}

#[test]
fn of_arms_among_obstacles() {
    check(&[("drawn arms among obstacles", mixes(1202, 6, true))]);
}

#[test]
fn of_whole_batches() {
    check(&[("drawn batches of many", many())]);
}
