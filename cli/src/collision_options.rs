//! Collision shapes and enabled collision pairs of a robot.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use kinopt::collision::{Checker, CollisionModel, MeshUse, SphereModel};
use kinopt::robot::Robot;

use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::model_options::ModelOptions;
use crate::output;

/// Random configurations that decide about pairs, where no file does.
const SAMPLES: u64 = 10_000;

/// Convex pieces of a mesh.
const PIECES: usize = 16;

/// Options of every subcommand that looks at a robot's shapes.
#[derive(Args, Debug)]
pub(crate) struct CollisionOptions {
    #[command(flatten)]
    shapes: ShapeOptions,

    /// An SRDF file whose disabled pairs of links may touch. Default: none.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS)]
    srdf: Option<PathBuf>,

    /// Let links touch that do so in nearly all of so many random configurations, or in none and are brought to
    /// touch by no descent from the nearest of them. Default: 10000, and 0 with --srdf.
    #[arg(long, value_name = "N", help_heading = COLLISIONS)]
    samples: Option<u64>,
}

/// Options about a robot's shapes alone.
#[derive(Args, Clone, Debug)]
pub(crate) struct ShapeOptions {
    /// A folder that holds ROS packages, or is one; repeat it for several. Default: none.
    ///
    /// Meshes at package://NAME/… are looked for in it, and in the folders above the robot's file.
    #[arg(long = "package", value_name = "FOLDER", help_heading = COLLISIONS, hide_short_help = true)]
    packages: Vec<PathBuf>,

    /// What meshes count as. Default: hull.
    #[arg(long, value_name = "AS", default_value = "hull", hide_default_value = true, help_heading = COLLISIONS, hide_short_help = true)]
    meshes: MeshChoice,

    /// Leave meshes out that are not found, each with a note. Default: refuse the robot.
    #[arg(long, help_heading = COLLISIONS, hide_short_help = true)]
    leave_out_meshes: bool,
}

/// Spheres that cover a robot's shapes.
#[derive(Args, Clone, Debug)]
pub(crate) struct SphereOption {
    /// Spheres that cover the robot's shapes, by which configurations are looked through first. Default: made anew.
    ///
    /// As `kinopt spheres` writes them, or others: cuRobo's collision_spheres (.yml), or a robot's URDF of spheres. They are grown
    /// by the gaps that they leave, so that no answer touches anything. Made anew they stick out by at most a tenth of the largest
    /// shape, which takes up to seconds where shapes are meshes.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS, hide_short_help = true)]
    sphere_model: Option<PathBuf>,
}

impl SphereOption {
    pub(crate) fn is_given(&self) -> bool {
        self.sphere_model.is_some()
    }

    /// What keeps a robot's shapes apart, but for pairs that cannot touch or always do.
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
                "note: {file}: the spheres leave up to {millimetres:.3} mm of the shapes uncovered, and are grown by that"
            ));
        }
        Ok(Checker::sampled_with_spheres(model, spheres))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeshChoice {
    /// Their convex hulls.
    Hull,
    /// The convex hull of each connected part.
    Parts,
    /// Up to 16 convex pieces each.
    Pieces,
    /// Their triangles, and what those enclose.
    Triangles,
}

impl ShapeOptions {
    /// In words, unless all is as usual.
    pub(crate) fn unusual(&self) -> Option<String> {
        let usual = self.packages.is_empty() && self.meshes == MeshChoice::Hull;
        (!usual || self.leave_out_meshes).then(|| format!("{self:?}"))
    }

    /// The model of a robot's shapes; notes go to standard error.
    pub(crate) fn model(&self, robot: &Robot) -> Outcome<CollisionModel> {
        let meshes = match self.meshes {
            MeshChoice::Hull => MeshUse::Hull,
            MeshChoice::Parts => MeshUse::Parts,
            MeshChoice::Pieces => MeshUse::Pieces(PIECES),
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
    /// The model of a robot's shapes; notes go to standard error.
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
