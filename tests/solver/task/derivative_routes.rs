//! Promise: all derivative routes agree, for every task and joint kind, under every parameter map, also 10⁶ m from the
//! origin.
//!
//! "Relative" is the largest entry-wise difference of two Jacobians over the largest entry (or 1 if that is larger).
//! Near the origin the exact routes agree to 1e-12. Far away, coordinates have a resolution of ε · 10⁶ m = 2.2e-10 m,
//! and levers are differences of coordinates. So 64 such roundings are allowed in addition.

use kinopt::model::{FrameId, Limits};
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Inputs, Point, Quantity, Residual, RowBlock, Task};
use kinopt::{Model, Problem, Scalar};
use nalgebra::{DMatrix, DVector};
use support::maps::maps_of;
use support::random::Random;
use support::tasks::{TaskCase, tasks_of};
use support::trees::RandomTree;
use support::{Rigid, placement, rigid};

const FAR_DISTANCE: f64 = 1e6;

fn jacobian(problem: &Problem, route: Derivatives, x: &[f64]) -> DMatrix<f64> {
    let problem = &problem.clone().with_derivatives(route);
    let mut scratch = problem.scratch();
    // NaN reveals entries that are not written.
    let mut jacobian = DMatrix::from_element(problem.rows(), problem.variables(), f64::NAN);
    Evaluation::new(problem, &mut scratch).jacobian(x, &mut jacobian);
    jacobian
}

fn gradient(problem: &Problem, route: Derivatives, x: &[f64]) -> (Vec<f64>, DVector<f64>) {
    let problem = &problem.clone().with_derivatives(route);
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(problem, &mut scratch);
    let mut residual = vec![f64::NAN; evaluation.rows()];
    evaluation.residual(x, &mut residual);
    let mut gradient = vec![f64::NAN; evaluation.variables()];
    let mut memory = DMatrix::zeros(evaluation.rows(), evaluation.variables());
    evaluation.gradient(x, &residual, &mut gradient, &mut memory);
    (gradient, DVector::from_vec(residual))
}

fn size(matrix: &DMatrix<f64>) -> f64 {
    matrix
        .iter()
        .fold(1.0, |largest: f64, v| largest.max(v.abs()))
}

/// Largest difference over the largest entry; NaN counts as infinite.
fn relative(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let largest = differences.fold(0.0, |largest: f64, d| {
        if d.is_nan() {
            f64::INFINITY
        } else {
            largest.max(d)
        }
    });
    largest / size(b)
}

fn check(label: &str, case: &TaskCase, problem: &Problem, x: &[f64], coordinates: f64) {
    let rounding = f64::EPSILON * coordinates;
    let exact = 1e-12 + 64.0 * rounding;
    let dual = jacobian(problem, Derivatives::Dual, x);
    let analytic = jacobian(problem, Derivatives::Analytic, x);
    let error = relative(&analytic, &dual);
    assert!(
        error <= exact,
        "{label}: analytic and dual differ by {error:e}"
    );

    let (reverse, residual) = gradient(problem, Derivatives::Analytic, x);
    let product = dual.transpose() * &residual;
    let scale = size(&dual) * residual.amax().max(1.0) * residual.len() as f64;
    for (ours, theirs) in reverse.iter().zip(&product) {
        let error = (ours - theirs).abs() / scale;
        assert!(error <= exact, "{label}: reverse gradient off by {error:e}");
    }
    if !case.smooth {
        return;
    }
    // A difference of two residuals with this rounding, over the step.
    let lost = |step: f64| 16.0 * rounding / step;
    let central = jacobian(problem, Derivatives::CentralDifference, x);
    let error = relative(&central, &dual);
    let allowed = 1e-7 + lost(f64::EPSILON.cbrt());
    assert!(
        error <= allowed,
        "{label}: central differences off by {error:e}"
    );
    let forward = jacobian(problem, Derivatives::ForwardDifference, x);
    let error = relative(&forward, &dual);
    let allowed = 1e-5 + lost(f64::EPSILON.sqrt());
    assert!(
        error <= allowed,
        "{label}: forward differences off by {error:e}"
    );
}

fn check_all(seed: u64, base: Rigid, coordinates: f64) {
    let tree = RandomTree::placed(seed, 12, base);
    let mut random = Random::new(seed);
    for expected in maps_of(&tree) {
        let x = expected.variables(&mut random);
        let q = expected.expand(&x);
        let mut all = Problem::builder(&tree.model);
        all.parameters(expected.map.clone());
        let cases = tasks_of(&tree, &q, &mut random);
        for case in &cases {
            let label = format!("{}, {}, tree {seed}", case.name, expected.name);
            let mut builder = Problem::builder(&tree.model);
            builder.parameters(expected.map.clone());
            (case.add)(&mut builder);
            let problem = builder.build().unwrap();
            check(&label, case, &problem, &x, coordinates);
            if case.smooth {
                (case.add)(&mut all);
            }
        }
        // All tasks together, which checks row offsets.
        let label = format!("all tasks, {}, tree {seed}", expected.name);
        check(&label, &cases[0], &all.build().unwrap(), &x, coordinates);
    }
}

