//! Promise: a mimic joint keeps its own velocity limit, which bounds its source joint by their ratio and no more.

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use kinopt::robot::{Mimic, Robot};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;

/// A prismatic joint whose tool should jump by 1 m, and its mimic joint with a velocity limit of 0.5 m/s.
#[test]
fn source_joint_is_as_fast_as_its_mimic_joint_allows() {
    let (at, limits) = (Placement::identity(), Limits::new(-4.0, 4.0));
    let [x, y, _] = Vector3::UNITS;
    for ratio in [-2.5, 0.4] {
        let mut builder = Model::builder("press");
        let leader = builder.prismatic("leader", None, at, x, limits);
        let follower = builder.prismatic("follower", None, at, y, limits);
        let tool = builder.frame("tool", Some(leader), at);
        let follows = Mimic {
            joint: follower,
            master: leader,
            ratio,
            offset: 0.1,
        };
        let robot = Robot::new(builder.build().unwrap(), vec![follows]).unwrap();
        let mut motion = MotionProblem::builder(robot.model(), 80, 0.1);
        motion.parameters(robot.map().clone());
        let task = motion.add(Point::new(tool, [0.0; 3]));
        motion.follow(task, |frame, point| {
            point.set_target([if frame < 5 { 0.0 } else { 1.0 }, 0.0, 0.0])
        });
        motion.max_speed("follower", 0.5);
        motion.rate_cost(RateCost::velocity(1e-4));
        let motion = motion.build().unwrap();
        let solved = MotionSolver::default().solve(&motion, &[0.0, 0.1]).unwrap();
        let steps = (1..80).map(|frame| {
            let [before, after] = [frame - 1, frame].map(|frame| solved.row(frame).unwrap());
            (after[1] - before[1]).abs()
        });
        let largest = steps.fold(0.0, f64::max);
        assert!(
            largest <= 0.05 + 1e-12 && largest > 0.049,
            "{ratio}: {largest}"
        );
        let last = solved.row(79).unwrap();
        assert!((last[0] - 1.0).abs() < 1e-3, "{ratio}: {last:?}");
    }
}
