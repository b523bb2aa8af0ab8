//! The `kinopt` command.
//!
//! Exit code 0 is success; a target that is not reached is a result, not a failure. Exit code 1 is a failure with a
//! one-line reason on standard error, and 2 wrong usage. With --fail-on-miss, 3 is a target that is not reached.

#[macro_use]
mod failure;

mod animate;
mod animated_armature;
mod ball_figure;
mod base_joint;
#[cfg(feature = "bench")]
mod bench;
#[cfg(not(feature = "bench"))]
mod bench_left_out;
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
mod info;
mod interpolation_choice;
mod joint_columns;
mod json_file;
mod loaded_model;
mod loop_options;
mod mesh_output;
mod method_choice;
mod model_options;
mod number_format;
mod number_list;
mod numpy_file;
mod output;
mod outside_limits;
mod path;
mod placed_frames;
mod progress;
mod retarget;
mod scene_output;
mod skin_report;
mod skinning_choice;
mod solve;
mod spheres;
mod table;
mod target;
mod targets_file;
mod weights_choice;
mod world_file;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, Error};
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
  3  target not reached, in solve and path with --fail-on-miss

Examples:
  kinopt info robot.urdf
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0
  kinopt solve robot.urdf --tip tool --targets poses.json --json
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
  kinopt fk arm.json --time 1.5 --frame bone/6
  kinopt fk walk.bvh --time 1.5 --frame Head/tip
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1 --out posed.obj
  kinopt check robot.urdf --q-file solved.json --world kitchen.json --margin 0.01
  kinopt animate arm.json --fps 24 --out frames
  kinopt animate fox.glb --clip Run --time 0.2 --out posed.glb
  kinopt spheres robot.urdf --max-protrusion 0.02 --out spheres.yml
  kinopt retarget walk.bvh g1.urdf --base-joint free --out walk.npz
  kinopt skin-report --out twist.svg
  kinopt bench robot.urdf --problems random:100 --out results

kinopt bench and the chart of skin-report need the features `bench` and `charts`:
  cargo run --release -p kinopt-cli --features bench -- bench robot.urdf --out results
  cargo install --path cli --features bench";

/// Inverse kinematics by optimisation: inspect and pose models, and find joint values within limits for targets.
#[derive(Debug, Parser)]
#[command(name = "kinopt", version, about, after_help = AFTER_HELP)]
struct Command {
    #[command(subcommand)]
    subcommand: Subcommands,

    /// Print one JSON document, in radians and metres (rigs: their own unit). Default: text.
    #[arg(long, global = true, help_heading = help_headings::OUTPUT)]
    json: bool,

    #[command(flatten)]
    files: file_access::FileOptions,
}

#[derive(Debug, Subcommand)]
enum Subcommands {
    Info(info::Arguments),
    Animate(animate::Arguments),
    Fk(fk::Arguments),
    Solve(Box<solve::Arguments>),
    Path(Box<path::Arguments>),
    Check(check::Arguments),
    Spheres(spheres::Arguments),
    Retarget(retarget::Arguments),
    SkinReport(skin_report::Arguments),
    Bench(bench::Arguments),
}

/// Common names of functions that are options or other subcommands, with the command.
const COMMON_NAMES: [(&str, &str); 5] = [
    ("ik", "solve MODEL --target FRAME=POSE"),
    ("track", "solve MODEL --targets FILE --track"),
    ("follow", "solve MODEL --targets FILE --track"),
    ("servo", "solve MODEL --targets FILE --servo HZ"),
    ("collide", "check MODEL"),
];

/// Parsed command line. Options that take a value accept negative numbers, so that their error message names the value.
fn parsed() -> Result<Command, Error> {
    let mut command = Command::command().mut_subcommands(|subcommand| {
        let subcommand = subcommand.mut_args(|option| {
            let takes_value = option.get_action().takes_values();
            option.allow_negative_numbers(takes_value)
        });
        with_short_help(subcommand)
    });
    let typed = command.try_get_matches_from_mut(std::env::args_os())?;
    Command::from_arg_matches(&typed).map_err(|error| error.format(&mut command))
}

/// `--help` lists the common options of a subcommand, a line each; `--help-all` lists all options and examples.
fn with_short_help(subcommand: clap::Command) -> clap::Command {
    let option = |name, action, help| {
        let option = clap::Arg::new(name).long(name).action(action).help(help);
        option.help_heading(help_headings::OUTPUT)
    };
    subcommand
        .disable_help_flag(true)
        .arg(option("help", ArgAction::HelpShort, "Print the common options.").short('h'))
        .arg(option(
            "help-all",
            ArgAction::HelpLong,
            "Print all options, with examples.",
        ))
}

fn main() -> ExitCode {
    let command = match parsed() {
        Ok(command) => command,
        Err(error) => {
            // Help, version or wrong usage: clap chooses stream and exit code. A closed stream is ignored.
            let _ = error.print();
            if let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
                && let Some((_, command_line)) = COMMON_NAMES.iter().find(|(name, _)| name == word)
            {
                output::message(&format!("`{word}` is `kinopt {command_line}`"));
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    command.files.hold();
    let json = command.json;
    let done = match &command.subcommand {
        Subcommands::Info(arguments) => info::run(arguments, json),
        Subcommands::Animate(arguments) => animate::run(arguments, json),
        Subcommands::Fk(arguments) => fk::run(arguments, json),
        Subcommands::Solve(arguments) => solve::run(arguments, json),
        Subcommands::Path(arguments) => path::run(arguments, json),
        Subcommands::Spheres(arguments) => spheres::run(arguments, json),
        Subcommands::Check(arguments) => check::run(arguments, json),
        Subcommands::Retarget(arguments) => retarget::run(arguments, json),
        Subcommands::SkinReport(arguments) => skin_report::run(arguments, json),
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
