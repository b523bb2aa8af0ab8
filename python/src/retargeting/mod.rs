//! Motion capture retargeted to robots and rigs: the compiled part of `kinopt.retargeting`.

mod capture;
mod figure_target;
mod folder;
mod live;
mod maps;
mod movement;
mod request;

use kinopt::motion::retarget::UpAxis;
use pyo3::prelude::*;

use crate::error::invalid;

/// Motion capture retargeted to robots and rigs: the compiled part.
#[pymodule(submodule)]
pub(crate) mod retargeting {
    #[pymodule_export]
    use super::{
        capture::Capture,
        figure_target::FigureTarget,
        folder::{folder_begun, unfinished},
        live::Live,
        maps::{map_completed, map_guessed, map_of_skeleton, skeleton_joints, skeleton_names},
        movement::capture_retargeted,
    };
}

fn up_axis(up: &str) -> PyResult<UpAxis> {
    match up {
        "y" => Ok(UpAxis::Y),
        "z" => Ok(UpAxis::Z),
        other => Err(invalid(format!("up is {other:?}: \"y\" or \"z\""))),
    }
}
