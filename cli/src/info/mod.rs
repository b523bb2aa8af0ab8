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
use crate::model_options::ModelOptions;
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt info robot.urdf         the tree of links and joints, limits in degrees and metres
  kinopt info arm.json           for people: limits in degrees and in radians
  kinopt info arm.json --json    for programs: limits in radians, null where there is none
  kinopt info walk.bvh           motion capture: bones, frames, time and channels
  kinopt info fox.glb            a scene: nodes and joints, clips, meshes, morph targets";

/// What a model has: joints with their limits, frames, degrees of freedom and which of them are
/// free; for a robot the tree of its links, its tips and the joints that follow others; for a rig
/// its mesh, skin weights, keyframes and pinned tips; for motion capture its bones, frames and
/// channels; for a scene its nodes, clips, meshes and morph targets, and what was left out.
///
/// The column q says where in a configuration a joint's value stands; fixed joints have none.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The model: a robot's .urdf or MJCF .xml, a rig's .json, a motion capture's .bvh or a scene's .glb or .gltf file.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    #[command(flatten)]
    model_options: ModelOptions,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let (model, model_options) = (&arguments.model, &arguments.model_options);
    if AnimatedArmature::is_at(model) && !model_options.makes_figure() {
        model_options.refuse(&model.display().to_string())?;
        let animated = AnimatedArmature::read(model)?;
        let document = animation::document(&animated)?;
        return output::result(json, || &document, || animation::text(&document));
    }
    let loaded = LoadedModel::read(model, model_options)?;
    let document = document::document(&loaded);
    output::result(json, || &document, || text::text(&loaded, &document))
}
