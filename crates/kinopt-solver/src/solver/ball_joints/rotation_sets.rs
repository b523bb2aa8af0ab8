//! Groups of variables that form rotations: rotation vectors, swings within an ellipse, rotations within an angle.

use std::f64::consts::{PI, TAU};

use super::TurnLimit;
use super::edge_frame::{Edge, NearEdge};
use kinopt_kinematics::spatial::Vector3;

/// Variables of a problem that rotate ball joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RotationSets {
    /// First of the three variables of each rotation vector.
    pub(crate) vectors: Vec<usize>,
    /// Bounded swings, in the order of their variables.
    pub(crate) swings: Vec<Swing>,
    /// Ball joints with a largest angle.
    pub(crate) turns: Vec<TurnLimit>,
}

impl RotationSets {
    /// No ball joints.
    pub(crate) const NONE: Self = Self {
        vectors: Vec::new(),
        swings: Vec::new(),
        turns: Vec::new(),
    };

    /// Swing that a variable belongs to.
    #[inline]
    pub(crate) fn swing_of(&self, variable: usize) -> Option<&Swing> {
        let next = self
            .swings
            .partition_point(|swing| swing.first + 1 < variable);
        let swing = self.swings.get(next);
        swing.filter(|swing| swing.first <= variable)
    }
}

/// Swing of a ball joint: two variables within an ellipse around 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swing {
    /// Index of the first variable; the other follows it.
    pub(crate) first: usize,
    /// Half axes of the ellipse, radians.
    pub(crate) half_angles: [f64; 2],
}

/// Relative distance from the edge within which a swing moves along and across it, so that the edge holds one variable.
const NEAR_EDGE_TOLERANCE: f64 = 1e-6;
/// Relative distance from the edge within which a swing counts as on it.
const ON_EDGE_TOLERANCE: f64 = 1e-12;
/// Relative distance within the edge at which a projection ends, for rounding.
const PROJECTION_MARGIN: f64 = 1e-14;
/// Largest number of Newton steps to the nearest point of an ellipse.
const MAX_NEWTON_STEPS: usize = 60;

impl Swing {
    fn of(&self, x: &[f64]) -> [f64; 2] {
        [x[self.first], x[self.first + 1]]
    }

    /// Distance from the centre relative to the edge: 1 on the edge.
    fn relative_distance(&self, [first, second]: [f64; 2]) -> f64 {
        let [a, b] = self.half_angles;
        let (u, v) = (first / a, second / b);
        (u * u + v * v).sqrt()
    }

    /// Returns true on the edge.
    pub(in crate::solver) fn is_on(&self, x: &[f64]) -> bool {
        self.relative_distance(self.of(x)) >= 1.0 - ON_EDGE_TOLERANCE
    }

    /// Angle of the swing, radians.
    pub(crate) fn angle(&self, x: &[f64]) -> f64 {
        let [first, second] = self.of(x);
        (first * first + second * second).sqrt()
    }

    /// Outward unit normal of the edge, if it is near; the tangent is the normal rotated by 90°.
    pub(in crate::solver) fn normal(&self, x: &[f64]) -> Option<[f64; 2]> {
        let [first, second] = self.of(x);
        let is_near = self.relative_distance([first, second]) >= 1.0 - NEAR_EDGE_TOLERANCE;
        let [a, b] = self.half_angles;
        let (u, v) = (first / (a * a), second / (b * b));
        let length = (u * u + v * v).sqrt();
        is_near.then_some([u / length, v / length])
    }

    /// Outward unit normal of the edge and its curvature (1 / radians), for a swing on it.
    pub(crate) fn edge(&self, x: &[f64]) -> Option<([f64; 2], f64)> {
        let normal = self.normal(x).filter(|_| self.is_on(x))?;
        let [first, second] = self.of(x);
        let [a, b] = self.half_angles.map(|a| 1.0 / (a * a));
        // With c = ½(u²/a² + v²/b² − 1): tᵀ ∇²c t / |∇c| for the tangent t.
        let [normal_x, normal_y] = normal;
        let (u, v) = (first * a, second * b);
        let gradient_norm = (u * u + v * v).sqrt();
        Some((
            normal,
            (normal_y * normal_y * a + normal_x * normal_x * b) / gradient_norm,
        ))
    }

    /// Edge of the swing, if it is near.
    pub(in crate::solver) fn near(&self, x: &[f64]) -> Option<NearEdge> {
        let [first, second] = self.normal(x)?;
        Some(NearEdge {
            edge: Edge::Swing,
            is_on: self.is_on(x),
            normal: Vector3::new(first, second, 0.0),
        })
    }

    /// Returns true if two angles are within the ellipse.
    pub(in crate::solver) fn holds(&self, pair: [f64; 2]) -> bool {
        self.relative_distance(pair) <= 1.0
    }

    /// Projects the swing to the nearest point within the ellipse.
    pub(in crate::solver) fn project(&self, x: &mut [f64]) {
        let swing = self.of(x);
        let distance = self.relative_distance(swing);
        if distance <= 1.0 - PROJECTION_MARGIN || !distance.is_finite() {
            return;
        }
        let projected = self.nearest(swing);
        let excess = self.relative_distance(projected) / (1.0 - PROJECTION_MARGIN);
        let projected = match excess > 1.0 {
            true => projected.map(|value| value / excess),
            false => projected,
        };
        x[self.first..self.first + 2].copy_from_slice(&projected);
    }

    /// Nearest point of the ellipse: a_i² p_i / (t + a_i²). The t ≥ 0 at which it is on the edge is found by Newton's
    /// method.
    fn nearest(&self, swing: [f64; 2]) -> [f64; 2] {
        let squares = self.half_angles.map(|a| a * a);
        let mut t = 0.0;
        for _ in 0..MAX_NEWTON_STEPS {
            let (mut value, mut slope) = (-1.0, 0.0);
            for (p, square) in swing.into_iter().zip(squares) {
                let part = p * p * square / ((t + square) * (t + square));
                value += part;
                slope -= 2.0 * part / (t + square);
            }
            if value <= 1e-15 {
                break;
            }
            t -= value / slope;
        }
        [0, 1].map(|k| squares[k] * swing[k] / (t + squares[k]))
    }
}

/// Replaces a rotation vector by the shortest one of the same rotation.
pub(in crate::solver) fn shorten_rotation_vector(vector: &mut [f64]) {
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > PI && length.is_finite() {
        let turns = (length / TAU).round();
        let factor = (length - turns * TAU) / length;
        vector.iter_mut().for_each(|v| *v *= factor);
    }
}

/// Shortens a step between rotation vectors, to − from, by a whole revolution of `to`, if that is shorter.
pub(in crate::solver) fn shorten_rotation_step(step: &mut [f64], to: &[f64]) {
    let squared = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
    let length = squared(to).sqrt();
    if length > 0.0 {
        let other: [f64; 3] = [0, 1, 2].map(|k| step[k] - TAU * to[k] / length);
        if squared(&other) < squared(step) {
            step.copy_from_slice(&other);
        }
    }
}
