//! Bins of orientations: boxes of angles on the six faces of a cube.
//!
//! The tool's z axis selects a face and two angles on it, and the rotation about that axis is the third angle. An
//! orientation is `F·Ry(a)·Rx(c)·Rz(s)`, with the face's rotation F, a and c within ±π/4 and s within ±π. A bin is a box
//! of (a, c, s), so that bounds of products of rotations hold for it without a loss.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::super::reachability::{Interval, OrientationCell};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

const FACES: usize = 6;

/// Bins with angles of π/(2·`per_face`) along each of the three coordinates.
///
/// Zero bins mean a single bin of all orientations, for goals without orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OrientationBins {
    /// Number of bins along each of the two angles of a face; 0 for a single bin of all orientations.
    pub(super) per_face: usize,
}

/// Rotation of the face whose normal is an axis (0 to 2), or the opposite of it (3 to 5).
fn base_from_face(face: usize) -> Matrix3<f64> {
    let axis = face % 3;
    let sign = if face < 3 { 1.0 } else { -1.0 };
    let unit = |k: usize| Vector3::UNITS[k % 3];
    Matrix3::from_columns(unit(axis + 1), unit(axis + 2) * sign, unit(axis) * sign)
}

impl OrientationBins {
    /// Bins of at most `step` radians along each coordinate; `None` for more than 64 along a face.
    pub(super) fn new(step: f64) -> Option<Self> {
        let per_face = (FRAC_PI_2 / step - 1e-9).ceil().max(1.0);
        (per_face <= 64.0).then_some(Self {
            per_face: per_face as usize,
        })
    }

    /// Number of bins.
    pub(super) fn count(&self) -> usize {
        match self.per_face {
            0 => 1,
            n => FACES * n * n * 4 * n,
        }
    }

    fn half_width(&self) -> f64 {
        FRAC_PI_4 / self.per_face as f64
    }

    /// Index of the bin that contains a rotation.
    pub(super) fn bin_at(&self, rotation: &Matrix3<f64>) -> usize {
        let n = self.per_face;
        if n == 0 {
            return 0;
        }
        let z = rotation.z.to_array();
        let mut axis = 0;
        for other in 1..3 {
            if z[other].abs() > z[axis].abs() {
                axis = other;
            }
        }
        let face = if z[axis] >= 0.0 { axis } else { axis + 3 };
        let of_face = base_from_face(face);
        let local = of_face.transpose_mul(rotation.z);
        let cos_c = (local.x * local.x + local.z * local.z).sqrt();
        let (sin_a, cos_a, sin_c) = (local.x / cos_c, local.z / cos_c, -local.y);
        // The tool's x axis relative to the first two columns of F·Ry(a)·Rx(c).
        let x = of_face.transpose_mul(rotation.x);
        let cos_s = x.x * cos_a - x.z * sin_a;
        let sin_s = (x.x * sin_a + x.z * cos_a) * sin_c + x.y * cos_c;
        let cell = |angle: f64, limit: f64, cells: usize| {
            let along = (angle + limit) / (2.0 * limit) * cells as f64;
            (along.max(0.0) as usize).min(cells - 1)
        };
        let a = cell(elementary::atan2(sin_a, cos_a), FRAC_PI_4, n);
        let c = cell(elementary::atan2(sin_c, cos_c), FRAC_PI_4, n);
        let spin = cell(elementary::atan2(sin_s, cos_s), PI, 4 * n);
        ((face * n + a) * n + c) * 4 * n + spin
    }

    /// The orientations of a bin.
    pub(super) fn bin(&self, index: usize) -> OrientationCell {
        let n = self.per_face.max(1);
        let half_width = self.half_width();
        let interval = |cell: usize, limit: f64| Interval {
            centre: half_width * (2 * cell + 1) as f64 - limit,
            half_width,
        };
        let (spin, rest) = (index % (4 * n), index / (4 * n));
        let (c, a, face) = (rest % n, rest / n % n, rest / (n * n));
        OrientationCell {
            base_from_face: Placement::new(base_from_face(face), Vector3::zero()),
            angles: [
                interval(a, FRAC_PI_4),
                interval(c, FRAC_PI_4),
                interval(spin, PI),
            ],
        }
    }

    /// Rotation of the centre of a bin; the identity for the single bin of all orientations.
    pub(super) fn centre(&self, index: usize) -> Matrix3<f64> {
        if self.per_face == 0 {
            return Matrix3::identity();
        }
        let OrientationCell {
            base_from_face,
            angles,
        } = self.bin(index);
        let [a, c, spin] = angles.map(|angle| elementary::clean_sin_cos(angle.centre));
        let [x, y, z] = Vector3::UNITS;
        base_from_face.rotation
            * Matrix3::rotation(y, a)
            * Matrix3::rotation(x, c)
            * Matrix3::rotation(z, spin)
    }
}
