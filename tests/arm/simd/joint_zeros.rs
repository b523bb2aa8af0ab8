//! Promise: results do not depend on the zeros of joints. A chain whose first and last joints have shifted zeros and
//! limits is solved from the same seeds in the same number of steps.
#![allow(clippy::unwrap_used)]

use kinopt::simd_ik::{Chain, LaneOptions, PoseSolver, Prefer};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::random::{Random, case_count};
use support::simd_chains::{panda, target, ur5};

/// The same chain, with the values of two joints increased by angles in radians.
fn with_shifted_zeros(chain: &Chain, shifts: [f64; 2]) -> Chain {
    let mut joints = chain.joints().to_vec();
    let last = joints.len() - 1;
    for (index, shift) in [0, last].into_iter().zip(shifts) {
        let joint = &mut joints[index];
        let back = Matrix3::rotation(joint.axis, (-shift).sin_cos());
        let back = Placement::new(back, Vector3::zero());
        joint.parent_from_joint = joint.parent_from_joint * back;
        joint.lower += shift;
        joint.upper += shift;
    }
    Chain::new(joints, *chain.joint_from_tip()).unwrap()
}

#[test]
fn shifted_zeros_have_the_same_seeds() {
    for chain in [panda(), ur5()] {
        let n = chain.joints().len();
        let plain = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
        for shifts in [[0.0, 2.5], [2.5, 0.0], [-4.0, 4.0]] {
            let solver =
                PoseSolver::new(&with_shifted_zeros(&chain, shifts), LaneOptions::default())
                    .unwrap();
            let mut random = Random::split_mix(11);
            let (mut q, mut other) = (vec![0.0; n], vec![0.0; n]);
            let (mut spent, mut same, count) = ([0; 2], 0, case_count(200, 60));
            for _ in 0..count {
                let goal = target(&chain, &random.chain_configuration(&chain));
                let mut start = random.chain_configuration(&chain);
                let first = Prefer::First;
                let outcome = plain.solve(&goal, &start, first, None, &mut q).unwrap();
                start[0] += shifts[0];
                start[n - 1] += shifts[1];
                let turned = solver
                    .solve(&goal, &start, first, None, &mut other)
                    .unwrap();
                assert!(outcome.reached && turned.reached);
                spent[0] += outcome.iterations;
                spent[1] += turned.iterations;
                other[0] -= shifts[0];
                other[n - 1] -= shifts[1];
                let apart = q.iter().zip(&other).map(|(a, b)| (a - b).abs());
                same += usize::from(apart.fold(0.0, f64::max) < 1e-5);
            }
            // Rounding can occasionally lead to another seed.
            assert!(20 * same >= 19 * count, "{shifts:?}: {same} of {count}");
            let [original, turned] = spent.map(f64::from);
            assert!(
                (turned / original - 1.0).abs() < 0.02,
                "{shifts:?}: {spent:?}"
            );
        }
    }
}
