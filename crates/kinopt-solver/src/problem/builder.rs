//! Problem builder: resolves ids, lengths, weights and bounds once.

use std::f64::consts::PI;
use std::sync::Arc;

use super::collision_avoidance::ClearanceRequest;
use super::compiled_task::{Block, CompiledTask};
use super::frame_reach::anchor;
use super::{
    Derivatives, Preferences, Problem, ProblemError, Ranks, ReportNames, Tangent, Targets, TaskId,
};
use crate::solver::{RotationSets, Swing, TurnLimit};
use crate::task::{
    Description, ErasedResidual, Inequality, Inputs, Quantity, Residual, Role, RowBlock, Task,
};
use kinopt_kinematics::kinematics::{FrameSlot, Tree};
use kinopt_kinematics::model::{
    FrameId, JointId, JointKind, LengthUnit, Limits, Model, ParameterMap,
};

/// Default tolerance of lengths in metres and angles in radians.
const DEFAULT_TOLERANCE: f64 = 1e-6;
/// Default weight of a radian as a fraction of the model's reach.
pub(super) const RADIAN_PER_REACH: f64 = 0.25;
/// Default tolerance of image distances, pixels.
const DEFAULT_TOLERANCE_PIXELS: f64 = 1e-3;

/// A task before its rows have indices.
#[derive(Clone, Debug)]
pub(super) struct PendingTask {
    name: Option<String>,
    description: Description,
    /// True if it closes a loop of the model. Such tasks are not the user's, and come before them in priority.
    pub(super) is_loop: bool,
    role: Role,
    level: usize,
    weights: Vec<(Quantity, f64)>,
    pub(super) factor: f64,
    tolerances: Vec<(Quantity, f64)>,
    inputs: Inputs,
    rows: Vec<RowBlock>,
    residual: Box<dyn ErasedResidual>,
}

/// The role of a clearance among the tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ClearanceAs {
    /// A required task of the first level.
    Goal,
    /// A soft task; all other soft tasks get weight 0.
    SoftTask,
}

impl PendingTask {
    pub(super) fn new<R: Residual>(task: Task<R>) -> Self {
        Self {
            name: task.name,
            description: task.residual.description(),
            is_loop: false,
            role: task.role,
            level: task.level,
            weights: task.weights,
            factor: task.factor,
            tolerances: task.tolerances,
            inputs: task.residual.inputs(),
            rows: task.residual.rows(),
            residual: Box::new(task.residual),
        }
    }

    /// The frame that reports name.
    fn own_frame(&self) -> Option<FrameId> {
        let first = self.inputs.frames.first().copied();
        first.filter(|_| !self.description.is_of_body)
    }
}

/// Collects tasks, bounds and settings; [`build`](Self::build) checks them.
#[derive(Clone, Debug)]
pub struct ProblemBuilder<'m> {
    pub(super) model: &'m Model,
    map: Option<ParameterMap>,
    tasks: Vec<PendingTask>,
    extra_bounds: Vec<(JointId, Limits)>,
    tolerances: Vec<(Quantity, f64)>,
    derivatives: Derivatives,
    preferences: Preferences,
    pub(super) clearance_request: Option<ClearanceRequest>,
}

