//! Promise: so it is for the lane engine under options that are not usual, and for what it refuses.
#![allow(clippy::unwrap_used)]

use kinopt::simd_ik::{
    AxisGoal, Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer,
};
use kinopt::spatial::{Placement, Vector3};

use crate::arm_doors::refused;
use crate::arms::turned;
use crate::digest::{Digest, Value, check};
use support::random::Random;

fn joint(kind: JointKind, lower: f64, upper: f64) -> ChainJoint {
    ChainJoint {
        parent_from_joint: Placement::translation(Vector3::new(0.1, 0.0, 0.2)),
        axis: Vector3::new(0.0, 2.0, 0.5),
        kind,
        lower,
        upper,
    }
}

/// The lane engine under options that are not usual, and what it refuses.
fn engine() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(73));
    let turning = joint(JointKind::Revolute, -2.0, 2.5);
    let tip = Placement::translation(Vector3::new(0.0, 0.1, 0.1));
    let endless = (f64::NEG_INFINITY, f64::INFINITY);
    let mut aside = turning;
    aside.parent_from_joint.rotation = turned(|| random.unit());
    let joints = vec![
        joint(JointKind::Prismatic, -0.2, 0.3),
        aside,
        turning,
        joint(JointKind::Continuous, endless.0, endless.1),
        aside,
        turning,
    ];
    let chain = Chain::new(joints.clone(), tip).unwrap();
    digest.bytes(format!("{:?}", chain.joints()));
    let usual = LaneOptions::default()
        .with_atlas(false)
        .with_attempts(9)
        .with_total_iterations(90);
    let mut loose = AxisGoal::full_pose();
    loose.position_weights = [1.0, 0.5, 2.0];
    loose.orientation_half_widths = [0.0, 0.2, 0.0];
    for options in [
        usual.clone(),
        usual.clone().with_damping(0.5).with_stall_limit(2),
        usual
            .clone()
            .with_position_tolerance(1e-2)
            .with_orientation_tolerance(1e-3),
        usual.clone().with_metres_per_radian(2.0).with_axes(loose),
        usual.clone().with_seed(9).with_iterations(7),
        usual.clone().with_attempts(2).with_total_iterations(5),
        usual.clone().with_axes(AxisGoal::position_only()),
    ] {
        let solver = PoseSolver::new(&chain, options).unwrap();
        digest.word(solver.joints() as u64 + solver.atlas_memory() as u64);
        let (mut q, mut outcomes) = (vec![0.0; 18], vec![PoseOutcome::default(); 3]);
        for _ in 0..2 {
            let mut draw = || -> Vec<f64> { (0..6).map(|_| 4.0 * random.unit() - 2.0).collect() };
            let targets: Vec<_> = (0..3)
                .map(|_| chain.base_from_tip(&draw()).unwrap())
                .collect();
            let starts: Vec<f64> = (0..3).flat_map(|_| draw()).collect();
            for search in [Prefer::First, Prefer::Start] {
                solver
                    .solve_batch(&targets, &starts, search, &mut q, &mut outcomes)
                    .unwrap();
                digest.doubles(q.iter().copied());
                digest.bytes(format!("{outcomes:?}"));
            }
            solver
                .track(&targets, &starts[..6], &mut q, &mut outcomes)
                .unwrap();
            digest.doubles(q.iter().copied());
            digest.bytes(format!("{outcomes:?}"));
            let search = Prefer::Start;
            solver
                .run_attempts(&targets[0], &starts[..6], search, 2, &mut q, &mut outcomes)
                .unwrap();
            digest.doubles(q[..12].iter().copied());
        }
        let tip = chain.base_from_tip(&[0.1; 6]).unwrap();
        let mut odd = tip;
        odd.rotation.x = -odd.rotation.x;
        let search = Prefer::Start;
        refused(
            &mut digest,
            solver.solve(&odd, &[0.0; 6], search, None, &mut q[..6]),
        );
        refused(
            &mut digest,
            solver.solve(&tip, &[0.0; 5], search, None, &mut q[..6]),
        );
        refused(
            &mut digest,
            solver.solve(&tip, &[f64::NAN; 6], search, None, &mut q[..6]),
        );
        refused(
            &mut digest,
            solver.solve(&tip, &[0.0; 6], search, None, &mut q[..5]),
        );
        refused(
            &mut digest,
            solver.solve_batch(
                &[tip, odd],
                &[0.0; 12],
                search,
                &mut q[..12],
                &mut outcomes[..2],
            ),
        );
        refused(
            &mut digest,
            solver.solve_batch(
                &[tip; 2],
                &[0.0; 11],
                search,
                &mut q[..12],
                &mut outcomes[..2],
            ),
        );
        refused(
            &mut digest,
            solver.solve_batch(&[tip; 2], &[0.0; 12], search, &mut q, &mut outcomes[..2]),
        );
        refused(
            &mut digest,
            solver.solve_batch(&[tip; 2], &[0.0; 12], search, &mut q[..12], &mut outcomes),
        );
        refused(&mut digest, chain.base_from_tip(&[f64::NAN; 6]));
        refused(&mut digest, chain.base_from_tip(&[0.0; 7]));
    }
    let mut flat = AxisGoal::full_pose();
    flat.position_weights[1] = -1.0;
    let mut wide = AxisGoal::full_pose();
    wide.orientation_half_widths[2] = f64::NAN;
    for options in [
        usual.clone().with_damping(0.0),
        usual.clone().with_metres_per_radian(-1.0),
        usual.clone().with_position_tolerance(f64::NAN),
        usual.clone().with_orientation_tolerance(0.0),
        usual.clone().with_axes(flat),
        usual.with_axes(wide),
    ] {
        refused(&mut digest, PoseSolver::new(&chain, options));
    }
    let mut others = vec![
        joint(JointKind::Fixed, 0.0, 1.0),
        joint(JointKind::Revolute, 1.0, 0.0),
        joint(JointKind::Revolute, f64::NAN, 0.0),
        joint(JointKind::Revolute, 0.0, 1e9),
        joint(JointKind::Prismatic, 0.0, 1e9),
    ];
    let mut still = turning;
    still.axis = Vector3::zero();
    let mut mirrored = turning;
    mirrored.parent_from_joint.rotation.z = -mirrored.parent_from_joint.rotation.z;
    others.extend([still, mirrored]);
    for other in others {
        refused(&mut digest, Chain::new(vec![turning, other], tip));
    }
    refused(&mut digest, Chain::new(Vec::new(), tip));
    refused(&mut digest, Chain::new(vec![turning; 65], tip));
    refused(&mut digest, Chain::new(joints, mirrored.parent_from_joint));
    digest.value()
}

#[test]
fn of_the_engine_under_options() {
    check(&[("lane engine under options, and what it refuses", engine())]);
}
