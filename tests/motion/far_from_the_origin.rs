//! Promise: a robot far from the origin follows as accurately as near it.

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};

use crate::retargeted_feet::{MAP, RATE, legs, person};

/// The normal equations are summed relative to the robot. About the origin they would lose twice the digits of the
/// distance.
#[test]
fn distant_subject_is_followed_equally() {
    let robot = legs("");
    let map = BodyMap::from_json(MAP, "legs").unwrap();
    let at = |offset: f64| {
        let mut numbers = person();
        for position in numbers.chunks_mut(3) {
            position[0] += offset;
            position[1] -= offset;
        }
        let capture = Capture::new(map.joints.clone(), &numbers, RATE).unwrap();
        let fitted = Retargeting::new(&robot, &map, &capture, RetargetOptions::default()).unwrap();
        fitted.per_frame().unwrap()
    };
    let (near, distance) = (at(0.0), 1e4);
    let far = at(distance);
    let frames = near.rows();
    for (near, far) in frames.zip(far.q.chunks(near.nq)) {
        // Except for the base position, which is rounded at its own size.
        let apart = near[3..].iter().zip(&far[3..]).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-12 * distance, "{apart}");
    }
}
