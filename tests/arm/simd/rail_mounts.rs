//! Promise: an arm whose mount is tilted from its vertical rail by rounding needs no more attempts than an exactly
//! upright one. The tilt may have any direction.

use kinopt::simd_ik::{Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::random::Random;
use support::simd_chains::{panda, target};

/// The Panda next to a short vertical rail, tilted about horizontal axes by angles in radians.
fn on_a_rail(tilt: [f64; 2]) -> Chain {
    let rail = ChainJoint {
        parent_from_joint: Placement::identity(),
        axis: Vector3::UNITS[2],
        kind: JointKind::Prismatic,
        lower: -0.2,
        upper: 0.2,
    };
    let tilted = rotation_exp(Vector3::new(tilt[0], tilt[1], 0.0));
    let mount = Placement::new(tilted, Vector3::new(0.6, 0.0, 0.0));
    let mut joints = vec![rail];
    joints.extend(panda().joints().iter().cloned());
    joints[1].parent_from_joint = mount * joints[1].parent_from_joint;
    Chain::new(joints, *panda().joint_from_tip()).unwrap()
}

/// Attempts for 200 poses.
fn attempts(chain: &Chain) -> u32 {
    const COUNT: usize = 200;
    let solver = PoseSolver::new(chain, LaneOptions::default()).unwrap();
    let mut random = Random::split_mix(5);
    let drawn = [(); COUNT].map(|()| random.chain_configuration(chain));
    let goals = drawn.map(|q| target(chain, &q));
    let n = solver.joints();
    let starts = vec![0.1; n * COUNT];
    let (mut q, mut outcomes) = (vec![0.0; n * COUNT], vec![PoseOutcome::default(); COUNT]);
    solver
        .solve_batch(&goals, &starts, Prefer::First, &mut q, &mut outcomes)
        .unwrap();
    assert!(outcomes.iter().all(|outcome| outcome.reached));
    outcomes.iter().map(|outcome| outcome.attempts).sum()
}

#[test]
fn mount_tilted_by_rounding_costs_no_attempts() {
    let upright = attempts(&on_a_rail([0.0, 0.0]));
    for tilt in [[1e-11, 0.0], [-1e-11, 0.0], [0.0, 1e-11], [-7e-12, -7e-12]] {
        let tilted = attempts(&on_a_rail(tilt));
        assert!(tilted * 4 <= upright * 5, "{tilt:?}: {tilted}, {upright}");
    }
}
