//! Collects what a motion should do, and checks it once.

use std::sync::Arc;

use super::bounds::FrameBounds;
use super::fixed_frames::fixed_frame;
use super::held_points::{points_of, stiffness};
use super::longest_moves::{longest_moves, longest_slide};
use super::motion_problem::Follow;
use super::space::FrameSpace;
use super::{Contact, MotionError, MotionProblem, RateCost};
use crate::bad_option::{BadOption, POSITIVE};
use crate::model::{JointRef, Limits, Model, ParameterMap, UnknownName};
use crate::problem::{Problem, ProblemBuilder, TaskId};
use crate::robot::Robot;
use crate::task::{Quantity, Residual, Task};

/// Collects the tasks, weights and limits of a [`MotionProblem`]; [`build`](Self::build) checks them.
#[derive(Clone)]
pub struct MotionProblemBuilder<'m> {
    model: &'m Model,
    problem: ProblemBuilder<'m>,
    frames: usize,
    time_step_s: f64,
    follow: Vec<Follow>,
    weights: Vec<(usize, Vec<f64>)>,
    rate_costs: Vec<RateCost>,
    /// By number of a configuration.
    speeds: Vec<f64>,
    /// Of free joints: their first slides, and how fast all three go together.
    free_speeds: Vec<(usize, f64)>,
    contacts: Vec<Contact>,
    ends: [Option<Vec<f64>>; 2],
    /// The first name or number that was wrong.
    wrong: Option<MotionError>,
}

