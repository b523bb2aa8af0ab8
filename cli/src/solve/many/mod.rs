//! `--targets`: many independent targets of one frame, a path, or the targets of a servo.

mod servo;
mod summary;

use std::path::Path;

use rayon::prelude::*;

use self::summary::Outcomes;
use super::answer::{Answer, Path as SolvedPath, Question};
use super::arguments::Arguments;
use super::arm_door::ArmDoor;
use super::core_door::CoreDoor;
use super::door::Door;
use crate::countdown::Countdown;
use crate::failure::{Failure, Outcome};
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::targets_file::TargetsFile;

/// Solves every target of a file and prints what came out.
pub(super) fn run(
    mut loaded: LoadedModel,
    arguments: &Arguments,
    path: &Path,
    json: bool,
) -> Outcome<()> {
    let file = TargetsFile::read(path)?;
    let tip = tip(&loaded, arguments, &file, path)?.to_owned();
    if let Some(tool) = &arguments.chain.tool {
        let frame = loaded.frame(&tip, BareName::Tip)?;
        loaded.put_tool(frame, tool)?;
    }
    let (loaded, tip) = (&loaded, tip.as_str());
    let robot = arguments.arm_of(loaded)?;
    let base = arguments.base.as_deref().or(file.base_link.as_deref());
    let turns = file.turns && !arguments.position_only;
    let outcomes = match robot {
        Some(robot) => {
            let door = ArmDoor::new(loaded, robot, arguments, base, tip, turns)?;
            let questions = questions(loaded, Some(&door), arguments, &file, path)?;
            if let Some(rate) = arguments.arm.servo {
                return servoed(loaded, &door, arguments, &questions, rate, json);
            }
            solve(&door, arguments, &questions)?
        }
        None => {
            let door = CoreDoor::new(loaded, arguments, base, tip, turns)?;
            let questions = questions(loaded, None, arguments, &file, path)?;
            solve(&door, arguments, &questions)?
        }
    };
    if json {
        output::json(&outcomes.document(loaded))?;
    } else {
        output::result(&outcomes.text(loaded))?;
    }
    let answers = &outcomes.answers;
    let missed = answers.iter().filter(|answer| !answer.solution.reached);
    arguments.told_misses(missed.count(), answers.len())
}

/// Follows the targets at a rate, in ticks a second, and prints what came out.
fn servoed(
    loaded: &LoadedModel,
    door: &ArmDoor<'_>,
    arguments: &Arguments,
    questions: &[Question],
    rate: f64,
    json: bool,
) -> Outcome<()> {
    let Some(first) = questions.first() else {
        return Err(Failure::new("there are no targets to follow"));
    };
    let servo = door.servo(arguments, first, rate)?;
    let servoed = servo::follow(loaded, door, servo, questions, rate)?;
    if json {
        output::json(&servoed)?;
    } else {
        output::result(&servoed.text())?;
    }
    arguments.told_misses(usize::from(servoed.missed()), 1)
}

/// The frame that the targets are for.
fn tip<'a>(
    loaded: &'a LoadedModel,
    arguments: &'a Arguments,
    file: &'a TargetsFile,
    path: &Path,
) -> Outcome<&'a str> {
    if let Some(tip) = arguments.tip.as_deref().or(file.tip_link.as_deref()) {
        return Ok(tip);
    }
    match loaded.tip_links().as_slice() {
        [only] => Ok(only),
        tips => Err(Failure::new(format!(
            "{}: has no key `tip_link`, so --tip must say which frame the targets are for{}",
            path.display(),
            if tips.is_empty() {
                String::new()
            } else {
                format!("; tips: {}", tips.join(", "))
            }
        ))),
    }
}

