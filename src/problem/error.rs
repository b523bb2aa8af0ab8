//! What can be wrong with a problem.

use thiserror::Error;

use crate::SizeMismatch;
use crate::task::Quantity;

/// Why tasks and a model do not make a problem.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// More or fewer numbers of a target than its task has.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// Nothing to solve for.
    #[error("model `{model}` has no free joint: everything is fixed or locked")]
    NoVariables {
        /// The model.
        model: String,
    },
    /// Nothing asked.
    #[error("no task: say what the frames of `{model}` should do")]
    NoTasks {
        /// The model.
        model: String,
    },
    /// A frame or joint id beyond those of the model, or a joint that does not move.
    #[error("task {task} refers to a {kind} that model `{model}` does not have")]
    ForeignId {
        /// The task's name.
        task: String,
        /// "frame" or "moving joint".
        kind: &'static str,
        /// The model.
        model: String,
    },
    /// Numbers in a task that make no sense.
    #[error("task {task}: {problem}")]
    BadTask {
        /// The task's name.
        task: String,
        /// What is wrong.
        problem: String,
    },
    /// A weight that is negative or not finite.
    #[error("task {task}: weight {weight} per {quantity} is not a finite number of at least 0")]
    BadWeight {
        /// The task's name.
        task: String,
        /// Which rows.
        quantity: Quantity,
        /// The weight.
        weight: f64,
    },
    /// Weights of a problem that has fewer or more rows in its reports.
    #[error(
        "{given} weights are given, the problem has {expected}: one for each of a solution's rows"
    )]
    WeightCount {
        /// How many were given.
        given: usize,
        /// How many there are.
        expected: usize,
    },
    /// A model of another shape than the problem's.
    #[error("model `{given}` is not the problem's `{expected}` with its joints elsewhere")]
    ForeignModel {
        /// The model that was given.
        given: String,
        /// The problem's.
        expected: String,
    },
    /// Other numbers for a problem that keeps clear of something, which depends on them.
    #[error("a problem that keeps clear of something does not take other {what}: build it anew")]
    KeepsClear {
        /// "weights" or "joint origins".
        what: &'static str,
    },
    /// A tolerance that is negative or NaN.
    #[error("task {task}: tolerance {tolerance} in {quantity} is not a number of at least 0")]
    BadTolerance {
        /// The task's name.
        task: String,
        /// Which rows.
        quantity: Quantity,
        /// The tolerance.
        tolerance: f64,
    },
    /// A weight or tolerance for rows that the task does not have.
    #[error("task {task} has no rows in {quantity}")]
    NoSuchQuantity {
        /// The task's name.
        task: String,
        /// The quantity asked for.
        quantity: Quantity,
    },
    /// A task id of another problem.
    #[error("task number {task} is not one of these, or of another type: {}", tasks.join(", "))]
    ForeignTask {
        /// The id's place in its own problem.
        task: usize,
        /// What the tasks here are, in order.
        tasks: Vec<String>,
    },
    /// Targets of a problem with other tasks.
    #[error("{given} targets of another problem; that on `{model}` has {expected} tasks")]
    ForeignTargets {
        /// How many they are.
        given: usize,
        /// The model.
        model: String,
        /// How many tasks there are.
        expected: usize,
    },
    /// A parameter map of another model, told by its size.
    #[error("the parameter map has {map} coordinates, model `{model}` has {model_coordinates}")]
    ForeignMap {
        /// Coordinates in the map.
        map: usize,
        /// The model.
        model: String,
        /// Coordinates in the model.
        model_coordinates: usize,
    },
    /// A checker of another model, told by its size.
    #[error(
        "the checker is of configurations of {given} numbers, those of model `{model}` have {expected}"
    )]
    ForeignChecker {
        /// Numbers that it checks.
        given: usize,
        /// The model.
        model: String,
        /// Numbers of the model.
        expected: usize,
    },
    /// Bounds for a joint beyond those of the model.
    #[error("bounds are set on a joint that model `{model}` does not have")]
    ForeignBound {
        /// The model.
        model: String,
    },
    /// Extra bounds of one number on a ball, which has none.
    #[error(
        "joint `{joint}` is a ball, which bounds of one number do not limit: give it a cone, or limit its move"
    )]
    BoundOnBall {
        /// The joint.
        joint: String,
    },
    /// Extra bounds that leave a joint no value.
    #[error("joint `{joint}`: extra bounds [{lower}, {upper}] leave it no value")]
    EmptyRange {
        /// The joint.
        joint: String,
        /// Lower end of what is left.
        lower: f64,
        /// Upper end of what is left.
        upper: f64,
    },
}
