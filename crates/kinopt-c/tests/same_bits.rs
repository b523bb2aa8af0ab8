//! Promise: results of the C interface are bitwise those of Rust.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "a test that calls the C interface"
)]

use std::ffi::CString;
use std::ptr::{null, null_mut};

use kinopt::robot::Robot;
use kinopt::spatial::Placement;
use kinopt_bindings::placement::to_columns;
use kinopt_c::KinoptStatus;
use kinopt_c::arm::{kinopt_arm_free, kinopt_arm_new, kinopt_arm_solve};
use kinopt_c::problem::{kinopt_problem_free, kinopt_problem_new};
use kinopt_c::robot::{kinopt_robot_free, kinopt_robot_read};
use kinopt_c::servo::{kinopt_servo_free, kinopt_servo_new, kinopt_servo_step};
use kinopt_c::solution::{kinopt_solution_free, kinopt_solution_new, kinopt_solution_q};

const NAO: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../models/aldebaran_nao.urdf"
);
const PANDA: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../models/franka_panda.urdf"
);

#[test]
fn poses_and_servo_equal_those_of_rust() {
    let robot = Robot::read(PANDA).unwrap();
    let arm = kinopt::Arm::new(&robot, "base", "flange").unwrap();
    let start = arm.default_start();
    let limits: Vec<_> = arm.limits().collect();
    // Poses of configurations within the limits, and one out of reach.
    let targets = (0..40).map(|query| {
        let at = |joint: usize| 0.5 + 0.45 * (f64::from(query) * 1.7 + joint as f64).sin();
        let within = limits.iter().enumerate();
        let q = within.map(|(joint, range)| range.lower + at(joint) * (range.upper - range.lower));
        arm.base_from_tool(&q.collect::<Vec<_>>()).unwrap()
    });
    let mut targets: Vec<Placement<f64>> = targets.collect();
    targets[39].translation.x = 5.0;

    // SAFETY: the pointers are those of live objects, arrays and texts of the stated lengths.
    unsafe {
        let text = |text: &str| CString::new(text).unwrap();
        let (path, base, tip) = (text(PANDA), text("base"), text("flange"));
        let (mut c_robot, mut c_arm) = (null_mut(), null_mut());
        let (mut solution, mut servo) = (null_mut(), null_mut());
        let check = |status| assert_eq!(status, KinoptStatus::Ok);
        check(kinopt_robot_read(path.as_ptr(), null(), &mut c_robot));
        check(kinopt_arm_new(
            c_robot,
            base.as_ptr(),
            tip.as_ptr(),
            null(),
            &mut c_arm,
        ));
        check(kinopt_solution_new(&mut solution));
        for target in &targets {
            let columns = to_columns(target);
            check(kinopt_arm_solve(
                c_arm,
                columns.as_ptr(),
                start.as_ptr(),
                7,
                solution,
            ));
            let q = std::slice::from_raw_parts(kinopt_solution_q(solution, null_mut()), 7);
            assert_eq!(q, arm.solve(*target, start).unwrap().q);
        }

        let mut of_rust = arm.servo(start, 1e-3).unwrap();
        check(kinopt_servo_new(
            c_arm,
            start.as_ptr(),
            7,
            1e-3,
            null(),
            &mut servo,
        ));
        let mut q = [0.0; 7];
        for target in targets.iter().flat_map(|target| [target; 25]) {
            let columns = to_columns(target);
            check(kinopt_servo_step(
                servo,
                columns.as_ptr(),
                q.as_mut_ptr(),
                7,
                null_mut(),
            ));
            assert_eq!(q, *of_rust.step(*target).unwrap().q);
        }
        kinopt_servo_free(servo);
        kinopt_solution_free(solution);
        kinopt_arm_free(c_arm);
        kinopt_robot_free(c_robot);
    }
}

#[test]
fn task_of_the_centre_of_mass_has_the_masses_of_the_robot() {
    // SAFETY: the pointers are those of live objects and texts.
    unsafe {
        let text = |text: &str| CString::new(text).unwrap();
        let path = text(NAO);
        let tasks = text(r#"[{"kind": "center of mass", "target": [0.0, 0.0, 0.3]}]"#);
        let (mut robot, mut problem) = (null_mut(), null_mut());
        let free = text(r#"{"base_joint": "free"}"#);
        let read = kinopt_robot_read(path.as_ptr(), free.as_ptr(), &mut robot);
        assert_eq!(read, KinoptStatus::Ok);
        let created = kinopt_problem_new(
            robot,
            tasks.as_ptr(),
            null(),
            null(),
            0.0,
            null(),
            &mut problem,
        );
        assert_eq!(created, KinoptStatus::Ok);
        kinopt_problem_free(problem);
        kinopt_robot_free(robot);
    }
}