/// The targets with their starts.
fn questions(
    loaded: &LoadedModel,
    arm: Option<&ArmDoor>,
    arguments: &Arguments,
    file: &TargetsFile,
    path: &Path,
) -> Outcome<Vec<Question>> {
    let fail = |problem: String| Failure::new(format!("{}: {problem}", path.display()));
    let named = file.joint_names.as_ref();
    let named = named.map(|names| loaded.joint_columns(names)).transpose();
    let named = named.map_err(|problem| fail(format!("joint_names: {problem}")))?;
    let starts = match &file.starts {
        None => vec![arguments.start(loaded, arm.map(ArmDoor::columns))?; file.targets.len()],
        Some(rows) => {
            let width = rows.first().map_or(0, Vec::len);
            let columns = match named {
                Some(columns) => columns,
                None => columns(loaded, arm, width).map_err(fail)?,
            };
            let configuration = |row: &Vec<f64>| loaded.within_limits(&columns.configuration(row));
            rows.iter().map(configuration).collect()
        }
    };
    let targets = file.targets.iter().zip(starts);
    Ok(targets
        .map(|(&base_from_tip, start)| Question {
            base_from_tip,
            start,
        })
        .collect())
}

/// What starts without joint names hold: all moving joints, or the free ones from base to tip.
fn columns(
    loaded: &LoadedModel,
    arm: Option<&ArmDoor>,
    width: usize,
) -> Result<JointColumns, String> {
    let all = loaded.model.degrees_of_freedom();
    if width == all {
        return Ok(loaded.columns_of((0..all).collect()));
    }
    let arm_columns = arm.map(ArmDoor::columns);
    if let Some(columns) = arm_columns.filter(|columns| columns.width() == width) {
        return Ok(columns);
    }
    let or_arm = arm.map_or_else(String::new, |arm| {
        let names = arm.joint_names();
        format!(
            ", or {} from base to tip: {}",
            names.len(),
            names.join(", ")
        )
    });
    Err(format!(
        "starts[0]: has {width} numbers; without joint_names there are {all} for all moving \
         joints{or_arm}"
    ))
}

/// Asks the door in the way that the arguments say.
fn solve(door: &impl Door, arguments: &Arguments, questions: &[Question]) -> Outcome<Outcomes> {
    let alone = |answers| SolvedPath {
        answers,
        jumps: None,
    };
    let tasks = door.tasks();
    let threads = arguments.threads.map(usize::from);
    let pool = threads.map(|threads| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build()
    });
    let pool = pool.transpose()?;
    let (path, batch_micros) = if arguments.batch {
        let (answers, micros) = match &pool {
            Some(pool) => pool.install(|| door.batch(questions, true))?,
            None => door.batch(questions, false)?,
        };
        (alone(answers), Some(micros))
    } else if arguments.track {
        let countdown = Countdown::new(questions.len(), "targets");
        let path = door.path(questions, &|| countdown.one_more());
        countdown.finish();
        (path?, None)
    } else {
        let answers = one_at_a_time(door, questions, pool.as_ref())?;
        (alone(answers), None)
    };
    Ok(Outcomes {
        answers: path.answers,
        jumps: path.jumps,
        tasks,
        batch_micros,
    })
}

fn one_at_a_time(
    door: &impl Door,
    questions: &[Question],
    pool: Option<&rayon::ThreadPool>,
) -> Outcome<Vec<Answer>> {
    let countdown = Countdown::new(questions.len(), "targets");
    let ask = |desk: &mut Option<_>, question: &Question| {
        let desk = match desk {
            Some(desk) => desk,
            None => desk.insert(door.desk()?),
        };
        let answer = door.answer(desk, question)?;
        countdown.one_more();
        Ok(answer)
    };
    let answers = match pool {
        Some(pool) => pool.install(|| {
            let questions = questions.par_iter();
            questions.map_init(|| None, ask).collect()
        }),
        None => {
            let mut desk = None;
            let questions = questions.iter();
            questions.map(|question| ask(&mut desk, question)).collect()
        }
    };
    countdown.finish();
    answers
}
