//! Promise: a parallelogram gripper without coupled joints opens both fingers equally and keeps them parallel.

use kinopt::ik::LoopClosure;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointId, Model, ParameterMap};
use kinopt::task::Point;
use kinopt::{Problem, Solver};
use support::fault_tables::ExpectedError;

use crate::loops::mechanisms::Gripper;

/// Checks that fingers are parallel to the palm and that rods keep their length. Tips must be symmetric and at the
/// position of the crank angle.
fn assert_gripper(model: &Model, q: &[f64]) {
    let [out, arm, _, hole, rod] = Gripper::SIZES;
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(q).unwrap();
    let at = |name: &str| placed[model.frame(name).unwrap().index()];
    let angle = q[model
        .coordinate(model.joint("right crank").unwrap())
        .unwrap()];
    let (sin, cos) = angle.sin_cos();
    for (side, s) in [("left", -1.0), ("right", 1.0)] {
        let tip = at(&format!("{side} tip"));
        let turned = (tip.rotation.x.y, tip.rotation.x.x);
        assert!(turned.0.abs() < 1e-7 && turned.1 > 0.0, "{turned:?}");
        let expected = [s * (out + arm * cos), arm * sin + 0.08];
        let deviation = (tip.translation.x - expected[0]).hypot(tip.translation.y - expected[1]);
        assert!(deviation < 1e-8, "{side}: {deviation:e}");
    }
    let across = out + hole * cos;
    let along = hole * sin - q[model.coordinate(model.joint("push").unwrap()).unwrap()];
    assert!((across.hypot(along) - rod).abs() < 1e-8);
}

/// Half open.
pub(crate) fn begin(model: &Model) -> Vec<f64> {
    let mut q = model.neutral();
    for (name, value) in [
        ("left crank", 0.8),
        ("right crank", 0.8),
        ("left second", 0.8),
        ("right second", 0.8),
        ("left finger", -0.8),
        ("right finger", -0.8),
        ("left rod", 0.5),
        ("right rod", 0.5),
        ("push", -0.01),
    ] {
        q[model.coordinate(model.joint(name).unwrap()).unwrap()] = value;
    }
    q
}

#[test]
fn prismatic_joint_moves_both_fingers() {
    let model = Gripper::model();
    let push = model.joint("push").unwrap();
    let moving = model.moving_joints().iter().copied();
    let dependent: Vec<JointId> = moving.filter(|id| *id != push).collect();
    let closure = LoopClosure::new(ParameterMap::builder(&model), &dependent).unwrap();
    let mut q = begin(&model);
    for k in 0..20 {
        q[model.coordinate(push).unwrap()] = -0.004 - 0.0006 * f64::from(k);
        closure.close(&mut q).unwrap();
        assert_gripper(&model, &q);
    }
    // Farther than the rods' length.
    q[model.coordinate(push).unwrap()] = -0.09;
    closure.close(&mut q).says("loop `left push` is open by");
}

#[test]
fn other_finger_follows_a_targeted_finger() {
    let model = Gripper::model();
    let tip = model.frame("right tip").unwrap();
    let [out, arm, ..] = Gripper::SIZES;
    for k in 0..10 {
        let angle = 0.5 + 0.06 * f64::from(k);
        let (sin, cos) = f64::sin_cos(angle);
        let mut problem = Problem::builder(&model);
        problem.add(Point::new(tip, [out + arm * cos, arm * sin + 0.08, 0.0]));
        let problem = problem.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &begin(&model))
            .unwrap();
        assert!(solution.reached, "{}", solution.explain());
        assert_gripper(&model, &solution.q);
    }
}
