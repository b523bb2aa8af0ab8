//! Joint positions of the humanoid at rest.
//!
//! Segment lengths as fractions of the stature after Drillis & Contini (1966), as given by Winter, "Biomechanics and
//! Motor Control of Human Movement", fig. 4.1.

use glam::DVec3;

/// Body height, metres.
const STATURE: f64 = 1.75;
/// Angle of the arms below the horizontal at rest, degrees.
const ARM_SLOPE: f64 = 40.0;

const FORWARD: DVec3 = DVec3::X;
const LEFT: DVec3 = DVec3::Y;
const UP: DVec3 = DVec3::Z;

/// Joint positions of the left side and the middle, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Landmarks {
    pub(crate) spine: [DVec3; 7],
    pub(crate) shoulder: DVec3,
    pub(crate) elbow: DVec3,
    pub(crate) wrist: DVec3,
    pub(crate) fingertips: DVec3,
    pub(crate) hip: DVec3,
    pub(crate) knee: DVec3,
    pub(crate) ankle: DVec3,
    pub(crate) ball: DVec3,
    pub(crate) toes: DVec3,
}

impl Landmarks {
    pub(crate) fn new() -> Self {
        let height = |share: f64| UP * (share * STATURE);
        let (sin, cos) = ARM_SLOPE.to_radians().sin_cos();
        let arm = LEFT * cos - UP * sin;
        // Centre of the joint: below and inside the acromion, which is at 0.818 and 0.129 of the stature.
        let shoulder = height(0.802) + LEFT * (0.11 * STATURE);
        let elbow = shoulder + arm * (0.186 * STATURE);
        let wrist = elbow + arm * (0.146 * STATURE);
        let hip = height(0.53) + LEFT * (0.05 * STATURE);
        let ankle = height(0.039) + LEFT * hip.y;
        // The foot is 0.152 of the stature long, with a quarter of its length behind the ankle.
        let sole = |share: f64| LEFT * hip.y + FORWARD * (share * 0.152 * STATURE) + UP * 0.022;
        Self {
            // Hips, waist, lower and upper end of the ribs, base and top of the neck, crown.
            spine: [0.53, 0.59, 0.66, 0.74, 0.825, 0.875, 1.0].map(height),
            shoulder,
            elbow,
            wrist,
            fingertips: wrist + arm * (0.108 * STATURE),
            hip,
            knee: height(0.285) + LEFT * hip.y,
            ankle,
            ball: sole(0.48),
            toes: sole(0.74),
        }
    }
}
