//! Targets of every query, and their base.

use std::path::Path;

use kinopt::model::{FrameId, JointId};
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::targets_file::TargetsFile;

use super::backend::QueryBackend;
use super::query::Query;
use crate::failure::Outcome;
use crate::json_file;
use crate::loaded_model::LoadedModel;

/// Targets of a problem, or of a file of many targets.
pub(super) struct Goals<'a> {
    problem: &'a ProblemSettings,
    /// File of many targets.
    file: Option<(&'a Path, TargetsFile)>,
    /// One for each target of a query, as typed.
    pub(super) targets: Vec<TargetFrame>,
    /// Frame in which targets are given; `None` for the world.
    pub(super) base: Option<String>,
}

/// Frame with a target.
#[derive(Clone, Debug)]
pub(super) struct TargetFrame {
    pub(super) name: String,
    /// True if the orientation counts.
    pub(super) turns: bool,
}

impl<'a> Goals<'a> {
    pub(super) fn read(
        loaded: &LoadedModel,
        problem: &'a ProblemSettings,
        path: Option<&'a Path>,
    ) -> Outcome<Self> {
        let goal = &problem.goal;
        let turns = |given| given && !goal.position_only;
        let Some(path) = path else {
            let targets = goal.target.iter().map(|target| {
                Ok(TargetFrame {
                    name: match &target.frame {
                        Some(frame) => frame.clone(),
                        None => tip(
                            loaded,
                            goal.tip.as_deref(),
                            "a target has no frame: write FRAME=x,y,z, or name it by --tip",
                        )?,
                    },
                    turns: turns(target.turns),
                })
            });
            return Ok(Self {
                problem,
                file: None,
                targets: targets.collect::<Outcome<_>>()?,
                base: goal.base.clone(),
            });
        };
        let file = TargetsFile::of_value(&json_file::read(path)?, path)?;
        let named = goal.tip.as_deref().or(file.tip_link.as_deref());
        let without_tip = format!(
            "{}: has no key `tip_link`, so --tip must name the frame of the targets",
            path.display()
        );
        let target = TargetFrame {
            name: tip(loaded, named, &without_tip)?,
            turns: turns(file.turns),
        };
        Ok(Self {
            problem,
            targets: vec![target],
            base: goal.base.clone().or_else(|| file.base_link.clone()),
            file: Some((path, file)),
        })
    }

    /// Frames with targets or rays, with the typed names.
    pub(super) fn frames(&self, loaded: &LoadedModel) -> Outcome<Vec<(String, FrameId)>> {
        let targets = self.targets.iter().map(|target| &target.name);
        let rays = self.problem.goal.ray.iter().map(|ray| &ray.frame);
        let frame = |name: &String| Ok((name.clone(), loaded.target_frame(name)?));
        targets.chain(rays).map(frame).collect()
    }

    /// True if the chain between the base and a target frame has a ball joint or moves a loop, itself or by mimic
    /// joints. An arm does not support either.
    pub(super) fn need_more_than_an_arm(&self, loaded: &LoadedModel) -> bool {
        let model = &loaded.model;
        let carriers = |name: &str| -> Vec<JointId> {
            let frame = model.frame(name);
            frame.map_or_else(|_| Vec::new(), |frame| model.joints_above(frame).collect())
        };
        let followers = loaded
            .robot
            .as_ref()
            .map_or(&[][..], |robot| robot.mimics());
        let moves_a_loop = |id: JointId| {
            let mut mimics = followers.iter().filter(|mimic| mimic.master == id);
            model.moves_a_loop(id) || mimics.any(|mimic| model.moves_a_loop(mimic.joint))
        };
        let base = self.base.as_deref().map_or_else(Vec::new, carriers);
        self.targets.iter().any(|target| {
            let tip = carriers(&target.name);
            let below = tip.iter().filter(|joint| !base.contains(joint));
            let above = base.iter().filter(|joint| !tip.contains(joint));
            let is_ball = |id: &JointId| {
                let joint = model.joints().get(id.index());
                joint.is_some_and(|joint| joint.kind.is_ball())
            };
            let mut chain = below.chain(above);
            chain.any(|id| is_ball(id) || moves_a_loop(*id))
        })
    }

    /// Adds the tool to the one frame with targets.
    pub(super) fn put_tool(&self, loaded: &mut LoadedModel) -> Outcome<()> {
        let Some(tool) = &self.problem.goal.tool else {
            return Ok(());
        };
        match self.frames(loaded)?.as_slice() {
            [(_, first), others @ ..] if others.iter().all(|(_, other)| other == first) => {
                loaded.put_tool(*first, tool)
            }
            _ => Err(usage!(
                "--tool: targets are on several frames; a tool needs targets of one frame"
            )),
        }
    }

    /// Queries: targets with their start configurations.
    pub(super) fn queries(
        &self,
        loaded: &LoadedModel,
        backend: &impl QueryBackend,
    ) -> Outcome<Vec<Query>> {
        let columns = backend.columns();
        let default = backend.default_start()?;
        let problem = self.problem;
        let Some((path, file)) = &self.file else {
            let targets = problem.goal.target.iter().map(|target| target.placement);
            return Ok(vec![Query {
                targets: targets.collect(),
                start: loaded.start(problem, columns, &default)?,
            }]);
        };
        let fail = |problem| failure!("{}: {problem}", path.display());
        let starts = match loaded.starts_of(file, columns.as_ref()).map_err(fail)? {
            Some(starts) => starts.iter().map(|q| loaded.within_limits(q)).collect(),
            None => vec![loaded.start(problem, columns, &default)?; file.targets.len()],
        };
        let targets = file.targets.iter().zip(starts);
        let queries = targets.map(|(&target, start)| Query {
            targets: vec![target],
            start,
        });
        Ok(queries.collect())
    }
}

/// Tip of a name, or the only tip of a robot.
///
/// # Errors
/// No name and not exactly one tip; the message begins with `lacks` and lists the tips.
fn tip(loaded: &LoadedModel, named: Option<&str>, lacks: &str) -> Outcome<String> {
    if let Some(tip) = named {
        return Ok(tip.to_owned());
    }
    let tips = loaded.tip_links();
    let listed = match tips.as_slice() {
        [only] => return Ok((*only).to_owned()),
        [] => String::new(),
        tips => format!("; tips: {}", tips.join(", ")),
    };
    Err(failure!("{lacks}{listed}"))
}
