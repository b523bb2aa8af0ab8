//! Default rest joints of the SMPL family, by a person's height.
//!
//! The fractions of the height are those of Drillis & Contini, "Body segment parameters" (1966), as in Winter,
//! "Biomechanics and Motor Control of Human Movement" (4th edition 2009), figure 4.1: ankle 0.039, knee 0.285, hip
//! 0.530, shoulder 0.818, upper arm 0.186, forearm 0.146, hand 0.108, foot 0.152. Depths, spine, collars, hips and
//! fingers are estimates of this project. No numbers of a body model are used.

use super::joints::Family;

/// Height of the default skeleton, metres.
pub const DEFAULT_HEIGHT: f64 = 1.7;

/// Height of the hips above the ground, relative to the height of the person. The pelvis joint is the origin.
const HIP_HEIGHT: f64 = 0.530;

/// Positions of the body's joints for a height of 1, from the ground: x left, y up, z forward, arms along x.
const BODY: [[f64; 3]; 22] = [
    [0.0, HIP_HEIGHT + 0.020, 0.0],
    [0.052, HIP_HEIGHT, 0.0],
    [-0.052, HIP_HEIGHT, 0.0],
    [0.0, 0.610, -0.010],
    [0.056, 0.285, 0.0],
    [-0.056, 0.285, 0.0],
    [0.0, 0.680, -0.005],
    [0.052, 0.039, -0.020],
    [-0.052, 0.039, -0.020],
    [0.0, 0.715, 0.0],
    [0.062, 0.008, 0.052],
    [-0.062, 0.008, 0.052],
    [0.0, 0.835, -0.015],
    [0.042, 0.790, -0.010],
    [-0.042, 0.790, -0.010],
    [0.0, 0.885, 0.010],
    [0.105, 0.818, -0.010],
    [-0.105, 0.818, -0.010],
    [0.291, 0.818, -0.010],
    [-0.291, 0.818, -0.010],
    [0.437, 0.818, -0.010],
    [-0.437, 0.818, -0.010],
];

/// Length of a hand, relative to the height.
const HAND: f64 = 0.108;
/// First joints of the fingers from the wrist: along the hand and forward, relative to the length of the hand.
const FINGERS: [[f64; 2]; 5] = [
    [0.50, 0.15],
    [0.52, 0.03],
    [0.44, -0.20],
    [0.48, -0.10],
    [0.20, 0.22],
];
/// Length of the first two phalanges, relative to the length of the hand.
const PHALANX: f64 = 0.17;
/// Jaw and eyes from the head joint: left, up and forward.
const FACE: [[f64; 3]; 3] = [
    [0.0, -0.010, 0.020],
    [0.018, 0.035, 0.045],
    [-0.018, 0.035, 0.045],
];
/// Hand joint of SMPL from the wrist, relative to the length of the hand.
const KNUCKLES: f64 = 0.45;

/// Rest positions of all joints for a height in metres, relative to the pelvis: x left, y up, z forward.
pub(super) fn default_rest(family: Family, height: f64) -> Vec<[f64; 3]> {
    let pelvis = BODY[0];
    let mut joints = BODY.to_vec();
    if family == Family::SmplX {
        let [x, y, z] = BODY[15];
        joints.extend(FACE.map(|[left, up, forward]| [x + left, y + up, z + forward]));
    }
    for (wrist, side) in [(BODY[20], 1.0), (BODY[21], -1.0)] {
        let at = |along: f64, forward: f64| {
            [
                wrist[0] + side * HAND * along,
                wrist[1],
                wrist[2] + HAND * forward,
            ]
        };
        match family {
            Family::Smpl => joints.push(at(KNUCKLES, 0.0)),
            _ => {
                for [along, forward] in FINGERS {
                    for phalanx in 0..3 {
                        joints.push(at(along + PHALANX * f64::from(phalanx), forward));
                    }
                }
            }
        }
    }
    let relative = joints
        .iter()
        .map(|joint| [0, 1, 2].map(|k| height * (joint[k] - pelvis[k])));
    relative.collect()
}

/// Names and rest positions of the joints of SMPL for a height in metres, relative to the pelvis: x left, y up, z
/// forward, arms along x.
#[must_use]
pub fn default_joints(height: f64) -> Vec<(String, [f64; 3])> {
    let names = Family::Smpl.joints().into_iter().map(|(name, _)| name);
    names.zip(default_rest(Family::Smpl, height)).collect()
}
