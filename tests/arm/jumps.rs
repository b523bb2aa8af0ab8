//! Promise: a requested jump leads to the nearest solution, modulo whole turns. The following motion equals that of a
//! follower that starts there, because a jump is not extrapolated.

use std::f64::consts::TAU;

use kinopt::Solution;
use kinopt::arm::{Arm, Axis, PoseBounds};
use kinopt::spatial::Placement;
use support::arms::{distance, robot};
use support::random::Random;

use crate::track_continuity::far_steps;

const STEPS: u32 = 300;

/// The solution with each joint at the equivalent value nearest to `to`, within limits.
fn nearest_turns(arm: &Arm, q: &[f64], to: &[f64]) -> Vec<f64> {
    let joints = q.iter().zip(to).zip(arm.limits());
    let nearest = joints.map(|((q, to), limits)| {
        let turned = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turns| q + turns * TAU);
        let within = turned.into_iter().filter(|turned| limits.contains(*turned));
        let nearest = within.min_by(|a, b| (a - to).abs().total_cmp(&(b - to).abs()));
        nearest.unwrap_or(*q)
    });
    nearest.collect()
}

#[test]
fn jumps_are_short_and_leave_no_state() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_atlas(false).with_global_search_on_miss(true);
    let arm = arm.build().unwrap();
    let mut random = Random::split_mix(7);
    let (mut jumps, mut too_long, mut after) = (0, 0, [0, 0]);
    for _ in 0..40 {
        let start = random.configuration(&arm);
        let end = random.configuration(&arm);
        let [first, last] = [&start, &end].map(|q| arm.base_from_tool(q).unwrap());
        let displacement = last.translation - first.translation;
        let at = |step: u32| {
            let share = f64::from(step) / f64::from(STEPS);
            Placement::new(first.rotation, first.translation + displacement * share)
        };
        let mut follower = arm.follower(&start).unwrap();
        let mut solution = Solution::default();
        for step in 1..STEPS {
            let before = follower.q().to_vec();
            let jump = follower.advance(at(step), &mut solution).unwrap();
            if jump.is_none() || !solution.reached {
                continue;
            }
            jumps += 1;
            let length = distance(&solution.q, &before);
            let others = (0..60).filter_map(|_| {
                let other = arm.solve(at(step), &random.configuration(&arm)).unwrap();
                let q = nearest_turns(&arm, &other.q, &before);
                other.reached.then(|| distance(&q, &before))
            });
            let shortest = others.fold(f64::INFINITY, f64::min);
            too_long += usize::from(length > shortest + 1e-6);
            let mut fresh = arm.follower(&solution.q).unwrap();
            let mut begun = Solution::default();
            fresh.advance(at(step + 1), &mut begun).unwrap();
            let jumps_on = follower.advance(at(step + 1), &mut solution).unwrap();
            if jumps_on.is_none() {
                assert!(distance(&begun.q, &solution.q) < 1e-4);
                after[0] += begun.iterations;
                after[1] += solution.iterations;
            }
            break;
        }
    }
    // Attempts rarely miss the nearest solution.
    assert!(
        jumps >= 15 && too_long * 10 <= jumps,
        "{too_long} of {jumps}"
    );
    assert!(after[1] <= after[0] + jumps / 2, "{after:?} of {jumps}");
}

/// Paths whose targets jump, so that branches end. Where a later search finds a continuous path, earlier jumps are not
/// reported.
#[test]
fn reported_jumps_are_those_of_the_track() {
    let robot = robot("franka_panda");
    let (mut reported, mut tracks) = (0, 0);
    for (goal, seed) in [
        (PoseBounds::default(), 147),
        (PoseBounds::free_about(Axis::Z), 178),
    ] {
        let arm = Arm::builder(&robot, "base", "flange").with_goal(goal);
        let arm = arm.with_atlas(false).with_global_search_on_miss(true);
        let arm = arm.build().unwrap();
        let mut random = Random::split_mix(seed);
        let ends = [(); 3].map(|()| random.configuration(&arm));
        let [first, second, third] = ends.each_ref().map(|q| arm.base_from_tool(q).unwrap());
        let mut points = Vec::new();
        for [from, to] in [[first, second], [second, third]] {
            let (from, displacement) = (from.translation, to.translation - from.translation);
            let shares = (0..60).map(|step| f64::from(step) / 60.0);
            points.extend(
                shares.map(|share| Placement::new(first.rotation, from + displacement * share)),
            );
        }
        let track = arm.track(&points, &ends[0]).unwrap();
        let expected_steps = far_steps(&track);
        let jumps = track.jumps.iter().map(|jump| (jump.index, jump.distance));
        assert_eq!(jumps.collect::<Vec<_>>(), expected_steps, "{seed}");
        tracks += usize::from(!expected_steps.is_empty());
        reported += expected_steps.len();
    }
    assert!(
        tracks == 2 && reported > 10,
        "{reported} jumps of {tracks} tracks"
    );
}

#[test]
fn path_follower_returns_within_limits_in_steps() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange").with_atlas(false);
    let arm = arm.build().unwrap();
    let start = [6.9, -1.0, 1.0, -0.5, 0.5, 0.2];
    let target = arm.base_from_tool(&start).unwrap();
    let mut follower = arm.follower(&start).unwrap();
    assert_eq!(follower.q(), start);
    let mut solution = kinopt::Solution::default();
    for step in 0..8 {
        let before = follower.q()[0];
        assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
        assert!((follower.q()[0] - before).abs() <= 0.2 + 1e-12, "{step}");
        let inside = follower.q()[0] <= 2.0 * std::f64::consts::PI;
        // 0.617 rad outside.
        assert_eq!(inside, step >= 3, "{step}");
        assert!(inside || !solution.reached, "{step}");
    }
}
