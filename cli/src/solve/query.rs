//! Queries and their solutions, in terms of the whole model.

use kinopt::Solution;
use kinopt::ik::JointJump;
use kinopt::spatial::Placement;
use serde::Serialize;

use super::derivative::TargetDerivatives;
use super::self_motion::SelfMotionCurve;
use crate::jump_document::JumpDocument;

/// Joint displacement of a step above which the step is reported, in radians.
const MAX_JOINT_STEP: f64 = 0.2;

/// Targets of frames, and the start configuration.
#[derive(Clone, Debug)]
pub(super) struct Query {
    /// base_from_target of each frame with a target.
    pub(super) targets: Vec<Placement<f64>>,
    /// Configuration of the model within its limits.
    pub(super) start: Vec<f64>,
}

/// Result of a query.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    /// Values of all moving joints of the model, in radians and metres.
    pub(super) q: Vec<f64>,
    /// Further solutions, nearest to the start first.
    pub(super) alternatives: Vec<Vec<f64>>,
    /// True if the solutions are a complete set; `None` for a search for one.
    pub(super) complete: Option<bool>,
    /// Self-motions of the target, if all solutions of an arm with seven revolute joints are wanted.
    pub(super) self_motions: Option<Vec<SelfMotionCurve>>,
    /// Solution of the solver; its `q` may have fewer joints.
    pub(super) solution: Solution,
    /// Solve time in microseconds; `None` for a target that was solved together with others.
    pub(super) micros: Option<f64>,
    /// Branch of the pose, for a skeleton that converges first.
    pub(super) settled: Option<Settled>,
    /// Derivative by the targets, if requested.
    pub(super) derivative: Option<TargetDerivatives>,
}

/// Branch on which a skeleton reached its pose.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Settled {
    pub(super) way: PoseOrigin,
    /// Lower cost of a search that did not reach either. `global_search_on_miss` returns that pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lower_cost_elsewhere: Option<f64>,
}

/// Origin of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PoseOrigin {
    /// Convergence from the start, on its branch.
    Own,
    /// A search from other starts, after the branch of the start did not reach the target.
    Another,
}

/// Result of a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    /// Solutions, one for each step.
    pub(super) answers: Vec<Answer>,
    /// Steps in which a joint exceeds the jump bound.
    pub(super) jumps: Vec<JumpDocument>,
}

impl Answer {
    /// Answer without alternatives, at `q`.
    pub(super) fn new(q: Vec<f64>, solution: Solution, micros: Option<f64>) -> Self {
        Self {
            q,
            alternatives: Vec::new(),
            complete: None,
            self_motions: None,
            solution,
            micros,
            settled: None,
            derivative: None,
        }
    }
}

/// Jump of a dragged path from `before` to `after`, in coordinates of the model, if a joint exceeds the bound. Only
/// `angles` count. It is no reconfiguration, because a drag stays on its branch.
pub(super) fn drag_jump(
    index: usize,
    before: &[f64],
    after: &[f64],
    angles: &[bool],
) -> Option<JointJump> {
    let moves = before.iter().zip(after).map(|(a, b)| (a - b).abs());
    let moves = moves.zip(angles).enumerate();
    let rotated = moves.filter_map(|(joint, (moved, &angle))| angle.then_some((moved, joint)));
    let (distance, joint) = rotated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (distance > MAX_JOINT_STEP).then_some(JointJump {
        index,
        joint,
        distance,
        reconfiguration: false,
    })
}
