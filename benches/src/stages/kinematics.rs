//! Forward kinematics of whole skeletons, and derivatives of five tips.

use std::error::Error;
use std::hint::black_box;

use kinopt::model::FrameId;
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::skeleton::Posing;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, rotation_log};
use kinopt::task::{Inputs, Point, Quantity, Residual, RowBlock};
use kinopt::{Problem, Scalar};
use nalgebra::DMatrix;

use super::{Run, Stage, single};
use crate::{Sequence, every_angle_free, figure};

pub(super) fn stages() -> Vec<Stage> {
    vec![
        single("forward kinematics, 22 bones", || forward(2, 4)),
        single("forward kinematics, 60 bones", || forward(10, 10)),
        single("Jacobian, analytic, 22 bones", || {
            jacobian(five_tips()?, Derivatives::Analytic)
        }),
        single("Jacobian, dual numbers, 22 bones", || {
            jacobian(five_tips()?, Derivatives::Dual)
        }),
        single("Jacobian, user-defined residual, 22 bones", || {
            jacobian(five_spheres()?, Derivatives::Analytic)
        }),
        single("Jacobian, forward differences, 22 bones", || {
            jacobian(five_tips()?, Derivatives::ForwardDifference)
        }),
        single("Jacobian, central differences, 22 bones", || {
            jacobian(five_tips()?, Derivatives::CentralDifference)
        }),
        single("gradient, reverse mode, 22 bones", gradient),
    ]
}

/// Alternates between two configurations, so that no forward pass is reused.
fn configurations(count: usize) -> [Vec<f64>; 2] {
    let mut random = Sequence::new(0.5);
    let x: Vec<f64> = (0..count).map(|_| random.unit() - 0.5).collect();
    let y = x.iter().map(|v| v + 1e-3).collect();
    [x, y]
}

fn forward(spine: usize, per_limb: usize) -> Result<Run, Box<dyn Error>> {
    let (skeleton, _) = figure(spine, per_limb);
    let mut posing = Posing::new(&skeleton);
    let configurations = configurations(skeleton.angles());
    let mut index = 0;
    Ok(Box::new(move || {
        index ^= 1;
        black_box(posing.pose(&configurations[index]).ok());
    }))
}

/// Five tips of 22 bones; every angle is a variable.
fn five_tips() -> Result<Problem, Box<dyn Error>> {
    let (skeleton, tips) = figure(2, 4);
    let skeleton = every_angle_free(&skeleton);
    let mut builder = Problem::builder(skeleton.model());
    for tip in tips {
        builder.add(Point::new(skeleton.tip(tip), [0.1, 0.2, 0.3]));
    }
    Ok(builder.build()?)
}

/// Distance of a frame from the unit sphere about the origin, and the rotation vector of the frame.
#[derive(Clone)]
struct OnSphere {
    frame: FrameId,
}

impl Residual for OnSphere {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::Metres, 1),
            RowBlock::new(Quantity::Radians, 3),
        ]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let p = frames[0].translation;
        residual[0] = (p.x * p.x + p.y * p.y + p.z * p.z).sqrt() - S::one();
        residual[1..].copy_from_slice(&rotation_log(&frames[0].rotation).to_array());
    }
}

/// Five tips of 22 bones, each with a residual that brings no derivative; every angle is a variable.
fn five_spheres() -> Result<Problem, Box<dyn Error>> {
    let (skeleton, tips) = figure(2, 4);
    let skeleton = every_angle_free(&skeleton);
    let mut builder = Problem::builder(skeleton.model());
    for tip in tips {
        builder.add(OnSphere {
            frame: skeleton.tip(tip),
        });
    }
    Ok(builder.build()?)
}

fn jacobian(problem: Problem, route: Derivatives) -> Result<Run, Box<dyn Error>> {
    let problem = problem.with_derivatives(route);
    let configurations = configurations(problem.variables());
    let mut scratch = problem.scratch();
    let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
    let mut index = 0;
    Ok(Box::new(move || {
        index ^= 1;
        Evaluation::new(&problem, &mut scratch).jacobian(&configurations[index], &mut jacobian);
        black_box(&jacobian);
    }))
}

fn gradient() -> Result<Run, Box<dyn Error>> {
    let problem = five_tips()?;
    let configurations = configurations(problem.variables());
    let mut scratch = problem.scratch();
    let (m, n) = (problem.rows(), problem.variables());
    let (residual, mut gradient) = (vec![0.1; m], vec![0.0; n]);
    let mut jacobian = DMatrix::zeros(m, n);
    let mut index = 0;
    Ok(Box::new(move || {
        index ^= 1;
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        evaluation.gradient(
            &configurations[index],
            &residual,
            &mut gradient,
            &mut jacobian,
        );
        black_box(&gradient);
    }))
}
