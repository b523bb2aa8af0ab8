//! Angles as unit vectors, and the linear equation of an angle.

use kinopt_kinematics::scalar::elementary;

/// Relative excess over the largest possible value at which a linear equation still counts as a double root.
///
/// Candidates are polished and checked, so that a false double root costs time only.
const TOUCHING: f64 = 1e-4;
/// Relative size below which a coefficient counts as zero.
const NEGLIGIBLE: f64 = 1e-9;

/// Angle of a joint by its cosine and sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Angle {
    pub(super) cos: f64,
    pub(super) sin: f64,
}

impl Angle {
    pub(super) const ZERO: Self = Self { cos: 1.0, sin: 0.0 };

    /// Angle of a point of the plane; zero for the origin.
    pub(super) fn of_point(x: f64, y: f64) -> Self {
        let length = (x * x + y * y).sqrt();
        match length > 0.0 {
            true => Self {
                cos: x / length,
                sin: y / length,
            },
            false => Self::ZERO,
        }
    }

    pub(super) fn of_radians(radians: f64) -> Self {
        let (sin, cos) = elementary::sin_cos(radians);
        Self { cos, sin }
    }

    /// Angle in (−π, π].
    pub(super) fn radians(self) -> f64 {
        elementary::atan2(self.sin, self.cos)
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }

    /// True if the angles differ by at most a small `distance` in radians.
    pub(super) fn is_within(self, distance: f64, other: Self) -> bool {
        let (cos, sin) = (self.cos - other.cos, self.sin - other.sin);
        cos * cos + sin * sin <= distance * distance
    }

    pub(super) fn negative(self) -> Self {
        Self {
            cos: self.cos,
            sin: -self.sin,
        }
    }

    /// The angle that points the other way round for an axis of opposite direction.
    pub(super) fn signed(self, sign: f64) -> Self {
        Self {
            cos: self.cos,
            sin: self.sin * sign,
        }
    }
}

/// Solutions of a linear equation of an angle.
#[derive(Clone, Copy, Debug)]
pub(super) enum LinearRoots {
    None,
    Two([Angle; 2]),
    /// Both sides vanish: every angle is a solution.
    All,
}

/// Solves a·cos θ + b·sin θ = d. `size` is the size of the terms that `d` was computed from.
pub(super) fn solve_linear(a: f64, b: f64, d: f64, size: f64) -> LinearRoots {
    let amplitude = (a * a + b * b).sqrt();
    if amplitude <= NEGLIGIBLE * size {
        return match d.abs() <= TOUCHING * size {
            true => LinearRoots::All,
            false => LinearRoots::None,
        };
    }
    let (x, y) = (a / amplitude, b / amplitude);
    let mut cos = d / amplitude;
    let excess = cos.abs() - 1.0;
    if excess * amplitude > TOUCHING * size {
        return LinearRoots::None;
    }
    if excess > 0.0 {
        // A pair near the double root, from which polishing reaches both solutions of the exact geometry.
        cos = cos.signum() * (1.0 - excess).max(0.5);
    }
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    LinearRoots::Two([
        Angle {
            cos: x * cos - y * sin,
            sin: y * cos + x * sin,
        },
        Angle {
            cos: x * cos + y * sin,
            sin: y * cos - x * sin,
        },
    ])
}
