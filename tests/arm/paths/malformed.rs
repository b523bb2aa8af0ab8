//! Promise: an invalid path, or an invalid option of its solver, is an error that names the fault.

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathError, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::fault_tables::ExpectedError;

fn point(x: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, 0.0, 0.5))
}

#[test]
fn invalid_points_and_lists_are_named() {
    assert_eq!(CartesianPath::new(Vec::new()), Err(PathError::Empty));
    let invalid = CartesianPath::new(vec![point(0.4), point(f64::NAN)]);
    assert!(matches!(invalid, Err(PathError::Point { index: 1, .. })));
    let path = CartesianPath::new(vec![point(0.4), point(0.41)]).unwrap();
    let times = path.clone().with_times(vec![0.0]);
    assert_eq!(
        times.unwrap_err().to_string(),
        "times has 1 entries, the path has 2 points"
    );
    let times = path.clone().with_times(vec![0.0, 0.0]);
    times.says("point 1");
    let times = path.clone().with_times(vec![0.0, f64::NAN]);
    assert!(matches!(times, Err(PathError::Time { index: 1, .. })));
    assert!(matches!(
        path.with_tools(vec![0]),
        Err(PathError::Count { .. })
    ));
}

#[test]
fn invalid_curves_are_named() {
    let steps = CartesianPath::spline(vec![point(0.4), point(0.41)], None, 0);
    steps.says("steps");
    // Each number is finite, the distance between them is not.
    let path = CartesianPath::spline(vec![point(1.7e308), point(-1.7e308)], None, 2);
    assert!(matches!(path, Err(PathError::Curve(_))), "{path:?}");
}

#[test]
fn invalid_options_are_named() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let path = CartesianPath::new(vec![point(0.4), point(0.41)]).unwrap();
    let first = arm.joints().next().unwrap();
    let solver = || PathSolver::new(&arm);
    let error = |solver: PathSolver<'_>| solver.solve(&path).unwrap_err().to_string();
    assert!(error(solver().with_max_step(0.0)).contains("max_step"));
    assert!(error(solver().with_samples(0)).contains("samples"));
    assert!(error(solver().with_joint_weights(&[1.0])).contains(first));
    assert!(error(solver().with_joint_weights(&[0.0; 6])).contains("joint_weights"));
    assert!(error(solver().with_start(&[f64::NAN; 6])).contains(first));
    assert!(error(solver().with_start(&[0.0; 6])).contains("start"));
    assert!(error(solver().with_end(&[0.0; 6])).contains("end"));
    assert!(error(solver().with_times_kept(true)).contains("times"));
    let cyclic = path.clone().with_traversal(Traversal::Cyclic);
    let with_end = solver().with_end(&[0.0; 6]).solve(&cyclic);
    assert!(matches!(with_end, Err(PathError::Conflict(_))));
    let anywhere = path.clone().with_traversal(Traversal::AnyStart);
    let with_start = solver().with_start(&[0.0; 6]).solve(&anywhere);
    assert!(matches!(with_start, Err(PathError::Conflict(_))));
}

/// A joint value whole turns beyond its limit gives the same tool pose, but is not a valid end.
#[test]
fn ends_beyond_a_limit_are_rejected() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let within = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let path = CartesianPath::new(vec![arm.base_from_tool(&within).unwrap(); 2]).unwrap();
    let solver = || PathSolver::new(&arm);
    assert!(solver().with_start(&within).solve(&path).is_ok());
    for turns in [-2.0, 2.0] {
        let mut beyond = within;
        beyond[5] += turns * std::f64::consts::TAU;
        let ends = [
            ("start", solver().with_start(&beyond)),
            ("end", solver().with_end(&beyond)),
        ];
        for (end, solver) in ends {
            let refused = solver.solve(&path);
            assert!(
                matches!(refused, Err(PathError::End { which, .. }) if which == end),
                "{turns}"
            );
        }
    }
}
