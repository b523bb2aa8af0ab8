//! Promise: both arms of a torso reach their poses at once to 1e-6 m and 1e-6 rad by independent kinematics, exactly
//! within limits.

use kinopt::ik::Restarts;
use kinopt::robot::Robot;
use kinopt::task::FramePose;
use kinopt::{Problem, Solver, Workspace};
use support::urdf_matrices::{Matrix, Tree, apart, placement};

const FILE: &str = "../models/rethink_baxter.urdf";
const TIPS: [&str; 2] = ["left_tool", "right_tool"];

struct Torso {
    robot: Robot,
    tree: Tree,
    names: Vec<String>,
}

impl Torso {
    fn read() -> Self {
        let robot = Robot::read(FILE).unwrap();
        let model = robot.model();
        let names = model.moving_joints().iter();
        Self {
            names: names
                .map(|id| model.joints()[id.index()].name.clone())
                .collect(),
            tree: Tree::read(FILE),
            robot,
        }
    }

    fn tips(&self, q: &[f64]) -> [Matrix; 2] {
        let values: Vec<_> = (self.names.iter().map(String::as_str))
            .zip(q.iter().copied())
            .collect();
        TIPS.map(|tip| self.tree.root_from_link(tip, &values))
    }

    fn problem(&self, targets: &[Matrix; 2]) -> Problem {
        let model = self.robot.model();
        let mut builder = Problem::builder(model);
        builder.parameters(self.robot.map().clone());
        for (tip, target) in TIPS.iter().zip(targets) {
            builder.add(FramePose::new(model.frame(tip).unwrap(), placement(target)));
        }
        builder.build().unwrap()
    }

    fn assert_within_limits(&self, q: &[f64]) {
        for (name, value) in self.names.iter().zip(q) {
            let (lower, upper) = self.tree.limits(name);
            assert!(lower <= *value && *value <= upper, "{name}: {value}");
        }
    }
}

#[test]
fn both_tips_reach_their_poses() {
    let torso = Torso::read();
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(300));
    let mut workspace = Workspace::new();
    for case in 0..60 {
        let truth = torso.robot.model().random_configuration(2 * case);
        let start = torso.robot.model().random_configuration(2 * case + 1);
        let targets = torso.tips(&truth);
        let problem = torso.problem(&targets);
        let solution = solver.solve(&problem, &start, &mut workspace).unwrap();
        torso.assert_within_limits(&solution.q);
        for (found, target) in torso.tips(&solution.q).iter().zip(&targets) {
            let (metres, radians) = apart(found, target);
            assert!(
                solution.reached && metres <= 1e-6 && radians <= 1e-6,
                "{case}: {metres:e} {radians:e} {}",
                solution.explain()
            );
        }
    }
}

/// With one tip out of reach the other keeps its pose, and the report distinguishes them.
#[test]
fn one_unreachable_tip_keeps_the_other_reached() {
    let torso = Torso::read();
    let rest = torso.robot.model().random_configuration(7);
    let mut targets = torso.tips(&rest);
    targets[1][0][3] += 5.0;
    let problem = torso.problem(&targets);
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    let solution = solver.solve(&problem, &rest, &mut workspace).unwrap();
    torso.assert_within_limits(&solution.q);
    assert!(!solution.reached);
    let found = torso.tips(&solution.q);
    let reports: Vec<_> = solution.tasks().collect();
    for ((report, found), (target, tip)) in reports.iter().zip(&found).zip(targets.iter().zip(TIPS))
    {
        let (metres, radians) = apart(found, target);
        assert_eq!(report.frame, Some(tip));
        assert!((report.position_error().unwrap() - metres).abs() < 1e-12);
        assert!((report.orientation_error().unwrap() - radians).abs() < 1e-9);
        assert_eq!(report.reached, metres <= 1e-6 && radians <= 1e-6);
    }
    assert!(reports[0].reached && !reports[1].reached);
    let explanation = solution.explain();
    assert!(explanation.contains("right_tool"), "{explanation}");
}