impl<'m> ProblemBuilder<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            map: None,
            tasks: Vec::new(),
            extra_bounds: Vec::new(),
            tolerances: Vec::new(),
            derivatives: Derivatives::default(),
            preferences: Preferences::default(),
            clearance_request: None,
        }
    }

    /// Sets the free, locked and coupled joints; by default every joint is free.
    pub fn parameters(&mut self, map: ParameterMap) -> &mut Self {
        self.map = Some(map);
        self
    }

    /// Adds a task: a residual, or a [`Task`] with further settings.
    ///
    /// Default weights are 1 per metre, pixel and joint unit, and a quarter of the model's reach per radian. Solutions
    /// therefore do not depend on the unit of length.
    pub fn add<R: Residual>(&mut self, task: impl Into<Task<R>>) -> TaskId<R> {
        self.tasks.push(PendingTask::new(task.into()));
        TaskId::new(self.tasks.len() - 1)
    }

    /// Narrows a joint's limits for this problem, in radians or metres.
    ///
    /// Bounds on a mimic joint narrow its source joint. Bounds on a locked joint must contain its value.
    pub fn bound(&mut self, joint: JointId, limits: Limits) -> &mut Self {
        self.extra_bounds.push((joint, limits));
        self
    }

    /// Sets the tolerance of a quantity for all tasks that do not set their own.
    ///
    /// Default: 1e-6 m, 1e-6 rad, 1e-6 m/s, 1e-6 rad/s and 1e-3 px. It is infinite for joint units and ratios. For a
    /// model in its own unit of length it is 1e-6 of the reach instead of 1e-6 m.
    pub fn tolerance(&mut self, quantity: Quantity, tolerance: f64) -> &mut Self {
        self.tolerances.push((quantity, tolerance));
        self
    }

    /// Sets the derivative method; [`Problem::with_derivatives`] changes it later.
    pub fn derivatives(&mut self, route: Derivatives) -> &mut Self {
        self.derivatives = route;
        self
    }

    /// Sets the treatment of soft tasks.
    ///
    /// By default they act in the null space of the required tasks. Otherwise they are weighted against them.
    pub fn preferences(&mut self, preferences: Preferences) -> &mut Self {
        self.preferences = preferences;
        self
    }

    /// Checks all parts and compiles the kinematics.
    ///
    /// The model's [loops](Model::loops) become required tasks after the added tasks. Their tolerance is
    /// [`Loop::TOLERANCE`](kinopt_kinematics::model::Loop::TOLERANCE).
    ///
    /// # Errors
    /// Returns the first defect by name:
    /// - no task or no free joint;
    /// - ids that are not in the model;
    /// - targets that are not finite;
    /// - weights or tolerances out of range;
    /// - bounds that leave no value;
    /// - a checker of another model.
    pub fn build(mut self) -> Result<Problem, ProblemError> {
        let request = self.clearance_request.take();
        let constraint = request
            .map(|request| self.collision_constraint(request))
            .transpose()?;
        let mut problem = self.compile(None)?;
        problem.collision_constraint = constraint.map(Arc::new);
        Ok(problem)
    }

    /// Builds the problem, with an optional clearance after all other tasks.
    pub(super) fn compile(
        mut self,
        clearance: Option<(PendingTask, ClearanceAs)>,
    ) -> Result<Problem, ProblemError> {
        let model = self.model;
        let mut map = match self.map {
            Some(map) => map,
            None => ParameterMap::free(model),
        };
        if map.sources().len() != model.configuration_len() {
            return Err(ProblemError::ForeignMap {
                map: map.sources().len(),
                model: model.name().to_owned(),
                model_coordinates: model.configuration_len(),
            });
        }
        if map.variables() == 0 {
            return Err(ProblemError::NoVariables {
                model: model.name().to_owned(),
            });
        }
        narrow(model, &mut map, &self.extra_bounds)?;
        self.tasks.extend(super::loops::tasks(model));
        if self.tasks.is_empty() {
            return Err(ProblemError::NoTasks {
                model: model.name().to_owned(),
            });
        }

        if let Some((mut task, role)) = clearance {
            let goals = self.tasks.iter().filter(|task| task.role == Role::Goal);
            let levels = goals.filter(|task| !task.is_loop).map(|task| task.level);
            task.level = levels.min().unwrap_or(0);
            if role == ClearanceAs::SoftTask {
                for other in &mut self.tasks {
                    if other.role == Role::Preference {
                        other.factor = 0.0;
                    }
                }
                task.role = Role::Preference;
                self.preferences = Preferences::default();
            }
            self.tasks.push(task);
        }

        let mut frames = Vec::new();
        let mut tasks = Vec::with_capacity(self.tasks.len());
        let mut residuals = Vec::with_capacity(self.tasks.len());
        let mut first_frames = Vec::with_capacity(self.tasks.len());
        let mut rows = 0;
        for (index, pending) in self.tasks.into_iter().enumerate() {
            let first_frame = pending.own_frame();
            let task = compile_task(model, index, &pending, &self.tolerances, &mut frames, rows)?;
            residuals.push(pending.residual);
            first_frames.push(first_frame);
            rows = task.rows.end;
            tasks.push(task);
        }

        let ranks = Ranks::of(&mut tasks, self.preferences);
        let reach = model.reach();
        let variables = 0..map.variables();
        let leading_joint = |variable: usize| {
            let joint = model.moving_joints()[map.leaders()[variable]];
            &model.joints()[joint.index()]
        };
        let spread = variables
            .clone()
            .map(|variable| model.sampling_spread(leading_joint(variable), reach))
            .collect();
        let floating = floating(model, &map);
        let mut rotations = RotationSets::NONE;
        for ball in map.balls() {
            match ball.swing {
                None => rotations.vectors.push(ball.variable),
                Some(half_angles) => rotations.swings.push(Swing {
                    first: ball.variable,
                    half_angles,
                }),
            }
            if let Some(max_angle) = ball.angle.filter(|angle| *angle < PI) {
                let third = ball.variable + 2;
                let twist = Limits::new(map.lower()[third], map.upper()[third]);
                let inside = [0.0, 0.0, twist.clamp(0.0)];
                let limit = TurnLimit::from_zero(ball.variable, ball.chart, inside, max_angle);
                rotations.turns.push(limit);
            }
        }
        let name_of = |variable: usize| {
            let joint = &leading_joint(variable).name;
            let ball = map.balls().iter().find(|ball| {
                (ball.variable..ball.variable + 3).contains(&variable) && ball.swing.is_some()
            });
            match ball.map(|ball| variable - ball.variable) {
                None => joint.clone(),
                Some(2) => format!("{joint} twist"),
                Some(_) => format!("{joint} swing"),
            }
        };
        let names = ReportNames {
            model: model.name().to_owned(),
            length_unit: model.length_unit(),
            variables: variables.clone().map(name_of).collect(),
            joints: variables
                .clone()
                .map(|v| leading_joint(v).name.clone())
                .collect(),
            variable_is_angle: variables.map(|v| !leading_joint(v).kind.slides()).collect(),
            tasks: tasks.iter().map(|task| task.name.clone()).collect(),
            loops: model
                .loops()
                .iter()
                .map(|model_loop| model_loop.name.clone())
                .collect(),
            task_levels: tasks.iter().map(|task| task.level).collect(),
            task_frames: (first_frames.iter())
                .map(|frame| frame.map(|f| model.frames()[f.index()].name.clone()))
                .collect(),
            anchors: (first_frames.iter())
                .map(|frame| anchor(model, &map, (*frame)?))
                .collect(),
        };
        let is_angle = names.variable_is_angle.clone();
        let mut problem = Problem {
            names: Arc::new(names),
            tree: Tree::new(model, &map, &frames),
            lower: map.lower().to_vec(),
            upper: map.upper().to_vec(),
            map,
            tasks,
            targets: Targets { residuals },
            rows,
            ranks,
            preferences: self.preferences,
            tangent: Tangent::new(model),
            rotations,
            is_base_variable: floating,
            spread,
            step_scale: step_scale(&is_angle, model.length_unit(), reach),
            reach,
            derivatives: self.derivatives,
            moves_task: Vec::new(),
            moved_variables: None,
            collision_constraint: None,
        };
        problem.mark_task_variables();
        problem.choose_sweeps();
        Ok(problem)
    }
}

