//! Placements as sixteen numbers of a 4 x 4 matrix.

use kinopt::spatial::{Matrix3, Placement, Vector3};

/// Largest deviation of the last row from 0 0 0 1.
const LAST_ROW_TOLERANCE: f64 = 1e-9;

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
