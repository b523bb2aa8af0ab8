//! Promise: slices of wrong length, foreign ids and indices out of range give NaN, nothing or a named error, never a
//! panic.

use std::ops::Range;

use kinopt::model::{FrameId, Limits, Model, ModelError, ParameterMap};
use kinopt::problem::{Evaluation, Problem};
use kinopt::scalar::Scalar;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::solver::{
    LeastSquares, Outcome, Silent, SolveError, SolverState, Stopping, Termination, minimise,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Extensions, Inequality, InequalityResidual, Inputs, LocalJacobian, Point, Quantity, Residual,
    RowBlock,
};
use nalgebra::DMatrix;
use support::fault_tables::ExpectedError;
use support::methods::methods;
use support::planar_arm;

fn problem() -> Problem {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.6, 0.4, 0.0]));
    builder.build().unwrap()
}

#[test]
fn evaluations_of_wrong_shapes_are_nan() {
    let problem = problem();
    // Scratch memory of another problem is not reused.
    let mut scratch = self::problem().scratch();
    let mut evaluation = Evaluation::new(&problem, &mut scratch);
    let mut r = [0.0; 3];
    evaluation.residual(&[0.1, 0.2, 0.3], &mut r);
    assert!(r.iter().all(|v| v.is_finite()));
    for x in [&[][..], &[0.1, 0.2], &[0.1; 4]] {
        evaluation.residual(x, &mut r);
        assert!(r.iter().all(|v| v.is_nan()));
        let mut jacobian = DMatrix::zeros(3, 3);
        evaluation.jacobian(x, &mut jacobian);
        assert!(jacobian.iter().all(|v| v.is_nan()));
        let mut gradient = [0.0; 3];
        evaluation.gradient(x, &[0.0; 3], &mut gradient, &mut jacobian);
        assert!(gradient.iter().all(|v| v.is_nan()));
    }
    evaluation.residual(&[0.1; 3], &mut [0.0; 2]);
    evaluation.jacobian(&[0.1; 3], &mut DMatrix::zeros(2, 3));
    assert!(problem.is_reached(&[]).is_err() && problem.is_reached(&[0.0; 2]).is_err());
    assert!(problem.is_reached(&[0.0; 3]).unwrap());
}

/// Scratch memory of a problem evaluated at the same x is not valid for another.
#[test]
fn scratch_of_another_problem_is_rebuilt() {
    let problem_of = |links: &[f64]| {
        let model = planar_arm(links, None);
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(model.frame("tip").unwrap(), [0.0; 3]));
        builder.build().unwrap()
    };
    let [short, long] = [[0.5, 0.4], [1.0, 0.8]].map(|links| problem_of(&links));
    let (x, mut residual) = ([0.0, 0.0], [0.0; 3]);
    let mut scratch = short.scratch();
    for (problem, length) in [(&short, 0.9), (&long, 1.8), (&short, 0.9)] {
        Evaluation::new(problem, &mut scratch).residual(&x, &mut residual);
        assert!((residual[0] - length).abs() < 1e-15, "{residual:?}");
    }
}

/// r(x) = x − 2 with bounds of any lengths.
struct Shifted {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl LeastSquares for Shifted {
    fn variables(&self) -> usize {
        2
    }
    fn rows(&self) -> usize {
        2
    }
    fn lower(&self) -> &[f64] {
        &self.lower
    }
    fn upper(&self) -> &[f64] {
        &self.upper
    }
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        for (r, x) in residual.iter_mut().zip(x) {
            *r = x - 2.0;
        }
    }
    fn jacobian(&mut self, _x: &[f64], jacobian: &mut DMatrix<f64>) {
        jacobian.fill_with_identity();
    }
}

type Ends = Vec<Result<(Outcome, Vec<f64>), SolveError>>;

fn search(lower: &[f64], upper: &[f64], start: &[f64]) -> Ends {
    let mut ends = Vec::new();
    for method in methods() {
        let mut problem = Shifted {
            lower: lower.to_vec(),
            upper: upper.to_vec(),
        };
        let mut memory = SolverState::default();
        let stopping = Stopping::default();
        let outcome = minimise(
            &mut problem,
            &*method,
            start,
            &stopping,
            &mut Silent,
            &mut memory,
        );
        ends.push(outcome.map(|outcome| (outcome, memory.x().to_vec())));
    }
    ends
}

#[test]
fn searches_of_wrong_shapes_do_not_start() {
    let (low, high) = ([1.0, -5.0], [5.0, 5.0]);
    for start in [
        &[][..],
        &[3.0],
        &[3.0; 3],
        &[f64::NAN, 9.0],
        &[3.0, f64::INFINITY],
    ] {
        for end in search(&low, &high, start) {
            let message = end.unwrap_err().to_string();
            let reason = if start.len() == 2 { "finite" } else { "2" };
            assert!(
                message.contains("start") && message.contains(reason),
                "{message}"
            );
        }
    }
    for (lower, upper) in [(&low[..1], &high[..]), (&low[..], &high[..0])] {
        for end in search(lower, upper, &[3.0, 3.0]) {
            end.says("bounds");
        }
    }
    for end in search(&low, &high, &[3.0, 3.0]) {
        let (outcome, x) = end.unwrap();
        assert_ne!(outcome.termination, Termination::NonFinite);
        assert!(x.iter().all(|v| (v - 2.0).abs() < 1e-6), "{x:?}");
    }
}

