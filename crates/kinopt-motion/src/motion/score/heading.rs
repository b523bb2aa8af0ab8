//! Heading of a motion relative to its capture.

use std::f64::consts::FRAC_PI_2;

use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Rotation about the vertical from the axes of a capture to those of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Heading {
    /// Multiple of 90° that fits the limb directions best. Programs differ by such rotations when they exchange axes.
    #[default]
    QuarterTurns,
    /// Angle that fits the limb directions best.
    Fitted,
    /// Given angle, radians.
    Fixed(f64),
}

impl Heading {
    /// Returns the angle about z, radians, for pairs of directions of the subject and the model.
    ///
    /// The angle maximises Σ (R s) · m over rotations R about z, with s and m the directions of subject and model.
    pub(super) fn angle(
        self,
        directions: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>,
    ) -> f64 {
        if let Self::Fixed(angle) = self {
            return angle;
        }
        let (sine, cosine) = directions.fold((0.0, 0.0), |(sine, cosine), (s, m)| {
            (sine + s.x * m.y - s.y * m.x, cosine + s.x * m.x + s.y * m.y)
        });
        let fitted = elementary::atan2(sine, cosine);
        match self {
            Self::Fitted => fitted,
            _ => (fitted / FRAC_PI_2).round() * FRAC_PI_2,
        }
    }
}

/// Rotation about z.
pub(super) fn about_z(angle: f64) -> Matrix3<f64> {
    Matrix3::rotation(Vector3::UNITS[2], elementary::sin_cos(angle))
}
