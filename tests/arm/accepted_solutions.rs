//! Promise: solutions offered to a callback are reached and distinct. The search goes on until the callback accepts one,
//! the time limit ends, or no new solution is found.

use std::time::Duration;

use kinopt::Solution;
use kinopt::arm::Arm;
use support::arms::{distance, robot, within_limits};
use support::urdf_matrices::{apart, from_placement};

/// Longer than any of these searches lasts.
const LONG: Duration = Duration::from_secs(600);
/// Distance of two offered solutions at first, and the smallest one, radians.
const DISTANCE: f64 = 0.1;
const MIN_DISTANCE: f64 = 1e-3;

fn panda() -> Arm {
    Arm::new(&robot("franka_panda"), "base", "flange").unwrap()
}

/// Offered configurations of a search that accepts number `accepted`, and whether it was accepted.
fn offered(arm: &Arm, q_target: &[f64], start: &[f64], accepted: usize) -> (Vec<Vec<f64>>, bool) {
    let target = arm.base_from_tool(q_target).unwrap();
    let mut all: Vec<Vec<f64>> = Vec::new();
    let mut solution = Solution::default();
    let accept = |q: &[f64]| {
        all.push(q.to_vec());
        all.len() == accepted
    };
    let found = arm
        .solve_accepted(target, start, accept, &mut solution)
        .unwrap();
    let expected = if found { all.last() } else { all.first() };
    assert_eq!(expected, Some(&solution.q));
    for (k, q) in all.iter().enumerate() {
        let (metres, radians) = apart(
            &from_placement(&arm.base_from_tool(q).unwrap()),
            &from_placement(&target),
        );
        assert!(metres < 1e-5 && radians < 1e-5, "{k}: {metres} {radians}");
        assert!(within_limits(arm, q));
        for (other, earlier) in all[..k].iter().enumerate() {
            assert!(distance(q, earlier) > 0.0, "{k} {other}");
        }
    }
    (all, found)
}

const PANDA_START: [f64; 7] = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
const UR5E_TARGET: [f64; 6] = [0.5, -1.0, 1.2, -0.9, 1.1, 0.3];
const PANDA_TARGET: [f64; 7] = [0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5];

#[test]
fn redundant_arm_accepts_number_five_hundred() {
    let arm = panda().with_query_bounds(Some(LONG), None).unwrap();
    let (all, found) = offered(&arm, &PANDA_TARGET, &PANDA_START, 500);
    assert!(found);
    assert_eq!(all.len(), 500);
    // Coarse at first, then finer.
    for (k, q) in all.iter().enumerate() {
        let distance_at = if k < 20 { DISTANCE } else { MIN_DISTANCE };
        assert!(
            all[..k]
                .iter()
                .all(|earlier| distance(q, earlier) > distance_at)
        );
    }
}

#[test]
fn six_joints_exhausted_before_the_time_limit() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let arm = arm.with_query_bounds(Some(LONG), None).unwrap();
    let (all, found) = offered(&arm, &UR5E_TARGET, &[0.0, -1.5, 1.5, -1.5, -1.5, 0.0], 0);
    assert!(!found);
    // The closed form has eight solutions.
    assert_eq!(all.len(), 8);
}

#[test]
fn no_time_limit_makes_one_round() {
    let (all, found) = offered(&panda(), &PANDA_TARGET, &PANDA_START, 0);
    assert!(!found);
    assert!(all.len() > 8 && all.len() <= 201, "{}", all.len());
}

#[test]
fn largest_motion_bounds_every_offered_solution() {
    let max_move = [0.5, 0.5, 0.3, 0.5, 0.2, 0.5, 0.5];
    let arm = panda()
        .with_query_bounds(Some(LONG), Some(&max_move))
        .unwrap();
    let (all, found) = offered(&arm, &PANDA_TARGET, &PANDA_START, 5);
    assert!(found);
    for q in &all {
        for ((q, start), bound) in q.iter().zip(PANDA_START).zip(max_move) {
            assert!((q - start).abs() <= bound + 1e-15, "{q} {start} {bound}");
        }
    }
}

#[test]
fn expired_time_limit_ends_the_search() {
    let arm = panda()
        .with_query_bounds(Some(Duration::from_millis(20)), None)
        .unwrap();
    let target = arm.base_from_tool(&PANDA_TARGET).unwrap();
    let mut calls = 0;
    let reject = |_: &[f64]| {
        calls += 1;
        std::thread::sleep(Duration::from_millis(30));
        false
    };
    let mut solution = Solution::default();
    let found = arm
        .solve_accepted(target, &PANDA_START, reject, &mut solution)
        .unwrap();
    assert!(!found && solution.reached);
    assert_eq!(calls, 1);
}

#[test]
fn unreachable_target_offers_nothing() {
    let arm = panda();
    let mut target = arm.base_from_tool(&PANDA_TARGET).unwrap();
    target.translation.x += 3.0;
    let mut solution = Solution::default();
    let accept = |_: &[f64]| panic!("nothing is reached");
    let found = arm.solve_accepted(target, &PANDA_START, accept, &mut solution);
    assert!(!found.unwrap() && !solution.reached);
}
