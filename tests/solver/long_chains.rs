//! Promise: on a long chain whose joints all move the target, an iteration takes a few gradients, not one per joint.
//! A search for an unreachable target converges to the closest pose.

use kinopt::ik::Restarts;
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solution, Solver};

/// Number of rows of a point task.
const ROWS: usize = 3;

/// Chain of a length of 1 along x.
fn chain(bones: usize) -> Skeleton {
    let mut builder = Skeleton::builder("chain");
    let mut parent = None;
    for k in 0..bones {
        parent = Some(builder.add(Bone {
            name: format!("{k}"),
            parent,
            length: 1.0 / bones as f64,
            model_from_rest: Placement::translation(Vector3::new(
                k as f64 / bones as f64,
                0.0,
                0.0,
            )),
            limits: [Limits::new(-1.5, 1.5); 3],
        }));
    }
    builder.build().unwrap()
}

/// Single attempt for the tip of a chain.
fn solved(bones: usize, target: [f64; 3]) -> Solution {
    let skeleton = chain(bones);
    let tip = skeleton.bone(&format!("{}", bones - 1)).unwrap();
    let mut problem = Problem::builder(skeleton.model());
    problem.add(Point::new(skeleton.tip(tip), target));
    let problem = problem.build().unwrap();
    let solver = Solver::default().with_restarts(Restarts::default().with_attempts(1));
    let start = skeleton.model().neutral();
    solver.solve_once(&problem, &start).unwrap()
}

#[test]
fn unreachable_target_takes_few_gradients() {
    for bones in [60, 212] {
        let solution = solved(bones, [0.6, 0.7, 0.6]);
        assert_eq!(solution.termination, Termination::Stationary);
        let miss = (2.0 * solution.cost).sqrt();
        assert!((miss - 0.1).abs() < 1e-9, "{bones}: {miss}");
        let gradients = solution.counts.gradients;
        // One gradient more per probe, and one per search to check the form of the curvature.
        let most = (ROWS + 1) * solution.iterations + 3;
        assert!(gradients <= most, "{bones}: {gradients} > {most}");
    }
}

#[test]
fn reachable_target_takes_no_gradients() {
    let solution = solved(212, [0.5, 0.4, 0.3]);
    assert!(solution.reached);
    assert_eq!(solution.counts.gradients, 0);
}

/// Random starts cannot be better than an attempt at the proven lower bound of the cost.
#[test]
fn attempts_end_at_the_largest_reach() {
    let skeleton = chain(60);
    let tip = skeleton.bone("59").unwrap();
    let mut problem = Problem::builder(skeleton.model());
    problem.add(Point::new(skeleton.tip(tip), [3.0, 4.0, 0.0]));
    let problem = problem.build().unwrap();
    let start = skeleton.model().neutral();
    let solve = |attempts: usize| {
        let restarts = Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        solver.solve_once(&problem, &start).unwrap()
    };
    let [few, many] = [8, 64].map(solve);
    assert_eq!(few.q, many.q);
    assert!((many.cost - 8.0).abs() < 1e-9 && !many.reached);
    assert!(many.attempts <= 8, "{}", many.attempts);
}
