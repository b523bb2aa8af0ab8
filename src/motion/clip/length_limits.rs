//! Limits of the length of up to three numbers together: how far a body slides or turns from a frame to the next, how far
//! a ball swings or turns in all.

use super::space::{is_bounded, rotation, turn_slopes};
use crate::model::{BallVariables, ParameterMap, Source};
use crate::spatial::{Matrix3, Vector3};

/// For the rounding of quaternions and of what is told from them, in radians, and as a share.
const ROUNDING: f64 = 1e-14;
/// Turned by more than this a rotation is any.
const FARTHEST_TURN: f64 = std::f64::consts::PI;

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// How far three variables, by these factors, go from the frame before.
    Slide([f64; 3]),
    /// By what angle a ball turns from the frame before.
    Turn(BallVariables),
    /// How far a ball swings, stretched so that its ellipse is a circle: of the geometric mean of the half axes.
    Swing(BallVariables, [f64; 2]),
    /// By what angle a ball is turned from its zero.
    Angle(BallVariables),
}

/// ‖ρ‖ ≤ most in every frame, for three numbers ρ of three variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LengthLimit {
    pub(super) measure: Measure,
    /// In ascending order.
    pub(super) variables: [usize; 3],
    pub(super) most: f64,
}

/// ρ, and by what it changes with steps of the variables of both frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) rho: Vector3<f64>,
    pub(super) by_from: Matrix3<f64>,
    pub(super) by_to: Matrix3<f64>,
}

impl Default for Measured {
    fn default() -> Self {
        Self {
            rho: Vector3::zero(),
            by_from: diagonal([0.0; 3]),
            by_to: diagonal([0.0; 3]),
        }
    }
}

fn diagonal(by: [f64; 3]) -> Matrix3<f64> {
    let [x, y, z] = Vector3::UNITS;
    Matrix3::from_columns(x * by[0], y * by[1], z * by[2])
}

impl LengthLimit {
    /// Of the cones and whole angles of balls.
    pub(super) fn of_balls(map: &ParameterMap) -> Vec<Self> {
        let mut limits = Vec::new();
        for ball in map.balls().iter().filter(|ball| is_bounded(ball)) {
            let variables = [0, 1, 2].map(|k| ball.variable + k);
            if let Some(half_axes) = ball.swing {
                let mean = (half_axes[0] * half_axes[1]).sqrt();
                limits.push(Self {
                    measure: Measure::Swing(*ball, half_axes),
                    variables,
                    most: mean * (1.0 - ROUNDING),
                });
            }
            if let Some(angle) = ball.angle.filter(|angle| *angle < FARTHEST_TURN) {
                limits.push(Self {
                    measure: Measure::Angle(*ball),
                    variables,
                    most: angle * (1.0 - ROUNDING) - ROUNDING,
                });
            }
        }
        limits
    }

    /// Of how far a ball turns from a frame to the next; none where it may turn anywhere.
    pub(super) fn of_turn(ball: &BallVariables, angle: f64) -> Option<Self> {
        (angle < FARTHEST_TURN).then(|| Self {
            measure: Measure::Turn(*ball),
            variables: [0, 1, 2].map(|k| ball.variable + k),
            most: angle * (1.0 - ROUNDING) - ROUNDING,
        })
    }

    /// Of how far three slides, of which the first has this number of a configuration, go together from a frame to the next;
    /// none where nothing moves them.
    pub(super) fn of_slides(map: &ParameterMap, first: usize, most: f64) -> Option<Self> {
        let mut variables = [usize::MAX; 3];
        let mut squares = [0.0; 3];
        let slopes = map.sources()[first..]
            .iter()
            .take(3)
            .filter_map(Source::slope);
        for (variable, ratio) in slopes.filter(|(_, ratio)| *ratio != 0.0) {
            let known = variables
                .iter()
                .position(|own| [variable, usize::MAX].contains(own));
            let own = known.unwrap_or_default();
            variables[own] = variable;
            squares[own] += ratio * ratio;
        }
        let any = variables[0];
        let mut parts = [0, 1, 2].map(|k| match variables[k] {
            // What does not move counts nothing.
            usize::MAX => (any, 0.0),
            variable => (variable, squares[k].sqrt()),
        });
        parts.sort_by_key(|(variable, _)| *variable);
        (any != usize::MAX).then(|| Self {
            measure: Measure::Slide(parts.map(|(_, factor)| factor)),
            variables: parts.map(|(variable, _)| variable),
            most,
        })
    }

    /// The ball that is limited, if it is one.
    pub(super) fn ball(&self) -> Option<&BallVariables> {
        match &self.measure {
            Measure::Slide(_) => None,
            Measure::Turn(ball) | Measure::Swing(ball, _) | Measure::Angle(ball) => Some(ball),
        }
    }

    /// Whether it is of a frame and the one before.
    pub(super) fn is_of_move(&self) -> bool {
        matches!(self.measure, Measure::Slide(_) | Measure::Turn(_))
    }

    /// ρ of a frame; `from` is the one before, if that counts.
    pub(super) fn rho(&self, from: &[f64], to: &[f64]) -> Vector3<f64> {
        let [a, b, c] = self.variables;
        match &self.measure {
            Measure::Slide(by) => Vector3::new(
                by[0] * (to[a] - from[a]),
                by[1] * (to[b] - from[b]),
                by[2] * (to[c] - from[c]),
            ),
            Measure::Turn(ball) => (rotation(ball, from).conjugate() * rotation(ball, to)).log(),
            Measure::Swing(_, [first, second]) => {
                let mean = (first * second).sqrt();
                Vector3::new(to[a] * (mean / first), to[b] * (mean / second), 0.0)
            }
            Measure::Angle(ball) => rotation(ball, to).log(),
        }
    }

    /// ρ and its derivatives; none by the frame before where that does not count.
    pub(super) fn measure(&self, from: &[f64], to: &[f64]) -> Measured {
        let rho = self.rho(from, to);
        let none = diagonal([0.0; 3]);
        let (by_from, by_to) = match &self.measure {
            Measure::Slide(by) => (diagonal(by.map(|by| -by)), diagonal(*by)),
            Measure::Turn(ball) => {
                let back = turn_slopes(ball, from, -rho);
                let by_from = Matrix3::from_columns(-back.x, -back.y, -back.z);
                (by_from, turn_slopes(ball, to, rho))
            }
            Measure::Swing(_, [first, second]) => {
                let mean = (first * second).sqrt();
                (none, diagonal([mean / first, mean / second, 0.0]))
            }
            Measure::Angle(ball) => (none, turn_slopes(ball, to, rho)),
        };
        Measured {
            rho,
            by_from,
            by_to,
        }
    }

    /// (most² − ‖ρ‖²) / (2 most): near the edge how far that is.
    pub(super) fn slack(&self, rho: Vector3<f64>) -> f64 {
        let length = rho.norm();
        0.5 * (self.most - length) * (1.0 + length / self.most)
    }
}
