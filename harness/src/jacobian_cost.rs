//! Cost of one Jacobian on chains of increasing length.
//!
//! The analytic mode is expected to cost O(m) for m bones, finite differences O(m²).

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::Problem;
use kinopt::model::Limits;
use kinopt::model::ModelError;
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use crate::clock;
use crate::route::route_name;

/// Lengths of the chains, in bones; every bone has three free angles.
pub const BONES: [usize; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];

/// Least duration of a batch of evaluations; the fastest batch counts.
const MIN_BATCH_TIME: Duration = Duration::from_micros(500);
const BATCHES: usize = 5;

/// Cost of one Jacobian by one derivative mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JacobianCost {
    /// Derivative mode.
    pub route: String,
    /// Number of bones, and microseconds.
    pub points: Vec<(usize, f64)>,
}

impl JacobianCost {
    /// Exponent p in cost ∝ mᵖ, from the longest chain and one of a quarter of its length; `None` without the latter.
    #[must_use]
    pub fn exponent(&self) -> Option<f64> {
        let (&(bones, micros), before) = self.points.split_last()?;
        let quarter = before.iter().find(|(fewer, _)| 4 * fewer == bones)?;
        Some((micros / quarter.1).ln() / 4_f64.ln())
    }
}

/// Measures all derivative modes on chains of up to `max_bones` bones, with a target for the last tip. `progress` is called
/// between two measurements and may break; finished measurements are returned.
///
/// # Errors
/// None with these chains.
pub fn measure(
    max_bones: usize,
    progress: &mut dyn FnMut() -> ControlFlow<()>,
) -> Result<Vec<JacobianCost>, ModelError> {
    let empty = |route: Derivatives| JacobianCost {
        route: route_name(route).to_owned(),
        points: Vec::new(),
    };
    let mut costs: Vec<JacobianCost> = Derivatives::ALL.map(empty).into();
    for bones in BONES.into_iter().filter(|&bones| bones <= max_bones) {
        let skeleton = chain(bones)?;
        let Some(tip) = skeleton.bone_ids().last() else {
            continue;
        };
        let mut builder = Problem::builder(skeleton.model());
        builder.add(Point::new(skeleton.tip(tip), [0.1, 0.2, 0.3]));
        let Ok(problem) = builder.build() else {
            continue;
        };
        for (route, cost) in Derivatives::ALL.into_iter().zip(&mut costs) {
            if progress().is_break() {
                return Ok(costs);
            }
            let problem = problem.clone().with_derivatives(route);
            cost.points.push((bones, micros_of_one(&problem)));
        }
    }
    Ok(costs)
}

/// Chain of bones along x, each 1 / `bones` long, with free angles.
fn chain(bones: usize) -> Result<Skeleton, ModelError> {
    let length = 1.0 / bones as f64;
    let mut builder = Skeleton::builder("chain");
    let mut parent = None;
    for index in 0..bones {
        let tail = Vector3::new(length * index as f64, 0.0, 0.0);
        parent = Some(builder.add(Bone {
            name: format!("bone/{index}"),
            parent,
            length,
            model_from_rest: Placement::translation(tail),
            limits: [Limits::UNBOUNDED; 3],
        }));
    }
    builder.build()
}

fn micros_of_one(problem: &Problem) -> f64 {
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(problem, &mut scratch);
    let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
    // Alternates between two configurations, so that no forward pass is reused.
    let first: Vec<f64> = (0..problem.variables())
        .map(|k| 0.3 * (k as f64).sin())
        .collect();
    let second: Vec<f64> = first.iter().map(|x| x + 1e-3).collect();
    let mut batch = |pairs: u32| {
        let ((), elapsed) = clock::time(|| {
            for _ in 0..pairs {
                evaluation.jacobian(&first, &mut jacobian);
                evaluation.jacobian(&second, &mut jacobian);
            }
        });
        elapsed
    };
    let mut pairs = 1;
    while batch(pairs) < MIN_BATCH_TIME {
        pairs *= 2;
    }
    let fastest = (0..BATCHES).map(|_| batch(pairs)).min();
    fastest.unwrap_or_default().as_secs_f64() * 1e6 / (2.0 * f64::from(pairs))
}
