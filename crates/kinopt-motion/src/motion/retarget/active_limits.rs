//! Active limits of a motion, with their spans.

use std::ops::Range;

use super::{RetargetReport, Retargeting};
use crate::motion::trajectory::MotionBound;
use kinopt_kinematics::Trajectory;
use kinopt_solver::solver::Side;

/// Distance from a limit that counts as active, relative to the range or to the displacement bound.
const RELATIVE_TOLERANCE: f64 = 1e-9;

/// Limit that is active for a joint over a span of samples.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LimitMet {
    /// Name of the joint.
    pub joint: String,
    /// Kind of the bound.
    pub bound: MotionBound,
    /// Lower or upper bound. For a velocity it is the sign of the motion.
    pub side: Side,
    /// Span of samples.
    pub frames: Range<usize>,
}

impl Retargeting<'_> {
    /// Returns the active limits of position and velocity, in the order of joints and samples.
    ///
    /// Limits of mimic joints count through their source joints.
    #[must_use]
    pub fn active_limits(&self, retargeted: &Trajectory<RetargetReport>) -> Vec<LimitMet> {
        let model = self.robot.model();
        let width = model.configuration_len();
        let max_steps = self.robot.moves_within(1.0 / self.frame_rate);
        let mut met = Vec::new();
        for (coordinate, id) in model.moving_joints().iter().enumerate() {
            let joint = &model.joints()[id.index()];
            if joint.kind.coordinates() != 1 {
                continue;
            }
            let values = || retargeted.q.iter().skip(coordinate).step_by(width.max(1));
            let (low, high) = (joint.limits.lower, joint.limits.upper);
            let scale = (high - low).min(1.0);
            let max_step = max_steps.get(coordinate).copied().unwrap_or(f64::INFINITY);
            let position = |side: Side, is_at: &dyn Fn(f64) -> bool| {
                let frames = values().enumerate().filter(|(_, value)| is_at(**value));
                spans(frames.map(|(frame, _)| frame), |frames| LimitMet {
                    joint: joint.name.clone(),
                    bound: MotionBound::Position,
                    side,
                    frames,
                })
            };
            met.extend(position(Side::Lower, &|value| {
                value <= low + RELATIVE_TOLERANCE * scale
            }));
            met.extend(position(Side::Upper, &|value| {
                value >= high - RELATIVE_TOLERANCE * scale
            }));
            if max_step.is_finite() {
                for (side, sign) in [(Side::Lower, -1.0), (Side::Upper, 1.0)] {
                    let steps = values().zip(values().skip(1)).enumerate();
                    let fast = steps.filter(|(_, (from, to))| {
                        sign * (**to - **from) >= (1.0 - RELATIVE_TOLERANCE) * max_step
                    });
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

/// Groups ascending samples into spans without gaps.
fn spans(
    frames: impl Iterator<Item = usize>,
    make_limit: impl Fn(Range<usize>) -> LimitMet,
) -> Vec<LimitMet> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for frame in frames {
        match spans.last_mut() {
            Some(span) if span.end == frame => span.end += 1,
            _ => spans.push(frame..frame + 1),
        }
    }
    spans.into_iter().map(make_limit).collect()
}
