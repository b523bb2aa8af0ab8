//! Problems of a bench.

use std::path::Path;

use kinopt::model::{FrameId, Model};
use kinopt::robot::Robot;
use kinopt_bindings::problem_file::targets_file::TargetsFile;
use kinopt_harness::{Case, ProblemSet, ProblemSetBuilder};

use super::arguments::{Arguments, StartAt};
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::json_file;
use crate::loaded_model::LoadedModel;
use crate::solve::base::Base;

/// Number of random problems.
const RANDOM_PROBLEMS: usize = 100;

/// Problems of the arguments.
pub(super) fn problems(loaded: &LoadedModel, arguments: &Arguments) -> Outcome<ProblemSet> {
    match &arguments.targets {
        Some(path) => of_file(loaded, arguments, path),
        None => at_random(loaded, arguments),
    }
}

fn at_random(loaded: &LoadedModel, arguments: &Arguments) -> Outcome<ProblemSet> {
    let frames = match &arguments.tip {
        Some(name) => vec![loaded.frame(name, BareName::Tip)?],
        None => default_tips(loaded)?,
    };
    let with_orientation = loaded.robot.is_some() && !arguments.position_only;
    let set = builder(loaded, arguments, &frames, with_orientation).build()?;
    let rest = loaded.rest();
    let start = match starts(loaded, arguments) {
        StartAt::Rest => Some(rest.as_slice()),
        StartAt::Random => None,
    };
    let count = arguments.problems.unwrap_or(RANDOM_PROBLEMS);
    Ok(set.with_random_cases(count, arguments.rng_seed, start)?)
}

fn of_file(loaded: &LoadedModel, arguments: &Arguments, path: &Path) -> Outcome<ProblemSet> {
    let fail = |problem: String| failure!("{}: {problem}", path.display());
    let file = TargetsFile::of_value(&json_file::read(path)?, path)?;
    let frame = match arguments.tip.as_ref().or(file.tip_link.as_ref()) {
        Some(name) => loaded.frame(name, BareName::Tip)?,
        None => match default_tips(loaded)?.as_slice() {
            [only] => *only,
            tips => {
                let problem = format!(
                    "has no key `tip_link`, so --tip must name one of {} tips",
                    tips.len()
                );
                return Err(fail(problem));
            }
        },
    };
    let world_from_base = match Base::named(loaded, file.base_link.as_deref())? {
        Base::Still(placement) => placement,
        Base::Moving(_) => {
            return Err(fail(
                "base_link: free joints move it; bench needs a fixed base".to_owned(),
            ));
        }
    };
    let turns = file.turns && !arguments.position_only;
    let set = builder(loaded, arguments, &[frame], turns)
        .build()?
        .with_seed(arguments.rng_seed);
    let starts = file_starts(loaded, arguments, &file, &set).map_err(fail)?;
    let targets = file.targets.iter().zip(starts);
    let cases = targets.map(|(&target, start)| Case {
        targets: vec![world_from_base * target],
        start,
    });
    Ok(set.with_cases(cases.collect())?)
}

fn builder(
    loaded: &LoadedModel,
    arguments: &Arguments,
    frames: &[FrameId],
    turns: bool,
) -> ProblemSetBuilder {
    let builder = match &loaded.robot {
        Some(robot) => ProblemSet::builder(&**robot),
        None => ProblemSet::builder(&loaded.model),
    };
    let builder = builder.size(loaded.size()).tolerance(arguments.tolerance);
    frames.iter().fold(builder, |builder, &frame| match turns {
        true => builder.pose(frame),
        false => builder.point(frame),
    })
}

fn starts(loaded: &LoadedModel, arguments: &Arguments) -> StartAt {
    arguments.start.unwrap_or(match loaded.robot {
        Some(_) => StartAt::Random,
        None => StartAt::Rest,
    })
}

/// One start for each target: the file's, unless the arguments set another.
fn file_starts(
    loaded: &LoadedModel,
    arguments: &Arguments,
    file: &TargetsFile,
    set: &ProblemSet,
) -> Result<Vec<Vec<f64>>, String> {
    if arguments.start.is_none() {
        if let Some(starts) = loaded.starts_of(file, None)? {
            return Ok(starts);
        }
    }
    let seed = |index: usize| arguments.rng_seed.wrapping_add(index as u64);
    let start = |index| match starts(loaded, arguments) {
        StartAt::Rest => loaded.rest(),
        StartAt::Random => set.random_configuration(seed(index)),
    };
    Ok((0..file.targets.len()).map(start).collect())
}

/// Pinned tips of a rig; the end of a robot's longest chain.
fn default_tips(loaded: &LoadedModel) -> Outcome<Vec<FrameId>> {
    if let Some(rig) = &loaded.rig {
        let tips = rig.constrained.iter();
        return Ok(tips.map(|&bone| rig.skeleton.tip(bone)).collect());
    }
    let robot = loaded.robot.as_deref();
    let tip = robot.and_then(end_of_longest_chain);
    let tip = tip.ok_or_else(|| failure!("{}: has no moving link", loaded.file))?;
    Ok(vec![tip])
}

/// Tip with the most rotating joints above it. Ties go to the longest path from the root, then to the first.
fn end_of_longest_chain(robot: &Robot) -> Option<FrameId> {
    let model = robot.model();
    let tips = robot.tips().into_iter();
    let rated = tips.map(|tip| (rating(model, tip), tip));
    let better = |best: Option<((usize, f64), FrameId)>, next: ((usize, f64), FrameId)| match best {
        Some(best) if best.0 >= next.0 => Some(best),
        _ => Some(next),
    };
    rated.fold(None, better).map(|(_, tip)| tip)
}

/// Number of rotating joints above a frame, and the length of the path to it in metres.
///
/// Prismatic joints do not count, so that a gripper finger does not make a chain longer than its tool.
fn rating(model: &Model, tip: FrameId) -> (usize, f64) {
    let Some(frame) = model.frames().get(tip.index()) else {
        return (0, 0.0);
    };
    let mut rating = (0, frame.joint_from_frame.translation.norm());
    let mut ancestor = frame.joint;
    while let Some(joint) = ancestor.and_then(|id| model.joints().get(id.index())) {
        rating.0 += usize::from(joint.kind.turns() && !joint.limits.is_locked());
        rating.1 += joint.parent_from_joint.translation.norm();
        ancestor = joint.parent;
    }
    rating
}
