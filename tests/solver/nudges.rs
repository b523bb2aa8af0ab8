//! Promise: a body in balance on a target that it could reach is nudged off, whatever its preferences lose by it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::ik::Drag;
use kinopt::problem::Problem;
use kinopt::task::{Point, Posture, Task};
use support::planar_arm;

#[test]
fn a_stretched_arm_bends_for_a_target_behind_its_hand() {
    let model = planar_arm(&[1.0, 1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
    builder.add(Task::new(Posture::new(&model, &[0.0, 0.0])).times(100.0));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
    assert!(!drag.advance().reached && drag.q() == [0.0, 0.0]);
    // In line with the arm, which feels nothing of it.
    drag.residual_mut(hand).unwrap().set_target([1.7, 0.0, 0.0]);
    let reached = (0..30).any(|_| drag.advance().reached);
    assert!(reached, "{}", drag.solution().explain());
}

/// A nudge comes with the first frame that settles on a miss, also where another miss was before.
#[test]
fn after_a_target_that_was_reached_the_next_miss_is_nudged_at_once() {
    let model = planar_arm(&[1.0, 1.0], Some((-1.0, 2.0)));
    for misses in 1..6 {
        let mut builder = Problem::builder(&model);
        let hand = builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
        let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
        let mut to = |x: f64| {
            drag.residual_mut(hand).unwrap().set_target([x, 0.0, 0.0]);
            drag.advance().reached
        };
        assert!((0..misses).all(|_| !to(2.5)));
        assert!(to(2.0), "stretched as it is");
        assert!(to(1.998), "after {misses} misses");
    }
}

/// A miss is at rest only when nudges have shown that there is nowhere to go.
#[test]
fn a_miss_rests_after_its_nudges() {
    let model = planar_arm(&[1.0, 1.0], Some((-1.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
    let awake = (0..20).take_while(|_| {
        drag.advance();
        !drag.rests()
    });
    assert_eq!(awake.count(), 4);
}
