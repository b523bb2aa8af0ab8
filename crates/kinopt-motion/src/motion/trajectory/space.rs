//! Manifold of the variables of one sample.

use std::f64::consts::PI;

use kinopt_kinematics::model::{BallVariables, ParameterMap};
use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3, rotation_log_jacobian};

/// Variables of a sample as a manifold of numbers and rotations.
///
/// Rotations are compared in the rotated frame, log(RᵀR'), and moved in it, R exp(δ). See Solà, Deray & Atchuthan 2018,
/// "A micro Lie theory for state estimation in robotics". A ball joint with swing or angle limits is moved by its
/// variables instead. The limits keep these away from singularities.
#[derive(Clone, Debug)]
pub(super) struct FrameSpace {
    balls: Vec<BallVariables>,
}

/// Returns whether a ball joint has limits, so that steps move its variables.
pub(super) fn is_bounded(ball: &BallVariables) -> bool {
    ball.swing.is_some() || ball.angle.is_some_and(|angle| angle < PI)
}

/// Returns the rotation of a ball joint.
pub(super) fn rotation(ball: &BallVariables, x: &[f64]) -> Quaternion<f64> {
    let variables = ball.of(x).unwrap_or([f64::NAN; 3]);
    ball.chart.rotation(variables)
}

/// Returns the derivative of `rotation_vector`, which leads to the ball's rotation, by steps of that ball
/// joint.
pub(super) fn rotation_jacobian(
    ball: &BallVariables,
    x: &[f64],
    rotation_vector: Vector3<f64>,
) -> Matrix3<f64> {
    let by_rotation = rotation_log_jacobian(-rotation_vector);
    match is_bounded(ball) {
        false => by_rotation,
        true => {
            let variables = ball.of(x).unwrap_or([f64::NAN; 3]);
            let inverse_rotation = ball.chart.rotation(variables).to_matrix().transpose();
            let [first, second, third] = ball.chart.axes(variables);
            by_rotation * inverse_rotation * Matrix3::from_columns(first, second, third)
        }
    }
}

/// Derivatives of the difference of two rotations, row by row.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallSlopes {
    /// Index of the first of the three variables.
    pub(super) first: usize,
    /// Derivatives by the first and by the second sample.
    pub(super) by_from: [[f64; 3]; 3],
    pub(super) by_to: [[f64; 3]; 3],
}

impl FrameSpace {
    pub(super) fn new(map: &ParameterMap) -> Self {
        Self {
            balls: map.balls().to_vec(),
        }
    }

    /// Returns whether a variable is a number, not part of a rotation.
    pub(super) fn is_number(&self, variable: usize) -> bool {
        let mut balls = self.balls.iter();
        !balls.any(|ball| (ball.variable..ball.variable + 3).contains(&variable))
    }

    /// Writes x ⊕ share · step.
    pub(super) fn integrate(&self, x: &[f64], fraction: f64, step: &[f64], to: &mut [f64]) {
        for ((to, x), step) in to.iter_mut().zip(x).zip(step) {
            *to = x + fraction * step;
        }
        for ball in self.balls.iter().filter(|ball| !is_bounded(ball)) {
            let range = ball.variable..ball.variable + 3;
            let delta = &step[range.clone()];
            let delta = Quaternion::exp(Vector3::new(delta[0], delta[1], delta[2]) * fraction);
            let rotated = rotation(ball, x) * delta;
            to[range].copy_from_slice(&ball.chart.variables(rotated));
        }
    }

    /// Writes to ⊖ from.
    pub(super) fn difference(&self, to: &[f64], from: &[f64], displacement: &mut [f64]) {
        for ((displacement, to), from) in displacement.iter_mut().zip(to).zip(from) {
            *displacement = to - from;
        }
        for ball in &self.balls {
            let rotated = rotation(ball, from).conjugate() * rotation(ball, to);
            displacement[ball.variable..ball.variable + 3]
                .copy_from_slice(&rotated.log().to_array());
        }
    }

    /// Returns the derivatives of the rotations in a [`difference`](Self::difference) by steps of both samples.
    pub(super) fn slopes<'a>(
        &'a self,
        displacement: &'a [f64],
        [from, to]: [&'a [f64]; 2],
    ) -> impl Iterator<Item = BallSlopes> + 'a {
        self.balls.iter().map(move |ball| {
            let first = ball.variable;
            let displacement = Vector3::new(
                displacement[first],
                displacement[first + 1],
                displacement[first + 2],
            );
            let rows = |columns: Matrix3<f64>, sign: f64| {
                let columns = [columns.x, columns.y, columns.z];
                let [x, y, z] = columns.map(|column| (column * sign).to_array());
                [0, 1, 2].map(|k| [x[k], y[k], z[k]])
            };
            BallSlopes {
                first,
                by_from: rows(rotation_jacobian(ball, from, -displacement), -1.0),
                by_to: rows(rotation_jacobian(ball, to, displacement), 1.0),
            }
        })
    }

    /// Converts Jacobian columns by the variables (column-major, `rows` rows) to columns by a step.
    pub(super) fn by_steps(&self, x: &[f64], rows: usize, entries: &mut [f64]) {
        for ball in self.balls.iter().filter(|ball| !is_bounded(ball)) {
            let Some([a, b, c]) = ball.of(x) else {
                continue;
            };
            // ẋ = J_r(x)⁻¹ ω in the rotated frame, with J_r(x) = J_l(−x).
            let inverse_jacobian = rotation_log_jacobian(-Vector3::new(a, b, c));
            let index = |column: usize, row: usize| (ball.variable + column) * rows + row;
            for row in 0..rows {
                let row_vector = Vector3::from([0, 1, 2].map(|k| entries[index(k, row)]));
                for (k, column) in [inverse_jacobian.x, inverse_jacobian.y, inverse_jacobian.z]
                    .into_iter()
                    .enumerate()
                {
                    entries[index(k, row)] = row_vector.dot(column);
                }
            }
        }
    }
}
