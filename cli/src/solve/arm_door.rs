//! The arm's front door.

use std::time::Instant;

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, Goal, Search, Servo};
use kinopt::model::JointId;
use kinopt::robot::Robot;
use kinopt::spatial::Placement;

use super::answer::{Answer, AskedTask, LongStep, Path, Question};
use super::arguments::Arguments;
use super::arm_arguments::Moves;
use super::door::Door;
use super::interval::{self, Interval};
use crate::failure::{Failure, Outcome};
use crate::joint_columns::JointColumns;
use crate::loaded_model::LoadedModel;
use crate::output;

/// An arm and the model that its answers are told in.
pub(super) struct ArmDoor<'a> {
    loaded: &'a LoadedModel,
    arm: Arm,
    tip: String,
    search: Search,
    /// Where the middle of the room lies in a target, where it is not the target itself.
    shift: Option<Placement<f64>>,
}

/// Memory of one thread.
#[derive(Default)]
pub(super) struct ArmDesk {
    q_arm: Vec<f64>,
    solution: Solution,
}

impl<'a> ArmDoor<'a> {
    /// The arm from `base` (without one the root link) to `tip`, with the options as typed; without
    /// `turns` its orientation does not matter.
    pub(super) fn new(
        loaded: &'a LoadedModel,
        robot: &'a Robot,
        arguments: &Arguments,
        base: Option<&str>,
        tip: &str,
        turns: bool,
    ) -> Outcome<Self> {
        let base = base.or_else(|| loaded.root_link()).unwrap_or_default();
        let options = &arguments.arm;
        let turning = options.intervals.iter().any(Interval::turns);
        let goal = match options.free_axis {
            _ if !turns && (turning || options.free_axis.is_some()) => {
                let option = if turning {
                    "--interval of a turn"
                } else {
                    "--free-axis"
                };
                return Err(Failure::usage(format!(
                    "{option} is for targets with an orientation (x,y,z,qw,qx,qy,qz)"
                )));
            }
            _ if !turns => Goal::position(),
            Some(axis) => Goal::free_about(axis.into()),
            None => Goal::pose(),
        };
        let intervals = &options.intervals;
        let (goal, shift) = interval::goal(goal.half_widths(), intervals, arguments.degrees);
        let search = options.search.unwrap_or_default();
        let mut builder = builder(loaded, robot, base, tip)?
            .with_goal(goal)
            .with_search(search)
            .with_global_search_on_miss(options.global_search_on_miss)
            .with_seed(arguments.rng_seed);
        if let Some(tolerance) = arguments.tolerance {
            builder = builder
                .with_position_tolerance(tolerance)
                .with_orientation_tolerance(tolerance);
        }
        if let Some(attempts) = arguments.attempts() {
            builder = builder.with_attempts(attempts);
        }
        if let Some(limit) = arguments.time_limit {
            builder = builder.with_time_limit(limit);
        }
        if let Some(tool) = &arguments.chain.tool {
            builder = builder.with_tool(tool);
        }
        if let Some(metres) = options.metres_per_radian {
            builder = builder.with_metres_per_radian(metres);
        }
        let weights = options.joint_weights.as_ref();
        if options.max_move.is_some() || options.posture.is_some() || weights.is_some() {
            // Which joints the numbers belong to is known once an arm stands.
            let joints = builder.clone().with_atlas(false).build()?;
            let one_each = |option: &str, given: &Moves| {
                one_a_joint(loaded, joints.joint_ids(), option, given, arguments.degrees)
            };
            if let Some(moves) = &options.max_move {
                builder = builder.with_max_move(&one_each("--max-move", moves)?);
            }
            if let Some(weights) = weights {
                // Weights are no angles.
                let ids = joints.joint_ids();
                let weights = one_a_joint(loaded, ids, "--joint-weights", weights, false)?;
                builder = builder.with_joint_weights(&weights);
            }
            if let Some(posture) = &options.posture {
                builder = builder.with_posture(&one_each("--posture", posture)?);
            }
        }
        Ok(Self {
            loaded,
            arm: builder.build()?,
            tip: tip.to_owned(),
            search,
            shift,
        })
    }

    /// Where the tip is to stand, the room about it even.
    pub(super) fn target(&self, question: &Question) -> Placement<f64> {
        let target = question.base_from_tip;
        self.shift.map_or(target, |shift| target * shift)
    }

