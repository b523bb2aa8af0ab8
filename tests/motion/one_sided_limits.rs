//! Promise: a single limit holds in every frame from any start of the search, and is reported exactly where it is
//! active.

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{MotionProblem, MotionSolver, MotionTermination, RateCost};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;

const FRAMES: usize = 30;

#[test]
fn prismatic_joint_stops_at_its_single_limit() {
    for side in [-1.0, 1.0] {
        let limits = match side < 0.0 {
            true => Limits::new(-0.5, f64::INFINITY),
            false => Limits::new(f64::NEG_INFINITY, 0.5),
        };
        let mut builder = Model::builder("rail");
        let x = Vector3::UNITS[0];
        let slide = builder.prismatic("slide", None, Placement::identity(), x, limits);
        let tool = builder.frame("tool", Some(slide), Placement::identity());
        let model = builder.build().unwrap();
        let mut motion = MotionProblem::builder(&model, FRAMES, 0.1);
        let point = motion.add(Point::new(tool, [0.0; 3]));
        // As far beyond the limit as in the other direction.
        let target_at = move |frame: usize| side * (frame as f64 / 10.0 - 2.0);
        motion.follow(point, move |frame, point| {
            point.set_target([target_at(frame), 0.0, 0.0]);
        });
        motion.rate_cost(RateCost::velocity(1e-6));
        let motion = motion.build().unwrap();
        for start in [0.0, 3.0 * side, -3.0 * side] {
            let start = [start; FRAMES];
            let solved = MotionSolver::default().solve_near(&motion, &start).unwrap();
            assert_eq!(solved.report.termination(), MotionTermination::Stationary);
            for frame in 0..FRAMES {
                let at = side * solved.row(frame).unwrap()[0];
                let expected = (side * target_at(frame)).min(0.5);
                assert!(at <= 0.5 && (at - expected).abs() < 1e-3, "{frame}: {at}");
                let reported = solved.report.active_limits(frame).count();
                // If the limit is just reached, either report is accepted.
                if (side * target_at(frame) - 0.5).abs() > 0.06 {
                    assert_eq!(
                        reported,
                        usize::from(side * target_at(frame) > 0.5),
                        "{frame}"
                    );
                }
            }
        }
    }
}
