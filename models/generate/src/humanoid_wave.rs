//! Keyframes of the humanoid: it raises its right arm and waves.

use kinopt::animation::{EulerClip, EulerKey, EulerTrack};
use kinopt::skeleton::Skeleton;

use crate::Failure;

/// Key times, seconds: arm up, four swings of the forearm, arm down.
const TIMES: [f64; 8] = [0.0, 0.7, 1.0, 1.3, 1.6, 1.9, 2.2, 3.0];

/// Clip from degrees at each time. The second twist rotates the arm's swing from forward to upward; the bend raises
/// it.
pub(crate) fn clip(skeleton: &Skeleton) -> Result<EulerClip, Failure> {
    let still = [0.0; 8];
    let while_up = |degrees: f64| {
        let [first, .., last] = TIMES;
        TIMES.map(|time| {
            if time == first || time == last {
                0.0
            } else {
                degrees
            }
        })
    };
    let swing = [0.0, 70.0, 30.0, 70.0, 30.0, 70.0, 50.0, 0.0];
    let wrist = [0.0, 0.0, -12.0, 12.0, -12.0, 12.0, 0.0, 0.0];
    let sway = [0.0, -3.0, 2.0, -2.0, 2.0, -2.0, 0.0, 0.0];
    let tracks = [
        ("chest", [still, sway, still]),
        ("head", [still, while_up(6.0), still]),
        ("left_upper_arm", [still, while_up(6.0), still]),
        ("left_forearm", [still, while_up(15.0), still]),
        ("right_upper_arm", [still, while_up(75.0), while_up(80.0)]),
        ("right_forearm", [still, swing, still]),
        ("right_hand", [still, wrist, still]),
    ];
    let mut list = Vec::new();
    for (name, [first, bend, second]) in tracks {
        let keys = TIMES.iter().enumerate().map(|(key, &time)| EulerKey {
            time,
            angles: [first, bend, second].map(|degrees| degrees[key].to_radians()),
        });
        list.push(EulerTrack {
            bone: skeleton.bone(name)?,
            keys: keys.collect(),
        });
    }
    Ok(EulerClip::new(list)?)
}