impl std::fmt::Debug for MotionProblemBuilder<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MotionProblemBuilder")
            .field("problem", &self.problem)
            .field("frames", &self.frames)
            .finish_non_exhaustive()
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
            wrong: None,
        }
    }

    /// Which joints are free, locked or coupled. Without it every joint is free.
    pub fn parameters(&mut self, map: ParameterMap) -> &mut Self {
        self.problem.parameters(map);
        self
    }

    /// Narrows a joint's limits in all frames, as [`ProblemBuilder::bound`].
    pub fn bound<'a>(&mut self, joint: impl Into<JointRef<'a>>, limits: Limits) -> &mut Self {
        match joint.into().resolve(self.model) {
            Ok(joint) => drop(self.problem.bound(joint, limits)),
            Err(unknown) => self.note(unknown),
        }
        self
    }

    /// The tolerance of all tasks that do not set their own, as [`ProblemBuilder::tolerance`].
    pub fn tolerance(&mut self, quantity: Quantity, tolerance: f64) -> &mut Self {
        self.problem.tolerance(quantity, tolerance);
        self
    }

    /// Adds a task of every frame, as [`ProblemBuilder::add`].
    pub fn add<R: Residual>(&mut self, task: impl Into<Task<R>>) -> TaskId<R> {
        self.problem.add(task)
    }

    /// Moves a task's target: `set` is asked for every frame, again and again, and puts the task's residual where it is
    /// in that frame, always the same.
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

    /// What multiplies a task's rows in each frame, beside its own weights: one number a frame, at least 0.
    pub fn weights<R: Residual>(&mut self, task: TaskId<R>, by_frame: &[f64]) -> &mut Self {
        self.weights.push((task.index(), by_frame.to_vec()));
        self
    }

    /// What velocities, accelerations or jerks cost; several add up.
    pub fn rate_cost(&mut self, cost: RateCost) -> &mut Self {
        self.rate_costs.push(cost);
        self
    }

    /// How fast a joint moves at most, in rad/s or m/s: hard, from each frame to the next. A ball turns by no larger angle,
    /// about whatever axis; a free joint has parts of its own, `NAME/x`, …, `NAME/rotation`, or both limits of
    /// [`max_free_speed`](Self::max_free_speed).
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
                self.note(unknown);
            }
            (Err(unknown), _) => self.note(unknown),
            (_, Err(bad)) => self.note(bad),
        }
        self
    }

    /// How fast a free joint moves at most: hard, from each frame to the next. Its place goes no farther than `linear` m/s in
    /// whatever direction, and its rotation turns no faster than `angular` rad/s about whatever axis. `name` is the joint's own,
    /// as given to [`ModelBuilder::free`](crate::model::ModelBuilder::free).
    pub fn max_free_speed(&mut self, name: &str, linear: f64, angular: f64) -> &mut Self {
        let joints = self.model.free_joints().iter();
        let slides = joints.map(|id| (id, &self.model.joints()[id.index()].name));
        let named = slides.filter_map(|(id, slide)| Some((*id, slide.strip_suffix("/x")?)));
        let named: Vec<_> = named.collect();
        match named.iter().find(|(_, own)| *own == name) {
            Some((slide, _)) => {
                for speed in [linear, angular] {
                    if let Err(bad) = BadOption::check("max_free_speed", speed, POSITIVE) {
                        self.note(bad);
                    }
                }
                self.free_speeds
                    .extend(self.model.coordinate(*slide).map(|first| (first, linear)));
                self.max_speed(format!("{name}/rotation").as_str(), angular)
            }
            None => {
                let valid = named.iter().map(|(_, own)| *own);
                let unknown = UnknownName::new("free joint", name, valid);
                self.note(unknown);
                self
            }
        }
    }

    /// How fast all joints of a robot move at most, as its file says: see [`Robot::velocity_limit`].
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
        if let Some(own) = self.speeds.get_mut(coordinate) {
            *own = own.min(speed);
        }
    }

    /// Holds points of a frame still over a span.
    pub fn contact(&mut self, contact: Contact) -> &mut Self {
        self.contacts.push(contact);
        self
    }

    /// The configuration of the first frame.
    pub fn first(&mut self, q: &[f64]) -> &mut Self {
        self.ends[0] = Some(q.to_vec());
        self
    }

    /// The configuration of the last frame.
    pub fn last(&mut self, q: &[f64]) -> &mut Self {
        self.ends[1] = Some(q.to_vec());
        self
    }

    fn note(&mut self, wrong: impl Into<MotionError>) {
        self.wrong.get_or_insert(wrong.into());
    }

    /// Checks everything and compiles the kinematics.
    ///
    /// # Errors
    /// The first thing that is wrong, by name: what [`ProblemBuilder::build`] refuses, no frame, weights or settings out
    /// of range, spans beyond the frames, goals on several levels, fixed frames beyond limits.
    pub fn build(self) -> Result<MotionProblem, MotionError> {
        let Self {
            model,
            frames,
            time_step_s,
            ..
        } = self;
        if let Some(wrong) = self.wrong {
            return Err(wrong);
        }
        if frames == 0 {
            return Err(MotionError::NoFrames);
        }
        BadOption::check("time_step_s", time_step_s, POSITIVE)?;
        let problem = self.problem.build()?;
        refuse_levels(&problem)?;
        let map = problem.parameters();
        let mut moves = longest_moves(&problem, &self.speeds, time_step_s)?;
        for (first, speed) in self.free_speeds {
            let slide = longest_slide(map, first, speed, time_step_s)?;
            moves.together.extend(slide);
        }
        let compiled = self.rate_costs.iter();
        let rate_costs = compiled
            .map(|cost| cost.compile(&problem, time_step_s))
            .collect::<Result<Vec<_>, _>>()?;
        let mut weights = vec![Vec::new(); problem.tasks()];
        for (task, by_frame) in self.weights {
            check_weights(&problem, task, &by_frame, frames)?;
            if let Some(own) = weights.get_mut(task) {
                *own = by_frame;
            }
        }
        let held = points_of(model, map, &self.contacts, frames)?;
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
            held,
            ends,
        })
    }
}

/// What is weighed together would silently break a level's promise.
fn refuse_levels(problem: &Problem) -> Result<(), MotionError> {
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
