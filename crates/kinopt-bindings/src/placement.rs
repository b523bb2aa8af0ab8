//! Placements as sixteen numbers of a 4 x 4 matrix, or as a position and a quaternion.

use kinopt::spatial::{Matrix3, Placement, Quaternion, Vector3};
use kinopt::task::PoseBounds;

/// Largest deviation of a quaternion's length from 1, from rounding; quaternions are normalised.
pub const QUATERNION_LENGTH_TOLERANCE: f64 = 0.01;

/// Largest deviation of the last row from 0 0 0 1.
const LAST_ROW_TOLERANCE: f64 = 1e-9;

/// A placement, or a position without orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseTarget {
    /// The placement; without an orientation its rotation is the identity.
    pub placement: Placement<f64>,
    /// False for a position.
    pub has_orientation: bool,
}

impl PoseTarget {
    /// Reads a position x, y, z, or a position with a quaternion w, x, y, z.
    ///
    /// # Errors
    /// If there are other numbers of them, or the quaternion's length is not 1.
    pub fn of_numbers(numbers: &[f64]) -> Result<Self, String> {
        let (position, rotation) = match *numbers {
            [x, y, z] => ([x, y, z], None),
            [x, y, z, qw, qx, qy, qz] => ([x, y, z], Some(of_quaternion([qw, qx, qy, qz])?)),
            _ => {
                return Err(format!(
                    "a placement takes 3 numbers (x,y,z) or 7 (x,y,z,qw,qx,qy,qz), not {}",
                    numbers.len()
                ));
            }
        };
        Ok(Self {
            placement: Placement::new(rotation.unwrap_or(Matrix3::identity()), position.into()),
            has_orientation: rotation.is_some(),
        })
    }

    /// The placement as a target under goal bounds; `what` names it in messages.
    ///
    /// # Errors
    /// If it has no orientation, and the bounds do not leave the orientation free.
    pub fn within(self, bounds: &PoseBounds, what: &str) -> Result<Placement<f64>, String> {
        match self.has_orientation || !bounds.has_orientation() {
            true => Ok(self.placement),
            false => Err(format!(
                "{what} is a position without orientation, but the goal bounds the orientation: set goal=\"position\", \
                 or add an orientation, such as a quaternion (w, x, y, z)"
            )),
        }
    }
}

/// Reads a quaternion w, x, y, z, and normalises it.
///
/// # Errors
/// If its length is not 1.
pub fn of_quaternion(wxyz: [f64; 4]) -> Result<Matrix3<f64>, String> {
    let length = wxyz.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Negated test: NaN fails it.
    let is_unit = (length - 1.0).abs() <= QUATERNION_LENGTH_TOLERANCE;
    if !is_unit {
        return Err(format!(
            "the quaternion (w,x,y,z) has length {length:.6}; expected 1"
        ));
    }
    let [w, x, y, z] = wxyz.map(|c| c / length);
    let v = Vector3::new(x, y, z);
    Ok(Quaternion { w, v }.to_matrix())
}

/// Reads sixteen numbers, row-major.
///
/// # Errors
/// Returns the last row of the matrix if it is not 0 0 0 1.
pub fn of_rows(m: &[f64; 16]) -> Result<Placement<f64>, [f64; 4]> {
    let column = |j: usize| Vector3::new(m[j], m[4 + j], m[8 + j]);
    of_parts([m[12], m[13], m[14], m[15]], column)
}

/// Reads sixteen numbers, column-major.
///
/// # Errors
/// Returns the last row of the matrix if it is not 0 0 0 1.
pub fn of_columns(m: &[f64; 16]) -> Result<Placement<f64>, [f64; 4]> {
    let column = |j: usize| Vector3::new(m[4 * j], m[4 * j + 1], m[4 * j + 2]);
    of_parts([m[3], m[7], m[11], m[15]], column)
}

fn of_parts(
    last_row: [f64; 4],
    column: impl Fn(usize) -> Vector3<f64>,
) -> Result<Placement<f64>, [f64; 4]> {
    let [a, b, c, d] = last_row;
    // Negated test: NaN fails it.
    let is_valid = [a, b, c, d - 1.0]
        .iter()
        .all(|value| value.abs() <= LAST_ROW_TOLERANCE);
    match is_valid {
        true => Ok(Placement::new(
            Matrix3::from_columns(column(0), column(1), column(2)),
            column(3),
        )),
        false => Err(last_row),
    }
}

/// Message for a matrix with another last row; `what` names it.
#[must_use]
pub fn bad_last_row(what: &str, last_row: [f64; 4]) -> String {
    format!(
        "{what} is not a placement: the last row of its matrix is {last_row:?}, not [0, 0, 0, 1]"
    )
}

/// Sixteen numbers, row-major.
#[must_use]
pub fn to_rows(placement: &Placement<f64>) -> [f64; 16] {
    let Matrix3 { x, y, z } = placement.rotation;
    let t = placement.translation;
    [
        x.x, y.x, z.x, t.x, //
        x.y, y.y, z.y, t.y, //
        x.z, y.z, z.z, t.z, //
        0.0, 0.0, 0.0, 1.0,
    ]
}

/// Sixteen numbers, column-major.
#[must_use]
pub fn to_columns(placement: &Placement<f64>) -> [f64; 16] {
    let Matrix3 { x, y, z } = placement.rotation;
    let t = placement.translation;
    [
        x.x, x.y, x.z, 0.0, //
        y.x, y.y, y.z, 0.0, //
        z.x, z.y, z.z, 0.0, //
        t.x, t.y, t.z, 1.0,
    ]
}