    /// Columns for the free joints from base to tip.
    pub(super) fn columns(&self) -> JointColumns {
        let model = &self.loaded.model;
        let ids = self.arm.joint_ids().iter();
        let coordinates = ids.filter_map(|&id| model.coordinate(id)).collect();
        self.loaded.columns_of(coordinates)
    }

    /// The names of the free joints from base to tip.
    pub(super) fn joint_names(&self) -> Vec<&str> {
        self.arm.joints().collect()
    }

    fn answer_of(
        &self,
        question: &Question,
        solution: Solution,
        micros: Option<f64>,
    ) -> Outcome<Answer> {
        Ok(Answer {
            q: self.configuration(question, &solution.q)?,
            alternatives: Vec::new(),
            solution,
            micros,
            way: None,
            elsewhere: None,
        })
    }

    pub(super) fn configuration(&self, question: &Question, q_arm: &[f64]) -> Outcome<Vec<f64>> {
        let mut q = question.start.clone();
        self.arm.configuration(q_arm, &mut q)?;
        Ok(q)
    }

    fn read_start(&self, desk: &mut ArmDesk, question: &Question) -> Outcome<()> {
        desk.q_arm.resize(self.arm.joint_count(), 0.0);
        Ok(self.arm.joint_values(&question.start, &mut desk.q_arm)?)
    }

    /// A servo that stands at a question's start, with so many ticks a second.
    pub(super) fn servo(
        &self,
        arguments: &Arguments,
        first: &Question,
        rate: f64,
    ) -> Outcome<Servo<'_>> {
        let mut desk = ArmDesk::default();
        self.read_start(&mut desk, first)?;
        let servo = self.arm.servo(&desk.q_arm, 1.0 / rate)?;
        let Some(limits) = &arguments.arm.velocity_limits else {
            let limits = self.arm.joints().zip(self.arm.velocity_limits());
            let without = limits.filter(|(_, limit)| limit.is_infinite());
            let without: Vec<_> = without.map(|(joint, _)| format!("`{joint}`")).collect();
            if !without.is_empty() {
                output::message(&format!(
                    "{} without a velocity limit in the file: a tick moves them by at most 0.1 rad; \
                     --velocity-limits gives one",
                    without.join(", ")
                ));
            }
            return Ok(servo);
        };
        let option = "--velocity-limits";
        let ids = self.arm.joint_ids();
        let limits = one_a_joint(self.loaded, ids, option, limits, arguments.degrees)?;
        Ok(servo.with_velocity_limits(&limits)?)
    }

    fn distinct(&self, desk: &mut ArmDesk, question: &Question) -> Outcome<Answer> {
        let started = Instant::now();
        let all = self.arm.solve_all(self.target(question), &desk.q_arm)?;
        let micros = microseconds(started);
        let mut all = all.into_iter();
        let Some(nearest) = all.next() else {
            // None: what comes closest is an answer all the same.
            let started = Instant::now();
            let closest = self.arm.solve(self.target(question), &desk.q_arm)?;
            let micros = micros + microseconds(started);
            return self.answer_of(question, closest, Some(micros));
        };
        let others = all.map(|other| self.configuration(question, &other.q));
        Ok(Answer {
            alternatives: others.collect::<Outcome<_>>()?,
            ..self.answer_of(question, nearest, Some(micros))?
        })
    }
}

