//! `kinopt solve`: from targets to a configuration.

mod answer;
mod arguments;
mod arm_arguments;
mod arm_door;
mod base;
mod bystanders;
mod core_door;
mod door;
mod many;
mod relative_pose;
mod report;
mod tasks;

use std::time::Instant;

use kinopt::Workspace;
use kinopt::robot::Robot;

use answer::{Answer, AskedTask, Question};
pub(crate) use arguments::Arguments;
use arm_door::{ArmDoor, microseconds};
use door::Door;
use report::Report;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Progress;

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let loaded = LoadedModel::read(&arguments.model)?;
    let robot = arguments.arm_of(&loaded)?;
    if let Some(file) = &arguments.file {
        return many::run(&loaded, robot, arguments, file, json);
    }
    // Before the search, not after it.
    let skin = arguments.out.as_ref().map(|_| loaded.skin()).transpose()?;
    let (answer, tasks) = match robot {
        Some(robot) => by_arm(&loaded, robot, arguments)?,
        None => by_general_solver(&loaded, arguments)?,
    };
    if let (Some(skin), Some(out)) = (skin, &arguments.out) {
        out.write(&skin.posed(&answer.q)?)?;
    }
    let report = Report {
        loaded: &loaded,
        answer: &answer,
        tasks: &tasks,
    };
    if json {
        output::json(&report.document_with_joints())?;
    } else {
        output::result(&report.text(arguments.degrees))?;
    }
    if let Some(out) = &arguments.out {
        output::message(&format!("wrote {}", out.path().display()));
    }
    Ok(())
}

/// One target of a robot.
fn by_arm(
    loaded: &LoadedModel,
    robot: &Robot,
    arguments: &Arguments,
) -> Outcome<(Answer, Vec<AskedTask>)> {
    let Some(target) = arguments.targets.first() else {
        return by_general_solver(loaded, arguments);
    };
    let turns = target.quaternion.is_some() && !arguments.position_only;
    let base = arguments.base.as_deref();
    let door = ArmDoor::new(loaded, robot, arguments, base, &target.frame, turns)?;
    let question = Question {
        base_from_tip: target.placement(),
        start: arguments.start(loaded, Some(&door))?,
    };
    let mut desk = door.desk()?;
    Ok((door.answer(&mut desk, &question)?, door.tasks()))
}

/// Everything that is asked at once.
fn by_general_solver(
    loaded: &LoadedModel,
    arguments: &Arguments,
) -> Outcome<(Answer, Vec<AskedTask>)> {
    let start = arguments.start(loaded, None)?;
    let asked = tasks::asked(loaded, arguments, &start)?;
    let mut workspace = Workspace::new();
    let mut progress = Progress::new();
    let solver = arguments.general_solver();
    let started = Instant::now();
    let solution = solver.solve_observed(&asked.problem, &start, &mut workspace, &mut progress)?;
    let micros = microseconds(started);
    progress.finish();
    let mut q = solution.q.clone();
    bystanders::put_back(&mut q, &asked.bystanders, &start);
    let answer = Answer {
        q,
        alternatives: Vec::new(),
        solution: solution.clone(),
        micros: Some(micros),
    };
    Ok((answer, asked.tasks))
}
