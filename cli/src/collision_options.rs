//! Collision shapes and enabled collision pairs of a robot.

use std::path::PathBuf;

use clap::Args;
use kinopt::collision::{Checker, CollisionModel, MeshUse, SphereModel, World};
use kinopt::robot::Robot;
use kinopt_bindings::problem_file::{CollisionSettings, ProblemSettings, number_list};

use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::model_options::read_srdf;
use crate::problem_options::set;
use crate::{output, world_file};

/// Number of random configurations that select enabled pairs, without an SRDF file.
const SAMPLES: u64 = 10_000;

/// Options of every subcommand that reads a robot's collision shapes.
#[derive(Args, Debug)]
pub(crate) struct CollisionOptions {
    /// SRDF file with disabled pairs of links. Default: none.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS)]
    srdf: Option<PathBuf>,

    /// Number of random configurations that select pairs. Default: 10000; 0 with an SRDF.
    #[arg(long, value_name = "N", help_heading = COLLISIONS)]
    samples: Option<u64>,
}

/// Obstacles and their margin.
#[derive(Args, Clone, Debug)]
pub(crate) struct ObstacleOptions {
    /// Avoid self-collisions and the obstacles of a .json or MoveIt .yaml.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS)]
    pub(crate) world: Option<PathBuf>,

    /// Required distance in m; without --world between links. Default: 0.
    #[arg(long, value_name = "M", value_parser = number_list::not_negative, help_heading = COLLISIONS)]
    margin: Option<f64>,
}

impl ObstacleOptions {
    pub(crate) fn add_to(&self, collisions: &mut CollisionSettings) {
        set(&mut collisions.world, self.world.as_ref());
        set(&mut collisions.margin, self.margin.as_ref());
    }
}

/// World of the file, or an empty one, with the allowed collisions. Notes go to standard error.
pub(crate) fn read_world(collisions: &CollisionSettings) -> Outcome<World> {
    let mut world = world_file::read(collisions.world.as_deref())?;
    for [one, other] in &collisions.allow_collision {
        let allowed = world.allow_collision(one, other);
        allowed.map_err(|error| usage!("allow_collision: {error}"))?;
    }
    Ok(world)
}

/// Checker of a robot's shapes; pairs that random configurations never or always have in contact are disabled.
pub(crate) fn checker(collisions: &CollisionSettings, model: CollisionModel) -> Outcome<Checker> {
    let Some(file) = &collisions.sphere_model else {
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

/// Shapes in words, or `None` for the defaults.
pub(crate) fn unusual_shapes(collisions: &CollisionSettings) -> Option<String> {
    let is_default = collisions.package.is_empty() && collisions.meshes == MeshUse::Hull;
    (!is_default || collisions.leave_out_meshes).then(|| {
        format!(
            "{:?}, packages {:?}, missing meshes left out: {}",
            collisions.meshes, collisions.package, collisions.leave_out_meshes
        )
    })
}

/// Collision model of a robot; notes go to standard error.
pub(crate) fn shapes(collisions: &CollisionSettings, robot: &Robot) -> Outcome<CollisionModel> {
    let mut builder = CollisionModel::builder(robot).with_meshes(collisions.meshes);
    for folder in &collisions.package {
        builder = builder.with_package_folder(folder);
    }
    if collisions.leave_out_meshes {
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

impl CollisionOptions {
    /// Collision model of a robot with its enabled pairs; notes go to standard error.
    pub(crate) fn model(
        &self,
        robot: &Robot,
        problem: &ProblemSettings,
    ) -> Outcome<CollisionModel> {
        let mut model = shapes(&problem.collisions, robot)?;
        let mut samples = SAMPLES;
        if let Some(path) = self.srdf.as_ref().or(problem.model.srdf.as_ref()) {
            model = model.with_srdf(&read_srdf(&problem.model, path, robot)?);
            samples = 0;
        }
        Ok(model.with_pairs_sampled(self.samples.unwrap_or(samples), 0)?)
    }
}
