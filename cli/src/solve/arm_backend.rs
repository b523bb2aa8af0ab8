//! Arm backend: one target on one chain of a robot.

use std::time::Instant;

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, Base, Search, Servo};
use kinopt::robot::Robot;
use kinopt::solver::Observer;
use kinopt::spatial::Placement;
use kinopt_bindings::problem_file::number_list::Numbers;
use kinopt_bindings::problem_file::start::SolutionChoice;
use kinopt_bindings::problem_file::{ProblemSettings, SolveSettings};

use super::arguments::ServoOptions;
use super::axis_intervals::GoalBounds;
use super::backend::{QueryBackend, microseconds};
use super::derivative::of_arm;
use super::goals::Goals;
use super::obstacles::keep_clear;
use super::query::{Answer, Path, Query};
use super::self_motion::SelfMotionCurve;
use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::jump_document::JumpDocument;
use crate::loaded_model::LoadedModel;
use crate::output;

/// Arm with the model in which its solutions are given.
pub(super) struct ArmBackend<'a> {
    loaded: &'a LoadedModel,
    arm: Arm,
    /// True if all solutions are wanted.
    finds_all: bool,
    goal_bounds: GoalBounds,
    columns: JointColumns,
    tasks: [TaskName; 1],
    idle: Vec<usize>,
    /// True if each solution has its derivative by the target.
    derives: bool,
}

/// Workspace of one thread.
#[derive(Default)]
pub(super) struct ArmWorkspace {
    q_arm: Vec<f64>,
    solution: Solution,
}

impl<'a> ArmBackend<'a> {
    /// Arm from the base, or the world without one, to the frame with the target; options as typed.
    pub(super) fn new(
        loaded: &'a LoadedModel,
        robot: &Robot,
        problem: &ProblemSettings,
        goals: &Goals,
    ) -> Outcome<Self> {
        let [target] = goals.targets.as_slice() else {
            return Err(usage!("an arm takes one --target"));
        };
        // Unknown links are reported with the valid ones, as links.
        let frame = |name| loaded.frame(name, BareName::Tail);
        let base = goals.base.as_deref().map(frame).transpose()?;
        let tip = frame(&target.name)?;
        let goal_bounds = GoalBounds::new(&problem.goal.interval, (target.turns, target.turns))?;
        let (options, tool) = (&problem.solve, problem.goal.tool);
        let (length, angle) = loaded.tolerances(options);
        let builder = Arm::builder(robot, base.map_or(Base::World, Base::from), tip)
            .with_tool(tool.unwrap_or_else(Placement::identity))
            .with_goal(goal_bounds.goal)
            .with_search(
                options
                    .search
                    .map_or(Search::default(), SolutionChoice::search),
            )
            .with_global_search_on_miss(options.global_search_on_miss)
            .with_seed(options.rng_seed)
            .with_position_tolerance(length)
            .with_orientation_tolerance(angle)
            .with_metres_per_radian(options.metres_per_radian)
            .with_attempts(options.attempts())
            .with_time_limit(options.time_limit);
        let builder = held(builder, loaded);
        let joints = builder.joints()?;
        let coordinates = joints.iter().filter_map(|&id| loaded.model.coordinate(id));
        let columns = loaded.columns_of(coordinates.collect());
        let builder = with_joint_options(builder, loaded, &columns, options)?;
        let rest = loaded.rest();
        let mut arm = builder.build()?;
        if let Some(srdf) = &loaded.srdf {
            arm = arm.with_srdf(srdf);
        }
        let arm = keep_clear(&problem.collisions, arm, loaded, &rest)?;
        Ok(Self {
            loaded,
            arm,
            finds_all: options.search == Some(SolutionChoice::All),
            goal_bounds,
            columns,
            tasks: [TaskName {
                frame: target.name.clone(),
                held: false,
            }],
            idle: loaded.idle_coordinates(base.into_iter().chain([tip])),
            derives: problem.output.derivative,
        })
    }

    pub(super) fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Target of the tip, at the middle of the goal bounds.
    pub(super) fn target(&self, query: &Query) -> Placement<f64> {
        let target = query.targets.first().copied();
        self.goal_bounds
            .middle(target.unwrap_or_else(Placement::identity))
    }

    /// Names of the free joints from base to tip.
    pub(super) fn joint_names(&self) -> Vec<&str> {
        self.arm.joints().collect()
    }

