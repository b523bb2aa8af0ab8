//! Cone limits of ball joints.

use std::f64::consts::PI;

use kinopt::model::Joint;
use serde::Serialize;

use crate::number_format::three_digits;

/// In radians.
#[derive(Serialize)]
pub(super) struct ConeDocument {
    pub(super) axis: [f64; 3],
    pub(super) swing: [f64; 2],
    /// The first axis of the two swings; none where they are the same.
    pub(super) about: Option<[f64; 3]>,
    /// None where there is no limit.
    pub(super) twist: [Option<f64>; 2],
    /// How far it may turn in all, whichever way; none where only swing and twist say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angle: Option<f64>,
}

impl ConeDocument {
    /// Of a ball that has limits.
    pub(super) fn of(joint: &Joint) -> Option<Self> {
        let finite = |limit: f64| limit.is_finite().then_some(limit);
        joint.ball.map(|limits| Self {
            axis: joint.axis.to_array(),
            swing: limits.swing,
            about: limits.about.map(|about| about.to_array()),
            twist: [limits.twist.lower, limits.twist.upper].map(finite),
            angle: limits.angle,
        })
    }

    /// How far a ball goes, in degrees; of one that goes anywhere nothing.
    pub(super) fn text(&self) -> Option<String> {
        let degrees = |radians: f64| three_digits(radians.to_degrees());
        let [first, second] = self.swing;
        let swing = match first == second {
            _ if first.min(second) >= PI => None,
            true => Some(format!("a swing of {}", degrees(first))),
            false => Some(format!(
                "a swing of {} and {}",
                degrees(first),
                degrees(second)
            )),
        };
        let twist = match self.twist {
            [Some(from), Some(to)] => {
                Some(format!("a twist of {} to {}", degrees(from), degrees(to)))
            }
            _ => None,
        };
        let angle = self
            .angle
            .map(|most| format!("a turn of {}", degrees(most)));
        let parts: Vec<String> = [swing, twist, angle].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("within {}", parts.join(", ")))
    }
}
