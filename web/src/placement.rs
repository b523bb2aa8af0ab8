//! Placements as sixteen numbers by columns, as in WebGL and three.js.

use kinopt::spatial::Placement;
pub(crate) use kinopt_bindings::placement::to_columns as columns;
use kinopt_bindings::placement::{bad_last_row, of_columns};
use wasm_bindgen::prelude::*;

use crate::error::Exception;

/// Reads one placement; `what` names it in messages.
pub(crate) fn read(numbers: &[f64], what: &str) -> Result<Placement<f64>, Exception> {
    let Ok(m) = <&[f64; 16]>::try_from(numbers) else {
        return Err(Exception::new(&format!(
            "{what} has {} numbers, a placement has 16: a 4 x 4 matrix by columns",
            numbers.len()
        )));
    };
    of_columns(m).map_err(|last_row| Exception::new(&bad_last_row(what, last_row)))
}

/// Reads one placement from a typed array or an array.
pub(crate) fn of(value: &JsValue, what: &str) -> Result<Placement<f64>, Exception> {
    read(&crate::arguments::numbers(value, what)?, what)
}

/// Reads several placements, sixteen numbers each.
pub(crate) fn read_all(numbers: &[f64], what: &str) -> Result<Vec<Placement<f64>>, Exception> {
    if !numbers.len().is_multiple_of(16) {
        return Err(Exception::new(&format!(
            "{what} has {} numbers, which is no multiple of 16",
            numbers.len()
        )));
    }
    let each = numbers.chunks_exact(16).enumerate();
    each.map(|(k, sixteen)| read(sixteen, &format!("{what} {k}")))
        .collect()
}
