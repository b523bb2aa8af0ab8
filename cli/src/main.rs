//! The `kinopt` command.
//!
//! Exit code 0 is success; a target that is not reached is a result, not a failure. Exit code 1 is a failure with a
//! one-line reason on standard error, and 2 wrong usage. With --fail-on-miss, 3 is a target that is not reached.

#[macro_use]
mod failure;

mod animate;
mod animated_armature;
mod ball_figure;
#[cfg(feature = "bench")]
mod bench;
#[cfg(not(feature = "bench"))]
mod bench_left_out;
mod calibrate;
mod check;
mod choices;
mod closed_by_fk;
mod collision_document;
mod collision_options;
mod configuration;
mod file_access;
mod fk;
mod frame_name;
mod frame_report;
mod help_headings;
mod hinges;
mod info;
mod interpolation_choice;
mod joint_columns;
mod json_file;
mod jump_document;
mod loaded_model;
mod mesh_output;
mod model_options;
mod moved_options;
mod number_format;
mod output;
mod outside_limits;
mod path;
mod placed_frames;
mod problem_options;
mod progress;
mod retarget;
mod robot_base;
mod scene_output;
mod score;
mod solve;
mod spheres;
mod table;
mod world_file;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{ArgAction, CommandFactory, FromArgMatches, Parser, Subcommand};

#[cfg(not(feature = "bench"))]
use bench_left_out as bench;
use failure::Failure;

const AFTER_HELP: &str = "\
Units: metres and radians; a rig has its own unit of length. Quaternions are w,x,y,z.
With --json, standard output is one JSON document; messages go to standard error.

Exit codes, of every subcommand:
  0  done; a target that is not reached is a result
  1  failed, with a one-line reason; for check also a collision
  2  wrong usage: unknown, malformed or conflicting options
  3  target not reached, in solve, body, batch, track, servo, reach and path with --fail-on-miss

Examples:
  kinopt info robot.urdf
  kinopt solve robot.urdf --tip tool --target 0.4,0.1,0.5,0,1,0,0
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1 --out posed.obj
  kinopt batch robot.urdf --tip tool --targets poses.json --json
  kinopt reach robot.urdf --tip tool --targets grasps.json --criterion manipulability
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
  kinopt fk walk.bvh --time 1.5 --frame Head/tip
  kinopt check robot.urdf --q-file solved.json --world kitchen.json --margin 0.01
  kinopt animate fox.glb --clip Run --time 0.2 --out posed.glb
  kinopt retarget walk.bvh g1.urdf --base-joint free --out walk.npz
  kinopt score walk.csv g1.urdf --subject walk.bvh

Each subcommand has a --help. Options that only few need are keys of a JSON file (--problem FILE);
docs/reference/problem.md lists them. kinopt bench needs a build with the feature `bench`:
  cargo install --path cli --features bench";

/// Inverse kinematics by optimisation: inspect and pose models, and find joint values within limits for targets.
#[derive(Debug, Parser)]
#[command(name = "kinopt", version, about, after_help = AFTER_HELP)]
struct Command {
    #[command(subcommand)]
    subcommand: Subcommands,

    /// Print one JSON document, in radians and metres.
    #[arg(long, global = true, help_heading = help_headings::OUTPUT)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Subcommands {
    Solve(Box<solve::one::Arguments>),
    Body(Box<solve::body::Arguments>),
    Batch(Box<solve::many::batch::Arguments>),
    Track(Box<solve::many::track::Arguments>),
    Servo(Box<solve::many::servo_arguments::Arguments>),
    Reach(Box<solve::reach::Arguments>),
    Path(Box<path::Arguments>),
    Fk(fk::Arguments),
    Info(info::Arguments),
    Check(check::Arguments),
    Spheres(spheres::Arguments),
    Calibrate(calibrate::Arguments),
    Animate(animate::Arguments),
    Retarget(retarget::Arguments),
    Score(score::Arguments),
    Bench(bench::Arguments),
}

/// Common names of functions that are other subcommands, with the command.
const COMMON_NAMES: [(&str, &str); 3] = [
    ("ik", "solve MODEL --target FRAME=POSE"),
    ("follow", "track MODEL --targets FILE"),
    ("collide", "check MODEL"),
];

/// Parsed command line. Options that take a value accept negative numbers, so that their error message names the value.
fn parsed() -> Result<Command, Error> {
    let mut command = Command::command().mut_subcommands(|subcommand| {
        let help = clap::Arg::new("help").long("help").short('h');
        let help = help.action(ArgAction::Help).help("Print this page");
        let subcommand = subcommand.mut_args(|option| {
            let takes_value = option.get_action().takes_values();
            option.allow_negative_numbers(takes_value)
        });
        subcommand
            .disable_help_flag(true)
            .arg(help.help_heading(help_headings::OUTPUT))
    });
    let typed = command.try_get_matches_from_mut(std::env::args_os())?;
    Command::from_arg_matches(&typed).map_err(|error| error.format(&mut command))
}

/// Hint for an unknown subcommand or option, if there is another name for it.
fn hint(error: &Error) -> Option<String> {
    if let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) {
        let (_, command) = COMMON_NAMES.iter().find(|(name, _)| name == word)?;
        return Some(format!("`{word}` is `kinopt {command}`"));
    }
    match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(option)) if error.kind() == ErrorKind::UnknownArgument => {
            moved_options::hint(option)
        }
        _ => None,
    }
}

fn main() -> ExitCode {
    let command = match parsed() {
        Ok(command) => command,
        Err(error) => {
            // Help, version or wrong usage: clap chooses stream and exit code. A closed stream is ignored.
            let _ = error.print();
            if let Some(hint) = hint(&error) {
                output::message(&hint);
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let json = command.json;
    let done = match &command.subcommand {
        Subcommands::Info(arguments) => info::run(arguments, json),
        Subcommands::Animate(arguments) => animate::run(arguments, json),
        Subcommands::Fk(arguments) => fk::run(arguments, json),
        Subcommands::Solve(arguments) => solve::one::run(arguments, json),
        Subcommands::Body(arguments) => solve::body::run(arguments, json),
        Subcommands::Batch(arguments) => solve::many::batch::run(arguments, json),
        Subcommands::Track(arguments) => solve::many::track::run(arguments, json),
        Subcommands::Servo(arguments) => solve::many::servo_arguments::run(arguments, json),
        Subcommands::Reach(arguments) => solve::reach::run(arguments, json),
        Subcommands::Path(arguments) => path::run(arguments, json),
        Subcommands::Spheres(arguments) => spheres::run(arguments, json),
        Subcommands::Calibrate(arguments) => calibrate::run(arguments, json),
        Subcommands::Check(arguments) => check::run(arguments, json),
        Subcommands::Retarget(arguments) => retarget::run(arguments, json),
        Subcommands::Score(arguments) => score::run(arguments, json),
        Subcommands::Bench(arguments) => bench::run(arguments, json),
    };
    match done {
        Ok(()) | Err(Failure::ReaderGone) => ExitCode::SUCCESS,
        Err(Failure::Usage(reason)) => {
            output::message(&format!("error: {reason}"));
            ExitCode::from(2)
        }
        Err(Failure::Missed(reason)) => {
            output::message(&reason);
            ExitCode::from(3)
        }
        Err(Failure::Touching(reason)) => {
            output::message(&reason);
            ExitCode::from(1)
        }
        Err(Failure::Reason(reason)) => {
            output::message(&format!("error: {reason}"));
            ExitCode::from(1)
        }
    }
}