    /// Configuration of the model with the arm at `q_arm`.
    pub(super) fn configuration(&self, query: &Query, q_arm: &[f64]) -> Outcome<Vec<f64>> {
        let mut q = query.start.clone();
        self.arm.configuration(q_arm, &mut q)?;
        Ok(q)
    }

    fn answer_of(&self, query: &Query, solution: Solution, micros: Option<f64>) -> Outcome<Answer> {
        let q = self.configuration(query, &solution.q)?;
        let mut answer = Answer::new(q, solution, micros);
        if self.derives {
            let derivative = self
                .arm
                .derivative(self.target(query), &answer.solution.q)?;
            let [task] = &self.tasks;
            answer.derivative = Some(of_arm(&derivative, &self.joint_names(), &task.frame));
        }
        Ok(answer)
    }

    /// Servo at the start of a query, with the rate and limits of the options.
    pub(super) fn servo(&self, first: &Query, options: &ServoOptions) -> Outcome<Servo<'_>> {
        let mut start = Vec::new();
        self.arm.joint_values(&first.start, &mut start)?;
        let servo = self.arm.servo(&start, 1.0 / options.rate)?;
        let mut servo = servo.with_straight_line(options.straight_line);
        let one_each = |option, limits| self.columns.one_each(self.loaded, option, limits);
        if let Some(limits) = &options.acceleration_limits {
            let limits = one_each("--acceleration-limits", limits)?;
            servo = servo.with_acceleration_limits(&limits)?;
        }
        if let Some(limits) = &options.jerk_limits {
            servo = servo.with_jerk_limits(&one_each("--jerk-limits", limits)?)?;
        }
        if let Some(limits) = &options.velocity_limits {
            let limits = one_each("--velocity-limits", limits)?;
            return Ok(servo.with_velocity_limits(&limits)?);
        }
        let limits = self.arm.joints().zip(self.arm.velocity_limits());
        let without = limits.filter(|(_, limit)| limit.is_infinite());
        let without: Vec<_> = without.map(|(joint, _)| format!("`{joint}`")).collect();
        if !without.is_empty() {
            output::message(&format!(
                "{} without a velocity limit in the file: limited to 0.1 rad in a control cycle; \
                 --velocity-limits sets one",
                without.join(", ")
            ));
        }
        Ok(servo)
    }

    /// All solutions, nearest first, or the closest pose if there is none.
    fn all_solutions(&self, query: &Query, start: &[f64]) -> Outcome<Answer> {
        let (started, target) = (Instant::now(), self.target(query));
        let all = self.arm.solve_all_from(target, start)?;
        let complete = all.complete;
        let micros = Some(microseconds(started));
        let mut solutions = all.solutions.into_iter();
        let nearest = match solutions.next() {
            Some(nearest) => self.arm.solve(target, &nearest.q)?,
            None => self.arm.solve(target, start)?,
        };
        let alternatives = solutions.map(|solution| self.configuration(query, &solution.q));
        Ok(Answer {
            alternatives: alternatives.collect::<Outcome<_>>()?,
            complete: Some(complete),
            ..self.answer_of(query, nearest, micros)?
        })
    }
}

