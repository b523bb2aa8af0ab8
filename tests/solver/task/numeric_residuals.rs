//! Promise: a numeric residual is equivalent to one over scalars. Values, solutions and derivatives by every route are
//! equal. Without derivatives it uses differences.

use kinopt::model::{FrameId, JointId, Limits, Model};
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Bounded, Inputs, LocalJacobian, Numeric, NumericResidual, Quantity, Residual, RowBlock,
};
use kinopt::{Problem, Scalar, Solver};
use nalgebra::DMatrix;
use support::random::Random;
use support::trees::RandomTree;

/// An axis and origin of frames and a joint in nonlinear rows.
#[derive(Clone)]
struct Mixed {
    frames: [FrameId; 2],
    joint: JointId,
    by_hand: bool,
}

fn mixed<S: Scalar>(frames: &[Placement<S>], joints: &[S], r: &mut [S]) {
    let [a, b] = [frames[0], frames[1]];
    r[0] = a.translation.dot(b.translation) + joints[0] * joints[0];
    r[1] = a.rotation.x.dot(b.translation) - joints[0].sin_cos().0;
}

impl Residual for Mixed {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames).with_joints([self.joint])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        mixed(frames, joints, residual);
    }
}

impl NumericResidual for Mixed {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames).with_joints([self.joint])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, 2)]
    }

    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
        mixed(frames, joints, residual);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        if !self.by_hand {
            return false;
        }
        let [a, b] = [frames[0], frames[1]];
        jacobian.linear_mut(0)[0] = b.translation;
        jacobian.linear_mut(1)[0] = a.translation;
        jacobian.linear_mut(1)[1] = a.rotation.x;
        // (ω × x) · t = ω · (x × t)
        jacobian.angular_mut(0)[1] = a.rotation.x.cross(b.translation);
        jacobian.joint_mut(0)[0] = 2.0 * joints[0];
        jacobian.joint_mut(0)[1] = -joints[0].cos();
        true
    }
}

fn problem<R: Residual>(tree: &RandomTree, residual: R, is_bounded: bool) -> Problem {
    let mut tasks = Problem::builder(&tree.model);
    match is_bounded {
        true => {
            tasks.add(Bounded::new(residual, 0.01));
        }
        false => {
            tasks.add(residual);
        }
    }
    tasks.build().unwrap()
}

fn jacobian(problem: &Problem, x: &[f64]) -> DMatrix<f64> {
    let mut scratch = problem.scratch();
    let mut jacobian = DMatrix::from_element(problem.rows(), problem.variables(), f64::NAN);
    Evaluation::new(problem, &mut scratch).jacobian(x, &mut jacobian);
    jacobian
}

#[test]
fn derivative_routes_match_the_scalar_residual() {
    for seed in 0..30 {
        let tree = RandomTree::new(seed, 7);
        let frames = [tree.far_frame(), tree.model.frame_ids().next().unwrap()];
        let joint = tree.model.moving_joints()[0];
        let mixed = |by_hand| Mixed {
            frames,
            joint,
            by_hand,
        };
        let q = tree.configuration(&mut Random::new(seed));
        for is_bounded in [false, true] {
            let exact = problem(&tree, mixed(true), is_bounded);
            let mut x = vec![0.0; exact.variables()];
            exact.parameters().reduce(&q, &mut x).unwrap();
            let expected = jacobian(&exact, &x);
            let size = expected
                .iter()
                .fold(1.0, |largest: f64, v| largest.max(v.abs()));
            for by_hand in [true, false] {
                let allowed = if by_hand { 1e-12 } else { 1e-8 };
                let numeric = problem(&tree, Numeric(mixed(by_hand)), is_bounded);
                for route in [Derivatives::Analytic, Derivatives::Dual] {
                    let found = jacobian(&numeric.clone().with_derivatives(route), &x);
                    let error = (found - &expected).amax() / size;
                    assert!(error <= allowed, "seed {seed}, {route:?}: off by {error:e}");
                }
            }
        }
    }
}

#[test]
fn solutions_match_the_scalar_residual() {
    #[derive(Clone)]
    struct At(FrameId, Vector3<f64>);
    impl NumericResidual for At {
        fn inputs(&self) -> Inputs {
            Inputs::frames([self.0])
        }

        fn rows(&self) -> Vec<RowBlock> {
            vec![RowBlock::new(Quantity::Metres, 3)]
        }

        fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
            residual.copy_from_slice(&(frames[0].translation - self.1).to_array());
        }
    }
    for seed in 0..20 {
        let tree = RandomTree::new(seed, 7);
        let mut random = Random::new(seed);
        let q = tree.configuration(&mut random);
        let start = tree.configuration(&mut random);
        let mut places = kinopt::kinematics::ForwardKinematics::new(&tree.model);
        let target = places.place(&q).unwrap()[tree.far_frame().index()].translation;
        let numeric = problem(&tree, Numeric(At(tree.far_frame(), target)), false);
        let point = kinopt::task::Point::new(tree.far_frame(), target);
        let point = problem(&tree, point, false);
        let [ours, theirs] = [numeric, point].map(|problem| {
            let solution = Solver::default().solve_once(&problem, &start);
            solution.unwrap()
        });
        assert_eq!(ours.reached, theirs.reached, "seed {seed}");
    }
}

/// Steps of differences scale with the coordinates, so slopes are accurate at 1000 km.
#[test]
fn difference_steps_scale_with_coordinates() {
    #[derive(Clone)]
    struct Away(FrameId);
    impl NumericResidual for Away {
        fn inputs(&self) -> Inputs {
            Inputs::frames([self.0])
        }

        fn rows(&self) -> Vec<RowBlock> {
            vec![RowBlock::new(Quantity::Metres, 1)]
        }

        fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
            residual[0] = frames[0].translation.norm();
        }
    }
    for size in [1.0, 1e6] {
        let mut model = Model::builder("far");
        let at = Placement::translation(Vector3::new(size, 2.0 * size, 0.0));
        let x = Vector3::new(1.0, 0.0, 0.0);
        let slide = model.prismatic("slide", None, at, x, Limits::new(-1.0, 1.0));
        let tip = model.frame("tip", Some(slide), Placement::identity());
        let model = model.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Numeric(Away(tip)));
        let slope = jacobian(&tasks.build().unwrap(), &[0.5])[(0, 0)];
        let expected_distance = size + 0.5;
        let expected = expected_distance / expected_distance.hypot(2.0 * size);
        assert!(
            (slope - expected).abs() < 1e-9,
            "{size}: {slope} {expected}"
        );
    }
}

/// The same for joints, in both directions from zero.
#[test]
fn difference_steps_scale_with_joint_values() {
    #[derive(Clone)]
    struct Along(JointId);
    impl NumericResidual for Along {
        fn inputs(&self) -> Inputs {
            Inputs::joints([self.0])
        }

        fn rows(&self) -> Vec<RowBlock> {
            vec![RowBlock::new(Quantity::Metres, 1)]
        }

        fn evaluate(&self, _frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
            residual[0] = 0.3 * joints[0];
        }
    }
    let mut model = Model::builder("long");
    let x = Vector3::new(1.0, 0.0, 0.0);
    let limits = Limits::new(-1e7, 1e7);
    model.prismatic("slide", None, Placement::identity(), x, limits);
    let model = model.build().unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(Numeric(Along(model.moving_joints()[0])));
    let problem = tasks.build().unwrap();
    for at in [-1e6, 0.1, 1e6] {
        let slope = jacobian(&problem, &[at])[(0, 0)];
        assert!((slope - 0.3).abs() < 1e-9, "{at}: {slope}");
    }
}
