//! Placements as sixteen numbers by columns, as in WebGL and three.js.

use kinopt::spatial::{Matrix3, Placement, Vector3};
use wasm_bindgen::prelude::*;

/// Largest deviation of the last row from 0 0 0 1.
const LAST_ROW: f64 = 1e-9;

/// Reads one placement; `what` names it in messages.
pub(crate) fn read(numbers: &[f64], what: &str) -> Result<Placement<f64>, JsError> {
    let Ok(m) = <&[f64; 16]>::try_from(numbers) else {
        return Err(JsError::new(&format!(
            "{what} has {} numbers, a placement has 16: a 4 x 4 matrix by columns",
            numbers.len()
        )));
    };
    let last = [m[3], m[7], m[11], m[15] - 1.0];
    // Negated test: NaN fails it.
    if !last.iter().all(|value| value.abs() <= LAST_ROW) {
        let row = [m[3], m[7], m[11], m[15]];
        return Err(JsError::new(&format!(
            "{what} is not a placement: the last row of its matrix is {row:?}, not [0, 0, 0, 1]"
        )));
    }
    let column = |k: usize| Vector3::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]);
    let rotation = Matrix3::from_columns(column(0), column(1), column(2));
    Ok(Placement::new(rotation, column(3)))
}

/// Reads one placement from a typed array or an array.
pub(crate) fn of(value: &JsValue, what: &str) -> Result<Placement<f64>, JsError> {
    read(&crate::arguments::numbers(value, what)?, what)
}

/// Reads several placements, sixteen numbers each.
pub(crate) fn read_all(numbers: &[f64], what: &str) -> Result<Vec<Placement<f64>>, JsError> {
    if !numbers.len().is_multiple_of(16) {
        return Err(JsError::new(&format!(
            "{what} has {} numbers, which is no multiple of 16",
            numbers.len()
        )));
    }
    let each = numbers.chunks_exact(16).enumerate();
    each.map(|(k, sixteen)| read(sixteen, &format!("{what} {k}")))
        .collect()
}

/// Sixteen numbers of a placement.
pub(crate) fn columns(placement: &Placement<f64>) -> [f64; 16] {
    let Placement {
        rotation: Matrix3 { x, y, z },
        translation: t,
    } = placement;
    [
        x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, t.x, t.y, t.z, 1.0,
    ]
}
