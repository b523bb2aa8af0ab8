//! Errors of minimisations, of solves and of the derivatives of solutions.

use thiserror::Error;

use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::bad_option::BadOption;

/// Error of a minimisation or a solve that did not start, or of the derivative of a solution.
///
/// An unreached target is no error but a [`Solution`](crate::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The start has a wrong length.
    #[error("the start has {given} numbers, expected {expected} for `{model}`")]
    StartLength {
        /// Name of the model.
        model: String,
        /// Length of the given start.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The start has a zero quaternion for a ball joint.
    #[error("the start: the quaternion of joint `{joint}` has length 0")]
    StartNoRotation {
        /// Name of the joint.
        joint: String,
    },
    /// The start is NaN or infinite. A start outside the limits is allowed.
    #[error("the start: joint `{joint}` is {value}, which is not a finite number")]
    StartNotFinite {
        /// Name of the joint.
        joint: String,
        /// Value of the coordinate.
        value: f64,
    },
    /// Joints of another model.
    #[error(
        "a configuration of the given model has {given} numbers, one of `{model}` has {expected}"
    )]
    OtherModel {
        /// The model that is solved.
        model: String,
        /// The numbers of its configuration.
        expected: usize,
        /// Numbers given.
        given: usize,
    },
    /// Joints cannot move on their parents where collisions are avoided.
    #[error("`{model}`: joint origins are constant with collision avoidance")]
    JointsOfCollisions {
        /// The model.
        model: String,
    },
    /// Another number of moves than a configuration has numbers.
    #[error("{given} moves, expected {expected} for a configuration of `{model}`")]
    MovesLength {
        /// Name of the model.
        model: String,
        /// Number of given moves.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The four moves of a ball joint differ; it has one rotation angle.
    #[error("the four moves of ball joint `{joint}` differ")]
    MovesOfBall {
        /// Name of the joint.
        joint: String,
    },
    /// The number of motion limits differs from the length of a configuration.
    #[error("{option} has {given} numbers, expected {expected} for a configuration of `{model}`")]
    MotionLimitsLength {
        /// Name of the option.
        option: &'static str,
        /// Name of the model.
        model: String,
        /// Number of given limits.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The motion of the problem cannot be limited by a time step.
    #[error("time_step: a drag with {reason} does not support acceleration limits")]
    UnsupportedTimeStep {
        /// The unsupported property of the drag.
        reason: String,
    },
    /// The moves belong to a problem with other variables.
    #[error("moves for {given} variables, expected {expected} for the problem on `{model}`")]
    ForeignMoves {
        /// Name of the model.
        model: String,
        /// Number of variables of the moves.
        given: usize,
        /// Number of variables of the problem.
        expected: usize,
    },
    /// A velocity, or a gradient by one, has the wrong length for a derivative.
    #[error("the velocity has {given} numbers: {expected} are needed")]
    VelocityLength {
        /// Number of given elements.
        given: usize,
        /// Degrees of freedom of the model.
        expected: usize,
    },
    /// A configuration, or a gradient by one, has the wrong length for a derivative.
    #[error("the configuration has {given} numbers: {expected} are needed")]
    ConfigurationLength {
        /// Number of given elements.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The parameters belong to another problem, or have joint origins although no model is set.
    #[error("the parameters do not fit this problem: create them by `parameters`")]
    ForeignParameters,
    /// The task does not exist.
    #[error("task {given} does not exist: the problem has {tasks} tasks, counted from 0")]
    NoSuchTask {
        /// Given index.
        given: usize,
        /// Number of tasks.
        tasks: usize,
    },
    /// The model is not that of the problem.
    #[error("the joints are of model `{given}`: those of `{expected}` are needed")]
    ForeignModel {
        /// Name of the given model.
        given: String,
        /// Name of the problem's model.
        expected: String,
    },
    /// A task that the geometric method does not support.
    #[error("{solver} does not support task {task}; supported tasks: {valid}")]
    UnsupportedTask {
        /// The name of the method.
        solver: &'static str,
        /// The name of the task.
        task: String,
        /// The supported kinds of tasks.
        valid: &'static str,
    },
    /// A ball joint: geometric methods move joints with one axis.
    #[error("joint `{joint}` is a ball joint, which {solver} does not support; use a `Solver`")]
    BallJoint {
        /// The name of the method.
        solver: &'static str,
        /// The name of the joint.
        joint: String,
    },
    /// A prismatic joint, for a geometric method that needs fixed distances between joints.
    #[error("joint `{joint}` is prismatic, which {solver} does not support; use CCD")]
    SlidingJoint {
        /// The name of the method.
        solver: &'static str,
        /// The name of the joint, or of its source joint.
        joint: String,
    },
    /// An analytic solution of a chain without exactly two bones.
    #[error(
        "model `{model}`: the free joints form {bones} bones with {tips} tip points, but the analytic \
         solution needs 2 bones with 1 tip point; lock other joints by a `ParameterMap`"
    )]
    NotTwoBones {
        /// The name of the model.
        model: String,
        /// Number of distances between points with free joints, including the tip's.
        bones: usize,
        /// Number of points with a target.
        tips: usize,
    },
    /// The start or the bounds have another length than the number of variables.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// The start of a minimisation is not finite.
    #[error("number {variable} of the start is {value}, which is not a finite number")]
    VariableNotFinite {
        /// Index of the variable, from 0.
        variable: usize,
        /// Value of the variable.
        value: f64,
    },
}
