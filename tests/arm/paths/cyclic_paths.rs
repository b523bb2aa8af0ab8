//! Promise: a closed path of a redundant arm has the same length from any starting point. This includes paths with a
//! full turn of a joint without limits.

use std::f64::consts::TAU;

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::with_endless_joint;

#[test]
fn turning_joint_gives_equal_length_from_any_point() {
    let robot = with_endless_joint("franka_panda", "joint7");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let down = rotation_exp(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
    let point = |k: u32| {
        let angle = TAU * f64::from(k) / 50.0;
        let (sin, cos) = angle.sin_cos();
        let at = Vector3::new(0.45 + 0.12 * cos, 0.2 * sin, 0.3);
        Placement::new(rotation_exp(Vector3::new(0.0, 0.0, angle)) * down, at)
    };
    let lengths = [0, 20].map(|begin| {
        let points: Vec<_> = (begin..begin + 50).map(point).collect();
        let path = CartesianPath::new(points).unwrap();
        let path = path.with_traversal(Traversal::Cyclic);
        let reported = PathSolver::new(&arm)
            .with_max_step(0.4)
            .solve(&path)
            .unwrap();
        assert!(reported.reached(), "{:?}", reported.jumps);
        let rows: Vec<&[f64]> = reported.rows().collect();
        let back = rows[49].iter().zip(rows[0]).map(|(a, b)| (a - b).abs());
        let back: Vec<f64> = back.collect();
        assert!((back[6] - TAU).abs() < 0.3 && back[..6].iter().all(|by| *by < 0.2));
        reported.report.length
    });
    let (shortest, longest) = (lengths.iter())
        .fold((f64::MAX, 0.0_f64), |(shortest, longest), length| {
            (shortest.min(*length), longest.max(*length))
        });
    assert!(longest < shortest * (1.0 + 5e-4), "{lengths:?}");
}