#[test]
fn routes_agree_near_the_origin() {
    for seed in 0..8 {
        check_all(seed, Rigid::identity(), 1.0);
    }
}

#[test]
fn routes_agree_far_from_the_origin() {
    for seed in 20..24 {
        let mut random = Random::new(seed);
        let translation = random.direction().into_inner() * FAR_DISTANCE;
        check_all(seed, rigid(random.rotation(), translation), FAR_DISTANCE);
    }
}

#[test]
fn gradients_by_every_route_agree() {
    let tree = RandomTree::new(31, 12);
    let mut random = Random::new(31);
    let q = tree.configuration(&mut random);
    let mut builder = Problem::builder(&tree.model);
    for case in tasks_of(&tree, &q, &mut random) {
        if case.smooth {
            (case.add)(&mut builder);
        }
    }
    let problem = builder.build().unwrap();
    let (reference, _) = gradient(&problem, Derivatives::Dual, &q);
    let largest = reference.iter().fold(1.0, |m: f64, g| m.max(g.abs()));
    for (route, within) in Derivatives::ALL.into_iter().zip([1e-12, 1e-15, 1e-5, 1e-7]) {
        let (ours, _) = gradient(&problem, route, &q);
        for (a, b) in ours.iter().zip(&reference) {
            assert!((a - b).abs() <= within * largest, "{route:?}: {a} and {b}");
        }
    }
}

/// Sum over the positions and rotations of many frames, as for a centre of mass.
#[derive(Clone)]
struct Centre(Vec<FrameId>);

impl Residual for Centre {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.0.clone())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
        r.fill(S::zero());
        for (k, frame) in frames.iter().enumerate() {
            let mass = S::constant(1.0 + k as f64);
            r[0] += frame.translation.x * mass;
            r[1] += (frame.translation.y + frame.rotation.x.z) * mass;
        }
    }
}

#[test]
fn frames_sharing_joints_agree() {
    let mut random = Random::new(5);
    let mut builder = Model::builder("spine");
    let (mut last, mut frames) = (None, Vec::new());
    for k in 0..12 {
        let at = placement(&random.rigid(0.5));
        let axis = Vector3::UNITS[k % 3];
        let joint = match k % 4 {
            3 => builder.prismatic(format!("{k}"), last, at, axis, Limits::UNBOUNDED),
            _ => builder.revolute(format!("{k}"), last, at, axis, Limits::UNBOUNDED),
        };
        frames.push(builder.frame(format!("{k}"), Some(joint), at));
        last = Some(joint);
    }
    let model = builder.build().unwrap();
    let mut tasks = Problem::builder(&model);
    // Rows of other tasks above and below.
    tasks.add(Point::new(frames[3], [0.0; 3]));
    tasks.add(Task::new(Centre(frames.clone())).scale(0.5));
    tasks.add(Point::new(frames[11], [0.0; 3]));
    let problem = tasks.build().unwrap();
    let x: Vec<f64> = (0..12).map(|k| 0.3 * f64::from(k % 5) - 0.5).collect();
    let exact = jacobian(&problem, Derivatives::Dual, &x);
    let error = relative(&jacobian(&problem, Derivatives::Analytic, &x), &exact);
    assert!(error < 1e-12, "{error:e}");
    let (slopes, residual) = gradient(&problem, Derivatives::Analytic, &x);
    let product = exact.transpose() * residual;
    let off = DVector::from_vec(slopes) - &product;
    assert!(off.amax() < 1e-12 * product.amax(), "{off}");
}

/// Also with ball joints on the edges of their cones, for steps across and along the edge.
#[test]
fn routes_agree_on_cone_edges() {
    use kinopt::model::BallLimits;
    use kinopt::problem::ProblemInstance;
    use kinopt::task::FramePose;
    let mut random = Random::new(47);
    for _ in 0..20 {
        let mut builder = Model::builder("balls");
        let mut last = None;
        for name in ["a", "b", "c"] {
            let about = random.vector(1.0);
            let limits = BallLimits::elliptic(
                [about.x, about.y, 0.0],
                [0.4 + random.unit(), 0.4 + random.unit()],
                Limits::new(-0.5, 0.7),
            );
            let link = Placement::translation(Vector3::new(0.1, 0.2, 0.3));
            last = Some(builder.ball(name, last, link, Vector3::UNITS[2], Some(limits)));
        }
        let hand = Placement::translation(Vector3::new(0.0, 0.1, 0.3));
        let tip = builder.frame("tip", last, hand);
        let model = builder.build().unwrap();
        let mut builder = Problem::builder(&model);
        builder.add(FramePose::new(tip, hand));
        let problem = builder.build().unwrap();
        let mut x: Vec<f64> = (0..problem.variables())
            .map(|_| random.within(-2.5, 2.5))
            .collect();
        ProblemInstance::from(&problem).space().project(&mut x);
        let exact = jacobian(&problem, Derivatives::Dual, &x);
        for (route, within) in [
            (Derivatives::Analytic, 1e-12),
            (Derivatives::ForwardDifference, 1e-6),
            (Derivatives::CentralDifference, 1e-8),
        ] {
            let error = relative(&jacobian(&problem, route, &x), &exact);
            assert!(error < within, "{route:?}: {error:e}");
        }
    }
}