/// Returns the length equivalent to a radian by variable, a fraction of the reach for prismatic joints, 1 for angles.
/// Empty unless the model has its own unit of length.
fn step_scale(is_angle: &[bool], unit: LengthUnit, reach: f64) -> Vec<f64> {
    if unit != LengthUnit::Own || reach <= 0.0 || is_angle.iter().all(|is_angle| *is_angle) {
        return Vec::new();
    }
    let scale = |is_angle: &bool| match is_angle {
        true => 1.0,
        false => RADIAN_PER_REACH * reach,
    };
    is_angle.iter().map(scale).collect()
}

/// Returns for each variable whether it moves a free joint; empty if there is no free joint.
fn floating(model: &Model, map: &ParameterMap) -> Vec<bool> {
    let free: Vec<usize> = model.free_coordinates().flatten().collect();
    match free.is_empty() {
        true => Vec::new(),
        false => map
            .leaders()
            .iter()
            .map(|leader| free.contains(leader))
            .collect(),
    }
}

/// Resolves one task. Appends the frames that no task before it reads to `frames`.
fn compile_task(
    model: &Model,
    index: usize,
    pending: &PendingTask,
    tolerances: &[(Quantity, f64)],
    frames: &mut Vec<FrameId>,
    first_row: usize,
) -> Result<CompiledTask, ProblemError> {
    let foreign = |task: &str, kind| ProblemError::ForeignId {
        task: task.to_owned(),
        kind,
        model: model.name().to_owned(),
    };
    let frame = pending.own_frame();
    let frame_name = frame.and_then(|f| model.frames().get(f.index()));
    let description = &pending.description;
    let name = pending.name.clone().unwrap_or_else(|| match frame_name {
        Some(frame) => format!("{} of `{}`", description.kind, frame.name),
        None if description.is_of_body => description.kind.to_owned(),
        None => format!("{} (task {index})", description.kind),
    });
    if let Some(defect) = description.defect() {
        return Err(ProblemError::BadTask {
            task: name,
            problem: defect.to_owned(),
        });
    }

    let mut slots: Vec<FrameSlot> = Vec::with_capacity(pending.inputs.frames.len());
    for &frame in &pending.inputs.frames {
        if frame.index() >= model.frames().len() {
            return Err(foreign(&name, "frame"));
        }
        let known = frames.iter().position(|&f| f == frame);
        slots.push(known.unwrap_or_else(|| {
            frames.push(frame);
            frames.len() - 1
        }));
    }
    let mut coordinates = Vec::with_capacity(pending.inputs.joints.len());
    for &joint in &pending.inputs.joints {
        let Some(first) = model.coordinate(joint) else {
            return Err(foreign(&name, "moving joint"));
        };
        let coordinate_count = model.joint_of(first).kind.coordinates();
        coordinates.extend(first..first + coordinate_count);
    }
    if let Some(expected) = pending.inputs.joint_values
        && expected != coordinates.len()
    {
        let joint = |id: &JointId| &model.joints()[id.index()];
        let mut joints = pending.inputs.joints.iter().map(joint);
        let ball = joints.find(|joint| joint.kind.is_ball());
        let problem = match ball {
            Some(ball) if expected == pending.inputs.joints.len() => format!(
                "it has one number per joint, but `{}` is a ball joint with a quaternion",
                ball.name
            ),
            _ => format!(
                "it has {expected} numbers for its joints, whose coordinates are {}",
                coordinates.len()
            ),
        };
        return Err(ProblemError::BadTask {
            task: name,
            problem,
        });
    }

    check_numbers(&name, &pending.rows, &pending.weights, &pending.tolerances)?;
    let mut blocks = Vec::with_capacity(pending.rows.len());
    let mut next_row = first_row;
    for rows in &pending.rows {
        let last_value = |list: &[(Quantity, f64)]| {
            let last = list.iter().rev().find(|(q, _)| *q == rows.quantity);
            last.map(|&(_, value)| value)
        };
        let weight =
            last_value(&pending.weights).unwrap_or_else(|| default_weight(rows.quantity, model));
        let weight = Block::weight_of(&name, rows.quantity, weight * pending.factor)?;
        let tolerance = last_value(&pending.tolerances)
            .or_else(|| last_value(tolerances))
            .unwrap_or_else(|| default_tolerance(rows.quantity, model));
        if tolerance.is_nan() || tolerance < 0.0 {
            return Err(ProblemError::BadTolerance {
                task: name,
                quantity: rows.quantity,
                tolerance,
            });
        }
        blocks.push(Block {
            measure: *rows,
            rows: next_row..next_row + rows.count,
            weight,
            tolerance,
        });
        next_row += rows.count;
    }
    let (inequalities, count) = (pending.residual.inequalities(), next_row - first_row);
    let is_out_of_range =
        |inequality: &&Inequality| inequality.rows().is_empty() || inequality.rows().end > count;
    if let Some(inequality) = inequalities.iter().find(is_out_of_range) {
        let rows = inequality.rows();
        return Err(ProblemError::BadTask {
            task: name,
            problem: format!("it has an inequality of its rows {rows:?}, but {count} rows"),
        });
    }
    let mut task = CompiledTask {
        name,
        is_loop: pending.is_loop,
        role: pending.role,
        binds: false,
        blocks,
        rows: first_row..next_row,
        level: pending.level,
        // Set later: by `Ranks`, which has all tasks, and `choose_sweeps`, which has the tree.
        rank: 0,
        rows_by_rank: 0..0,
        slacks_by_rank: 0..0,
        uses_sweeps: false,
        slack_weights: Vec::new(),
        inequalities,
        weights: Vec::new(),
        frames: slots,
        coordinates,
    };
    task.update_weights();
    Ok(task)
}

