//! Promise: on a closed curve that may be entered anywhere, the deviation of the step back to the entry is reported
//! like any other.

use std::f64::consts::TAU;

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;

#[test]
fn step_back_to_the_entry_reports_its_deviation() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let begin = arm.base_from_tool(&q).unwrap();
    // Two full rotations, for which the last joint of a Panda needs a reconfiguration anywhere: the path is entered
    // there. The path moves aside at once at the entry, and comes back gradually.
    let entry = 19;
    let turn = |k: usize| {
        let angle = 2.0 * TAU * k as f64 / 30.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        let aside = match k.checked_sub(entry) {
            Some(0 | 1) => 0.07,
            Some(2) => 0.045,
            Some(3) => 0.02,
            _ => 0.0,
        };
        Placement::new(turned, begin.translation + Vector3::new(0.0, aside, 0.0))
    };
    let keys: Vec<_> = (0..30).map(turn).collect();
    let curved = CartesianPath::spline(keys.clone(), None, 1).unwrap();
    let [straight, curved] = [CartesianPath::new(keys).unwrap(), curved].map(|path| {
        let path = path.with_traversal(Traversal::AnyStart);
        let solver = PathSolver::new(&arm).with_samples(24).with_max_step(0.5);
        solver.solve(&path).unwrap()
    });
    assert_eq!(curved.report.entry, entry);
    let reported = curved.report.largest_deviation;
    assert_eq!(reported.metres_at, 30);
    assert!(reported.metres > straight.report.largest_deviation.metres + 0.02);
}
