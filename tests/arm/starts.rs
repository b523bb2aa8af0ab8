//! Promise: every search solves from difficult starts within limits: on a limit, singular, outside the limits, or at
//! the solution. An invalid start is named in the error.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::{Arc, Mutex, OnceLock};

use kinopt::Solution;
use kinopt::arm::{Arm, QueryError, Search};
use kinopt::spatial::Placement;
use support::arms::{robot, within_limits};
use support::random::{Random, cases, few, part};
use support::urdf_matrices::{apart, from_placement};

const SEARCHES: [Search; 3] = [Search::Start, Search::First, Search::Nearest];

/// Both kinds of wrist, and a prismatic joint.
const ROBOTS: [&str; 3] = ["franka_panda", "universal_ur5e", "adept_cobra_s600"];

type Arms = [(Search, Arm); 3];

/// Arms of a robot from base to flange, one per search; built once.
fn arms(name: &'static str) -> Arc<Arms> {
    static ARM_CACHE: Mutex<BTreeMap<&str, Arc<OnceLock<Arc<Arms>>>>> = Mutex::new(BTreeMap::new());
    let cell = ARM_CACHE.lock().unwrap().entry(name).or_default().clone();
    let build = |search| {
        let robot = robot(name);
        let builder = Arm::builder(&robot, "base", "flange");
        // A debug build makes seeds only for searches that start from them.
        let builder = builder.with_atlas(search == Search::First || !few());
        (search, builder.with_search(search).build().unwrap())
    };
    cell.get_or_init(|| Arc::new(SEARCHES.map(build))).clone()
}

fn assert_solved(arm: &Arm, target: &Placement<f64>, solution: &Solution, start: &[f64]) {
    let found = arm.base_from_tool(&solution.q).unwrap();
    let (metres, radians) = apart(&from_placement(&found), &from_placement(target));
    assert!(
        solution.reached && metres <= 1e-6 && radians <= 1e-6,
        "{start:?}: {metres:e} {radians:e} {}",
        solution.explain()
    );
    assert!(within_limits(arm, &solution.q), "{start:?}");
}

/// Solves a random reachable pose from each start, by each search.
fn all_solved_from(name: &'static str, starts: impl Fn(&Arm) -> Vec<Vec<f64>>) {
    for (_, arm) in arms(name).iter() {
        let mut random = Random::split_mix(31);
        for start in starts(arm) {
            let truth = random.configuration(arm);
            let target = arm.base_from_tool(&truth).unwrap();
            assert_solved(arm, &target, &arm.solve(target, &start).unwrap(), &start);
        }
    }
}

#[test]
fn starts_on_limits_are_solved() {
    for name in ROBOTS {
        all_solved_from(name, |arm| {
            let (lower, upper): (Vec<f64>, Vec<f64>) =
                arm.limits().map(|l| (l.lower, l.upper)).unzip();
            // All on one side, and each alone.
            let mut starts = vec![lower.clone(), upper.clone()];
            for k in part(0..lower.len(), 2) {
                let mut start: Vec<f64> = lower
                    .iter()
                    .zip(&upper)
                    .map(|(l, u)| 0.5 * (l + u))
                    .collect();
                start[k] = if k % 4 < 2 { lower[k] } else { upper[k] };
                starts.push(start);
            }
            starts
        });
    }
}

#[test]
fn starts_far_outside_limits_are_solved() {
    for name in ROBOTS {
        all_solved_from(name, |arm| {
            let n = arm.joint_count();
            vec![
                vec![50.0; n],
                vec![-1e6; n],
                vec![1e300; n],
                vec![-f64::MAX; n],
            ]
        });
    }
}

#[test]
fn singular_starts_are_solved() {
    // Stretched, aligned wrist axes, above the shoulder.
    all_solved_from("franka_panda", |_| {
        vec![
            vec![0.0, 0.0, 0.0, -0.0698, 0.0, 0.0, 0.0],
            vec![0.0, 0.0, 0.0, -FRAC_PI_2, 0.0, 0.0, 0.0],
            vec![0.3, 0.0, 0.2, -1.5, FRAC_PI_2, FRAC_PI_2, 0.0],
        ]
    });
    all_solved_from("universal_ur5e", |_| {
        vec![
            vec![0.0; 6],
            vec![0.0, -FRAC_PI_2, 0.0, -FRAC_PI_2, 0.0, 0.0],
            vec![1.0, -FRAC_PI_2, 1.2, 0.3, 0.0, 0.4],
        ]
    });
    all_solved_from("kuka_iiwa14", |_| vec![vec![0.0; 7]]);
}

