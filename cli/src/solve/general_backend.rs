//! General backend: any number of targets and rays, rigs and skeletons.

use std::time::Instant;

use kinopt::Workspace;
use kinopt::collision::Checker;
use kinopt::ik::Drag;
use kinopt::model::FrameId;
use kinopt::solver::Observer;
use kinopt::spatial::Placement;
use kinopt::task::{Quantity, Ray, Task};
use kinopt_bindings::problem_file::ProblemSettings;

use super::axis_intervals::GoalBounds;
use super::backend::{QueryBackend, microseconds};
use super::balance::Balance;
use super::base::{Base, TargetTask};
use super::derivative;
use super::goals::Goals;
use super::held_frames::Held;
use super::levels::{BALANCE, HELD, levels};
use super::obstacles::checker_of;
use super::pose_finder::{PoseFinder, TargetMotion};
use super::query::{Answer, Path, Query, drag_jump};
use super::task_builder;
use super::task_name::TaskName;
use super::task_name::{DefaultLevel, GOALS};
use super::weights::Weights;
use crate::failure::Outcome;
use crate::joint_columns::JointColumns;
use crate::jump_document::JumpDocument;
use crate::loaded_model::LoadedModel;

/// General solver with the problem of all queries.
pub(super) struct GeneralBackend<'a> {
    loaded: &'a LoadedModel,
    problem: &'a ProblemSettings,
    goals: &'a Goals<'a>,
    finder: PoseFinder,
    base: Base,
    /// Frames with targets, then frames with rays.
    frames: Vec<FrameId>,
    /// Goal bounds of each target, if any.
    goal_bounds: Vec<Option<GoalBounds>>,
    held: Held,
    weights: Weights,
    /// Tasks of the centre of mass.
    balance: Option<Balance>,
    /// Collision checker.
    checker: Option<Checker>,
    tasks: Vec<TaskName>,
    /// Priority level of each task.
    levels: Vec<usize>,
    idle: Vec<usize>,
}

/// Workspace of one thread.
#[derive(Default)]
pub(super) struct GeneralWorkspace {
    drag_problem: Option<DragProblem>,
    solver: Workspace,
}

/// Problem of one start configuration, with a drag there.
struct DragProblem {
    drag: Drag,
    targets: Vec<TargetTask>,
    held: Vec<(FrameId, TargetTask)>,
    start: Vec<f64>,
}

impl<'a> GeneralBackend<'a> {
    pub(super) fn new(
        loaded: &'a LoadedModel,
        problem: &'a ProblemSettings,
        goals: &'a Goals<'a>,
    ) -> Outcome<Self> {
        let base = Base::named(loaded, goals.base.as_deref())?;
        let named_frames = goals.frames(loaded)?;
        let frames: Vec<FrameId> = named_frames.iter().map(|(_, frame)| *frame).collect();
        let held = Held::of(loaded, &problem.body.hold, &frames)?;
        let weighted = [named_frames.as_slice(), &held.tips].concat();
        let weights = Weights::of(loaded, &problem.body.weight, &weighted)?;
        let tasks = weighted.into_iter().enumerate().map(|(k, (frame, _))| {
            let held = k >= named_frames.len();
            TaskName { frame, held }
        });
        let balance = Balance::of(loaded, &problem.body)?;
        let balance_tasks = balance.iter();
        let tasks: Vec<_> = tasks
            .chain(balance_tasks.clone().flat_map(Balance::names))
            .chain(task_builder::names(&problem.tasks))
            .collect();
        let mut default_levels = vec![DefaultLevel::IfPrioritised(GOALS); named_frames.len()];
        default_levels.resize(
            default_levels.len() + held.tips.len(),
            DefaultLevel::IfPrioritised(HELD),
        );
        let balance_count = balance_tasks.clone().flat_map(Balance::names).count();
        default_levels.resize(
            default_levels.len() + balance_count,
            DefaultLevel::IfPrioritised(BALANCE),
        );
        default_levels.extend(task_builder::levels(&problem.tasks));
        let holds_frames = !problem.body.hold.is_empty() && !held.tips.is_empty();
        let uses_priorities = holds_frames || balance.is_some();
        let levels = levels(&problem.body, &tasks, &default_levels, uses_priorities)?;
        let moved = frames.iter().copied().chain(base.moving_frame());
        let moved = moved.chain(held.tips.iter().map(|(_, frame)| *frame));
        let moved = moved.chain(balance_tasks.flat_map(Balance::frames));
        let moved = moved.chain(task_builder::frames(&problem.tasks, loaded)?);
        let idle = loaded.idle_coordinates(moved);
        Ok(Self {
            loaded,
            problem,
            goals,
            finder: PoseFinder::new(loaded, problem, held.has_held_feet(loaded))?,
            base,
            frames,
            goal_bounds: GoalBounds::of_targets(problem, goals)?,
            held,
            weights,
            balance,
            checker: checker_of(&problem.collisions, loaded)?,
            tasks,
            levels,
            idle,
        })
    }

