//! Where one frame of a motion stands, and the way from one frame to the next.

use crate::model::{BallVariables, ParameterMap};
use crate::spatial::{Quaternion, Vector3, rotation_log_jacobian};

/// The variables of a frame as a manifold: numbers, and rotations that are moved and compared in their turned axes,
/// R exp(δ) and log(RᵀR') (Solà, Deray & Atchuthan 2018, "A micro Lie theory for state estimation in robotics").
#[derive(Clone, Debug)]
pub(super) struct FrameSpace {
    balls: Vec<BallVariables>,
}

/// Three variables that a rotation's difference depends on, with its derivatives, row by row.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallSlopes {
    /// The first of the three.
    pub(super) first: usize,
    /// By the frame from which, and by the frame to which the way leads.
    pub(super) by_from: [[f64; 3]; 3],
    pub(super) by_to: [[f64; 3]; 3],
}

impl FrameSpace {
    pub(super) fn new(map: &ParameterMap) -> Self {
        Self {
            balls: map.balls().to_vec(),
        }
    }

    /// Whether a variable is a number by itself.
    pub(super) fn is_number(&self, variable: usize) -> bool {
        let mut balls = self.balls.iter();
        !balls.any(|ball| (ball.variable..ball.variable + 3).contains(&variable))
    }

    fn rotation(ball: &BallVariables, x: &[f64]) -> Quaternion<f64> {
        let own = ball.of(x).unwrap_or([f64::NAN; 3]);
        ball.chart.rotation(own)
    }

    /// Writes x ⊕ share · step.
    pub(super) fn integrate(&self, x: &[f64], share: f64, step: &[f64], to: &mut [f64]) {
        for ((to, x), step) in to.iter_mut().zip(x).zip(step) {
            *to = x + share * step;
        }
        for ball in &self.balls {
            let own = ball.variable..ball.variable + 3;
            let by = &step[own.clone()];
            let by = Quaternion::exp(Vector3::new(by[0], by[1], by[2]) * share);
            let turned = Self::rotation(ball, x) * by;
            to[own].copy_from_slice(&ball.chart.variables(turned));
        }
    }

    /// Writes to ⊖ from.
    pub(super) fn difference(&self, to: &[f64], from: &[f64], way: &mut [f64]) {
        for ((way, to), from) in way.iter_mut().zip(to).zip(from) {
            *way = to - from;
        }
        for ball in &self.balls {
            let turned = Self::rotation(ball, from).conjugate() * Self::rotation(ball, to);
            way[ball.variable..ball.variable + 3].copy_from_slice(&turned.log().to_array());
        }
    }

    /// How the rotations' part of a [`difference`](Self::difference) changes with steps of both ends.
    pub(super) fn slopes<'a>(&'a self, way: &'a [f64]) -> impl Iterator<Item = BallSlopes> + 'a {
        self.balls.iter().map(|ball| {
            let first = ball.variable;
            let way = Vector3::new(way[first], way[first + 1], way[first + 2]);
            let rows = |turned: Vector3<f64>, sign: f64| {
                let columns = rotation_log_jacobian(turned);
                let columns = [columns.x, columns.y, columns.z];
                let [x, y, z] = columns.map(|column| (column * sign).to_array());
                [0, 1, 2].map(|k| [x[k], y[k], z[k]])
            };
            BallSlopes {
                first,
                by_from: rows(way, -1.0),
                by_to: rows(-way, 1.0),
            }
        })
    }

    /// Turns the columns of a Jacobian by the variables (column-major, so many rows) into those by a step.
    pub(super) fn by_steps(&self, x: &[f64], rows: usize, entries: &mut [f64]) {
        for ball in &self.balls {
            let Some([a, b, c]) = ball.of(x) else {
                continue;
            };
            // ẋ = J_r(x)⁻¹ ω in turned axes, and J_r(x) = J_l(−x).
            let by = rotation_log_jacobian(-Vector3::new(a, b, c));
            let at = |column: usize, row: usize| (ball.variable + column) * rows + row;
            for row in 0..rows {
                let own = Vector3::from([0, 1, 2].map(|k| entries[at(k, row)]));
                for (k, column) in [by.x, by.y, by.z].into_iter().enumerate() {
                    entries[at(k, row)] = own.dot(column);
                }
            }
        }
    }
}
