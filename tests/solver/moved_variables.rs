//! Promise: a search uses only the variables that its tasks move, for any number of further bones of a character. Its
//! result equals that of a search over all variables.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use kinopt::ik::Restarts;
use kinopt::model::Limits;
use kinopt::skeleton::{BallSkeleton, Bone, BoneId, Cones, Skeleton, SkeletonRoot};
use kinopt::solver::{Iterate, Iteration, LevenbergMarquardt, Method, SolverState, Step};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solver, Workspace};

/// Levenberg-Marquardt that records the largest number of columns of a Jacobian.
struct Counting(Arc<AtomicUsize>);

impl Method for Counting {
    type State = <LevenbergMarquardt as Method>::State;

    fn name(&self) -> &'static str {
        "counting"
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn reserve(&self, state: &mut Self::State, rows: usize, variables: usize) {
        LevenbergMarquardt::default().reserve(state, rows, variables);
    }

    fn begin(&self, state: &mut Self::State, at: &SolverState) {
        LevenbergMarquardt::default().begin(state, at);
    }

    fn step(&self, state: &mut Self::State, at: &mut Iterate<'_>) -> Step {
        self.0.fetch_max(at.jacobian().ncols(), Ordering::Relaxed);
        LevenbergMarquardt::default().step(state, at)
    }

    fn control(&self, state: &Self::State) -> f64 {
        LevenbergMarquardt::default().control(state)
    }
}

/// Chains of `length` bones of 0.1 m each, which begin at the end of a spine of three bones.
fn character(chains: usize, length: usize) -> Skeleton {
    let mut builder = Skeleton::builder("character");
    let mut bone = |name: String, parent, at: [f64; 3]| {
        builder.add(Bone {
            name,
            parent,
            length: 0.1,
            model_from_rest: Placement::translation(Vector3::from(at)),
            limits: [Limits::new(-1.5, 1.5); 3],
        })
    };
    let mut spine: Option<BoneId> = None;
    for k in 0..3 {
        spine = Some(bone(
            format!("spine {k}"),
            spine,
            [0.1 * k as f64, 0.0, 0.0],
        ));
    }
    for chain in 0..chains {
        let mut parent = spine;
        for k in 0..length {
            let y = 0.01 * chain as f64;
            let at = [0.3 + 0.1 * k as f64, y, 0.02 * (k % 2) as f64];
            parent = Some(bone(format!("{chain} {k}"), parent, at));
        }
    }
    builder.build().unwrap()
}

fn solved(skeleton: &Skeleton, target: [f64; 3]) -> (kinopt::Solution, usize) {
    let tip = skeleton.bone("0 9").unwrap();
    let mut problem = Problem::builder(skeleton.model());
    problem.add(Point::new(skeleton.tip(tip), target));
    let problem = problem.build().unwrap();
    let columns = Arc::new(AtomicUsize::new(0));
    let solver = Solver::new(Counting(Arc::clone(&columns)));
    let start = skeleton.model().neutral();
    let mut seen = Vec::new();
    let mut observer = |iteration: &Iteration<'_>| {
        seen.push(iteration.x.len());
        std::ops::ControlFlow::Continue(())
    };
    let mut workspace = Workspace::new();
    let solution = solver.solve_observed(&problem, &start, &mut workspace, &mut observer);
    let solution = solution.unwrap().clone();
    assert!(
        seen.iter()
            .all(|variables| *variables == problem.variables())
    );
    (solution, columns.load(Ordering::Relaxed))
}

#[test]
fn search_has_the_columns_that_tasks_move() {
    let (few, many) = (character(1, 10), character(29, 10));
    for target in [[0.9, 0.4, 0.1], [2.0, 1.0, 0.3]] {
        let [few, many] = [&few, &many].map(|problem| solved(problem, target));
        assert_eq!((few.1, many.1), (3 * 13, 3 * 13));
        let costs = [&few, &many].map(|solution| solution.0.cost);
        let near = 1e-3 * costs[0] + 1e-9;
        assert!((costs[0] - costs[1]).abs() < near, "{costs:?}");
        assert_eq!(few.0.reached, many.0.reached);
        // Variables that no task moves are unchanged.
        assert!(many.0.q[3 * 13..].iter().all(|angle| *angle == 0.0));
    }
}

/// Balls stay within their cones, and a ball that no task moves is unchanged.
#[test]
fn search_of_balls_has_the_columns_that_tasks_move() {
    use kinopt::model::BallLimits;
    use kinopt::skeleton::BoneCone;
    let skeleton = character(29, 10);
    let cones: Cones = skeleton
        .bones()
        .iter()
        .map(|bone| {
            let limits = BallLimits::cone(0.5, Limits::new(-0.3, 0.3));
            (bone.name.clone(), BoneCone::new(limits))
        })
        .collect();
    let figure = BallSkeleton::new(skeleton, &cones, SkeletonRoot::Fixed).unwrap();
    let tip = figure.bone("7 9").unwrap();
    let mut problem = Problem::builder(figure.model());
    problem.add(Point::new(figure.tip(tip), [0.9, 0.5, 0.2]));
    let problem = problem.build().unwrap();
    let columns = Arc::new(AtomicUsize::new(0));
    let solver = Solver::new(Counting(Arc::clone(&columns)));
    let solver = solver.with_restarts(Restarts::default().with_attempts(8));
    let start = figure.model().neutral();
    let solution = solver.solve_once(&problem, &start).unwrap();
    assert!(solution.reached);
    assert_eq!(columns.load(Ordering::Relaxed), 3 * 13);
    // The swing of a ball with axis x is the angle between x and the rotated x.
    for q in solution.q.chunks_exact(4) {
        let cosine = 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]);
        assert!(cosine > 0.5_f64.cos() - 1e-9, "{q:?}");
    }
}
