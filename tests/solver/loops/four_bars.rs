//! Promise: a four-bar linkage is closed at any crank angle, as in Freudenstein's equation. Its pen reaches the points
//! of its curve, and only those.

use std::f64::consts::TAU;

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::ParameterMap;
use kinopt::problem::Preferences;
use kinopt::task::{Point, Posture, Task};
use kinopt::{Problem, Solver};

use crate::loops::mechanisms::FourBar;

#[test]
fn rocker_follows_a_locked_crank() {
    let linkage = FourBar::CRANK_ROCKER;
    let model = linkage.model();
    for k in 0..24 {
        let angle = TAU * f64::from(k) / 24.0 - 3.1;
        let map = ParameterMap::builder(&model).with_locked(model.joint("crank").unwrap(), angle);
        let mut problem = Problem::builder(&model);
        problem.parameters(map.build().unwrap());
        // Only the loop, no task.
        let solution = Solver::default().solve_once(&problem.build().unwrap(), &[0.0, 0.5, 1.5]);
        let solution = solution.unwrap();
        assert!(solution.reached, "{}", solution.explain());
        assert!(solution.loops_closed());
        let [crank, coupler, rocker] = solution.q[..] else {
            panic!("three joints")
        };
        assert_eq!(crank, angle);
        let deviation = linkage.freudenstein(crank, rocker);
        assert!(deviation.abs() < 1e-8, "{deviation:e} at {angle}");
        // Direction of the coupler, from the two ends that Freudenstein's equation omits.
        let (x, y) = (
            linkage.ground + linkage.rocker * rocker.cos() - linkage.crank * crank.cos(),
            linkage.rocker * rocker.sin() - linkage.crank * crank.sin(),
        );
        let turned = (y.atan2(x) - crank - coupler).sin();
        assert!(turned.abs() < 1e-7, "{turned:e}");
    }
}

#[test]
fn pen_reaches_points_of_its_curve() {
    let linkage = FourBar::CRANK_ROCKER;
    let model = linkage.model();
    let pen = model.frame("pen").unwrap();
    let mut kinematics = ForwardKinematics::new(&model);
    for k in 0..40 {
        // A point on the coupler's path: any crank angle, and the coupler by the law of cosines.
        let crank = TAU * (f64::from(k) + 0.3) / 40.0;
        let (x, y) = (
            linkage.ground - linkage.crank * crank.cos(),
            -linkage.crank * crank.sin(),
        );
        let (diagonal, b, c) = (x.hypot(y), linkage.coupler, linkage.rocker);
        let cosine = (b * b + diagonal * diagonal - c * c) / (2.0 * b * diagonal);
        let coupler = y.atan2(x) + cosine.acos() - crank;
        let placed = kinematics.place(&[crank, coupler, 0.0]).unwrap();
        let target = placed[pen.index()].translation;

        let mut problem = Problem::builder(&model);
        problem.add(Point::new(pen, target));
        let solution = Solver::default().solve_once(&problem.build().unwrap(), &[0.5, 0.5, 1.5]);
        let solution = solution.unwrap();
        assert!(solution.reached, "{k}: {}", solution.explain());
        let deviation = linkage.freudenstein(solution.q[0], solution.q[2]);
        assert!(deviation.abs() < 1e-8, "{deviation:e}");
    }
}

/// A loop is no required task for soft tasks to be weighted against: soft tasks keep their order.
#[test]
fn soft_tasks_are_not_weighted_against_loops() {
    let model = FourBar::CRANK_ROCKER.model();
    let crank = model.joint("crank").unwrap();
    for preferences in [Preferences::WithinGoals, Preferences::Traded] {
        let mut problem = Problem::builder(&model);
        for (level, angle) in [(0, 0.4), (1, 1.0)] {
            let posture = Task::new(Posture::of_joints([(crank, angle)]));
            problem.add(posture.preference().at_level(level));
        }
        problem.preferences(preferences);
        let solution = Solver::default().solve_once(&problem.build().unwrap(), &[0.5, 0.5, 1.5]);
        let solution = solution.unwrap();
        assert!(
            solution.reached && (solution.q[0] - 0.4).abs() < 1e-4,
            "{:?}",
            solution.q
        );
    }
}
