//! Motion capture retargeted to robots and rigs: the compiled part of `kinopt.retargeting`.

mod capture;
pub(crate) mod figure_target;
mod folder;
mod hand;
mod live;
mod maps;
mod movement;
mod request;
mod score;
mod up_axis;

use pyo3::prelude::*;

pub(crate) use request::target_of;

/// Motion capture retargeted to robots and rigs: the compiled part.
#[pymodule(submodule)]
pub(crate) mod retargeting {
    #[pymodule_export]
    use super::{
        capture::Capture,
        figure_target::FigureTarget,
        folder::{folder_begun, unfinished},
        hand::{LiveHand, hand_map_guessed, hand_retargeted},
        live::Live,
        maps::{map_completed, map_guessed, map_of_skeleton, skeleton_joints, skeleton_names},
        movement::capture_retargeted,
        score::motion_scored,
    };
}