    /// Sets the targets of a query, at the middle of their goal bounds.
    fn set_targets(&self, drag: &mut Drag, tasks: &[TargetTask], query: &Query) -> Outcome<()> {
        for ((&task, &target), bounds) in tasks.iter().zip(&query.targets).zip(&self.goal_bounds) {
            let target = bounds.map_or(target, |bounds| bounds.middle(target));
            self.base.set_target(drag, task, target)?;
        }
        Ok(())
    }

    /// Placements of the frames with targets at the start of a query, in the base.
    fn start_placements(&self, query: &Query) -> Vec<Placement<f64>> {
        let placed = self.loaded.all_frames(&query.start);
        let at = |frame: &FrameId| placed.get(frame.index()).copied();
        let world_from_base = match self.base {
            Base::Still(placed) => placed,
            Base::Moving(frame) => at(&frame).unwrap_or_else(Placement::identity),
        };
        let frames = self.frames.iter().zip(&query.targets);
        let placements = frames.map(|(frame, target)| {
            at(frame).map_or(*target, |placed| world_from_base.inverse() * placed)
        });
        placements.collect()
    }

    /// Problem for queries that start at `start`. Held joints keep their values of `start`. Targets and held tips are
    /// set again for every query.
    fn drag_problem(&self, start: &[f64]) -> Outcome<DragProblem> {
        let mut builder = kinopt::Problem::builder(&self.loaded.model);
        let (length, angle) = self.loaded.tolerances(&self.problem.solve);
        builder
            .parameters(self.held.parameters(self.loaded, start)?)
            .derivatives(self.problem.solve.jacobian.unwrap_or_default())
            .tolerance(Quantity::Metres, length)
            .tolerance(Quantity::Radians, angle);
        if let Some(checker) = &self.checker {
            builder.keep_clear(checker);
        }
        let mut frames = self.frames.iter().copied();
        let levels = &mut self.levels.iter().copied();
        let mut level = || levels.next().unwrap_or_default();
        let targets = self.goals.targets.iter().zip(&self.goal_bounds);
        let targets = targets.zip(frames.by_ref());
        let targets = targets.map(|((target, bounds), frame)| {
            let name = format!("target {}", target.name);
            let (name_weight_level, identity) = (
                (name, self.weights.weight(frame), level()),
                Placement::identity(),
            );
            let counts = (target.turns, bounds.map(|bounds| bounds.goal));
            self.base
                .add_target(&mut builder, frame, identity, counts, name_weight_level)
        });
        let targets: Vec<_> = targets.collect();
        for (ray, frame) in self.problem.goal.ray.iter().zip(frames) {
            let task = Task::new(Ray::new(frame, ray.eye, ray.through));
            let task = task.scale(self.weights.weight(frame)).at_level(level());
            builder.add(task.named(format!("ray {}", ray.frame)));
        }
        let (world, identity) = (Base::Still(Placement::identity()), Placement::identity());
        let turns = self.held.turns(self.loaded);
        let held = self.held.tips.iter().map(|(name, frame)| {
            let weight = self.held.weight(self.loaded, &self.weights, *frame);
            let name_weight_level = (format!("hold {name}"), weight, level());
            let task = world.add_target(
                &mut builder,
                *frame,
                identity,
                (turns, None),
                name_weight_level,
            );
            (*frame, task)
        });
        let held: Vec<_> = held.collect();
        if let Some(balance) = &self.balance {
            balance.add(&mut builder, levels.by_ref());
        }
        let tasks = &self.problem.tasks;
        task_builder::add(tasks, &mut builder, (self.loaded, start), levels)?;
        // After the requested tasks, whose order is that of the report.
        for posture in self.held.posture(self.loaded, start)? {
            builder.add(posture);
        }
        Ok(DragProblem {
            drag: self.finder.drag(builder.build()?, start)?,
            targets,
            held,
            start: start.to_vec(),
        })
    }
}

