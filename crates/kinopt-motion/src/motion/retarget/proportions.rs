//! Plausibility of limb lengths of a map.

use std::collections::BTreeMap;

use super::{BodyPart, Capture};
use kinopt_kinematics::spatial::Vector3;

/// Limbs of both sides, with their names.
const LIMBS: [(&str, [BodyPart; 2], [BodyPart; 2]); 4] = [
    (
        "thigh",
        [BodyPart::LeftHip, BodyPart::LeftKnee],
        [BodyPart::RightHip, BodyPart::RightKnee],
    ),
    (
        "shin",
        [BodyPart::LeftKnee, BodyPart::LeftAnkle],
        [BodyPart::RightKnee, BodyPart::RightAnkle],
    ),
    (
        "upper arm",
        [BodyPart::LeftShoulder, BodyPart::LeftElbow],
        [BodyPart::RightShoulder, BodyPart::RightElbow],
    ),
    (
        "forearm",
        [BodyPart::LeftElbow, BodyPart::LeftHand],
        [BodyPart::RightElbow, BodyPart::RightHand],
    ),
];
/// Largest relative difference of the two sides.
const MAX_ASYMMETRY: f64 = 0.25;
/// Largest relative variation of a bone's length over a capture.
const MAX_LENGTH_VARIATION: f64 = 0.2;
/// Number of capture frames that are checked.
const CHECKED_FRAMES: usize = 64;

/// Limb lengths in capture frames spread over a capture.
#[derive(Clone, Debug)]
pub(super) struct Proportions {
    /// Name, and shortest and longest length on the left and on the right, in the capture's unit.
    limbs: Vec<(&'static str, [[f64; 2]; 2])>,
}

impl Proportions {
    pub(super) fn of(capture: &Capture, joints: &BTreeMap<BodyPart, usize>) -> Self {
        let step = capture.frames().div_ceil(CHECKED_FRAMES).max(1);
        let length = |ends: [BodyPart; 2]| -> Option<[f64; 2]> {
            let [from, to] = [joints.get(&ends[0])?, joints.get(&ends[1])?];
            let frames = (0..capture.frames()).step_by(step);
            let lengths = frames.filter_map(|frame| {
                let positions: &[Vector3<f64>] = capture.frame(frame)?;
                Some((positions[*to] - positions[*from]).norm())
            });
            let ends = |[low, high]: [f64; 2], length: f64| [low.min(length), high.max(length)];
            Some(lengths.fold([f64::INFINITY, 0.0], ends))
        };
        let limbs = LIMBS
            .iter()
            .filter_map(|(name, left, right)| Some((*name, [length(*left)?, length(*right)?])));
        Self {
            limbs: limbs.collect(),
        }
    }

    /// Returns messages about implausible lengths.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (name, sides) in &self.limbs {
            for ([shortest, longest], side) in sides.iter().zip(["left", "right"]) {
                if *longest == 0.0 {
                    warnings.push(format!(
                        "the {side} {name} has no length: its ends are at one position"
                    ));
                } else if *shortest < (1.0 - MAX_LENGTH_VARIATION) * longest {
                    warnings.push(format!(
                        "the {side} {name} is between {shortest:.3} and {longest:.3} long: its ends may not be of one bone"
                    ));
                }
            }
            let [left, right] = [sides[0][1], sides[1][1]];
            if left.min(right) > 0.0 && left.min(right) < (1.0 - MAX_ASYMMETRY) * left.max(right) {
                warnings.push(format!(
                    "the left {name} is {left:.3} long and the right one {right:.3}"
                ));
            }
        }
        warnings
    }
}
