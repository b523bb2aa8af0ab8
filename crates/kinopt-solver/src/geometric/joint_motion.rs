//! Best motion of one joint, in closed form.
//!
//! A rotation of a vector u by δ about the unit axis a brings it closest to the position v at the minimum of
//!
//! ```text
//! ½‖R(δ) u − v‖² = constant − (c cos δ + s sin δ),   c = u⊥ · v⊥,   s = a · (u × v)
//! ```
//!
//! The minimum is at the signed angle atan2(s, c) from u⊥ to v⊥, both projected along the axis. Sums of such terms have
//! the same form, so one joint may have several points and directions as targets. Source: Wang & Chen 1991, "A combined
//! optimization method for solving the inverse kinematics problem of mechanical manipulators", eq. 17 to 21.

use std::f64::consts::TAU;

use crate::problem::ProblemInstance;
use kinopt_kinematics::kinematics::JointAxis;
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Sum of the terms of several vectors, for one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RotationCost {
    cosine: f64,
    sine: f64,
}

impl RotationCost {
    /// A sum with its maximum at `angle`, radians.
    pub(super) fn towards(angle: f64) -> Self {
        let (sine, cosine) = elementary::sin_cos(angle);
        Self { cosine, sine }
    }

    /// Adds a vector u, relative to a point on the axis, with its target v.
    pub(super) fn add_target(
        &mut self,
        axis: Vector3<f64>,
        u: Vector3<f64>,
        v: Vector3<f64>,
        weight: f64,
    ) {
        self.cosine += weight * (u.dot(v) - axis.dot(u) * axis.dot(v));
        self.sine += weight * axis.dot(u.cross(v));
    }

    /// The best δ within `range`, which contains 0, radians.
    ///
    /// If the direct angle is outside, the equivalent angle in the opposite direction is used. If both are outside, the
    /// better end of the range is used.
    pub(super) fn best(&self, range: Limits) -> f64 {
        let direct = elementary::atan2(self.sine, self.cosine);
        if range.contains(direct) {
            return direct;
        }
        let equivalent = direct - TAU.copysign(direct);
        if range.contains(equivalent) {
            return equivalent;
        }
        // Both ends are finite; otherwise one of the two angles would be in the range.
        let gain =
            |delta: f64| self.cosine * elementary::cos(delta) + self.sine * elementary::sin(delta);
        match gain(range.lower) > gain(range.upper) {
            true => range.lower,
            false => range.upper,
        }
    }
}

/// Moves the variable of a joint by the result of `best` for the joint's range; returns the joint's motion.
#[inline]
pub(super) fn move_joint(
    instance: ProblemInstance<'_>,
    joint: usize,
    x: &mut [f64],
    best: impl FnOnce(Limits) -> f64,
) -> f64 {
    let (variable, bounded) = BoundedVariable::of(instance, joint);
    let motion = best(bounded.motion_range(x[variable]));
    x[variable] = bounded.moved_by(x[variable], motion);
    motion
}

/// The matrix of a rotation about an axis.
pub(super) fn rotation_matrix(axis: Vector3<f64>, angle: f64) -> Matrix3<f64> {
    Matrix3::rotation(axis, elementary::sin_cos(angle))
}

/// The signed angle from u to v about the axis; 0 if one of them is parallel to it.
fn signed_angle(axis: Vector3<f64>, u: Vector3<f64>, v: Vector3<f64>) -> f64 {
    let mut cost = RotationCost::default();
    cost.add_target(axis, u, v, 1.0);
    elementary::atan2(cost.sine, cost.cosine)
}

/// The two pairs of rotations about an inner and then an outer axis through one point that rotate u onto v.
///
/// Returns (outer, inner) angles in radians. If v is unreachable, u comes close to it. `None` for parallel axes.
/// Source: Paden-Kahan subproblem 2; Murray, Li & Sastry 1994, "A Mathematical Introduction to Robotic Manipulation",
/// section 3.2.
pub(super) fn two_rotations(
    outer: Vector3<f64>,
    inner: Vector3<f64>,
    u: Vector3<f64>,
    v: Vector3<f64>,
) -> Option<[(f64, f64); 2]> {
    const PARALLEL_TOLERANCE: f64 = 1e-12;
    let c = outer.dot(inner);
    let normal = outer.cross(inner);
    let normal_squared = normal.norm_squared();
    if normal_squared < PARALLEL_TOLERANCE {
        return None;
    }
    // Between the rotations u is at z = α outer + β inner ± γ outer × inner.
    let alpha = (outer.dot(v) - c * inner.dot(u)) / normal_squared;
    let beta = (inner.dot(u) - c * outer.dot(v)) / normal_squared;
    let in_plane = alpha * alpha + beta * beta + 2.0 * alpha * beta * c;
    let gamma = ((u.norm_squared() - in_plane) / normal_squared)
        .max(0.0)
        .sqrt();
    let middle = outer * alpha + inner * beta;
    Some([gamma, -gamma].map(|gamma| {
        let z = middle + normal * gamma;
        (signed_angle(outer, z, v), signed_angle(inner, u, z))
    }))
}

/// A variable within its bounds, moved in units of its joint.
pub(super) struct BoundedVariable {
    pub(super) bounds: Limits,
    /// Joint units per variable unit.
    pub(super) ratio: f64,
}

impl BoundedVariable {
    /// Index and bounds of a joint's variable.
    pub(super) fn of(instance: ProblemInstance<'_>, joint: usize) -> (usize, Self) {
        let (variable, ratio) = instance.tree().variable_of(joint);
        let bounds = Limits::new(instance.lower()[variable], instance.upper()[variable]);
        (variable, Self { bounds, ratio })
    }

    /// The range of the joint's motion from its present value.
    pub(super) fn motion_range(&self, x: f64) -> Limits {
        let (a, b) = (
            self.ratio * (self.bounds.lower - x),
            self.ratio * (self.bounds.upper - x),
        );
        // Avoids 0 · ∞ for a joint that its variable does not move.
        match self.ratio == 0.0 {
            true => Limits::new(0.0, 0.0),
            false => Limits::new(a.min(b), a.max(b)),
        }
    }

    /// The variable after its joint moved by `motion`; snaps to a bound that is within rounding.
    pub(super) fn moved_by(&self, x: f64, motion: f64) -> f64 {
        const RELATIVE_ROUNDING: f64 = 4.0 * f64::EPSILON;
        if motion == 0.0 || self.ratio == 0.0 {
            return x;
        }
        let value = self.bounds.clamp(x + motion / self.ratio);
        let Limits { lower, upper } = self.bounds;
        let is_at = |bound: f64| {
            bound.is_finite()
                && (value - bound).abs() <= RELATIVE_ROUNDING * x.abs().max(bound.abs())
        };
        match (is_at(lower), is_at(upper)) {
            (true, _) => lower,
            (_, true) => upper,
            _ => value,
        }
    }
}

/// The best translation of a prismatic joint for some points: the weighted mean of their offsets along its axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TranslationCost {
    weighted_offset: f64,
    weight: f64,
}

impl TranslationCost {
    /// Adds a point whose target is at `offset` from it.
    pub(super) fn add_target(&mut self, axis: &JointAxis, offset: Vector3<f64>, weight: f64) {
        self.weighted_offset += weight * axis.direction.dot(offset);
        self.weight += weight;
    }

    /// The best translation within `range`, metres.
    pub(super) fn best(&self, range: Limits) -> f64 {
        match self.weight > 0.0 {
            true => range.clamp(self.weighted_offset / self.weight),
            false => 0.0,
        }
    }
}
