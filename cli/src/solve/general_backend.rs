//! General backend: any number of targets and rays, rigs and skeletons.

use std::time::Instant;

use kinopt::collision::Checker;
use kinopt::ik::Drag;
use kinopt::model::FrameId;
use kinopt::solver::Observer;
use kinopt::spatial::{Placement, Quaternion};
use kinopt::task::{Quantity, Ray, Task};
use kinopt::{Problem, Workspace};

use super::arguments::Arguments;
use super::axis_intervals::Room;
use super::backend::{QueryBackend, microseconds};
use super::balance::Balance;
use super::base::{Base, TargetTask};
use super::derivative;
use super::goals::Goals;
use super::held_frames::Held;
use super::levels::{BALANCE, GOALS, HELD, Unless};
use super::pose_finder::{Aim, PoseFinder};
use super::query::{Answer, LongStep, Path, Query};
use super::task_file::TaskFile;
use super::task_name::TaskName;
use super::weights::Weights;
use crate::failure::Outcome;
use crate::joint_columns::JointColumns;
use crate::loaded_model::LoadedModel;

/// General solver with the problem of all queries.
pub(super) struct GeneralBackend<'a> {
    loaded: &'a LoadedModel,
    arguments: &'a Arguments,
    goals: &'a Goals<'a>,
    finder: PoseFinder,
    base: Base,
    /// Frames with targets, then frames with rays.
    frames: Vec<FrameId>,
    /// Goal bounds of each target, if any.
    rooms: Vec<Option<Room>>,
    held: Held,
    weights: Weights,
    /// Tasks of the centre of mass.
    balance: Option<Balance>,
    /// Collision checker.
    checker: Option<Checker>,
    /// Tasks of --tasks.
    others: Option<TaskFile>,
    tasks: Vec<TaskName>,
    /// Priority level of each task.
    levels: Vec<usize>,
    idle: Vec<usize>,
}

/// Workspace of one thread.
#[derive(Default)]
pub(super) struct GeneralWorkspace {
    statement: Option<Statement>,
    solver: Workspace,
}

/// Problem of one start configuration, with a drag there.
struct Statement {
    body: Drag,
    targets: Vec<TargetTask>,
    held: Vec<(FrameId, TargetTask)>,
    start: Vec<f64>,
}

impl<'a> GeneralBackend<'a> {
    pub(super) fn new(
        loaded: &'a LoadedModel,
        arguments: &'a Arguments,
        goals: &'a Goals<'a>,
    ) -> Outcome<Self> {
        let base = Base::named(loaded, goals.base.as_deref())?;
        let named = goals.frames(loaded)?;
        let frames: Vec<FrameId> = named.iter().map(|(_, frame)| *frame).collect();
        let held = Held::of(loaded, arguments, &frames)?;
        let weighted = [named.as_slice(), &held.tips].concat();
        let weights = Weights::of(loaded, &arguments.weights, &weighted)?;
        let tasks = weighted.into_iter().enumerate().map(|(k, (frame, _))| {
            let held = k >= named.len();
            TaskName { frame, held }
        });
        let balance = Balance::of(loaded, &arguments.balance)?;
        let others = arguments.tasks.as_deref().map(TaskFile::read).transpose()?;
        let asked = balance.iter();
        let tasks: Vec<_> = tasks
            .chain(asked.clone().flat_map(Balance::names))
            .chain(others.iter().flat_map(TaskFile::names))
            .collect();
        let mut ranked = vec![Unless::Ranked(GOALS); named.len()];
        ranked.resize(ranked.len() + held.tips.len(), Unless::Ranked(HELD));
        let balances = asked.clone().flat_map(Balance::names).count();
        ranked.resize(ranked.len() + balances, Unless::Ranked(BALANCE));
        ranked.extend(others.iter().flat_map(TaskFile::levels));
        let holds = !arguments.hold.is_empty() && !held.tips.is_empty();
        let steps_back = holds || balance.is_some();
        let levels = arguments.levels.of(&tasks, &ranked, steps_back)?;
        let moved = frames.iter().copied().chain(base.moving_frame());
        let moved = moved.chain(held.tips.iter().map(|(_, frame)| *frame));
        let moved = moved.chain(asked.flat_map(Balance::frames));
        let others_of = others.as_ref().map(|others| others.frames(loaded));
        let moved = moved.chain(others_of.transpose()?.into_iter().flatten());
        let idle = loaded.idle_coordinates(moved);
        Ok(Self {
            loaded,
            arguments,
            goals,
            finder: PoseFinder::new(loaded, arguments, held.stands(loaded))?,
            base,
            frames,
            rooms: Room::of_targets(arguments, goals)?,
            held,
            weights,
            balance,
            checker: (arguments.obstacles).checker(loaded)?,
            others,
            tasks,
            levels,
            idle,
        })
    }

