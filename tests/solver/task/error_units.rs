//! Promise: a task's error is reported, weighted and judged in the unit of its quantity. The unit is metres or radians;
//! for a joint coupling it is that of the first joint.

use kinopt::Problem;
use kinopt::model::{Limits, Model};
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{
    Bounded, Distance, FramePose, FrameVelocity, Gaze, JointCoupling, LimitCentring, LookAt,
    Orientation, Plane, Point, Posture, Quantity, Ray, Residual, Smoothness, Task,
};

fn quantities(residual: &impl Residual) -> Vec<Quantity> {
    let rows = residual.rows();
    rows.iter().map(|rows| rows.quantity).collect()
}

#[test]
fn every_task_has_the_unit_of_its_quantity() {
    use Quantity::{
        JointUnits, JointUnitsPerSecond, Metres, MetresPerSecond, Radians, RadiansPerSecond, Ratio,
    };
    let mut builder = Model::builder("crane");
    let (x, z, identity) = (Vector3::UNITS[0], Vector3::UNITS[2], Placement::identity());
    let limits = Limits::new(-1.0, 1.0);
    let hinge = builder.revolute("hinge", None, identity, z, limits);
    let slide = builder.prismatic("slide", Some(hinge), identity, x, limits);
    let base = builder.frame("base", Some(hinge), identity);
    let hook = builder.frame("hook", Some(slide), Placement::translation(x));
    let model = builder.build().unwrap();
    let q = model.neutral();
    let pair = |a, b| JointCoupling::new(&model, [(a, 1.0), (b, 2.0)], 0.3);
    let slow = FrameVelocity::new(hook, identity, 0.1, ([0.0; 3], z));
    for (reported, expected) in [
        (quantities(&pair(hinge, slide)), vec![Radians]),
        (quantities(&pair(slide, hinge)), vec![Metres]),
        (quantities(&Point::new(hook, x)), vec![Metres]),
        (quantities(&Ray::new(hook, z, x)), vec![Metres]),
        (quantities(&Distance::new(base, hook, 0.5)), vec![Metres]),
        (quantities(&Plane::new(hook, x, z)), vec![Metres]),
        (
            quantities(&Orientation::new(hook, Matrix3::identity())),
            vec![Radians],
        ),
        (quantities(&LookAt::new(hook, x, z)), vec![Radians]),
        (quantities(&Gaze::along(hook, x, z, 0.1)), vec![Radians]),
        (
            quantities(&FramePose::new(hook, identity)),
            vec![Metres, Radians],
        ),
        (quantities(&slow), vec![MetresPerSecond, RadiansPerSecond]),
        (quantities(&Posture::new(&model, &q)), vec![JointUnits]),
        (
            quantities(&Smoothness::new(&model, &q, 0.1)),
            vec![JointUnitsPerSecond],
        ),
        (quantities(&LimitCentring::new(&model)), vec![Ratio]),
        // Bounds do not change the unit.
        (
            quantities(&Bounded::at_least(pair(slide, hinge), 0.0)),
            vec![Metres],
        ),
    ] {
        assert_eq!(reported, expected);
    }

    // A weight on metres applies to a coupling of prismatic joints; one on radians does not.
    let slope = |quantity| {
        let mut tasks = Problem::builder(&model);
        tasks.add(Task::new(pair(slide, hinge)).weight(quantity, 3.0));
        let problem = tasks.build().unwrap();
        let mut residual = [0.0];
        let scratch = &mut problem.scratch();
        Evaluation::new(&problem, scratch).residual(&[0.1, 0.2], &mut residual);
        residual[0]
    };
    // 0.2 + 2 · 0.1 − 0.3.
    assert!((slope(Metres) - 0.3).abs() < 1e-15);
}
