//! `kinopt info`: content of a model.

mod animation;
mod cone;
mod document;
mod robot;
mod text;

use std::path::PathBuf;

use clap::Args;

use crate::animated_armature::AnimatedArmature;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::model_options::{ModelOptions, refuse_robot_settings};
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt info robot.urdf         the tree of links and joints, limits in degrees and metres
  kinopt info arm.json --json    one JSON document: limits in radians, null without a limit
  kinopt info walk.bvh           motion capture: bones, frames, time and channels
  kinopt info fox.glb            a scene: nodes and joints, clips, meshes, morph targets

The column q is the index of a joint in a configuration; fixed joints have none.";

/// Content of a model: joints with limits, frames and degrees of freedom.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, rig .json, motion capture .bvh, scene .glb, .gltf or .vrm.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    #[command(flatten)]
    model_options: ModelOptions,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let model = &arguments.model;
    let settings = arguments.model_options.problem()?.model;
    if AnimatedArmature::is_at(model) && !settings.makes_figure() {
        refuse_robot_settings(&settings, &model.display().to_string())?;
        let animated = AnimatedArmature::read_for(model, &settings)?;
        let document = animation::document(&animated)?;
        return output::result(json, || &document, || animation::text(&document));
    }
    let loaded = LoadedModel::read(model, &settings)?;
    let document = document::document(&loaded);
    output::result(json, || &document, || text::text(&loaded, &document))
}
