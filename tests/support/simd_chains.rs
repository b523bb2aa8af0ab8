//! Chains for tests of the SIMD solver, and forward kinematics by nalgebra.

use std::f64::consts::{FRAC_PI_2, PI};

use kinopt::simd_ik::{Chain, ChainJoint, JointKind};
use kinopt::spatial::{Placement, Vector3};
use nalgebra::{Isometry3, Rotation3, Translation3, Unit, UnitQuaternion};

use crate::random::Random;

impl Random {
    /// Random configuration within the bounds; joints without bounds are within a turn or a metre of zero.
    pub fn chain_configuration(&mut self, chain: &Chain) -> Vec<f64> {
        chain
            .joints()
            .iter()
            .map(|joint| self.within(joint.lower.max(-PI), joint.upper.min(PI)))
            .collect()
    }
}

fn placement(isometry: Isometry3<f64>) -> Placement<f64> {
    Placement::from(&isometry)
}

fn modified_dh(a: f64, d: f64, alpha: f64) -> Isometry3<f64> {
    Isometry3::rotation(nalgebra::Vector3::x() * alpha)
        * Translation3::new(a, 0.0, 0.0)
        * Translation3::new(0.0, 0.0, d)
}

fn revolute(
    parent_from_joint: Isometry3<f64>,
    axis: [f64; 3],
    lower: f64,
    upper: f64,
) -> ChainJoint {
    ChainJoint {
        parent_from_joint: placement(parent_from_joint),
        axis: axis.into(),
        kind: JointKind::Revolute,
        lower,
        upper,
    }
}

/// Franka Emika Panda up to the flange: Denavit-Hartenberg parameters (Craig) and joint limits of the manufacturer's
/// Robot and Interface Specifications.
pub fn panda() -> Chain {
    let rows = [
        (0.0, 0.333, 0.0, -2.8973, 2.8973),
        (0.0, 0.0, -FRAC_PI_2, -1.7628, 1.7628),
        (0.0, 0.316, FRAC_PI_2, -2.8973, 2.8973),
        (0.0825, 0.0, FRAC_PI_2, -3.0718, -0.0698),
        (-0.0825, 0.384, -FRAC_PI_2, -2.8973, 2.8973),
        (0.0, 0.0, FRAC_PI_2, -0.0175, 3.7525),
        (0.088, 0.0, FRAC_PI_2, -2.8973, 2.8973),
    ];
    let joints = rows
        .iter()
        .map(|&(a, d, alpha, lower, upper)| {
            revolute(modified_dh(a, d, alpha), [0.0, 0.0, 1.0], lower, upper)
        })
        .collect();
    Chain::new(joints, placement(Isometry3::translation(0.0, 0.0, 0.107))).unwrap()
}

/// Universal Robots UR5: the manufacturer's Denavit-Hartenberg parameters; every joint has a range of ±360°.
pub fn ur5() -> Chain {
    let rows = [
        (0.0, 0.089_159, 0.0),
        (0.0, 0.0, FRAC_PI_2),
        (-0.425, 0.0, 0.0),
        (-0.392_25, 0.109_15, 0.0),
        (0.0, 0.094_65, FRAC_PI_2),
        (0.0, 0.0823, -FRAC_PI_2),
    ];
    let joints = rows
        .iter()
        .map(|&(a, d, alpha)| {
            revolute(
                modified_dh(a, d, alpha),
                [0.0, 0.0, 1.0],
                -2.0 * PI,
                2.0 * PI,
            )
        })
        .collect();
    Chain::new(joints, placement(Isometry3::identity())).unwrap()
}