impl Door for ArmDoor<'_> {
    type Desk = ArmDesk;

    fn desk(&self) -> Outcome<ArmDesk> {
        Ok(ArmDesk::default())
    }

    fn answer(&self, desk: &mut ArmDesk, question: &Question) -> Outcome<Answer> {
        self.read_start(desk, question)?;
        if matches!(self.search, Search::Distinct { .. }) {
            return self.distinct(desk, question);
        }
        let started = Instant::now();
        self.arm
            .solve_into(self.target(question), &desk.q_arm, &mut desk.solution)?;
        let micros = microseconds(started);
        self.answer_of(question, desk.solution.clone(), Some(micros))
    }

    fn path(&self, questions: &[Question], told: &dyn Fn()) -> Outcome<Path> {
        let Some(first) = questions.first() else {
            return Ok(Path::default());
        };
        let mut desk = ArmDesk::default();
        self.read_start(&mut desk, first)?;
        let mut follower = self.arm.follower(&desk.q_arm)?;
        let mut jumps = Vec::new();
        let mut steps = Vec::with_capacity(questions.len());
        for question in questions {
            let started = Instant::now();
            let jump = follower.advance(self.target(question), &mut desk.solution)?;
            steps.push((desk.solution.clone(), microseconds(started)));
            jumps.extend(jump);
            told();
        }
        if jumps.iter().any(|jump| !jump.continuous) {
            // Whoever knows the whole path may find a way round; its steps are timed together.
            let targets: Vec<_> = questions.iter().map(|q| self.target(q)).collect();
            let started = Instant::now();
            let track = self.arm.track(&targets, &desk.q_arm)?;
            let each = microseconds(started) / questions.len() as f64;
            jumps = track.jumps;
            let solutions = track.solutions.into_iter();
            steps = solutions.map(|solution| (solution, each)).collect();
        }
        let answers = steps.into_iter();
        let answers =
            answers.map(|(solution, micros)| self.answer_of(first, solution, Some(micros)));
        let joints = self.joint_names();
        let jumps = jumps.iter().map(|jump| LongStep::of(jump, &joints));
        Ok(Path {
            answers: answers.collect::<Outcome<_>>()?,
            jumps: Some(jumps.collect()),
        })
    }

    fn batch(&self, questions: &[Question], parallel: bool) -> Outcome<(Vec<Answer>, f64)> {
        let targets: Vec<_> = questions.iter().map(|q| self.target(q)).collect();
        let mut starts = Vec::with_capacity(questions.len() * self.arm.joint_count());
        let mut desk = ArmDesk::default();
        for question in questions {
            self.read_start(&mut desk, question)?;
            starts.extend_from_slice(&desk.q_arm);
        }
        let started = Instant::now();
        let solutions = if parallel {
            self.arm.solve_batch_parallel(&targets, &starts)?
        } else {
            self.arm.solve_batch(&targets, &starts)?
        };
        let micros = microseconds(started);
        let answers = questions.iter().zip(solutions);
        let answers = answers.map(|(question, solution)| self.answer_of(question, solution, None));
        Ok((answers.collect::<Outcome<_>>()?, micros))
    }

    fn tasks(&self) -> Vec<AskedTask> {
        vec![AskedTask {
            frame: self.tip.clone(),
            held: false,
        }]
    }
}

/// Unknown links are told with the valid ones, as the user calls them.
fn builder<'m>(
    loaded: &LoadedModel,
    robot: &'m Robot,
    base: &str,
    tip: &str,
) -> Outcome<ArmBuilder<'m>> {
    for name in [base, tip] {
        loaded.frame(name, crate::frame_name::BareName::Tail)?;
    }
    let mut builder = Arm::builder(robot, base, tip);
    if let Some(held) = &loaded.held {
        for (joint, value) in &held.locked {
            builder = builder.with_locked(joint, *value);
        }
        if let Some((joints, q)) = &held.only {
            let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
            builder = builder.with_only(&joints, q);
        }
    }
    Ok(builder)
}

/// Numbers for the arm's joints out of one for all, one for each, or one for each moving joint of
/// the model.
fn one_a_joint(
    loaded: &LoadedModel,
    joints: &[JointId],
    option: &str,
    given: &Moves,
    degrees: bool,
) -> Outcome<Vec<f64>> {
    let model = &loaded.model;
    let all = model.degrees_of_freedom();
    let coordinates: Vec<usize> = joints
        .iter()
        .filter_map(|&id| model.coordinate(id))
        .collect();
    let numbers = &given.0;
    let picked: Vec<f64> = match numbers.as_slice() {
        [one] if option != "--posture" => vec![*one; coordinates.len()],
        _ if numbers.len() == all => coordinates
            .iter()
            .filter_map(|&coordinate| numbers.get(coordinate).copied())
            .collect(),
        _ if numbers.len() == coordinates.len() => numbers.clone(),
        _ => {
            let names = coordinates.iter().filter_map(|&c| {
                let id = model.moving_joints().get(c)?;
                Some(model.joints().get(id.index())?.name.as_str())
            });
            return Err(Failure::new(format!(
                "{option}: {} numbers given; it takes {} ({}) or {}, one for each moving joint",
                numbers.len(),
                coordinates.len(),
                names.collect::<Vec<_>>().join(", "),
                all,
            )));
        }
    };
    Ok(loaded.columns_of(coordinates).in_radians(&picked, degrees))
}

pub(super) fn microseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e6
}
