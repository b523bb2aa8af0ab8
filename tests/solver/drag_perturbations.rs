//! Promise: a drag at an unstable equilibrium is perturbed and then reaches its target, whatever its soft tasks lose.

use kinopt::Solver;
use kinopt::ik::Drag;
use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::Stopping;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Distance, Point, Posture, Quantity, Task};
use support::planar_arm;

#[test]
fn stretched_arm_bends_for_a_target_on_its_line() {
    let model = planar_arm(&[1.0, 1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
    builder.add(Task::new(Posture::new(&model, &[0.0, 0.0])).scale(100.0));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
    assert!(!drag.advance().reached && drag.q() == [0.0, 0.0]);
    // On the arm's line, where the gradient is zero.
    drag.target_mut(hand).unwrap().set_target([1.7, 0.0, 0.0]);
    let reached = (0..30).any(|_| drag.advance().reached);
    assert!(reached, "{}", drag.solution().explain());
}

/// The perturbation comes with the first frame that settles on a miss, also after earlier misses.
#[test]
fn miss_after_a_success_is_perturbed_at_once() {
    let model = planar_arm(&[1.0, 1.0], Some((-1.0, 2.0)));
    for misses in 1..6 {
        let mut builder = Problem::builder(&model);
        let hand = builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
        let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
        let mut to = |x: f64| {
            drag.target_mut(hand).unwrap().set_target([x, 0.0, 0.0]);
            drag.advance().reached
        };
        assert!((0..misses).all(|_| !to(2.5)));
        assert!(to(2.0), "stretched as it is");
        assert!(to(1.998), "after {misses} misses");
    }
}

/// A miss is at rest only after perturbations found no improvement.
#[test]
fn miss_rests_after_its_perturbations() {
    let model = planar_arm(&[1.0, 1.0], Some((-1.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [2.5, 0.0, 0.0]));
    let mut drag = Drag::new(builder.build().unwrap(), &[0.0, 0.0]).unwrap();
    let awake = (0..20).take_while(|_| {
        drag.advance();
        !drag.is_at_rest()
    });
    assert_eq!(awake.count(), 4);
}

/// The perturbation of a prismatic joint is relative to the model's size, so frames are equal in all units.
#[test]
fn perturbation_scales_with_the_model() {
    let slid = |unit: f64| {
        let mut builder = Model::builder("slide");
        let axis = Vector3::new(1.0, 0.0, 0.0);
        let limits = Limits::new(-unit, 3.0 * unit);
        let slide = builder.prismatic("slide", None, Placement::identity(), axis, limits);
        let rider = builder.frame("rider", Some(slide), Placement::identity());
        let aside = Placement::translation([0.0, unit, 0.0].into());
        let post = builder.frame("post", None, aside);
        let model = builder.build().unwrap();
        // Slightly farther than the closest point: both directions are equally good, and the derivative is zero.
        let mut builder = Problem::builder(&model);
        let distance = f64::hypot(1.0, 0.02) * unit;
        builder.add(Distance::new(rider, post, distance));
        builder.tolerance(Quantity::Metres, 1e-6 * unit);
        let drag = Drag::new(builder.build().unwrap(), &[0.0]).unwrap();
        let once = Stopping::default().with_max_iterations(1);
        let mut drag = drag.with_solver(Solver::default(), once).unwrap();
        drag.advance();
        drag.q()[0] / unit
    };
    let metres = slid(1.0);
    assert!(metres > 1e-3, "{metres}");
    for unit in [1024.0, 1.0 / 1024.0] {
        let other = slid(unit);
        assert!((other - metres).abs() < 1e-9, "{unit}: {other} {metres}");
    }
}