impl QueryBackend for ArmBackend<'_> {
    type Workspace = ArmWorkspace;

    fn answer(
        &self,
        ArmWorkspace { q_arm, solution }: &mut ArmWorkspace,
        query: &Query,
        _observer: &mut dyn Observer,
    ) -> Outcome<Answer> {
        self.arm.joint_values(&query.start, q_arm)?;
        if self.finds_all {
            return self.all_solutions(query, q_arm);
        }
        let started = Instant::now();
        self.arm.solve_into(self.target(query), q_arm, solution)?;
        let micros = microseconds(started);
        self.answer_of(query, solution.clone(), Some(micros))
    }

    fn self_motions(&self, query: &Query) -> Outcome<Option<Vec<SelfMotionCurve>>> {
        if !self.finds_all {
            return Ok(None);
        }
        let Some(motions) = self.arm.self_motions(self.target(query))? else {
            return Ok(None);
        };
        let curves = motions.iter().map(|motion| {
            let q = motion.q.chunks_exact(self.arm.joint_count());
            let q = q.map(|q| self.configuration(query, q));
            Ok(SelfMotionCurve {
                closed: motion.closed,
                q: q.collect::<Outcome<_>>()?,
            })
        });
        Ok(Some(curves.collect::<Outcome<_>>()?))
    }

    fn path(&self, queries: &[Query], answered: &dyn Fn()) -> Outcome<Path> {
        let Some(first) = queries.first() else {
            return Ok(Path::default());
        };
        let (mut q_arm, mut solution) = (Vec::new(), Solution::default());
        self.arm.joint_values(&first.start, &mut q_arm)?;
        let mut follower = self.arm.follower(&q_arm)?;
        let mut jumps = Vec::new();
        let mut steps = Vec::with_capacity(queries.len());
        for query in queries {
            let started = Instant::now();
            let jump = follower.advance(self.target(query), &mut solution)?;
            steps.push((solution.clone(), microseconds(started)));
            jumps.extend(jump);
            answered();
        }
        if jumps.iter().any(|jump| jump.reconfiguration) {
            // With the whole path known, the arm may avoid the jump; the steps are timed together.
            let targets: Vec<_> = queries.iter().map(|q| self.target(q)).collect();
            let started = Instant::now();
            let track = self.arm.track(&targets, &q_arm)?;
            let each = microseconds(started) / queries.len() as f64;
            jumps = track.jumps;
            let solutions = track.report.into_iter();
            steps = solutions.map(|solution| (solution, each)).collect();
        }
        let answer = |(solution, micros)| self.answer_of(first, solution, Some(micros));
        let answers = steps.into_iter().map(answer);
        let joints = self.joint_names();
        let jumps = jumps.iter().map(|jump| JumpDocument::of(jump, &joints));
        Ok(Path {
            answers: answers.collect::<Outcome<_>>()?,
            jumps: jumps.collect(),
        })
    }

    fn tasks(&self) -> &[TaskName] {
        &self.tasks
    }

    fn idle_coordinates(&self) -> &[usize] {
        &self.idle
    }

    fn columns(&self) -> Option<JointColumns> {
        Some(self.columns.clone())
    }

    fn default_start(&self) -> Outcome<Vec<f64>> {
        let mut q = self.loaded.rest();
        self.arm.configuration(self.arm.default_start(), &mut q)?;
        Ok(q)
    }

    fn batch(&self, queries: &[Query], parallel: bool) -> Outcome<(Vec<Answer>, f64)> {
        let targets: Vec<_> = queries.iter().map(|q| self.target(q)).collect();
        let (mut starts, mut q_arm) = (Vec::new(), Vec::new());
        for query in queries {
            self.arm.joint_values(&query.start, &mut q_arm)?;
            starts.extend_from_slice(&q_arm);
        }
        let started = Instant::now();
        let solutions = match parallel {
            true => self.arm.solve_batch_parallel(&targets, &starts)?,
            false => self.arm.solve_batch(&targets, &starts)?,
        };
        let micros = microseconds(started);
        let answers = queries.iter().zip(solutions);
        let answers = answers.map(|(query, solution)| self.answer_of(query, solution, None));
        Ok((answers.collect::<Outcome<_>>()?, micros))
    }
}

/// Adds the joints that the command locks.
pub(crate) fn held<'m>(mut builder: ArmBuilder<'m>, loaded: &LoadedModel) -> ArmBuilder<'m> {
    if let Some(held) = &loaded.held {
        for &(joint, value) in &held.locked {
            builder = builder.with_locked(joint, value);
        }
        if let Some((joints, q)) = &held.only {
            builder = builder.with_only(joints, q);
        }
    }
    builder
}

/// Adds the settings with one number for each joint.
fn with_joint_options<'m>(
    mut builder: ArmBuilder<'m>,
    loaded: &LoadedModel,
    columns: &JointColumns,
    options: &SolveSettings,
) -> Outcome<ArmBuilder<'m>> {
    let one_each = |option, given: &Option<Numbers>| {
        let by_joint = |given| columns.one_each(loaded, option, given);
        given.as_ref().map(by_joint).transpose()
    };
    if let Some(moves) = one_each("--max-move", &options.max_move)? {
        builder = builder.with_max_move(&moves);
    }
    if let Some(weights) = one_each("joint_weights", &options.joint_weights)? {
        builder = builder.with_joint_weights(&weights);
    }
    if let Some(posture) = one_each("--posture", &options.posture)? {
        builder = builder.with_posture(&posture);
    }
    Ok(builder)
}