    /// Sets the targets of a query, at the middle of their goal bounds.
    fn aim(&self, body: &mut Drag, tasks: &[TargetTask], query: &Query) -> Outcome<()> {
        for ((&task, &target), room) in tasks.iter().zip(&query.targets).zip(&self.rooms) {
            let target = room.map_or(target, |room| room.middle(target));
            self.base.aim(body, task, target)?;
        }
        Ok(())
    }

    /// Placements of the frames with targets at the start of a query, in the base.
    fn standing(&self, query: &Query) -> Vec<Placement<f64>> {
        let placed = self.loaded.all_frames(&query.start);
        let at = |frame: &FrameId| placed.get(frame.index()).copied();
        let world_from_base = match self.base {
            Base::Still(placed) => placed,
            Base::Moving(frame) => at(&frame).unwrap_or_else(Placement::identity),
        };
        let frames = self.frames.iter().zip(&query.targets);
        let stand = frames.map(|(frame, target)| {
            at(frame).map_or(*target, |placed| world_from_base.inverse() * placed)
        });
        stand.collect()
    }

    /// Problem for queries that start at `start`. Held joints keep their values of `start`. Targets and held tips are
    /// set again for every query.
    fn state(&self, start: &[f64]) -> Outcome<Statement> {
        let mut builder = Problem::builder(&self.loaded.model);
        let (length, angle) = self.arguments.tolerances(self.loaded);
        builder
            .parameters(self.held.parameters(self.loaded, start)?)
            .derivatives(self.arguments.derivatives())
            .tolerance(Quantity::Metres, length)
            .tolerance(Quantity::Radians, angle);
        if let Some(checker) = &self.checker {
            builder.keep_clear(checker);
        }
        let mut frames = self.frames.iter().copied();
        let levels = &mut self.levels.iter().copied();
        let mut level = || levels.next().unwrap_or_default();
        let targets = self.goals.targets.iter().zip(&self.rooms);
        let targets = targets.zip(frames.by_ref());
        let targets = targets.map(|((target, room), frame)| {
            let name = format!("target {}", target.name);
            let (named, anywhere) = (
                (name, self.weights.weight(frame), level()),
                Placement::identity(),
            );
            let counts = (target.turns, room.map(|room| room.goal));
            self.base
                .add_target(&mut builder, frame, anywhere, counts, named)
        });
        let targets: Vec<_> = targets.collect();
        for (ray, frame) in self.arguments.rays.iter().zip(frames) {
            let task = Task::new(Ray::new(frame, ray.eye, ray.through));
            let task = task.scale(self.weights.weight(frame)).at_level(level());
            builder.add(task.named(format!("ray {}", ray.frame)));
        }
        let (world, anywhere) = (Base::Still(Placement::identity()), Placement::identity());
        let turns = self.held.turns(self.loaded);
        let held = self.held.tips.iter().map(|(name, frame)| {
            let weight = self.held.weight(self.loaded, &self.weights, *frame);
            let named = (format!("hold {name}"), weight, level());
            let task = world.add_target(&mut builder, *frame, anywhere, (turns, None), named);
            (*frame, task)
        });
        let held: Vec<_> = held.collect();
        if let Some(balance) = &self.balance {
            balance.add(&mut builder, levels.by_ref());
        }
        if let Some(others) = &self.others {
            others.add(&mut builder, (self.loaded, start), levels)?;
        }
        // After the requested tasks, whose order is that of the report.
        for posture in self.held.posture(self.loaded, start)? {
            builder.add(posture);
        }
        Ok(Statement {
            body: self.finder.body(builder.build()?, start)?,
            targets,
            held,
            start: start.to_vec(),
        })
    }
}

