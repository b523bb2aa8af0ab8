//! Upward axes by name.

use kinopt::motion::retarget::UpAxis;
use pyo3::prelude::*;

use crate::error::invalid;

/// Returns an upward axis by its name, "y" or "z".
pub(super) fn up_axis(up: &str) -> PyResult<UpAxis> {
    match up {
        "y" => Ok(UpAxis::Y),
        "z" => Ok(UpAxis::Z),
        other => Err(invalid(format!("up is {other:?}: \"y\" or \"z\""))),
    }
}
