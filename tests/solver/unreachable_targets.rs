//! Promise: an unreachable target gives the closest point, `reached: false` and the active limits.

use kinopt::ik::{Restarts, Side};
use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::{FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient, Termination};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Solution, Solver};
use nalgebra as na;
use support::random::Random;
use support::{planar_arm, planar_tip};

/// Methods that converge in 200 iterations here; fixed-step descent is in the battery.
fn quick_solvers() -> [Solver; 3] {
    [
        Solver::new(LevenbergMarquardt::default()),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}

fn solve(solver: &Solver, model: &Model, target: na::Vector3<f64>, start: &[f64]) -> Solution {
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame("tip").unwrap(), target));
    let problem = builder.build().unwrap();
    solver.solve_once(&problem, start).unwrap()
}

#[test]
fn target_beyond_a_stretched_arm() {
    let links = [0.7, 0.5, 0.4];
    let length: f64 = links.iter().sum();
    let model = planar_arm(&links, Some((-1.5, 1.5)));
    let mut random = Random::new(1);
    for k in 0..10 {
        let heading = random.within(-1.2, 1.2);
        let distance = length + [1e-3, 0.1, 1.0, 50.0][k % 4];
        let target = na::Vector3::new(heading.cos(), heading.sin(), 0.0) * distance;
        for solver in quick_solvers() {
            let solution = solve(&solver, &model, target, &[0.1, 0.2, -0.3]);
            let name = solver.method();
            assert!(!solution.reached, "{name}");
            let missed = (planar_tip(&links, &solution.q) - target).norm();
            assert!(
                (missed - (distance - length)).abs() < 1e-9,
                "{name}: {missed}"
            );
            let reported = solution.tasks().next().unwrap().position_error().unwrap();
            assert!((reported - missed).abs() < 1e-12);
            let explanation = solution.explain();
            assert!(explanation.starts_with("Not reached"), "{explanation}");
            assert!(
                explanation.contains("point of `tip` misses by"),
                "{explanation}"
            );
        }
    }
}

#[test]
fn target_in_the_hole_of_a_two_link_arm() {
    // The long link cannot be folded away: targets nearer than 0.6 are unreachable.
    let links = [1.0, 0.4];
    let model = planar_arm(&links, None);
    let mut random = Random::new(2);
    for _ in 0..10 {
        let heading = random.within(-3.0, 3.0);
        let distance = random.within(0.05, 0.55);
        let target = na::Vector3::new(heading.cos(), heading.sin(), 0.0) * distance;
        for solver in quick_solvers() {
            let solution = solve(&solver, &model, target, &[heading + 0.3, 2.0]);
            let missed = (planar_tip(&links, &solution.q) - target).norm();
            // Gauss-Newton has no curvature except JᵀJ, which vanishes for the folded arm.
            let within = if solver.method() == "gauss-newton" {
                1e-6
            } else {
                1e-9
            };
            assert!((missed - (0.6 - distance)).abs() < within, "{missed}");
            assert!(!solution.reached);
            assert_eq!(solution.active_limits().count(), 0);
            assert!(solution.explain().contains("No joint limit"));
        }
    }
}

#[test]
fn blocking_limit_is_named() {
    // The joint's limit is at 30° and the target at 90°: the tip ends at 30°.
    let links = [1.0];
    let stop = 30_f64.to_radians();
    let model = planar_arm(&links, Some((-1.0, stop)));
    let target = na::Vector3::new(0.0, 1.0, 0.0);
    for solver in quick_solvers() {
        let solution = solve(&solver, &model, target, &[0.0]);
        assert!(!solution.reached);
        assert_eq!(solution.q, [stop]);
        let limits: Vec<_> = solution.active_limits().collect();
        assert_eq!(limits.len(), 1);
        assert_eq!((limits[0].joint, limits[0].side), ("joint 0", Side::Upper));
        assert_eq!(limits[0].value, stop);
        // d/dq of ½‖(cos q, sin q) − (0, 1)‖² = −cos q.
        assert!((limits[0].push - stop.cos()).abs() < 1e-12);
        assert_eq!(solution.termination, Termination::Stationary);
        let explanation = solution.explain();
        // Without contacts none are reported.
        assert!(!explanation.contains("Collisions:"), "{explanation}");
        assert!(
            explanation.contains("the upper limit 0.5236 rad (30.00°) of `joint 0`"),
            "{explanation}"
        );
    }
}

#[test]
fn prismatic_joint_ends_at_its_limit() {
    let mut builder = Model::builder("slider");
    let axis = Vector3::new(0.0, 0.0, 2.0);
    let limits = Limits::new(-0.1, 0.7);
    let slide = builder.prismatic("slide", None, Placement::identity(), axis, limits);
    builder.frame("tip", Some(slide), Placement::identity());
    let model = builder.build().unwrap();
    for (z, expected) in [(5.0, 0.7), (-5.0, -0.1)] {
        let target = na::Vector3::new(0.3, 0.4, z);
        for solver in quick_solvers() {
            let solution = solve(&solver, &model, target, &[0.2]);
            assert_eq!(solution.q, [expected]);
            let missed = f64::hypot(0.5, z - expected);
            let reported = solution.tasks().next().unwrap().position_error().unwrap();
            assert!((reported - missed).abs() < 1e-12);
            assert_eq!(solution.active_limits().count(), 1);
        }
    }
}

