//! An answer in terms of the whole model.

use kinopt::Solution;
use kinopt::arm::Jump;
use serde::Serialize;

use crate::number_format::six_digits;

/// A joint that moves further in a step is told, in radians.
const LONG: f64 = 0.2;

/// What came out for one question.
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
    /// Of a figure, unless it was only searched for.
    pub(super) way: Option<Way>,
    /// The cost of a nearer miss that a search found elsewhere and that was not asked for.
    pub(super) elsewhere: Option<f64>,
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
    /// The steps in which a joint moved far; none where nobody looked.
    pub(super) jumps: Option<Vec<LongStep>>,
}

/// A step of a path in which a joint moved further than 0.2 rad.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LongStep {
    /// The place of its target, from 0.
    step: usize,
    /// The joint that moved furthest.
    pub(super) joint: String,
    /// How far, in radians; a slide by the metres that weigh as much.
    pub(super) distance: f64,
    /// Whether small steps lead there too; if not, the arm flipped to another branch.
    pub(super) continuous: bool,
}

impl LongStep {
    /// A jump of an arm with these joints.
    pub(super) fn of(jump: &Jump, joints: &[&str]) -> Self {
        Self {
            step: jump.step,
            joint: joints
                .get(jump.joint)
                .copied()
                .unwrap_or_default()
                .to_owned(),
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
        format!(
            "step {}: `{}` moves by {} rad, {how}",
            self.step,
            self.joint,
            six_digits(self.distance)
        )
    }
}

/// A task of a question, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(super) struct AskedTask {
    /// The frame as it was typed; for a held tip the bone's name.
    pub(super) frame: String,
    /// A pinned tip that is kept where it was, rather than something asked for.
    pub(super) held: bool,
}

/// A target of one frame, and where the search for it starts.
#[derive(Clone, Debug)]
pub(super) struct Question {
    /// Where the tip should stand in the base.
    pub(super) base_from_tip: kinopt::spatial::Placement<f64>,
    /// A configuration of the model within its limits.
    pub(super) start: Vec<f64>,
}
