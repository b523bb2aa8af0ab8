//! Errors of problems and of loop closures.

use thiserror::Error;

use super::LoopGap;
use crate::solver::SolveError;
use crate::task::Quantity;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::ModelError;

/// Error of a problem, or of a configuration found by solving one: with closed loops, or crouched.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// Too many or too few numbers for a task's target.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A model without free joints.
    #[error("model `{model}` has no free joint: everything is fixed or locked")]
    NoVariables {
        /// Name of the model.
        model: String,
    },
    /// A problem without tasks.
    #[error("no task: the problem of model `{model}` needs at least one")]
    NoTasks {
        /// Name of the model.
        model: String,
    },
    /// A frame or joint id that is not in the model, or a joint that does not move.
    #[error("task {task} refers to a {kind} that model `{model}` does not have")]
    ForeignId {
        /// Name of the task.
        task: String,
        /// Kind of the object: "frame" or "moving joint".
        kind: &'static str,
        /// Name of the model.
        model: String,
    },
    /// Invalid parameters of a task.
    #[error("task {task}: {problem}")]
    BadTask {
        /// Name of the task.
        task: String,
        /// The defect.
        problem: String,
    },
    /// A weight that is negative or not finite.
    #[error("task {task}: weight {weight} per {quantity} is not a finite number of at least 0")]
    BadWeight {
        /// Name of the task.
        task: String,
        /// The quantity of the rows.
        quantity: Quantity,
        /// The weight.
        weight: f64,
    },
    /// Weights whose number differs from the number of row blocks in reports.
    #[error("{given} weights are given, the problem has {expected}: one per row of a solution")]
    WeightCount {
        /// Number of given weights.
        given: usize,
        /// Number of row blocks.
        expected: usize,
    },
    /// A model that differs from the problem's in joints or frames.
    #[error(
        "model `{given}` does not match the problem's model `{expected}`: only joint origins may differ"
    )]
    ForeignModel {
        /// The given model.
        given: String,
        /// The problem's model.
        expected: String,
    },
    /// New weights or joint origins for a problem with collision avoidance, which depends on them.
    #[error("a problem with collision avoidance does not accept other {what}: build a new problem")]
    KeepsClear {
        /// The rejected parameters: "weights" or "joint origins".
        what: &'static str,
    },
    /// A tolerance that is negative or NaN.
    #[error("task {task}: tolerance {tolerance} in {quantity} is not a number of at least 0")]
    BadTolerance {
        /// Name of the task.
        task: String,
        /// The quantity of the rows.
        quantity: Quantity,
        /// The tolerance.
        tolerance: f64,
    },
    /// A weight or tolerance for rows that the task does not have.
    #[error("task {task} has no rows in {quantity}")]
    NoSuchQuantity {
        /// Name of the task.
        task: String,
        /// The requested quantity.
        quantity: Quantity,
    },
    /// A task id of another problem.
    #[error("task number {task} does not exist or is of another type; tasks are {}", tasks.join(", "))]
    ForeignTask {
        /// The index of the id.
        task: usize,
        /// The kinds of the tasks of this problem, in order.
        tasks: Vec<String>,
    },
    /// Targets of a problem with other tasks.
    #[error(
        "{given} targets of another problem: the problem of model `{model}` has {expected} tasks"
    )]
    ForeignTargets {
        /// Number of tasks of the targets.
        given: usize,
        /// Name of the model.
        model: String,
        /// Number of tasks of the problem.
        expected: usize,
    },
    /// A parameter map of another model, detected by its size.
    #[error("the parameter map has {map} coordinates, model `{model}` has {model_coordinates}")]
    ForeignMap {
        /// Number of coordinates of the map.
        map: usize,
        /// Name of the model.
        model: String,
        /// Number of coordinates of the model.
        model_coordinates: usize,
    },
    /// A collision checker of another model, detected by its size.
    #[error(
        "the checker is for configurations of {given} numbers: those of model `{model}` have {expected}"
    )]
    ForeignChecker {
        /// Number of coordinates that the checker expects.
        given: usize,
        /// Name of the model.
        model: String,
        /// Number of coordinates of the model.
        expected: usize,
    },
    /// Bounds on a joint that is not in the model.
    #[error("bounds are set on a joint that model `{model}` does not have")]
    ForeignBound {
        /// Name of the model.
        model: String,
    },
    /// Extra bounds on a ball joint, which has several coordinates.
    #[error(
        "joint `{joint}` is a ball joint: bounds are not allowed, use a cone or a displacement limit"
    )]
    BoundOnBall {
        /// Name of the joint.
        joint: String,
    },
    /// Extra bounds that leave a joint no value.
    #[error("joint `{joint}`: extra bounds [{lower}, {upper}] leave no value")]
    EmptyRange {
        /// Name of the joint.
        joint: String,
        /// Lower end of the remaining interval.
        lower: f64,
        /// Upper end of the remaining interval.
        upper: f64,
    },
    /// Invalid frames or an invalid configuration.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// The configuration has the wrong length, a locked joint is outside its limits, or a joint cannot be dependent.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A solve that did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// No joint is given that closes the loops.
    #[error(
        "model `{model}` has loops but no passive joints that close them: name some of {}",
        joints.join(", ")
    )]
    NoPassiveJoints {
        /// Name of the model.
        model: String,
        /// Names of the joints that move the loops.
        joints: Vec<String>,
    },
    /// The search found no values of the dependent joints that close a loop.
    #[error("{}: no values of {} were found that close it", listed(open), dependent.join(", "))]
    OpenLoops {
        /// Open loops with their closure errors.
        open: Vec<LoopGap>,
        /// Names of the dependent joints.
        dependent: Vec<String>,
    },
}

fn listed(open: &[LoopGap]) -> String {
    let open: Vec<String> = open.iter().map(LoopGap::to_string).collect();
    open.join(", ")
}