impl DragProblem {
    /// Sets the targets of a query, and holds tips at their placements in its start.
    fn set_targets(&mut self, backend: &GeneralBackend<'_>, query: &Query) -> Outcome<()> {
        backend.set_targets(&mut self.drag, &self.targets, query)?;
        if self.held.is_empty() {
            return Ok(());
        }
        let placements = backend.loaded.all_frames(&query.start);
        let world = Base::Still(Placement::identity());
        for &(frame, task) in &self.held {
            if let Some(placement) = placements.get(frame.index()) {
                world.set_target(&mut self.drag, task, *placement)?;
            }
        }
        Ok(())
    }
}

impl QueryBackend for GeneralBackend<'_> {
    type Workspace = GeneralWorkspace;

    fn answer(
        &self,
        workspace: &mut GeneralWorkspace,
        query: &Query,
        observer: &mut dyn Observer,
    ) -> Outcome<Answer> {
        let previous = workspace.drag_problem.take();
        let depends_on_start = self.held.holds_still() || self.problem.tasks.depends_on_start();
        let previous =
            previous.filter(|previous| !depends_on_start || previous.start == query.start);
        let drag_problem = match previous {
            Some(drag_problem) => workspace.drag_problem.insert(drag_problem),
            None => workspace
                .drag_problem
                .insert(self.drag_problem(&query.start)?),
        };
        drag_problem.set_targets(self, query)?;
        let targets = drag_problem.targets.clone();
        let (drag, solver) = (&mut drag_problem.drag, &mut workspace.solver);
        let start_placements = self
            .held
            .has_held_feet(self.loaded)
            .then(|| self.start_placements(query));
        let motion = start_placements.map(|start_placements| {
            move |drag: &mut Drag, share: f64| {
                let segments = start_placements.iter().zip(&query.targets);
                let interpolated = segments.map(|(from, to)| match share >= 1.0 {
                    true => *to,
                    false => from.interpolated(to, share),
                });
                let intermediate = Query {
                    targets: interpolated.collect(),
                    start: Vec::new(),
                };
                self.set_targets(drag, &targets, &intermediate)
            }
        });
        let motion = motion.as_ref().map(|motion| motion as &TargetMotion<'_>);
        let from = (query.start.as_slice(), motion);
        let mut answer = self.finder.find(drag, from, solver, observer)?;
        if self.problem.output.derivative {
            drag_problem.set_targets(self, query)?;
            let (instance, tasks) = (drag_problem.drag.question(), &self.tasks);
            let derivative = derivative::of_problem(self.loaded, instance, tasks, &answer.q)?;
            answer.derivative = Some(derivative);
        }
        Ok(answer)
    }

    fn path(&self, queries: &[Query], answered: &dyn Fn()) -> Outcome<Path> {
        let mut path = Path::default();
        let Some(first) = queries.first() else {
            return Ok(path);
        };
        let mut drag_problem = self.drag_problem(&first.start)?;
        drag_problem.set_targets(self, first)?;
        let mut drag = self.finder.follower(drag_problem.drag)?;
        let mut workspace = Workspace::new();
        let angles: Vec<bool> = self.loaded.is_angle().collect();
        let joints = self.loaded.joint_names();
        for (step, query) in queries.iter().enumerate() {
            let before = drag.q().to_vec();
            self.set_targets(&mut drag, &drag_problem.targets, query)?;
            let started = Instant::now();
            let solution = self.finder.follow(&mut drag, &mut workspace)?;
            let micros = microseconds(started);
            let answer = Answer::new(solution.q.clone(), solution, Some(micros));
            path.answers.push(answer);
            if step > 0 {
                let jump = drag_jump(step, &before, drag.q(), &angles);
                path.jumps
                    .extend(jump.map(|jump| JumpDocument::of(&jump, &joints)));
            }
            answered();
        }
        Ok(path)
    }

    fn tasks(&self) -> &[TaskName] {
        &self.tasks
    }

    fn idle_coordinates(&self) -> &[usize] {
        &self.idle
    }

    fn columns(&self) -> Option<JointColumns> {
        None
    }

    fn default_start(&self) -> Outcome<Vec<f64>> {
        Ok(self.loaded.rest())
    }
}