/// Checks that a task's weights and tolerances are valid and refer to rows that it has.
fn check_numbers(
    task: &str,
    rows: &[RowBlock],
    weights: &[(Quantity, f64)],
    tolerances: &[(Quantity, f64)],
) -> Result<(), ProblemError> {
    let present = |quantity| rows.iter().any(|r| r.quantity == quantity);
    let numbers = weights.iter().chain(tolerances);
    if let Some(&(quantity, _)) = numbers.into_iter().find(|(q, _)| !present(*q)) {
        return Err(ProblemError::NoSuchQuantity {
            task: task.to_owned(),
            quantity,
        });
    }
    let invalid = weights.iter().find(|(_, w)| !(*w >= 0.0 && w.is_finite()));
    match invalid {
        None => Ok(()),
        Some(&(quantity, weight)) => Err(ProblemError::BadWeight {
            task: task.to_owned(),
            quantity,
            weight,
        }),
    }
}

fn default_weight(quantity: Quantity, model: &Model) -> f64 {
    let reach = model.reach();
    match quantity {
        Quantity::Radians | Quantity::RadiansPerSecond if reach > 0.0 => RADIAN_PER_REACH * reach,
        _ => 1.0,
    }
}

fn default_tolerance(quantity: Quantity, model: &Model) -> f64 {
    let reach = model.reach();
    let length = match model.length_unit() {
        LengthUnit::Own if reach > 0.0 => reach,
        _ => 1.0,
    };
    match quantity {
        Quantity::Metres | Quantity::MetresPerSecond => DEFAULT_TOLERANCE * length,
        Quantity::Radians | Quantity::RadiansPerSecond => DEFAULT_TOLERANCE,
        Quantity::Pixels => DEFAULT_TOLERANCE_PIXELS,
        Quantity::JointUnits | Quantity::JointUnitsPerSecond | Quantity::Ratio => f64::INFINITY,
    }
}

/// Narrows the map by the problem's bounds.
fn narrow(
    model: &Model,
    map: &mut ParameterMap,
    extra: &[(JointId, Limits)],
) -> Result<(), ProblemError> {
    for &(id, limits) in extra {
        let Some(joint) = model.joints().get(id.index()) else {
            return Err(ProblemError::ForeignBound {
                model: model.name().to_owned(),
            });
        };
        let narrowed = match model.coordinate(id) {
            Some(coordinate) => map.narrow(coordinate, &limits),
            // A fixed joint is at zero.
            None if limits.is_valid() && limits.contains(0.0) => Ok(()),
            None => Err(limits),
        };
        let name = || joint.name.clone();
        narrowed.map_err(|range| match joint.kind {
            JointKind::Ball => ProblemError::BoundOnBall { joint: name() },
            _ => ProblemError::EmptyRange {
                joint: name(),
                lower: range.lower,
                upper: range.upper,
            },
        })?;
    }
    Ok(())
}
