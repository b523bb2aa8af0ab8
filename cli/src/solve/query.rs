//! Queries and their solutions, in terms of the whole model.

use kinopt::Solution;
use kinopt::arm::Jump;
use kinopt::spatial::Placement;
use serde::Serialize;

use super::derivative::TargetDerivatives;
use crate::number_format::six_digits;

/// A joint that moves further in a step is reported, in radians.
const LONG: f64 = 0.2;

/// Where frames should stand, and where the search for that starts.
#[derive(Clone, Debug)]
pub(super) struct Query {
    /// base_from_target of each frame that has a target.
    pub(super) targets: Vec<Placement<f64>>,
    /// A configuration of the model within its limits.
    pub(super) start: Vec<f64>,
}

/// What came out for one query.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    /// All moving joints of the model, in radians and metres.
    pub(super) q: Vec<f64>,
    /// Further answers where several distinct ones are wanted, nearest to the start first.
    pub(super) alternatives: Vec<Vec<f64>>,
    /// The truth about it; its own `q` may hold fewer joints.
    pub(super) solution: Solution,
    /// Time spent solving, in microseconds; none where it was solved together with others.
    pub(super) micros: Option<f64>,
    /// Of a figure that settled.
    pub(super) settled: Option<Settled>,
    /// Where it was asked for.
    pub(super) derivative: Option<TargetDerivatives>,
}

/// How a figure came to its pose.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Settled {
    pub(super) way: Way,
    /// The cost of a nearer miss that a search found elsewhere, which --global-search-on-miss would
    /// answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lower_cost_elsewhere: Option<f64>,
}

/// Which way a figure took to its pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Way {
    /// It settled there from where it stood.
    Own,
    /// Its own way missed, and a search from other places found better.
    Another,
}

/// What came out for a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    /// One for each step.
    pub(super) answers: Vec<Answer>,
    /// The steps in which a joint moved far.
    pub(super) jumps: Vec<LongStep>,
}

/// A step of a path in which a joint moved further than 0.2 rad.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LongStep {
    /// The position of its target, from 0.
    step: usize,
    /// The joint that moved furthest.
    joint: String,
    /// How far, in radians; a slide by the metres that weigh as much.
    distance: f64,
    /// Whether small steps lead there too; if not, the arm flipped to another branch.
    continuous: bool,
}

impl Answer {
    /// The only answer, at `q`.
    pub(super) fn new(q: Vec<f64>, solution: Solution, micros: Option<f64>) -> Self {
        Self {
            q,
            alternatives: Vec::new(),
            solution,
            micros,
            settled: None,
            derivative: None,
        }
    }
}

impl LongStep {
    /// A jump of an arm with these joints.
    pub(super) fn of(jump: &Jump, joints: &[&str]) -> Self {
        let joint = joints.get(jump.joint).copied().unwrap_or_default();
        Self {
            step: jump.step,
            joint: joint.to_owned(),
            distance: jump.distance,
            continuous: jump.continuous,
        }
    }

    /// A step of a path that was dragged, from `before` to `after` (coordinates of the model; those
    /// that are no `angles` do not count), if it is long: in one piece, as a drag never leaps.
    pub(super) fn between(
        step: usize,
        before: &[f64],
        after: &[f64],
        angles: &[bool],
        joints: &[&str],
    ) -> Option<Self> {
        let moves = before.iter().zip(after).map(|(a, b)| (a - b).abs());
        let moves = moves.zip(angles).zip(joints);
        let turned = moves.filter_map(|((moved, &angle), joint)| angle.then_some((moved, joint)));
        let (distance, joint) = turned.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (distance > LONG).then(|| Self {
            step,
            joint: (*joint).to_owned(),
            distance,
            continuous: true,
        })
    }

    /// A line for people.
    pub(super) fn text(&self) -> String {
        let how = match self.continuous {
            true => "in one piece: a fast motion or a coarse path",
            false => "a flip, as the branch ends there",
        };
        let (step, joint, distance) = (self.step, &self.joint, six_digits(self.distance));
        format!("step {step}: `{joint}` moves by {distance} rad, {how}")
    }
}
