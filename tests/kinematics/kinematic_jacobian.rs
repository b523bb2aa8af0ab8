//! Promise: the Jacobian of tips with respect to stacked Euler angles equals finite differences with h = 1e-7.
//! Differences and forward mode evaluate once per variable or group of variables; the analytic route evaluates equally
//! often for sixty variables as for six.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use kinopt::Scalar;
use kinopt::model::{FrameId, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation, Problem};
use kinopt::solver::LeastSquares;
use kinopt::spatial::Placement;
use kinopt::task::{Inputs, Point, Quantity, Residual, RowBlock};
use nalgebra::DMatrix;
use support::bones::RandomRig;
use support::planar_arm;
use support::random::Random;
use support::trees::configuration_of;

#[test]
fn jacobian_matches_differences_of_the_recursion() {
    const H: f64 = 1e-7;
    for seed in 0..4 {
        let rig = RandomRig::new(seed);
        let model = rig.skeleton.model();
        let q = configuration_of(model, &mut Random::new(seed));
        let mut builder = Problem::builder(model);
        // Every angle, also locked ones, so that columns are those of the stacked vector.
        builder.parameters(ParameterMap::identity(model));
        for &tip in &rig.tips {
            builder.add(Point::new(rig.skeleton.tip(tip), [0.0; 3]));
        }
        let problem = builder.build().unwrap();
        let angles = rig.skeleton.angles();
        assert_eq!((problem.rows(), problem.variables()), (15, angles));

        let tips = |q: &[f64]| -> Vec<f64> {
            let posed = rig.transforms(q);
            let tips = rig.tips.iter().map(|&tip| rig.tip(&posed, tip));
            tips.flat_map(|tip| tip.as_slice().to_vec()).collect()
        };
        let start_tips = tips(&q);
        let mut quotient = DMatrix::zeros(15, angles);
        for j in 0..angles {
            let mut moved = q.clone();
            moved[j] += H;
            for (i, (moved_tip, tip)) in tips(&moved).iter().zip(&start_tips).enumerate() {
                quotient[(i, j)] = (moved_tip - tip) / H;
            }
        }
        for route in Derivatives::ALL {
            let problem = problem.clone().with_derivatives(route);
            let mut scratch = problem.scratch();
            let mut jacobian = DMatrix::from_element(15, angles, f64::NAN);
            Evaluation::new(&problem, &mut scratch).jacobian(&q, &mut jacobian);
            let deviation = (&jacobian - &quotient).amax();
            assert!(deviation < 1e-6, "{route:?}: off by {deviation:e}");
        }
    }
}

/// Position of a frame, with a counter of evaluations.
#[derive(Clone)]
struct Counted {
    frame: FrameId,
    calls: Arc<AtomicUsize>,
}

impl Residual for Counted {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 3)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        self.calls.fetch_add(1, Ordering::Relaxed);
        residual.copy_from_slice(&frames[0].translation.to_array());
    }
}

#[test]
fn derivative_routes_have_known_evaluation_counts() {
    let evaluations = |joints: usize, route: Derivatives, gradient: bool| {
        let model = planar_arm(&vec![0.1; joints], None);
        let calls = Arc::new(AtomicUsize::new(0));
        let mut builder = Problem::builder(&model);
        builder.derivatives(route);
        let frame = model.frame("tip").unwrap();
        let counted = calls.clone();
        builder.add(Counted {
            frame,
            calls: counted,
        });
        let problem = builder.build().unwrap();
        let mut scratch = problem.scratch();
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let x = vec![0.1; joints];
        let (mut jacobian, mut r) = (DMatrix::zeros(3, joints), [0.0; 3]);
        evaluation.residual(&x, &mut r);
        calls.store(0, Ordering::Relaxed);
        if gradient {
            evaluation.gradient(&x, &r, &mut vec![0.0; joints], &mut jacobian);
        } else {
            evaluation.jacobian(&x, &mut jacobian);
        }
        calls.load(Ordering::Relaxed)
    };
    for n in [6, 12, 60] {
        let jacobian = |route| evaluations(n, route, false);
        assert_eq!(jacobian(Derivatives::ForwardDifference), n + 1);
        assert_eq!(jacobian(Derivatives::CentralDifference), 2 * n);
        assert_eq!(jacobian(Derivatives::Dual), n / 6);
        // A frame has six degrees of freedom, which is one group of six.
        assert_eq!(jacobian(Derivatives::Analytic), 1);
        // Reverse mode: the gradient of all variables in one sweep.
        assert_eq!(evaluations(n, Derivatives::Analytic, true), 1);
    }
}
