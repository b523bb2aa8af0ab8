//! Promise: a robot whose target is very low keeps its feet on the ground and not below it. It still follows, whether
//! the feet are in contact or slide.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};

use crate::retargeted_feet::{MAP, RATE, check_limits, legs, person};
use crate::retargeted_soles::SOLE;
use support::retargeted::mean_target_error;

/// A subject that moves down by `depth` metres and up again, and whose feet slide by `sliding` metres.
fn lowered(depth: f64, sliding: f64) -> Capture {
    let mut numbers = person();
    for (k, frame) in numbers.chunks_mut(27).enumerate() {
        let down = 0.5 * depth * (1.0 - (0.026 * k as f64).cos());
        let along = sliding * (0.08 * k as f64).sin();
        // Chest and hips, and the knees half as far.
        for (joints, down) in [([0, 1, 5].as_slice(), down), (&[2, 6], 0.5 * down)] {
            for joint in joints {
                frame[3 * joint + 2] -= down;
            }
        }
        for joint in [2, 3, 4, 6, 7, 8] {
            frame[3 * joint] += along;
        }
    }
    let joints = BodyMap::from_json(MAP, "legs").unwrap().joints;
    Capture::new(joints, &numbers, RATE).unwrap()
}

/// The target of the hips is below the ground, where the legs cannot fold further.
#[test]
fn feet_in_contact_are_not_pressed_into_the_ground() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = lowered(0.8, 0.0);
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    for found in [fitted.per_frame().unwrap(), fitted.whole().unwrap()] {
        check_limits(&robot, &found);
        assert!(
            found.report.ground_penetration < 1e-3,
            "{} m",
            found.report.ground_penetration
        );
        assert!(found.report.slip < 1e-3, "{} m", found.report.slip);
        assert!(
            found.report.lost_contacts.is_empty(),
            "{:?}",
            found.report.lost_contacts
        );
    }
}

/// A step that begins with feet on the ground's surface takes the ground into account. Without it the step is rejected,
/// and the robot is motionless from the first frame on.
#[test]
fn sliding_feet_do_not_stop_the_robot() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    for depth in [0.0, 0.4] {
        let capture = lowered(depth, 0.15);
        let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
        let found = fitted.per_frame().unwrap();
        check_limits(&robot, &found);
        assert!(found.report.contacts.iter().all(|in_contact| !in_contact));
        assert!(
            mean_target_error(&fitted, &found) < 0.07,
            "{} m",
            mean_target_error(&fitted, &found)
        );
        assert!(
            found.report.ground_penetration < 8e-4,
            "{} m",
            found.report.ground_penetration
        );
    }
}

/// A motion solved as a whole begins with the result frame by frame.
#[test]
fn sliding_feet_stay_above_ground_solved_as_a_whole() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = lowered(0.8, 0.15);
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = fitted.whole().unwrap();
    check_limits(&robot, &found);
    assert!(
        found.report.ground_penetration < 1.5e-3,
        "{} m",
        found.report.ground_penetration
    );
}
