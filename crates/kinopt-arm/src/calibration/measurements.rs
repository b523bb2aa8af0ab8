//! Measured poses or points, and their noise.

use kinopt_kinematics::spatial::{Placement, Vector3};

/// Largest deviation of a measured rotation from orthonormality.
const RIGIDITY_TOLERANCE: f64 = 1e-6;

/// Measurements of the tip.
#[derive(Clone, Copy, Debug)]
pub enum Measurements<'a> {
    /// Poses of the tip, metres.
    Poses(&'a [Placement<f64>]),
    /// Positions of the tip, metres.
    Points(&'a [Vector3<f64>]),
}

impl Measurements<'_> {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Poses(poses) => poses.len(),
            Self::Points(points) => points.len(),
        }
    }

    /// Number of residual rows of a measurement.
    pub(super) fn rows(&self) -> usize {
        if self.has_rotations() { 6 } else { 3 }
    }

    pub(super) fn has_rotations(&self) -> bool {
        matches!(self, Self::Poses(_))
    }

    /// Index and defect of the first invalid measurement.
    pub(super) fn first_defect(&self) -> Option<(usize, &'static str)> {
        match self {
            Self::Poses(poses) => {
                let is_invalid =
                    |pose: &Placement<f64>| pose.check_rigid(RIGIDITY_TOLERANCE).is_err();
                let index = poses.iter().position(is_invalid)?;
                Some((index, "the pose is not a rigid motion"))
            }
            Self::Points(points) => {
                let index = points.iter().position(|point| !point.is_finite())?;
                Some((index, "the point is not finite"))
            }
        }
    }

    pub(super) fn position(&self, index: usize) -> Vector3<f64> {
        match self {
            Self::Poses(poses) => poses[index].translation,
            Self::Points(points) => points[index],
        }
    }
}

/// Standard deviation of measurements, in each direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Metres.
    pub position: f64,
    /// Radians; not used for points.
    pub angle: f64,
}
