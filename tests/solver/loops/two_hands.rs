//! Promise: two hands on one box are a loop: both keep their grips for any motion of the box.

use kinopt::ik::LoopClosure;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Loop, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp, rotation_log};
use kinopt::task::{FramePose, Posture};
use kinopt::{Problem, Solver};

/// From each tool to the centre of the box, 0.4 m wide, held from both sides.
pub(crate) fn grips() -> [Placement<f64>; 2] {
    [1.0, -1.0].map(|side| {
        let turn = rotation_exp(Vector3::new(side * std::f64::consts::FRAC_PI_2, 0.0, 0.0));
        Placement::new(turn, Vector3::new(0.0, 0.0, 0.2))
    })
}

pub(crate) fn robot() -> Robot {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/rethink_baxter.urdf");
    let robot = Robot::read(file).unwrap();
    let tools = ["left_tool", "right_tool"].map(|name| robot.model().frame(name).unwrap());
    robot
        .with_loop(Loop::weld("box", tools).at(grips()))
        .unwrap()
}

/// Relative placement of the box in both hands: distance from the identity, metres and radians.
fn closure_error(model: &Model, q: &[f64]) -> [f64; 2] {
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(q).unwrap();
    let [left, right] = ["left_tool", "right_tool"].map(|name| model.frame(name).unwrap());
    let [one, other] = grips();
    let between = (placed[left.index()] * one).inverse() * (placed[right.index()] * other);
    [
        between.translation.norm(),
        rotation_log(&between.rotation).norm(),
    ]
}

#[test]
fn box_reaches_poses_that_both_hands_allow() {
    let robot = robot();
    let model = robot.model();
    let closure = LoopClosure::new(robot.parameters(), &model.moving_joints()[..1]).unwrap();
    let left = model.frame("left_tool").unwrap();
    let mut kinematics = ForwardKinematics::new(model);
    let mut reached = 0;
    let start = closure.random_configuration(1000).unwrap();
    for seed in 0..25 {
        let drawn = closure.random_configuration(seed).unwrap();
        let closure_errors = closure_error(model, &drawn);
        assert!(
            closure_errors.iter().all(|deviation| *deviation < 1.1e-9),
            "{closure_errors:?}"
        );
        let target = kinematics.place(&drawn).unwrap()[left.index()] * grips()[0];
        let mut problem = Problem::builder(model);
        problem.add(FramePose::new(left, target).with_tool(grips()[0]));
        problem.add(Posture::new(model, &start));
        let problem = problem.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        let closure_errors = closure_error(model, &solution.q);
        if solution.reached {
            assert!(
                closure_errors.iter().all(|deviation| *deviation < 1.1e-9),
                "{closure_errors:?}"
            );
            reached += 1;
        } else {
            assert_eq!(
                solution.loops_closed(),
                closure_errors.iter().all(|deviation| *deviation <= 1e-9),
                "{closure_errors:?}"
            );
        }
    }
    assert!(reached >= 24, "{reached} of 25");
}