/// Placement at a share between two others: straight line, and rotation at a constant rate.
fn between(from: &Placement<f64>, to: &Placement<f64>, share: f64) -> Placement<f64> {
    if share >= 1.0 {
        return *to;
    }
    let turn = Quaternion::from_matrix(&(from.rotation.transpose() * to.rotation)).log();
    let rotation = from.rotation * Quaternion::exp(turn * share).to_matrix();
    let way = to.translation - from.translation;
    Placement::new(rotation, from.translation + way * share)
}

impl Statement {
    /// Sets the targets of a query, and holds tips at their placements in its start.
    fn aim(&mut self, backend: &GeneralBackend<'_>, query: &Query) -> Outcome<()> {
        backend.aim(&mut self.body, &self.targets, query)?;
        if self.held.is_empty() {
            return Ok(());
        }
        let placements = backend.loaded.all_frames(&query.start);
        let world = Base::Still(Placement::identity());
        for &(frame, task) in &self.held {
            if let Some(placed) = placements.get(frame.index()) {
                world.aim(&mut self.body, task, *placed)?;
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
        let kept = workspace.statement.take();
        let others = self.others.as_ref();
        let of_start = self.held.holds_still() || others.is_some_and(TaskFile::depends_on_start);
        let kept = kept.filter(|kept| !of_start || kept.start == query.start);
        let statement = match kept {
            Some(statement) => workspace.statement.insert(statement),
            None => workspace.statement.insert(self.state(&query.start)?),
        };
        statement.aim(self, query)?;
        let targets = statement.targets.clone();
        let (body, solver) = (&mut statement.body, &mut workspace.solver);
        let froms = self.held.stands(self.loaded).then(|| self.standing(query));
        let way = froms.map(|froms| {
            move |body: &mut Drag, share: f64| {
                let ways = froms.iter().zip(&query.targets);
                let between = ways.map(|(from, to)| between(from, to, share));
                let targets_then = Query {
                    targets: between.collect(),
                    start: Vec::new(),
                };
                self.aim(body, &targets, &targets_then)
            }
        });
        let way = way.as_ref().map(|way| way as &Aim<'_>);
        let from = (query.start.as_slice(), way);
        let mut answer = self.finder.find(body, from, solver, observer)?;
        if self.arguments.derivative {
            statement.aim(self, query)?;
            let (question, tasks) = (statement.body.question(), &self.tasks);
            let derivative = derivative::of_problem(self.loaded, question, tasks, &answer.q)?;
            answer.derivative = Some(derivative);
        }
        Ok(answer)
    }

    fn path(&self, queries: &[Query], answered: &dyn Fn()) -> Outcome<Path> {
        let mut path = Path::default();
        let Some(first) = queries.first() else {
            return Ok(path);
        };
        let mut statement = self.state(&first.start)?;
        statement.aim(self, first)?;
        let mut body = self.finder.follower(statement.body)?;
        let mut workspace = Workspace::new();
        let angles: Vec<bool> = self.loaded.is_angle().collect();
        let joints = self.loaded.joint_names();
        for (step, query) in queries.iter().enumerate() {
            let before = body.q().to_vec();
            self.aim(&mut body, &statement.targets, query)?;
            let started = Instant::now();
            let solution = self.finder.follow(&mut body, &mut workspace)?;
            let micros = microseconds(started);
            let answer = Answer::new(solution.q.clone(), solution, Some(micros));
            path.answers.push(answer);
            if step > 0 {
                let jump = LongStep::between(step, &before, body.q(), &angles, &joints);
                path.jumps.extend(jump);
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
