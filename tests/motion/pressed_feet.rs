//! Promise: a body that is led far down presses its feet onto the ground and not into it, and follows all the same, whether they
//! stand or slide.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};

use crate::retargeted_feet::{MAP, RATE, check_limits, legs, person};
use crate::retargeted_soles::SOLE;

/// A person who goes down by so much more, metres, and up again, and whose feet slide so far, if they do.
fn led_down(by: f64, sliding: f64) -> Capture {
    let mut numbers = person();
    for (k, frame) in numbers.chunks_mut(27).enumerate() {
        let down = 0.5 * by * (1.0 - (0.026 * k as f64).cos());
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

/// The hips are led to below the ground, where the legs fold no further: pressed against a spring, feet stood 1.4 mm deep.
#[test]
fn feet_that_stand_are_pressed_onto_the_ground() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = led_down(0.8, 0.0);
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    for found in [fitted.per_frame().unwrap(), fitted.whole().unwrap()] {
        check_limits(&robot, &found);
        assert!(found.sunk < 8e-4, "{} m", found.sunk);
        assert!(found.slip < 1e-3, "{} m", found.slip);
        assert!(found.given_up.is_empty(), "{:?}", found.given_up);
    }
}

/// Every step that began with the feet on the ground's edge led into it, as nothing told of the ground there, and was refused: the
/// body stood still from the first frame on, 155 mm off in the mean.
#[test]
fn feet_that_slide_over_the_ground_stop_no_body() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    for by in [0.0, 0.4] {
        let capture = led_down(by, 0.15);
        let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
        let found = fitted.per_frame().unwrap();
        check_limits(&robot, &found);
        assert!(found.contacts.iter().all(|stands| !stands));
        assert!(found.mean_error < 0.07, "{} m", found.mean_error);
        assert!(found.sunk < 8e-4, "{} m", found.sunk);
    }
}

/// A whole movement begins where frame by frame leads: from the body that stood still it came to feet 7.2 mm deep.
#[test]
fn feet_that_slide_are_over_the_ground_in_a_whole_movement() {
    let robot = legs(SOLE);
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let capture = led_down(0.8, 0.15);
    let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
    let found = fitted.whole().unwrap();
    check_limits(&robot, &found);
    assert!(found.sunk < 1.5e-3, "{} m", found.sunk);
}
