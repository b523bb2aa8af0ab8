//! Promise: the derivative of a solution is as accurate near full stretch as elsewhere.

use kinopt::ik::{DerivativeWorkspace, SolutionDerivative};
use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use nalgebra::{DMatrix, DVector};

use crate::soft_task_fixtures::linearised;

/// J · dq/dtarget = 1 for an arm of three joints whose rows are nearly dependent. Normal equations would square the
/// condition number.
#[test]
fn derivative_near_full_stretch_is_accurate() {
    let mut builder = Model::builder("arm");
    let [_, y, z] = Vector3::UNITS;
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let all = Limits::new(-3.0, 3.0);
    let waist = builder.revolute("waist", None, Placement::identity(), z, all);
    let shoulder = builder.revolute("shoulder", Some(waist), Placement::identity(), y, all);
    let elbow = builder.revolute("elbow", Some(shoulder), link, y, all);
    let tip = builder.frame("tip", Some(elbow), link);
    let model = builder.build().unwrap();
    for bend in [1.0, 0.1, 0.03, 0.01, 0.003] {
        for waist in [0.3, 1.1, -2.0] {
            let q = [waist, 0.4, bend];
            let target = kinopt::kinematics::ForwardKinematics::new(&model)
                .place(&q)
                .unwrap()[tip.index()]
            .translation;
            let mut builder = Problem::builder(&model);
            builder.add(Point::new(tip, target));
            let problem = builder.build().unwrap();
            let mut memory = DerivativeWorkspace::default();
            let mut derivative = SolutionDerivative::new(&problem, &q, &mut memory).unwrap();
            let moved = derivative.by_target(0).unwrap();
            let (_, jacobian) = linearised(&problem, &q);
            let deviation = (&jacobian * &moved - DMatrix::identity(3, 3)).amax();
            assert!(deviation < 1e-12, "bent by {bend}: {deviation:e}");
            // Reverse mode as well: Jᵀ · gradient is the slope.
            let slope = [0.3, -0.2, 0.9];
            let mut gradient = derivative.parameters();
            derivative.gradient(&slope, &mut gradient).unwrap();
            let reported = DVector::from_column_slice(gradient.target(0));
            let deviation =
                (jacobian.transpose() * reported - DVector::from_column_slice(&slope)).amax();
            assert!(deviation < 1e-12, "bent by {bend}: {deviation:e}");
        }
    }
}
