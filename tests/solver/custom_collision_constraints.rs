//! Promise: problems accept collision constraints from outside the library. A robot that is dragged into the obstacle
//! approaches it and stops. No step through the obstacle is taken, however short.

use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::Drag;
use kinopt::model::{FrameId, Limits, Model};
use kinopt::problem::{ClearanceCheck, Collision, CollisionAvoidance};
use kinopt::scalar::Scalar;
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Description, Inequality, InequalityResidual, Inputs, Point, Quantity, Residual, RowBlock, Task,
};
use kinopt::{Problem, Solution, Solver};
use support::planar_arm;

/// Clearance from the table at which motion stops, metres.
const MIN_CLEARANCE: f64 = 1e-3;

/// Depth of a frame's origin below the table, z = 0.
#[derive(Clone, Debug)]
struct Depth(FrameId);

impl Residual for Depth {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        residual[0] = (-frames[0].translation.z).max(S::zero());
    }

    fn description(&self) -> Description {
        Description::new("depth")
    }
}

impl InequalityResidual for Depth {
    fn inequalities(&self) -> Vec<Inequality> {
        Vec::new()
    }

    fn slacks<S: Scalar>(&self, _: &[Placement<S>], _: &[S], _: &mut [S]) {}
}

/// Checks the height, the second coordinate of a configuration.
#[derive(Clone, Debug)]
struct OverTable;

impl ClearanceCheck for OverTable {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        let under = (q[1] < 0.0).then(|| Collision::new("tool", "table", q[1]));
        under.into_iter().collect()
    }

    fn blocked(&mut self, _from: &[f64], to: &[f64]) -> Option<Collision> {
        self.collisions(to).pop().map(Collision::met_on_the_way)
    }

    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        match to[1] < MIN_CLEARANCE {
            true => ((from[1] - MIN_CLEARANCE) / (from[1] - to[1])).max(0.0),
            false => 1.0,
        }
    }
}

struct Table(FrameId);

impl CollisionAvoidance for Table {
    type Clearance = Depth;
    type Check = OverTable;

    fn configuration_len(&self) -> usize {
        2
    }

    fn clearance(&self) -> Task<Depth> {
        Task::new(Depth(self.0))
    }

    fn check(&self) -> OverTable {
        OverTable
    }
}

/// Two prismatic joints, one forward and one upward.
fn slides() -> (Model, FrameId) {
    let mut builder = Model::builder("two slides");
    let limits = Limits::new(-1.0, 1.0);
    let at = Placement::identity();
    let [ahead, _, up] = Vector3::UNITS;
    let along = builder.prismatic("along", None, at, ahead, limits);
    let height = builder.prismatic("height", Some(along), at, up, limits);
    let tool = builder.frame("tool", Some(height), at);
    (builder.build().unwrap(), tool)
}

#[test]
fn drag_into_obstacle_stops_at_clearance() {
    let (model, tool) = slides();
    for (under, longest) in [
        (0.05, 0.13),
        (0.4, 0.13),
        (0.05, f64::INFINITY),
        (0.4, f64::INFINITY),
    ] {
        let mut tasks = Problem::builder(&model);
        let goal = Vector3::new(0.5, 0.0, -under);
        tasks.add(Point::new(tool, goal));
        tasks.keep_clear(&Table(tool));
        let problem = tasks.build().unwrap();
        let drag = Drag::new(problem, &[0.0, 0.3]).unwrap();
        let mut drag = drag.with_max_move(longest).unwrap();
        for frame in 0..60 {
            drag.advance();
            assert!(drag.q()[1] >= 0.0, "{under}, {frame}: {:?}", drag.q());
        }
        assert!(
            drag.q()[1] <= MIN_CLEARANCE + 1e-9,
            "{under}: {:?}",
            drag.q()
        );
        assert_eq!(drag.solution().collisions()[0].second, "table");
        assert!(!drag.solution().reached);
    }
}

/// CCD and FABRIK do not avoid collisions. A result in contact is not reached, and its contacts are reported.
#[test]
fn geometric_solvers_report_contacts() {
    let model = planar_arm(&[1.0, 0.8], None);
    let tip = model.frame("tip").unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [1.2, 0.4, 0.0]));
    let plain = tasks.clone().build().unwrap();
    tasks.keep_clear(&Table(tip));
    let clear = tasks.build().unwrap();
    let mut touched = [0; 2];
    for start in [[0.9, -1.5], [-0.3, 1.5]] {
        let solved = |problem: &Problem| {
            [
                Ccd::default().solve(problem, &start).unwrap(),
                Fabrik::default().solve(problem, &start).unwrap(),
            ]
        };
        for (plain, clear) in solved(&plain).iter().zip(&solved(&clear)) {
            let touches = clear.q[1] < 0.0;
            assert_eq!(clear.q, plain.q);
            assert!(plain.reached && plain.collisions().is_empty());
            touched[usize::from(touches)] += 1;
            assert_eq!((clear.reached, clear.goals_reached()), (!touches, true));
            assert_eq!(clear.collisions().len(), usize::from(touches));
        }
    }
    assert!(!touched.contains(&0), "{touched:?}");
}

/// Required tasks count as reached in contact only if all of them are.
#[test]
fn goals_are_reached_in_contact_only_together() {
    let model = planar_arm(&[1.0, 0.8], None);
    let tip = model.frame("tip").unwrap();
    for (second, all) in [([1.2, 0.4, 0.0], true), ([1.2, 0.4, 0.3], false)] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Task::new(Point::new(tip, [1.2, 0.4, 0.0])).tolerance(Quantity::Metres, 0.2));
        tasks.add(Task::new(Point::new(tip, second)));
        tasks.keep_clear(&Table(tip));
        let solution = Ccd::default().solve(&tasks.build().unwrap(), &[0.9, -1.5]);
        let solution = solution.unwrap();
        assert!(!solution.reached && !solution.collisions().is_empty());
        assert_eq!(solution.goals_reached(), all);
        assert!(solution.tasks().next().unwrap().reached);
    }
}

/// Tasks of two levels that are reached in contact count as reached: contact does not relax a level.
#[test]
fn levels_reached_in_contact_are_not_relaxed() {
    let (model, tool) = slides();
    let solve = |level: usize| {
        let goal = [0.5, 0.0, -0.2];
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tool, goal));
        tasks.add(Task::new(Point::new(tool, goal)).at_level(level));
        tasks.keep_clear(&Table(tool));
        let problem = tasks.build().unwrap();
        Solver::default().solve_once(&problem, &[0.0, 0.3]).unwrap()
    };
    let [one, two] = [0, 1].map(solve);
    assert!(one.goals_reached() && !one.reached);
    assert_eq!((&two.q, two.reached), (&one.q, one.reached));
    assert_ne!(two.termination, Termination::Reached);
    let reported = |solution: &Solution| (solution.termination, solution.iterations);
    assert_eq!(reported(&two), reported(&one));
}