#[test]
fn three_link_arm_matches_a_grid_search() {
    // Two joints are on their limits and the third points at the target.
    let links = [0.6, 0.5, 0.4];
    let model = planar_arm(&links, Some((-0.4, 0.4)));
    let target = na::Vector3::new(-0.6, 1.1, 0.0);
    let steps = 160;
    let mut nearest = f64::INFINITY;
    let at = |k: usize| -0.4 + 0.8 * k as f64 / steps as f64;
    for (i, j, k) in (0..=steps)
        .flat_map(|i| (0..=steps).map(move |j| (i, j)))
        .flat_map(|(i, j)| [0, steps / 2, steps].map(|k| (i, j, k)))
    {
        let tip = planar_tip(&links, &[at(i), at(j), at(k)]);
        nearest = nearest.min((tip - target).norm());
    }
    for solver in quick_solvers() {
        let solution = solve(&solver, &model, target, &[0.0, 0.1, -0.1]);
        let missed = (planar_tip(&links, &solution.q) - target).norm();
        assert!(missed <= nearest, "{missed} but the grid has {nearest}");
        let held = solution.active_limits().map(|l| l.joint.to_owned());
        let held: Vec<String> = held.collect();
        for joint in &held {
            assert!(solution.explain().contains(&format!("`{joint}`")));
        }
        assert!(!held.is_empty());
    }
}

#[test]
fn limit_without_force_is_not_named() {
    // Stretched along x on its upper limit, with the target straight ahead: the cost rises beyond the limit, and the
    // force is rounding.
    let model = planar_arm(&[1.0], Some((-1.0, 0.3)));
    let target = na::Vector3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0) * 2.0;
    for solver in quick_solvers() {
        let solution = solve(&solver, &model, target, &[0.1]);
        assert!(!solution.reached);
        let named: Vec<_> = solution.active_limits().map(|limit| limit.push).collect();
        assert!(named.is_empty(), "{named:?}");
    }
}

#[test]
fn tiny_miss_is_printed_as_nonzero() {
    let model = planar_arm(&[1.0], Some((-1.0, 1.0)));
    let mut builder = Problem::builder(&model);
    let tip = model.frame("tip").unwrap();
    builder.add(Point::new(tip, [1.0 + 1e-9, 0.0, 0.0]));
    builder.tolerance(kinopt::task::Quantity::Metres, 1e-12);
    let problem = builder.build().unwrap();
    let explanation = Solver::default()
        .solve_once(&problem, &[0.0])
        .unwrap()
        .explain();
    assert!(
        explanation.contains("misses by 1.000e-9 m"),
        "{explanation}"
    );
}

#[test]
fn moving_unreachable_target_causes_no_jumps() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.5, 2.5)));
    let solver = Solver::default();
    let mut q = vec![0.3, 0.2, 0.1];
    for frame in 0..120 {
        let angle = 0.02 * f64::from(frame);
        let target = na::Vector3::new(2.0 * angle.cos(), 2.0 * angle.sin(), 0.0);
        let solution = solve(&solver, &model, target, &q);
        assert!(!solution.reached);
        let moved = solution.q.iter().zip(&q).map(|(a, b)| (a - b).abs());
        let largest = moved.fold(0.0, f64::max);
        assert!(
            frame == 0 || largest < 0.1,
            "frame {frame} jumped by {largest} rad"
        );
        q.clone_from(&solution.q);
    }
}

#[test]
fn far_tip_targets_end_at_a_minimum() {
    // The residual stays large, so JᵀJ approximates the second derivative badly. With it alone most searches end by the
    // iteration limit.
    for seed in 0..8 {
        let rig = support::bones::RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut random = Random::new(seed);
        let problem = rig.drawn_to(|| random.vector(4.0));
        let solver = Solver::default().with_restarts(Restarts::none());
        let start = support::trees::configuration_of(model, &mut random);
        let solution = solver.solve_once(&problem, &start).unwrap();
        assert!(!solution.reached);
        assert_eq!(solution.termination, Termination::Stationary, "rig {seed}");
        assert!(solution.projected_gradient.unwrap() < 1e-7, "rig {seed}");
    }
}

/// Two stretched links on their lower limits, with the target 1e-13 m off their line. The cost falls beyond the limits
/// by a slope of 1e-12, which is negligible.
#[test]
fn limit_with_rounding_force_is_not_named() {
    for (limits, side) in [((0.0, 2.0), -1.0), ((-2.0, 0.0), 1.0)] {
        let model = planar_arm(&[1.0, 1.0], Some(limits));
        for solver in quick_solvers() {
            let at = |off: f64| {
                let target = na::Vector3::new(3.0, side * off, 0.0);
                solve(&solver, &model, target, &[0.0; 2])
            };
            let straight = at(1e-13);
            assert!(!straight.reached && straight.q == [0.0; 2], "{straight:?}");
            assert_eq!(
                straight.active_limits().count(),
                0,
                "{}",
                straight.explain()
            );
            let below = at(0.5);
            assert_eq!(below.active_limits().count(), 2, "{}", below.explain());
        }
    }
}
