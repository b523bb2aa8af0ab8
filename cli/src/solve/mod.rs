//! `kinopt solve`: from targets to a configuration.

mod report;
mod tasks;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{ArgGroup, Args};
use kinopt::Workspace;
use kinopt::ik::Restarts;
use kinopt::solver::Stopping;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::mesh_output::MeshFile;
use crate::method_choice::{self, JacobianRoute};
use crate::progress::Progress;
use crate::target::{RayTarget, Start, Target};
use crate::{number_list, output};

const EXAMPLES: &str = "\
Examples:
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1
        bring a tip to a point; tips pinned in the rig stay where they are
  kinopt solve man.json --free --target bone/9=0.5,1.2,0.3 --target bone/13=-0.5,1.2,0.3
        two hands at once, nothing pinned
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1,1,0,0,0 --out posed.obj
        a whole pose (quaternion w,x,y,z), and the skinned mesh
  kinopt solve arm.json --ray bone/6=0,0.5,3:0.2,0.5,0 --json
        a tip onto the viewing ray through two points

A target that is out of reach is no failure: the closest pose found is printed with what each
target misses by and which limits hold it back (--json: \"reached\": false). The exit code is 0.";

/// Joint angles, within their limits, that bring frames to targets (inverse kinematics).
///
/// In a rig the other tips that the file pins (ik_constraints) are held where they are at the start,
/// unless --free.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    group = ArgGroup::new("wanted").required(true).multiple(true).args(["targets", "rays"])
)]
pub(crate) struct Arguments {
    /// The model: a rig's .json file.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Where a frame should be, in metres (rigs: their own unit). Default: none.
    ///
    /// Three numbers are a point; with a quaternion w,x,y,z it is a whole pose. In a rig `bone/3`
    /// or a bone's name is that bone's tip; `bone/3/tip` and `bone/3/tail` say it outright. Repeat
    /// it for several. At least one --target or --ray is needed.
    #[arg(long = "target", value_name = "FRAME=x,y,z[,qw,qx,qy,qz]", value_parser = Target::parse)]
    targets: Vec<Target>,

    /// A line that a frame should lie on, in metres (rigs: their own unit). Default: none.
    ///
    /// It goes through an eye and a point (the mouse, unprojected). Frames are named as for
    /// --target. Repeat it for several.
    #[arg(long = "ray", value_name = "FRAME=ex,ey,ez:mx,my,mz", value_parser = RayTarget::parse)]
    rays: Vec<RayTarget>,

    /// Let the rig's pinned tips go. Default: those without a target of their own are held.
    #[arg(long)]
    free: bool,

    /// Where the search starts: a word, or numbers in radians and metres.
    ///
    /// `rest` is all zeros, moved into the limits; `random` is drawn within the limits from
    /// --rng-seed; numbers are a configuration in the order of `kinopt info`: radians (degrees with
    /// --degrees) and, for sliding joints, metres. They are moved into the limits.
    #[arg(long, value_name = "NUMBERS|rest|random", default_value = "rest",
          allow_hyphen_values = true, value_parser = Start::parse)]
    start: Start,

    /// The numbers of --start, and the angles in text output, are in degrees. Default: radians.
    #[arg(long)]
    degrees: bool,

    /// The method.
    #[arg(long, value_name = "NAME", default_value = "levenberg-marquardt",
          value_parser = method_choice::names())]
    solver: String,

    /// How derivatives are found.
    #[arg(long, value_name = "ROUTE", default_value = "analytic", value_enum)]
    jacobian: JacobianRoute,

    /// Seed of a random start and of the restarts: a whole number. Same seed, same result.
    #[arg(long, value_name = "N", default_value_t = 0)]
    rng_seed: u64,

    /// Stop after so many milliseconds with the best found. Default: no limit.
    ///
    /// Results then depend on the machine. The clock runs while solving, not while reading files.
    #[arg(long, value_name = "MS", value_parser = milliseconds)]
    time_limit: Option<Duration>,

    /// What counts as reached: so many metres (rigs: their own unit) and radians. Default: 1e-9 of
    /// a rig's size and 1e-9 rad; 1e-6 m and rad for robots.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative)]
    tolerance: Option<f64>,

    /// How many more attempts from other places while the targets are missed; 0 for none.
    #[arg(long, value_name = "N", default_value_t = 31)]
    restarts: u32,

    /// How many steps each attempt may take, at most.
    ///
    /// The gradient methods take many small ones.
    #[arg(long, value_name = "N", default_value_t = 200)]
    max_iterations: u32,

    /// Write the mesh in the pose found, as .obj or .ply. Default: not written.
    ///
    /// It needs a rig with a mesh and skin weights.
    #[arg(long, value_name = "FILE", value_parser = MeshFile::parse)]
    out: Option<MeshFile>,
}

