//! `kinopt check`: collisions of a robot with a world and with itself.

use std::path::PathBuf;

use clap::Args;
use kinopt::collision::{Checker, Collision};
use kinopt_bindings::problem_file::number_list::Numbers;
use serde::Serialize;

use crate::collision_document::CollisionDocument;
use crate::collision_options::{CollisionOptions, ObstacleOptions, read_world};
use crate::failure::{Failure, Outcome};
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::output;
use crate::outside_limits::OutsideLimits;
use crate::table::Table;

const EXAMPLES: &str = "\
Examples:
  kinopt check robot.urdf --q 0,-0.8,0,-2.4,0,1.6,0.8,0.04,0.04 --world kitchen.json
  kinopt check robot.urdf --q-file solved.json --world scene.yaml --margin 0.02 --json
  kinopt check robot.urdf --srdf robot.srdf

Reports all enabled pairs nearer than --margin, deepest first, or else the nearest pair, and joints
outside their limits. Distances are exact. Exits with code 1 on a collision. Disabled are adjacent
links, pairs of the SRDF file, and pairs that random configurations show in contact never or almost
always. Shapes and allowed collisions are keys of the --problem file, such as
  {\"collisions\": {\"meshes\": \"parts\", \"allow_collision\": [[\"hand\", \"table\"]]}}";

/// Collision check of a robot against the obstacles of a world and against itself.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Robot file: .urdf or MJCF .xml.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,

    /// Configuration in radians and metres, as in `kinopt fk`. Default: the rest pose.
    #[arg(
        long,
        value_name = "NUMBERS",
        allow_hyphen_values = true,
        group = "configuration"
    )]
    q: Option<Numbers>,

    /// JSON file with the configuration, as in `kinopt fk`. Default: none.
    #[arg(long, value_name = "FILE", group = "configuration")]
    q_file: Option<PathBuf>,

    /// The angles of --q are degrees. Default: radians.
    #[arg(long, requires = "q", conflicts_with = "q_file")]
    degrees: bool,

    #[command(flatten)]
    obstacles: ObstacleOptions,

    #[command(flatten)]
    collisions: CollisionOptions,

    #[command(flatten)]
    model_options: ModelOptions,
}

#[derive(Serialize)]
struct Document<'a> {
    q: &'a [f64],
    free: bool,
    margin: f64,
    collisions: Vec<CollisionDocument<'a>>,
    /// Nearest of all pairs; `None` if no pair is checked.
    nearest: Option<CollisionDocument<'a>>,
    /// Joints outside their limits.
    outside_limits: &'a [OutsideLimits],
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let mut problem = arguments.model_options.problem()?;
    arguments.obstacles.add_to(&mut problem.collisions);
    let margin = problem.collisions.margin.unwrap_or(0.0);
    let loaded = LoadedModel::read(&arguments.robot, &problem.model)?;
    let robot = loaded.robot_with_shapes("check")?;
    let mut q = match (&arguments.q, &arguments.q_file) {
        (Some(numbers), _) => {
            loaded.typed_configuration(&numbers.values, arguments.degrees, "--q")?
        }
        (_, Some(path)) => loaded.configuration_file(path)?,
        _ => loaded.rest(),
    };
    loaded.close_loops(&mut q)?;
    let world = read_world(&problem.collisions)?;
    let model = (arguments.collisions).model(robot, &problem)?;
    let checker = Checker::new(model)
        .with_world(&world)?
        .with_margin(margin)?;
    let collisions = checker.collisions(&q)?;
    let nearest = match collisions.first() {
        Some(deepest) => Some(deepest.clone()),
        None => checker.nearest(&mut checker.workspace(), &q, f64::INFINITY)?,
    };
    let outside = loaded.outside_limits(&q)?;
    let document = || Document {
        q: &q,
        free: collisions.is_empty(),
        margin,
        collisions: collisions.iter().map(CollisionDocument::of).collect(),
        nearest: nearest.as_ref().map(CollisionDocument::of),
        outside_limits: &outside,
    };
    let text = || {
        let outside = outside.iter().map(|joint| format!("{joint}\n"));
        text(&collisions, nearest.as_ref()) + &outside.collect::<String>()
    };
    output::result(json, document, text)?;
    match collisions.len() {
        0 => Ok(()),
        count => Err(Failure::Touching(match (count, margin) {
            (1, 0.0) => "1 pair is in contact".to_owned(),
            (count, 0.0) => format!("{count} pairs are in contact"),
            (1, margin) => format!("1 pair is nearer than {margin} m"),
            (count, margin) => format!("{count} pairs are nearer than {margin} m"),
        })),
    }
}

fn text(collisions: &[Collision], nearest: Option<&Collision>) -> String {
    let millimetres = |metres: f64| format!("{:.3} mm", 1e3 * metres);
    match (collisions, nearest) {
        ([], None) => "free: no enabled pairs\n".to_owned(),
        ([], Some(nearest)) => format!(
            "free: {nearest} are nearest, {} apart\n",
            millimetres(nearest.distance)
        ),
        _ => {
            let mut table = Table::new("first | second | >depth | >distance");
            for pair in collisions {
                let depth = match pair.depth() > 0.0 {
                    true => millimetres(pair.depth()),
                    false => String::new(),
                };
                let distance = match pair.distance >= 0.0 {
                    true => millimetres(pair.distance),
                    false => String::new(),
                };
                let first = format!("{} {}", pair.first_kind, pair.first);
                let second = format!("{} {}", pair.second_kind, pair.second);
                table.row([first, second, depth, distance]);
            }
            table.text()
        }
    }
}