/// Writes derivatives for frames and joints that it does not declare.
#[derive(Clone)]
struct UndeclaredDerivatives(FrameId);

impl Residual for UndeclaredDerivatives {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
        r[0] = frames[0].translation.x;
    }

    fn differentiate(
        &self,
        _frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        for index in [1, 7, usize::MAX] {
            assert!(jacobian.linear_mut(index).is_empty());
            assert!(jacobian.angular_mut(index).is_empty());
            assert!(jacobian.joint_mut(index).is_empty());
            assert!(jacobian.linear(index).is_empty() && jacobian.angular(index).is_empty());
        }
        jacobian.linear_mut(0)[0] = Vector3::new(1.0, 0.0, 0.0);
        true
    }
}

#[test]
fn undeclared_derivatives_are_ignored() {
    let model = planar_arm(&[0.5, 0.4], None);
    let mut builder = Problem::builder(&model);
    builder.add(UndeclaredDerivatives(model.frame("tip").unwrap()));
    let problem = builder.build().unwrap();
    let mut jacobian = DMatrix::zeros(1, 2);
    Evaluation::new(&problem, &mut problem.scratch()).jacobian(&[0.3, 0.4], &mut jacobian);
    let height = |a: f64| -a.sin();
    assert!((jacobian[(0, 1)] - 0.4 * height(0.7)).abs() < 1e-14);
}

#[test]
fn bones_of_another_skeleton_are_rejected() {
    let bone = |name: &str, parent| Bone {
        name: name.to_owned(),
        parent,
        length: 1.0,
        model_from_rest: Placement::identity(),
        limits: [Limits::UNBOUNDED; 3],
    };
    let one = Skeleton::new("one", vec![bone("a", None)]).unwrap();
    let two = Skeleton::new("two", vec![bone("a", None), bone("b", None)]).unwrap();
    let foreign = two.bone("b").unwrap();
    let pose = one.pose(&[0.0; 3]).unwrap();
    let refused = ModelError::ForeignBone { bone: 1, bones: 1 };
    assert_eq!(pose.tail(foreign).unwrap_err(), refused);
    assert_eq!(pose.tip(&one, foreign).unwrap_err(), refused);
    assert_eq!(pose.tip(&two, foreign).unwrap_err(), refused);
}

#[test]
fn ratios_that_overflow_along_a_chain_are_named() {
    let mut builder = Model::builder("chain");
    let axis = Vector3::new(0.0, 0.0, 1.0);
    let mut joint = |name: &str| builder.continuous(name, None, Placement::identity(), axis);
    let [a, b, c] = ["a", "b", "c"].map(&mut joint);
    let model = builder.build().unwrap();
    let map = ParameterMap::builder(&model)
        .with_coupled(b, a, 1e200, 0.0)
        .with_coupled(c, b, 1e200, 0.0)
        .build();
    assert!(
        matches!(map, Err(ModelError::NotFinite { ref joint, .. }) if joint == "c"),
        "{map:?}"
    );
}

#[test]
fn fixed_joint_needs_no_axis() {
    use kinopt::model::{Joint, JointKind};
    let mut builder = Model::builder("fixed");
    let (origin, locked) = (Placement::identity(), Limits::new(0.0, 0.0));
    let weld = Joint::new(
        "weld",
        None,
        origin,
        JointKind::Fixed,
        Vector3::zero(),
        locked,
    );
    builder.joint(weld);
    assert!(builder.build().is_ok());
}

/// One row, and an inequality of any rows.
#[derive(Clone)]
struct OneSided {
    frame: FrameId,
    rows: Range<usize>,
}

impl Residual for OneSided {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], residual: &mut [S]) {
        residual[0] = frames[0].translation.z.max(S::zero());
    }
}

impl InequalityResidual for OneSided {
    fn inequalities(&self) -> Vec<Inequality> {
        vec![Inequality::new(self.rows.clone(), 1)]
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], depths: &mut [S]) {
        depths[0] = -frames[0].translation.z;
    }
}

/// Row indices are the residual's own, whatever tasks precede it.
#[test]
fn inequality_rows_are_validated() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-1.0, 1.0)));
    let frame = model.frame("tip").unwrap();
    for before in 0..3 {
        for (room, fits) in [(0..1, true), (0..0, false), (0..2, false), (1..2, false)] {
            let mut builder = Problem::builder(&model);
            for _ in 0..before {
                builder.add(Point::new(frame, [0.6, 0.4, 0.0]));
            }
            let message = format!("an inequality of its rows {room:?}, but 1 rows");
            builder.add(OneSided { frame, rows: room });
            match builder.build() {
                Ok(_) => assert!(fits, "{before}: {message}"),
                Err(refused) => assert!(refused.to_string().contains(&message), "{refused}"),
            }
        }
    }
}
