//! Collision shapes and enabled collision pairs of a robot.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use kinopt::collision::{Checker, CollisionModel, MeshUse, SphereModel};
use kinopt::robot::Robot;

use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::model_options::ModelOptions;
use crate::output;

/// Number of random configurations that select enabled pairs, without an SRDF file.
const SAMPLES: u64 = 10_000;

/// Largest number of convex pieces of a mesh.
const MAX_PIECES: usize = 16;

/// Options of every subcommand that reads a robot's collision shapes.
#[derive(Args, Debug)]
pub(crate) struct CollisionOptions {
    #[command(flatten)]
    shapes: ShapeOptions,

    /// SRDF file with disabled pairs of links. Default: none.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS)]
    srdf: Option<PathBuf>,

    /// Number of random configurations that select pairs. Default: 10000; 0 with --srdf.
    #[arg(long, value_name = "N", help_heading = COLLISIONS)]
    samples: Option<u64>,
}

/// Options of a robot's collision shapes.
#[derive(Args, Clone, Debug)]
pub(crate) struct ShapeOptions {
    /// Folder of ROS packages for package:// meshes. Default: folders above the file. Repeatable.
    #[arg(long = "package", value_name = "FOLDER", help_heading = COLLISIONS, hide_short_help = true)]
    packages: Vec<PathBuf>,

    /// Collision shapes of meshes. Default: hull.
    #[arg(long, value_name = "SHAPES", default_value = "hull", hide_default_value = true, help_heading = COLLISIONS, hide_short_help = true)]
    meshes: MeshChoice,

    /// Omit meshes that are not found, with a note. Default: error.
    #[arg(long, help_heading = COLLISIONS, hide_short_help = true)]
    leave_out_meshes: bool,
}

/// Sphere model of a robot's shapes.
#[derive(Args, Clone, Debug)]
pub(crate) struct SphereOption {
    /// Sphere model for fast checks, as of `kinopt spheres` or cuRobo. Default: computed.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS, hide_short_help = true)]
    sphere_model: Option<PathBuf>,
}

impl SphereOption {
    pub(crate) fn is_given(&self) -> bool {
        self.sphere_model.is_some()
    }

    /// Checker of a robot's shapes; pairs that random configurations never or always have in contact are disabled.
    pub(crate) fn checker(&self, model: CollisionModel) -> Outcome<Checker> {
        let Some(file) = &self.sphere_model else {
            return Ok(Checker::sampled(model));
        };
        let spheres = SphereModel::read(file, &model)?;
        for note in spheres.notes() {
            output::message(&format!("note: {}: {note}", file.display()));
        }
        if spheres.gap() > 0.0 {
            let (file, millimetres) = (file.display(), 1e3 * spheres.gap());
            output::message(&format!(
                "note: {file}: the spheres leave up to {millimetres:.3} mm of the shapes uncovered; radii grow by that"
            ));
        }
        Ok(Checker::sampled_with_spheres(model, spheres))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeshChoice {
    /// Convex hull of each mesh.
    Hull,
    /// Convex hull of each connected part.
    Parts,
    /// Up to 16 convex pieces for each mesh.
    Pieces,
    /// Triangles and their interior.
    Triangles,
}

impl ShapeOptions {
    /// Options in words, or `None` for the defaults.
    pub(crate) fn unusual(&self) -> Option<String> {
        let is_default = self.packages.is_empty() && self.meshes == MeshChoice::Hull;
        (!is_default || self.leave_out_meshes).then(|| format!("{self:?}"))
    }

    /// Collision model of a robot; notes go to standard error.
    pub(crate) fn model(&self, robot: &Robot) -> Outcome<CollisionModel> {
        let meshes = match self.meshes {
            MeshChoice::Hull => MeshUse::Hull,
            MeshChoice::Parts => MeshUse::Parts,
            MeshChoice::Pieces => MeshUse::Pieces(MAX_PIECES),
            MeshChoice::Triangles => MeshUse::Triangles,
        };
        let mut builder = CollisionModel::builder(robot).with_meshes(meshes);
        for folder in &self.packages {
            builder = builder.with_package_folder(folder);
        }
        if self.leave_out_meshes {
            builder = builder.leaving_out_missing_meshes();
        }
        let model = builder.build()?;
        for note in model.notes() {
            output::message(&format!("note: {note}"));
        }
        if model.objects().is_empty() {
            let name = robot.name();
            return Err(failure!("{name} has no collision shapes"));
        }
        Ok(model)
    }
}

impl CollisionOptions {
    /// Collision model of a robot with its enabled pairs; notes go to standard error.
    pub(crate) fn model(&self, robot: &Robot, options: &ModelOptions) -> Outcome<CollisionModel> {
        let mut model = self.shapes.model(robot)?;
        let mut samples = SAMPLES;
        if let Some(path) = &self.srdf {
            model = model.with_srdf(&options.read_srdf(path, robot)?);
            samples = 0;
        }
        Ok(model.with_pairs_sampled(self.samples.unwrap_or(samples), 0)?)
    }
}
