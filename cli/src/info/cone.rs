//! Cone limits of ball joints.

use std::f64::consts::PI;

use kinopt::model::Joint;
use serde::Serialize;

use crate::number_format::three_digits;

/// Limits of a ball joint, in radians.
#[derive(Serialize)]
pub(super) struct ConeDocument {
    pub(super) axis: [f64; 3],
    pub(super) swing: [f64; 2],
    /// First axis of the two swings; `None` if the swings are equal.
    pub(super) about: Option<[f64; 3]>,
    /// Range of the twist; `None` without a limit.
    pub(super) twist: [Option<f64>; 2],
    /// Largest rotation angle in any direction; `None` without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angle: Option<f64>,
}

impl ConeDocument {
    /// Limits of a ball joint; `None` if it has none.
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

    /// Limits in degrees; `None` if the joint rotates freely.
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
            .map(|max_angle| format!("a rotation of {}", degrees(max_angle)));
        let parts: Vec<String> = [swing, twist, angle].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("within {}", parts.join(", ")))
    }
}
