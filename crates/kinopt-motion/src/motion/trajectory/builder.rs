//! Builder of a [`MotionProblem`].

use std::sync::Arc;

use super::bounds::FrameBounds;
use super::contact_springs::{contact_problem, stiffness};
use super::fixed_frames::fixed_frame;
use super::motion_problem::SetTargets;
use super::space::FrameSpace;
use super::step_limits::{step_limits, translation_limit};
use super::{Contact, MotionError, MotionProblem, RateCost};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::model::{JointRef, Limits, Model, ParameterMap, UnknownName};
use kinopt_robot::robot::Robot;
use kinopt_solver::problem::{Problem, ProblemBuilder, TaskId};
use kinopt_solver::task::{Quantity, Residual, Task};

/// Builder of a [`MotionProblem`] from tasks, weights and limits. [`build`](Self::build) checks them.
#[derive(Clone)]
pub struct MotionProblemBuilder<'m> {
    model: &'m Model,
    problem: ProblemBuilder<'m>,
    frames: usize,
    time_step_s: f64,
    follow: Vec<SetTargets>,
    weights: Vec<(usize, Vec<f64>)>,
    rate_costs: Vec<RateCost>,
    /// Velocity limit of each number of a configuration.
    speeds: Vec<f64>,
    /// Velocity limits of free joints: coordinate of the first prismatic joint, and speed of all three together, m/s.
    free_speeds: Vec<(usize, f64)>,
    contacts: Vec<Contact>,
    ends: [Option<Vec<f64>>; 2],
    /// First invalid name or number.
    first_error: Option<MotionError>,
}

impl std::fmt::Debug for MotionProblemBuilder<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MotionProblemBuilder")
            .field("problem", &self.problem)
            .field("frames", &self.frames)
            .finish_non_exhaustive()
    }
}

impl MotionProblem {
    /// Creates a builder for `frames` samples that are `time_step_s` seconds apart, with all joints free.
    #[must_use]
    pub fn builder(model: &Model, frames: usize, time_step_s: f64) -> MotionProblemBuilder<'_> {
        MotionProblemBuilder::new(model, frames, time_step_s)
    }
}

impl<'m> MotionProblemBuilder<'m> {
    pub(super) fn new(model: &'m Model, frames: usize, time_step_s: f64) -> Self {
        Self {
            model,
            problem: Problem::builder(model),
            frames,
            time_step_s,
            follow: Vec::new(),
            weights: Vec::new(),
            rate_costs: Vec::new(),
            speeds: vec![f64::INFINITY; model.configuration_len()],
            free_speeds: Vec::new(),
            contacts: Vec::new(),
            ends: [None, None],
            first_error: None,
        }
    }

    /// Sets the free, locked and mimic joints. By default every joint is free.
    pub fn parameters(&mut self, map: ParameterMap) -> &mut Self {
        self.problem.parameters(map);
        self
    }

