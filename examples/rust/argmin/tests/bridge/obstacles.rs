//! Promise: the result of an argmin run is checked for collisions and counts as reached only if it is collision-free.
#![allow(clippy::unwrap_used)]

use argmin::core::Executor;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use kinopt::Problem;
use kinopt::argmin_bridge::UnboundedProblem;
use kinopt::model::FrameId;
use kinopt::problem::{ClearanceCheck, Collision, CollisionAvoidance};
use kinopt::scalar::Scalar;
use kinopt::spatial::Placement;
use kinopt::task::{
    Description, FramePose, Inequality, InequalityResidual, Inputs, Quantity, Residual, RowBlock,
    Task,
};

use crate::bent_arm::{arm, world_from_tip};

const START: [f64; 7] = [0.1, 0.3, -0.2, -1.0, 0.2, 0.6, 0.05];
const TARGET: [f64; 7] = [0.5, 0.6, -0.4, -1.3, 0.2, 0.9, 0.12];

/// Wall that only counts in checks and has no gradient for a solver.
#[derive(Clone, Debug)]
struct Wall {
    tip: FrameId,
    /// Largest collision-free value of the first joint, radians.
    first: f64,
}

impl Residual for Wall {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.tip])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        residual[0] = S::zero();
    }

    fn description(&self) -> Description {
        Description::new("wall")
    }
}

impl InequalityResidual for Wall {
    fn inequalities(&self) -> Vec<Inequality> {
        Vec::new()
    }

    fn slacks<S: Scalar>(&self, _: &[Placement<S>], _: &[S], _: &mut [S]) {}
}

impl ClearanceCheck for Wall {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        let beyond = q[0] - self.first;
        let touch = (beyond > 0.0).then(|| Collision::new("tip", "wall", -beyond));
        touch.into_iter().collect()
    }

    fn blocked(&mut self, _from: &[f64], to: &[f64]) -> Option<Collision> {
        self.collisions(to).pop()
    }

    fn free_share(&mut self, _from: &[f64], _to: &[f64]) -> f64 {
        1.0
    }
}

impl CollisionAvoidance for Wall {
    type Clearance = Self;
    type Check = Self;

    fn configuration_len(&self) -> usize {
        START.len()
    }

    fn clearance(&self) -> Task<Self> {
        Task::new(self.clone())
    }

    fn check(&self) -> Self {
        self.clone()
    }
}

/// Reachable target pose of the tip, with such a wall.
fn beside_a_wall(first: f64) -> Problem {
    let model = arm();
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(FramePose::new(tip, world_from_tip(&model, &TARGET)));
    builder.keep_clear(&Wall { tip, first });
    builder.build().unwrap()
}

#[test]
fn run_that_ends_in_a_wall_is_not_reached() {
    for (first, free) in [(3.0, true), (-3.0, false)] {
        let problem = beside_a_wall(first);
        let unbounded = UnboundedProblem::new(&problem);
        let start = unbounded.start(&START).unwrap();
        let search = MoreThuenteLineSearch::new();
        let run = Executor::new(unbounded.clone(), LBFGS::new(search, 7))
            .configure(|state| state.param(start).max_iters(500).target_cost(1e-16))
            .run()
            .unwrap();
        let solution = unbounded.solution(&run).unwrap();
        assert!(solution.goals_reached(), "{}", solution.explain());
        assert_eq!(solution.reached, free, "{:?}", solution.collisions());
        let names: Vec<&str> = solution
            .collisions()
            .iter()
            .map(|met| met.second.as_str())
            .collect();
        assert_eq!(names, if free { vec![] } else { vec!["wall"] });
    }
}
