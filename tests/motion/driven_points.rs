//! Promise: a driven point of a frame moves as a frame at that point would.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};

use crate::retargeted_feet::{MAP, RATE, check_limits, legs, person};

/// Offset of the subject's hips from the joints of the model's thighs, metres.
const HIP_OFFSET: [f64; 3] = [0.03, 0.02, 0.06];

#[test]
fn driven_points_move_as_frames_at_these_points() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = Capture::new(map.joints.clone(), &person(), RATE).unwrap();
    let [mut by_points, mut by_frames] = [map.clone(), map];
    for drive in &mut by_points.drives {
        if drive.frame.ends_with("_thigh") {
            drive.offset = HIP_OFFSET.into();
        }
    }
    for drive in &mut by_frames.drives {
        drive.frame = drive.frame.replace("_thigh", "_hip_mark");
    }
    let options = RetargetOptions::default();
    let [points, frames] = [by_points, by_frames]
        .map(|map| Retargeting::new(&robot, &map, &capture, options.clone()).unwrap());
    let [by_points, by_frames] =
        [&points, &frames].map(|retargeting| retargeting.per_frame().unwrap());
    // Errors are measured at the points.
    let [errors, of_frames] = [(&points, &by_points), (&frames, &by_frames)]
        .map(|(retargeting, found)| retargeting.errors(found).unwrap());
    let deviation = errors.iter().zip(&of_frames).map(|(a, b)| (a - b).abs());
    assert!(deviation.fold(0.0, f64::max) < 1e-6);
    check_limits(&robot, &by_points);
    let ends = by_points.q.iter().zip(&by_frames.q);
    let deviation = ends.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(deviation < 1e-6, "{deviation}");
}