/// A time limit that a clock can hold: above zero, at most 30 years.
fn milliseconds(text: &str) -> Result<Duration, String> {
    let milliseconds = number_list::positive(text)?;
    if milliseconds > 1e12 {
        return Err(format!("`{text}` is above 1e12 ms"));
    }
    Duration::try_from_secs_f64(milliseconds * 1e-3).map_err(|error| error.to_string())
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let loaded = LoadedModel::read(&arguments.model)?;
    // Before the search, not after it.
    let skin = arguments.out.as_ref().map(|_| loaded.skin()).transpose()?;
    let start = start(&loaded, arguments)?;
    let (mut problem, tasks) = tasks::problem(&loaded, arguments, &start)?;
    problem.set_derivatives(arguments.jacobian.into());

    let iterations = usize::try_from(arguments.max_iterations).unwrap_or(usize::MAX);
    let mut stopping = Stopping::default().with_max_iterations(iterations);
    if let Some(limit) = arguments.time_limit {
        stopping = stopping.with_time_limit(limit);
    }
    let attempts = usize::try_from(arguments.restarts).unwrap_or(usize::MAX);
    let attempts = attempts.saturating_add(1);
    // All attempts are made: several that agree may still share a local minimum, and a person who
    // waits for one answer rather waits a millisecond more than hears that a target is out of reach.
    let restarts = Restarts::default()
        .with_attempts(attempts)
        .with_agreeing(attempts)
        .with_seed(arguments.rng_seed);
    let solver = method_choice::solver(&arguments.solver)
        .with_stopping(stopping)
        .with_restarts(restarts);

    let mut workspace = Workspace::new();
    let mut progress = Progress::new();
    let started = Instant::now();
    let solution = solver.solve_observed(&problem, &start, &mut workspace, &mut progress)?;
    let micros = started.elapsed().as_secs_f64() * 1e6;
    progress.finish();

    if let (Some(skin), Some(out)) = (skin, &arguments.out) {
        out.write(&skin.posed(&solution.q)?)?;
    }
    let result = report::Report {
        loaded: &loaded,
        solution,
        tasks: &tasks,
        micros,
    };
    if json {
        output::json(&result.document())?;
    } else {
        output::result(&result.text(arguments.degrees))?;
    }
    if let Some(out) = &arguments.out {
        output::message(&format!("wrote {}", out.path().display()));
    }
    Ok(())
}

/// The start within the limits.
fn start(loaded: &LoadedModel, arguments: &Arguments) -> Outcome<Vec<f64>> {
    let start = match &arguments.start {
        Start::Rest => loaded.model.neutral(),
        Start::Random => loaded.model.random_configuration(arguments.rng_seed),
        Start::Numbers(numbers) => {
            let typed = loaded.typed_configuration(numbers, arguments.degrees, "--start")?;
            loaded.note_outside_limits(&typed, "the search starts within them");
            typed
        }
    };
    let limits = loaded.model.limits().zip(start);
    Ok(limits.map(|(limits, value)| limits.clamp(value)).collect())
}
