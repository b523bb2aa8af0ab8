//! Which limits a movement runs into, and when.

use std::ops::Range;

use super::{Retargeted, Retargeting};
use crate::motion::clip::MotionBound;
use crate::solver::Side;

/// So near to a limit, as a share of the room between both or of the longest move, it is met.
const NEAR: f64 = 1e-9;

/// A limit that a joint is at over a span of frames.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LimitMet {
    /// The joint's name.
    pub joint: String,
    /// What is limited.
    pub bound: MotionBound,
    /// Which end: of a speed, whether it falls or rises.
    pub side: Side,
    /// The frames.
    pub frames: Range<usize>,
}

impl Retargeting<'_> {
    /// The limits of position and speed that a movement is at, in the order of joints and frames. What joints follow others by
    /// counts through those that they follow.
    #[must_use]
    pub fn limits_met(&self, found: &Retargeted) -> Vec<LimitMet> {
        let model = self.robot.model();
        let width = model.configuration_len();
        let moves = self.robot.moves_within(1.0 / self.frame_rate);
        let mut met = Vec::new();
        for (coordinate, id) in model.moving_joints().iter().enumerate() {
            let joint = &model.joints()[id.index()];
            if joint.kind.coordinates() != 1 {
                continue;
            }
            let values = || found.q.iter().skip(coordinate).step_by(width.max(1));
            let (low, high) = (joint.limits.lower, joint.limits.upper);
            let room = (high - low).min(1.0);
            let most = moves.get(coordinate).copied().unwrap_or(f64::INFINITY);
            let position = |side: Side, is_at: &dyn Fn(f64) -> bool| {
                let frames = values().enumerate().filter(|(_, value)| is_at(**value));
                spans(frames.map(|(frame, _)| frame), |frames| LimitMet {
                    joint: joint.name.clone(),
                    bound: MotionBound::Position,
                    side,
                    frames,
                })
            };
            met.extend(position(Side::Lower, &|value| value <= low + NEAR * room));
            met.extend(position(Side::Upper, &|value| value >= high - NEAR * room));
            if most.is_finite() {
                for (side, sign) in [(Side::Lower, -1.0), (Side::Upper, 1.0)] {
                    let steps = values().zip(values().skip(1)).enumerate();
                    let fast = steps
                        .filter(|(_, (from, to))| sign * (**to - **from) >= (1.0 - NEAR) * most);
                    met.extend(spans(fast.map(|(frame, _)| frame + 1), |frames| LimitMet {
                        joint: joint.name.clone(),
                        bound: MotionBound::Speed,
                        side,
                        frames,
                    }));
                }
            }
        }
        met
    }
}

/// Frames in order as spans without gaps.
fn spans(
    frames: impl Iterator<Item = usize>,
    told: impl Fn(Range<usize>) -> LimitMet,
) -> Vec<LimitMet> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for frame in frames {
        match spans.last_mut() {
            Some(span) if span.end == frame => span.end += 1,
            _ => spans.push(frame..frame + 1),
        }
    }
    spans.into_iter().map(told).collect()
}