    /// Narrows a joint's limits at all samples, as [`ProblemBuilder::bound`].
    pub fn bound<'a>(&mut self, joint: impl Into<JointRef<'a>>, limits: Limits) -> &mut Self {
        match joint.into().resolve(self.model) {
            Ok(joint) => drop(self.problem.bound(joint, limits)),
            Err(unknown) => self.record_error(unknown),
        }
        self
    }

    /// Sets the default tolerance of tasks, as [`ProblemBuilder::tolerance`].
    pub fn tolerance(&mut self, quantity: Quantity, tolerance: f64) -> &mut Self {
        self.problem.tolerance(quantity, tolerance);
        self
    }

    /// Adds a task at every sample, as [`ProblemBuilder::add`].
    pub fn add<R: Residual>(&mut self, task: impl Into<Task<R>>) -> TaskId<R> {
        self.problem.add(task)
    }

    /// Sets a task's target per sample. `set` receives the sample index and modifies the task's residual.
    ///
    /// `set` is called repeatedly and must always produce equal targets for equal indices.
    pub fn follow<R: Residual>(
        &mut self,
        task: TaskId<R>,
        set: impl Fn(usize, &mut R) + Send + Sync + 'static,
    ) -> &mut Self {
        self.follow.push(Arc::new(move |frame, targets| {
            set(frame, targets.get_mut(task)?);
            Ok(())
        }));
        self
    }

    /// Sets factors of a task's rows per sample, in addition to its weights: one number per sample, at least 0.
    pub fn weights<R: Residual>(&mut self, task: TaskId<R>, by_frame: &[f64]) -> &mut Self {
        self.weights.push((task.index(), by_frame.to_vec()));
        self
    }

    /// Adds a cost of velocities, accelerations or jerks.
    pub fn rate_cost(&mut self, cost: RateCost) -> &mut Self {
        self.rate_costs.push(cost);
        self
    }

    /// Sets the velocity limit of a joint between consecutive samples, rad/s or m/s.
    ///
    /// For a ball joint it limits the rotation angle about any axis. A free joint has components `NAME/x`, …,
    /// `NAME/rotation`, or both limits of [`max_free_speed`](Self::max_free_speed).
    pub fn max_speed<'a>(&mut self, joint: impl Into<JointRef<'a>>, speed: f64) -> &mut Self {
        let resolved = joint.into().resolve(self.model);
        let coordinate = resolved.map(|joint| (joint, self.model.coordinate(joint)));
        match (coordinate, BadOption::check("max_speed", speed, POSITIVE)) {
            (Ok((_, Some(coordinate))), Ok(())) => self.limit_speed(coordinate, speed),
            (Ok((joint, None)), _) => {
                let fixed = &self.model.joints()[joint.index()].name;
                let moving = self.model.moving_joints().iter();
                let valid = moving.map(|id| self.model.joints()[id.index()].name.as_str());
                let unknown = UnknownName::new("moving joint", fixed, valid);
                self.record_error(unknown);
            }
            (Err(unknown), _) => self.record_error(unknown),
            (_, Err(bad)) => self.record_error(bad),
        }
        self
    }

    /// Sets the velocity limits of a free joint between consecutive samples.
    ///
    /// `linear` limits the translation in any direction, m/s. `angular` limits the rotation about any axis, rad/s.
    /// `name` is the name given to [`ModelBuilder::free`](kinopt_kinematics::model::ModelBuilder::free).
    pub fn max_free_speed(&mut self, name: &str, linear: f64, angular: f64) -> &mut Self {
        let joints = self.model.free_joints().iter();
        let slides = joints.map(|id| (id, &self.model.joints()[id.index()].name));
        let named = slides.filter_map(|(id, slide)| Some((*id, slide.strip_suffix("/x")?)));
        let named: Vec<_> = named.collect();
        match named.iter().find(|(_, stem)| *stem == name) {
            Some((slide, _)) => {
                for speed in [linear, angular] {
                    if let Err(bad) = BadOption::check("max_free_speed", speed, POSITIVE) {
                        self.record_error(bad);
                    }
                }
                self.free_speeds
                    .extend(self.model.coordinate(*slide).map(|first| (first, linear)));
                self.max_speed(format!("{name}/rotation").as_str(), angular)
            }
            None => {
                let valid = named.iter().map(|(_, stem)| *stem);
                let unknown = UnknownName::new("free joint", name, valid);
                self.record_error(unknown);
                self
            }
        }
    }

    /// Sets the velocity limits of all joints from a robot file: see [`Robot::velocity_limit`].
    pub fn max_speeds_of(&mut self, robot: &Robot) -> &mut Self {
        for joint in robot.model().joint_ids() {
            let coordinate = self.model.coordinate(joint);
            if let (Some(coordinate), Some(speed)) = (coordinate, robot.velocity_limit(joint)) {
                self.limit_speed(coordinate, speed);
            }
        }
        self
    }

    fn limit_speed(&mut self, coordinate: usize, speed: f64) {
        if let Some(limit) = self.speeds.get_mut(coordinate) {
            *limit = limit.min(speed);
        }
    }

    /// Adds a contact: points of a frame that stay fixed over a span of samples.
    pub fn contact(&mut self, contact: Contact) -> &mut Self {
        self.contacts.push(contact);
        self
    }

    /// Fixes the configuration of the first sample.
    pub fn first(&mut self, q: &[f64]) -> &mut Self {
        self.ends[0] = Some(q.to_vec());
        self
    }

    /// Fixes the configuration of the last sample.
    pub fn last(&mut self, q: &[f64]) -> &mut Self {
        self.ends[1] = Some(q.to_vec());
        self
    }

    fn record_error(&mut self, first_error: impl Into<MotionError>) {
        self.first_error.get_or_insert(first_error.into());
    }

    /// Checks all inputs and compiles the kinematics.
    ///
    /// # Errors
    /// Returns the first error found:
    ///
    /// - those of [`ProblemBuilder::build`];
    /// - no samples, or invalid spans;
    /// - weights or settings out of range;
    /// - required tasks on several levels;
    /// - fixed samples beyond limits.
    pub fn build(self) -> Result<MotionProblem, MotionError> {
        let Self {
            model,
            frames,
            time_step_s,
            ..
        } = self;
        if let Some(first_error) = self.first_error {
            return Err(first_error);
        }
        if frames == 0 {
            return Err(MotionError::NoFrames);
        }
        BadOption::check("time_step_s", time_step_s, POSITIVE)?;
        let problem = self.problem.build()?;
        check_levels(&problem)?;
        let map = problem.parameters();
        let mut moves = step_limits(&problem, &self.speeds, time_step_s)?;
        for (first, speed) in self.free_speeds {
            let limit = translation_limit(map, first, speed, time_step_s)?;
            moves.lengths.extend(limit);
        }
        let compiled = self.rate_costs.iter();
        let rate_costs = compiled
            .map(|cost| cost.compile(&problem, time_step_s))
            .collect::<Result<Vec<_>, _>>()?;
        let mut weights = vec![Vec::new(); problem.tasks()];
        for (task, by_frame) in self.weights {
            check_weights(&problem, task, &by_frame, frames)?;
            if let Some(task_weights) = weights.get_mut(task) {
                *task_weights = by_frame;
            }
        }
        let contact_points = contact_problem(model, map, &self.contacts, frames)?;
        let mut ends = [None, None];
        for (end, q) in ends.iter_mut().zip(self.ends) {
            *end = q.map(|q| fixed_frame(&problem, &q)).transpose()?;
        }
        let mut targets = problem.targets();
        for follow in &self.follow {
            follow(0, &mut targets)?;
        }
        Ok(MotionProblem {
            stiffness: stiffness(&problem),
            space: FrameSpace::new(map),
            bounds: FrameBounds::new(&problem, moves),
            problem,
            frames,
            time_step_s,
            follow: self.follow,
            weights,
            rate_costs,
            contacts: self.contacts,
            contact_points,
            ends,
        })
    }
}

/// Returns an error for required tasks on several levels, because all tasks are weighted together.
fn check_levels(problem: &Problem) -> Result<(), MotionError> {
    let levels = &problem.names().task_levels;
    let below = (0..problem.tasks()).find(|&task| levels[task] > 0);
    match below {
        Some(task) if problem.ranks().levels() > 1 => Err(MotionError::Level {
            task: problem.task_name(task).unwrap_or_default().to_owned(),
            level: levels[task],
        }),
        _ => Ok(()),
    }
}

fn check_weights(
    problem: &Problem,
    task: usize,
    by_frame: &[f64],
    frames: usize,
) -> Result<(), MotionError> {
    let name = problem.task_name(task).unwrap_or("of another problem");
    if by_frame.len() != frames {
        return Err(MotionError::Length {
            what: format!("the weights of task {name} by frame"),
            given: by_frame.len(),
            expected: frames,
        });
    }
    let bad = |weight: &f64| !(*weight >= 0.0 && weight.is_finite());
    match by_frame.iter().position(bad) {
        None => Ok(()),
        Some(frame) => Err(MotionError::BadWeight {
            task: name.to_owned(),
            frame,
            weight: by_frame[frame],
        }),
    }
}
