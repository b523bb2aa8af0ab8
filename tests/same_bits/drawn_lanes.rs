//! Promise: so it is for the lane engine under options that are drawn at random, on chains with slides, endless and wide joints:
//! alone, in batches of any length, attempt by attempt and along ways, from starts that are far beyond, and for what is no question.
#![allow(clippy::unwrap_used)]

use kinopt::simd_ik::{AxisGoal, Chain, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

use crate::arms::odd_chain;
use crate::digest::{Digest, Value, check};
use crate::drawn::one_of;
use crate::every_joint::vector;
use crate::mixed_arms::{INF, rarely};

fn axes(random: &mut Random) -> AxisGoal {
    let mut own = match random.below(3) {
        0 => AxisGoal::position_only(),
        _ => AxisGoal::full_pose(),
    };
    for axis in 0..3 {
        match random.below(8) {
            0 => own.position_weights[axis] = one_of(random, &[0.0, 0.5, 2.0]),
            1 => own.orientation_weights[axis] = one_of(random, &[0.0, 0.5, 2.0]),
            2 => own.position_half_widths[axis] = one_of(random, &[0.0, 0.02, 1.0]),
            3 => own.orientation_half_widths[axis] = one_of(random, &[0.0, 0.2, 4.0]),
            _ => {}
        }
    }
    if rarely(random, 20) {
        own.position_half_widths[2] = -0.1;
    }
    own
}

fn options(random: &mut Random) -> LaneOptions {
    let mut own = LaneOptions::default()
        .with_atlas(false)
        .with_attempts(one_of(random, &[1, 3, 9, 12]));
    for _ in 0..random.below(6) {
        own = match random.below(10) {
            0 => own.with_position_tolerance(one_of(random, &[1e-6, 1e-3, 0.1])),
            1 => own.with_orientation_tolerance(one_of(random, &[1e-6, 1e-3, 0.5])),
            2 => own.with_metres_per_radian(one_of(random, &[0.1, 1.0, 3.0])),
            3 | 4 => own.with_axes(axes(random)),
            5 => own.with_damping(one_of(random, &[0.01, 0.5, 0.0])),
            6 => own.with_stall_limit(one_of(random, &[0, 1, 3, 20])),
            7 => own.with_iterations(one_of(random, &[0, 1, 5, 40])),
            8 => own.with_total_iterations(one_of(random, &[1, 10, 200])),
            _ => own
                .with_seed(one_of(random, &[0, 3, u64::MAX]))
                .with_portable(random.below(2) == 0),
        };
    }
    own
}

/// Values of a chain's joints: mostly within, else on limits, beyond, or no numbers.
fn values(chain: &Chain, random: &mut Random) -> Vec<f64> {
    let case = random.below(16);
    let each = chain.joints().iter().map(|joint| match case {
        0 => joint.lower.max(-3.0),
        1 => joint.upper.min(3.0) + 0.3,
        2 => random.within(-60.0, 60.0),
        3 => random.within(-4e6, 4e6),
        _ => random.within(joint.lower.max(-3.0), joint.upper.min(3.0)),
    });
    let mut all: Vec<f64> = each.collect();
    if case == 4 && rarely(random, 3) {
        all[0] = INF;
    }
    all
}

fn target(chain: &Chain, random: &mut Random) -> Placement<f64> {
    let each = chain.joints().iter();
    let within = each.map(|joint| random.within(joint.lower.max(-3.0), joint.upper.min(3.0)));
    let mut at = chain.base_from_tip(&within.collect::<Vec<_>>()).unwrap();
    match random.below(10) {
        0 => at.translation = at.translation * 3.0,
        1 => at.translation += vector(random, 0.1),
        2 if rarely(random, 5) => at.translation = Vector3::new(0.0, 0.0, f64::NAN),
        _ => {}
    }
    at
}

fn ask(digest: &mut Digest, solver: &PoseSolver, chain: &Chain, random: &mut Random) {
    let n = solver.joints();
    let prefer = one_of(random, &[Prefer::Start, Prefer::First]);
    let count = one_of(random, &[0, 1, 3, 8, 9, 17]);
    let start = values(chain, random);
    let (mut q, mut outcomes) = (vec![0.5; n * count], vec![PoseOutcome::default(); count]);
    let found = match random.below(4) {
        0 => {
            let mut q = vec![0.5; n];
            let found = solver.solve(&target(chain, random), &start, prefer, None, &mut q);
            digest.noted(&found);
            digest.doubles(q);
            return;
        }
        1 => {
            let starts: Vec<f64> = (0..count).flat_map(|_| values(chain, random)).collect();
            let targets: Vec<_> = (0..count).map(|_| target(chain, random)).collect();
            solver.solve_batch(&targets, &starts, prefer, &mut q, &mut outcomes)
        }
        2 => {
            let (at, first) = (target(chain, random), one_of(random, &[0, 1, 7, 300]));
            solver.run_attempts(&at, &start, prefer, first, &mut q, &mut outcomes)
        }
        _ => {
            let at = target(chain, random);
            let by = vector(random, 0.03);
            let ways =
                (0..count).map(|k| Placement::new(at.rotation, at.translation + by * k as f64));
            let mut ways: Vec<_> = ways.collect();
            if count > 2 && rarely(random, 6) {
                ways[count - 1].translation.x = f64::NAN;
            }
            solver.track(&ways, &start, &mut q, &mut outcomes)
        }
    };
    digest.refusal(found);
    digest.doubles(q);
    digest.noted(&outcomes);
}

fn mixes(cases: u64) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1251));
    for case in 0..cases {
        let joints = one_of(&mut random, &[1, 2, 3, 5, 6, 6, 7, 8, 9]);
        let slides = random.below(3);
        let chain = odd_chain(&mut Random::split_mix(case), joints, slides);
        let solver = match PoseSolver::new(&chain, options(&mut random)) {
            Ok(solver) => solver,
            Err(error) => {
                digest.text(error.to_string());
                continue;
            }
        };
        for _ in 0..6 {
            ask(&mut digest, &solver, &chain, &mut random);
        }
    }
    digest.value()
}

#[test]
fn of_lanes() {
    check(&[("drawn the lane engine", mixes(50))]);
}
