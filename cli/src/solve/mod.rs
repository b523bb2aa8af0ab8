//! `kinopt solve`: from targets to a configuration.

mod answer;
mod arguments;
mod arm_arguments;
mod arm_door;
pub(crate) mod base;
mod bystanders;
mod chain_arguments;
mod core_door;
mod door;
mod figure;
mod held;
mod interval;
mod many;
mod out_file;
mod report;
mod tasks;
mod weights;

use std::time::Instant;

use kinopt::Workspace;
use kinopt::robot::Robot;

use answer::{Answer, AskedTask, Question};
pub(crate) use arguments::Arguments;
use arm_door::{ArmDoor, microseconds};
use door::Door;
use figure::Finder;
use report::Report;
use tasks::Asked;

use crate::failure::{Failure, Outcome};
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Progress;

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let moment = arguments.moment();
    let mut loaded = LoadedModel::read_at(&arguments.model, &arguments.robot, moment)?;
    arguments.hold(&mut loaded)?;
    if let Some(file) = &arguments.file {
        return many::run(loaded, arguments, file, json);
    }
    arguments.put_tool(&mut loaded)?;
    let robot = arguments.arm_of(&loaded)?;
    // Before the search, not after it; but after all names, as making up skin weights takes a while.
    let ready = || {
        let out = arguments.out.as_ref();
        out.map(|out| out.of(&loaded, arguments.skin_weights))
            .transpose()
    };
    let (written, answered) = match robot {
        Some(robot) => (ready()?, by_arm(&loaded, robot, arguments)?),
        None => {
            let start = arguments.start(&loaded, None)?;
            let asked = tasks::asked(&loaded, arguments, &start)?;
            let written = ready()?;
            let answered = by_general_solver(&loaded, arguments, asked, &start)?;
            (written, answered)
        }
    };
    let mut notes = loaded.notes();
    notes.extend(written.as_ref().and_then(|written| written.note()));
    let written = written.as_ref();
    let written = written
        .map(|written| written.write(&answered.answer.q, arguments.skinning))
        .transpose()?;
    let report = Report {
        loaded: &loaded,
        answer: &answered.answer,
        tasks: &answered.tasks,
        bystanders: &answered.bystanders,
    };
    if json {
        output::json(&report.whole_document(notes))?;
    } else {
        output::result(&report.text(arguments.degrees))?;
    }
    if let Some(path) = written {
        output::message(&format!("wrote {}", path.display()));
    }
    let missed = usize::from(!answered.answer.solution.reached);
    arguments.told_misses(missed, 1)
}

/// An answer to all that was asked at once.
struct Answered {
    answer: Answer,
    tasks: Vec<AskedTask>,
    /// Coordinates that no task feels.
    bystanders: Vec<usize>,
}

/// One target of a robot.
fn by_arm(loaded: &LoadedModel, robot: &Robot, arguments: &Arguments) -> Outcome<Answered> {
    let Some(target) = arguments.targets.first() else {
        return Err(Failure::usage("a robot's arm is asked for one --target"));
    };
    let turns = target.quaternion.is_some() && !arguments.position_only;
    let base = arguments.base.as_deref();
    let door = ArmDoor::new(loaded, robot, arguments, base, &target.frame, turns)?;
    let question = Question {
        base_from_tip: target.placement(),
        start: arguments.start(loaded, Some(door.columns()))?,
    };
    let mut desk = door.desk()?;
    let ends = [Some(target.frame.as_str()), base].into_iter().flatten();
    let ends = ends.map(|name| loaded.frame(name, BareName::Tail));
    let ends = ends.collect::<Result<Vec<_>, _>>()?;
    Ok(Answered {
        answer: door.answer(&mut desk, &question)?,
        tasks: door.tasks(),
        bystanders: bystanders::bystanders(loaded, &ends),
    })
}

/// Everything that is asked at once.
fn by_general_solver(
    loaded: &LoadedModel,
    arguments: &Arguments,
    asked: Asked,
    start: &[f64],
) -> Outcome<Answered> {
    let mut workspace = Workspace::new();
    let mut progress = Progress::new();
    let finder = Finder::new(loaded, arguments);
    let mut body = finder.body(asked.problem, start)?;
    let started = Instant::now();
    let found = finder.find(&mut body, start, &mut workspace, &mut progress)?;
    let micros = microseconds(started);
    progress.finish();
    Ok(Answered {
        answer: found.answer(micros),
        tasks: asked.tasks,
        bystanders: asked.bystanders,
    })
}
