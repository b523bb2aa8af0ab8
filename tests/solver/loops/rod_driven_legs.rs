//! Promise: in a leg with rod-driven knee and ankle, read from an MJCF file, passive joints follow the motors. Every
//! solution keeps the rods' lengths.

use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::task::{FramePose, Point};
use kinopt::{Problem, Solver};

fn leg() -> Robot {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/solver/loops/files/knee.xml");
    Robot::read_mjcf(file).unwrap()
}

/// Distances from the crank's pin to the lever's, by body frames and the file's anchor points.
fn rods(robot: &Robot, q: &[f64]) -> [f64; 2] {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(q).unwrap();
    let mut lengths = [0.0; 2];
    for (length, rod_loop) in lengths.iter_mut().zip(model.loops()) {
        let [rod, lever] = rod_loop.frames.map(|frame| placed[frame.index()]);
        let pin = lever.apply(rod_loop.frame_from_place[1].translation);
        *length = (pin - rod.translation).norm();
    }
    lengths
}

fn assert_rods(robot: &Robot, q: &[f64]) {
    // From the file, pin to pin: (0.01, -0.012, -0.4) and (0.005, 0, -0.38).
    let drawn = [0.01_f64.hypot(0.012).hypot(0.4), 0.005_f64.hypot(0.38)];
    for (actual, drawn) in rods(robot, q).into_iter().zip(drawn) {
        assert!((actual - drawn).abs() < 1.1e-9, "{actual} {drawn}");
    }
}

#[test]
fn undriven_joints_are_passive() {
    let robot = leg();
    let model = robot.model();
    let name = |id: &kinopt::model::JointId| model.joints()[id.index()].name.as_str();
    let passive: Vec<_> = robot.passive_joints().iter().map(name).collect();
    let body = ["base/x", "base/y", "base/z", "base/rotation"];
    let expected = ["knee_rod", "knee", "ankle_rod", "ankle"];
    assert_eq!(passive, [&body[..], &expected[..]].concat());
    let closure = robot.loop_closure().unwrap();
    let dependent: Vec<_> = closure.dependent().iter().map(name).collect();
    assert_eq!(dependent, expected);
}

#[test]
fn motors_bend_knee_and_ankle() {
    let robot = leg();
    let model = robot.model();
    let closure = robot.loop_closure().unwrap();
    let at = |name| model.coordinate(model.joint(name).unwrap()).unwrap();
    let mut q = model.neutral();
    let mut last = f64::NEG_INFINITY;
    for k in 0..20 {
        let motor = 0.04 * f64::from(k);
        q[at("knee_motor")] = motor;
        q[at("ankle_motor")] = 0.5 * motor;
        closure.close(&mut q).unwrap();
        assert_eq!((q[at("knee_motor")], q[at("hip")]), (motor, 0.0));
        assert_rods(&robot, &q);
        // The rod pulls the shank's lever up and the knee bends further.
        assert!(q[at("knee")] > last);
        last = q[at("knee")];
    }
    assert!(last > 0.8, "{last}");
}

#[test]
fn foot_reaches_random_closed_configurations() {
    let robot = leg();
    let model = robot.model();
    let closure = robot.loop_closure().unwrap();
    let (foot, pelvis) = (model.frame("foot").unwrap(), model.frame("pelvis").unwrap());
    let toe = model.frame("toe").unwrap();
    let mut kinematics = ForwardKinematics::new(model);
    let mut reached = 0;
    for seed in 0..40 {
        let drawn = closure.random_configuration(seed).unwrap();
        assert!(model.is_within_limits(&drawn));
        assert_rods(&robot, &drawn);
        let placed = kinematics.place(&drawn).unwrap();
        let mut problem = Problem::builder(model);
        problem.add(FramePose::new(pelvis, placed[pelvis.index()]));
        problem.add(Point::new(foot, placed[foot.index()].translation));
        problem.add(Point::new(toe, placed[toe.index()].translation));
        let problem = problem.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &model.neutral())
            .unwrap();
        if solution.reached {
            assert!(solution.loops_closed());
            assert_rods(&robot, &solution.q);
            reached += 1;
        }
    }
    assert!(reached >= 39, "{reached} of 40");
}
