//! Limits on the length of up to three variables together.
//!
//! They limit translations and rotations between samples, and swing and rotation angles of ball joints.

use super::space::{is_bounded, rotation, rotation_jacobian};
use kinopt_kinematics::model::{BallVariables, ParameterMap, Source};
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Tolerance for rounding of quaternions, in radians and relative.
const ROUNDING: f64 = 1e-14;
/// Largest rotation angle. A limit of at least that has no effect.
const MAX_ROTATION: f64 = std::f64::consts::PI;

/// Measure of a length limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// Translation of three variables from the previous sample, scaled by factors.
    Translation([f64; 3]),
    /// Rotation angle of a ball joint from the previous sample.
    Rotation(BallVariables),
    /// Swing of a ball joint, scaled so that its ellipse becomes a circle with the geometric mean of the half axes.
    Swing(BallVariables, [f64; 2]),
    /// Rotation angle of a ball joint from zero.
    Angle(BallVariables),
}

/// Limit ‖ρ‖ ≤ most at every sample, for a vector ρ of three variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LengthLimit {
    pub(super) measure: Measure,
    /// Indices of the variables, ascending.
    pub(super) variables: [usize; 3],
    pub(super) max_length: f64,
}

/// Value of ρ, with its derivatives by steps of both samples.
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

fn diagonal(factors: [f64; 3]) -> Matrix3<f64> {
    let [x, y, z] = Vector3::UNITS;
    Matrix3::from_columns(x * factors[0], y * factors[1], z * factors[2])
}

impl LengthLimit {
    /// Creates the swing and angle limits of ball joints.
    pub(super) fn for_balls(map: &ParameterMap) -> Vec<Self> {
        let mut limits = Vec::new();
        for ball in map.balls().iter().filter(|ball| is_bounded(ball)) {
            let variables = [0, 1, 2].map(|k| ball.variable + k);
            if let Some(half_axes) = ball.swing {
                let mean = (half_axes[0] * half_axes[1]).sqrt();
                limits.push(Self {
                    measure: Measure::Swing(*ball, half_axes),
                    variables,
                    max_length: mean * (1.0 - ROUNDING),
                });
            }
            if let Some(angle) = ball.angle.filter(|angle| *angle < MAX_ROTATION) {
                limits.push(Self {
                    measure: Measure::Angle(*ball),
                    variables,
                    max_length: angle * (1.0 - ROUNDING) - ROUNDING,
                });
            }
        }
        limits
    }

    /// Creates a limit on the rotation of a ball joint between samples; `None` if it has no effect.
    pub(super) fn for_rotation(ball: &BallVariables, angle: f64) -> Option<Self> {
        (angle < MAX_ROTATION).then(|| Self {
            measure: Measure::Rotation(*ball),
            variables: [0, 1, 2].map(|k| ball.variable + k),
            max_length: angle * (1.0 - ROUNDING) - ROUNDING,
        })
    }

    /// Creates a limit on the translation of three prismatic joints between samples, the first with coordinate `first`.
    ///
    /// Returns `None` if no variable moves them.
    pub(super) fn for_translation(
        map: &ParameterMap,
        first: usize,
        max_length: f64,
    ) -> Option<Self> {
        let mut variables = [usize::MAX; 3];
        let mut squares = [0.0; 3];
        let slopes = map.sources()[first..]
            .iter()
            .take(3)
            .filter_map(Source::slope);
        for (variable, ratio) in slopes.filter(|(_, ratio)| *ratio != 0.0) {
            let known = variables
                .iter()
                .position(|candidate| [variable, usize::MAX].contains(candidate));
            let index = known.unwrap_or_default();
            variables[index] = variable;
            squares[index] += ratio * ratio;
        }
        let any = variables[0];
        let mut parts = [0, 1, 2].map(|k| match variables[k] {
            // Components without a variable have factor 0.
            usize::MAX => (any, 0.0),
            variable => (variable, squares[k].sqrt()),
        });
        parts.sort_by_key(|(variable, _)| *variable);
        (any != usize::MAX).then(|| Self {
            measure: Measure::Translation(parts.map(|(_, factor)| factor)),
            variables: parts.map(|(variable, _)| variable),
            max_length,
        })
    }

    /// Returns the limited ball joint, if there is one.
    pub(super) fn ball(&self) -> Option<&BallVariables> {
        match &self.measure {
            Measure::Translation(_) => None,
            Measure::Rotation(ball) | Measure::Swing(ball, _) | Measure::Angle(ball) => Some(ball),
        }
    }

    /// Returns whether it limits a displacement from the previous sample.
    pub(super) fn limits_displacement(&self) -> bool {
        matches!(self.measure, Measure::Translation(_) | Measure::Rotation(_))
    }

    /// Returns ρ of a sample. `from` is the previous sample, used for displacements only.
    pub(super) fn rho(&self, from: &[f64], to: &[f64]) -> Vector3<f64> {
        let [a, b, c] = self.variables;
        match &self.measure {
            Measure::Translation(factors) => Vector3::new(
                factors[0] * (to[a] - from[a]),
                factors[1] * (to[b] - from[b]),
                factors[2] * (to[c] - from[c]),
            ),
            Measure::Rotation(ball) => {
                (rotation(ball, from).conjugate() * rotation(ball, to)).log()
            }
            Measure::Swing(_, [first, second]) => {
                let mean = (first * second).sqrt();
                Vector3::new(to[a] * (mean / first), to[b] * (mean / second), 0.0)
            }
            Measure::Angle(ball) => rotation(ball, to).log(),
        }
    }

    /// Returns ρ and its derivatives. Those by the previous sample are zero if it is not used.
    pub(super) fn measure(&self, from: &[f64], to: &[f64]) -> Measured {
        let rho = self.rho(from, to);
        let none = diagonal([0.0; 3]);
        let (by_from, by_to) = match &self.measure {
            Measure::Translation(factors) => {
                (diagonal(factors.map(|factor| -factor)), diagonal(*factors))
            }
            Measure::Rotation(ball) => {
                let backward = rotation_jacobian(ball, from, -rho);
                let by_from = Matrix3::from_columns(-backward.x, -backward.y, -backward.z);
                (by_from, rotation_jacobian(ball, to, rho))
            }
            Measure::Swing(_, [first, second]) => {
                let mean = (first * second).sqrt();
                (none, diagonal([mean / first, mean / second, 0.0]))
            }
            Measure::Angle(ball) => (none, rotation_jacobian(ball, to, rho)),
        };
        Measured {
            rho,
            by_from,
            by_to,
        }
    }

    /// Returns the slack (most² − ‖ρ‖²) / (2 most), which approximates the distance from the limit near it.
    pub(super) fn slack(&self, rho: Vector3<f64>) -> f64 {
        let length = rho.norm();
        0.5 * (self.max_length - length) * (1.0 + length / self.max_length)
    }
}