/// Chain of random placements and axes with `slides` prismatic joints. Every fourth revolute joint has no bounds if
/// `continuous` is true.
pub fn random_chain(seed: u64, joints: usize, slides: usize, continuous: bool) -> Chain {
    let mut random = Random::split_mix(seed);
    let length = 1.2 / joints as f64;
    let list = (0..joints)
        .map(|i| {
            let vector = |r: &mut Random| {
                nalgebra::Vector3::new(
                    r.within(-1.0, 1.0),
                    r.within(-1.0, 1.0),
                    r.within(-1.0, 1.0),
                )
            };
            let rotation = vector(&mut random) * 1.5;
            let translation = vector(&mut random) * length + nalgebra::Vector3::z() * length;
            let axis: [f64; 3] = (vector(&mut random) * 2.0).into();
            let slides = i % 3 == 1 && i / 3 < slides;
            let (lower, upper) = if slides {
                (random.within(-0.5, -0.2), random.within(0.2, 0.5))
            } else if continuous && i % 4 == 0 {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                (random.within(-3.0, -1.5), random.within(1.5, 3.0))
            };
            ChainJoint {
                parent_from_joint: placement(Isometry3::new(translation, rotation)),
                axis: axis.into(),
                kind: if slides {
                    JointKind::Prismatic
                } else {
                    JointKind::Revolute
                },
                lower,
                upper,
            }
        })
        .collect();
    let tip = Isometry3::new(
        nalgebra::Vector3::new(0.02, -0.05, 0.1),
        nalgebra::Vector3::new(0.3, 0.2, -0.5),
    );
    Chain::new(list, placement(tip)).unwrap()
}

/// Planar arm: two revolute joints about z with links of 1 m.
pub fn planar() -> Chain {
    let link = Isometry3::translation(1.0, 0.0, 0.0);
    let axis = [0.0, 0.0, 1.0];
    let joints = vec![
        revolute(Isometry3::identity(), axis, -3.0, 3.0),
        revolute(link, axis, -2.5, 2.5),
    ];
    Chain::new(joints, placement(link)).unwrap()
}

/// Forward kinematics by nalgebra, as in textbooks.
pub fn tip(chain: &Chain, q: &[f64]) -> Isometry3<f64> {
    let mut at = Isometry3::identity();
    for (joint, &value) in chain.joints().iter().zip(q) {
        let axis = Unit::new_normalize(nalgebra::Vector3::from(joint.axis));
        at *= Isometry3::from(&joint.parent_from_joint);
        at *= match joint.kind {
            JointKind::Prismatic => Isometry3::from_parts(
                Translation3::from(axis.into_inner() * value),
                UnitQuaternion::identity(),
            ),
            _ => Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&axis, value),
            ),
        };
    }
    at * Isometry3::from(chain.joint_from_tip())
}

/// Placement of the tip, as a target.
pub fn target(chain: &Chain, q: &[f64]) -> Placement<f64> {
    placement(tip(chain, q))
}

/// Distance (m) and angle (rad) between the tip at q and a target.
pub fn errors(chain: &Chain, q: &[f64], target: &Placement<f64>) -> (f64, f64) {
    let tip = tip(chain, q);
    let distance = (tip.translation.vector - nalgebra::Vector3::from(target.translation)).norm();
    let target_rotation = Rotation3::from_matrix_unchecked(target.rotation.into());
    let relative = target_rotation.inverse() * tip.rotation.to_rotation_matrix();
    let m = relative.matrix();
    let skew = nalgebra::Vector3::new(
        m[(2, 1)] - m[(1, 2)],
        m[(0, 2)] - m[(2, 0)],
        m[(1, 0)] - m[(0, 1)],
    );
    (distance, skew.norm().atan2(m.trace() - 1.0))
}

/// True if every value is exactly within its bounds.
pub fn within_bounds(chain: &Chain, q: &[f64]) -> bool {
    chain
        .joints()
        .iter()
        .zip(q)
        .all(|(joint, value)| joint.lower <= *value && *value <= joint.upper)
}

/// Unreachable target in the orientation of the base.
pub fn far_away() -> Placement<f64> {
    Placement::new(
        kinopt::spatial::Matrix3::identity(),
        Vector3::new(9.0, -4.0, 2.0),
    )
}