/// Poses of singular configurations, from other starts: convergence is slow there.
#[test]
fn singular_targets_are_solved() {
    for (name, truths) in [
        (
            "universal_ur5e",
            vec![
                vec![0.4, -1.2, 1.3, 0.2, 0.0, 0.7],
                vec![0.4, -1.2, 1.3, 0.2, 1e-7, 0.7],
                vec![0.4, -1.2, 1e-4, 0.2, 0.9, 0.7],
                vec![0.4, -1.2, 0.0, 0.2, 0.9, 0.7],
            ],
        ),
        (
            "franka_panda",
            vec![
                vec![0.4, 0.0, 0.3, -1.6, 0.2, 0.0, 0.5],
                vec![0.4, 0.3, 0.3, -0.0698, 0.2, 1.1, 0.5],
                vec![0.4, 1e-8, 0.3, -1.6, 0.2, 1.1, 0.5],
            ],
        ),
        (
            "kuka_iiwa14",
            vec![
                vec![0.4, 0.8, 0.3, 0.0, 0.2, 1.1, 0.5],
                vec![0.4, 0.8, 0.3, 1.2, 0.2, 0.0, 0.5],
                vec![0.4, 0.0, 0.3, 1.2, 0.2, 0.9, 0.5],
            ],
        ),
    ] {
        for (_, arm) in arms(name).iter() {
            let mut random = Random::split_mix(32);
            for truth in &truths {
                let target = arm.base_from_tool(truth).unwrap();
                for _ in cases(3, 1) {
                    let start = random.configuration(arm);
                    assert_solved(arm, &target, &arm.solve(target, &start).unwrap(), &start);
                }
            }
        }
    }
}

/// The start is the solution and is returned, except for rounding and whole turns.
#[test]
fn start_at_the_solution_is_returned() {
    for name in ROBOTS {
        for (search, arm) in arms(name).iter() {
            let mut random = Random::split_mix(33);
            for _ in 0..4 {
                let truth = random.configuration(arm);
                let target = arm.base_from_tool(&truth).unwrap();
                let solution = arm.solve(target, &truth).unwrap();
                assert_solved(arm, &target, &solution, &truth);
                if *search == Search::First {
                    continue;
                }
                for (found, given) in solution.q.iter().zip(&truth) {
                    assert!(
                        (found - given).abs() < 1e-3,
                        "{search:?} {name}: {found} {given}"
                    );
                }
            }
        }
    }
}

/// Half a turn from the target's orientation, where the rotation logarithm has two values.
#[test]
fn start_half_a_turn_away_is_solved() {
    for (_, arm) in arms("universal_ur5e").iter() {
        let truth = [0.2, -1.2, 1.4, -0.4, 1.3, 0.5];
        let target = arm.base_from_tool(&truth).unwrap();
        for turn in [0.5 * TAU, -0.5 * TAU] {
            let mut start = truth;
            start[5] += turn;
            assert_solved(arm, &target, &arm.solve(target, &start).unwrap(), &start);
        }
    }
}

#[test]
fn invalid_starts_are_named() {
    for (_, arm) in arms("franka_panda").iter() {
        let goal = Placement::identity();
        for invalid in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (k, name) in arm.joints().enumerate() {
                let mut start = [0.1; 7];
                start[k] = invalid;
                for error in [
                    arm.solve(goal, &start).unwrap_err(),
                    arm.solve_all_from(goal, &start).unwrap_err(),
                    arm.solve_batch(&[goal], &start).unwrap_err(),
                    arm.track(&[goal], &start).unwrap_err(),
                ] {
                    let message = error.to_string();
                    assert!(
                        matches!(&error, QueryError::StartNotFinite { joint, value, .. }
                        if joint == name && value.to_bits() == invalid.to_bits())
                    );
                    assert!(message.contains(name), "{message}");
                }
            }
        }
        for given in [0, 6, 8] {
            let start = vec![0.1; given];
            for error in [
                arm.solve(goal, &start).unwrap_err(),
                arm.solve_all_from(goal, &start).unwrap_err(),
                arm.solve_batch(&[goal], &start).unwrap_err(),
                arm.track(&[goal], &start).unwrap_err(),
            ] {
                assert!(
                    matches!(error, QueryError::Length { given: g, expected: 7, .. } if g == given)
                );
                // Both counts are in the message.
                let message = error.to_string();
                assert!(
                    message.contains(&given.to_string()) && message.contains('7'),
                    "{message}"
                );
            }
        }
        let starts = [[0.1; 7], [f64::NAN; 7]].concat();
        let error = arm.solve_batch(&[goal, goal], &starts).unwrap_err();
        assert!(matches!(
            error,
            QueryError::StartNotFinite { query: Some(1), .. }
        ));
        let mut bent = goal;
        bent.rotation.x.x = 1.1;
        let error = arm.solve_batch(&[goal, bent], &[0.1; 14]).unwrap_err();
        assert!(matches!(error, QueryError::Target { query: Some(1), .. }));
        let mut broken = goal;
        broken.translation.y = f64::NAN;
        let message = arm.solve(broken, &[0.1; 7]).unwrap_err().to_string();
        assert!(
            message.starts_with("target: the entry in row 1, column 3"),
            "{message}"
        );
    }
}
