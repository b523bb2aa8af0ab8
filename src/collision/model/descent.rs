//! Whether two links can be brought to touch: down the slope of their distance.

use std::sync::Arc;

use super::CollisionModel;
use super::link_shapes::LinkShapes;
use crate::Problem;
use crate::collision::{ROUNDING, Separation};
use crate::model::{FrameId, ModelError};
use crate::problem::Evaluation;
use crate::solver::{LevenbergMarquardt, Silent, SolverState, Stopping, minimise};
use crate::spatial::Placement;
use crate::task::{LocalJacobian, Numeric, NumericResidual, Quantity, Rows};

/// So deep a descent aims, metres: aimed at touching alone, it ends a hair before it.
const DEPTH: f64 = 1e-3;
/// Steps of a descent, and of those that do not halve what is left.
const STEPS: usize = 60;
const PATIENCE: usize = 12;

/// How far two links are apart; nothing where they touch.
#[derive(Clone, Debug)]
struct Apart {
    links: [FrameId; 2],
    shapes: [Arc<LinkShapes>; 2],
}

impl Apart {
    fn separation(&self, frames: &[Placement<f64>]) -> Option<Separation> {
        let [first, second] = &self.shapes;
        first.apart(&frames[0], second, &frames[1], f64::INFINITY)
    }
}

impl NumericResidual for Apart {
    answers! {
        fn kind(&self) -> &'static str = "distance of links";
        fn frames(&self) -> Vec<FrameId> = self.links.to_vec();
        fn rows(&self) -> Vec<Rows> = vec![Rows::new(Quantity::Metres, 1)];
    }

    fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
        let distance = self.separation(frames).map_or(0.0, |found| found.distance);
        residual[0] = match distance <= ROUNDING {
            true => 0.0,
            false => distance + DEPTH,
        };
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        if let Some(found) = self.separation(frames) {
            // The distance grows as the second goes along the normal, and as the first goes back.
            let slopes = [
                (-found.normal, found.on_first),
                (found.normal, found.on_second),
            ];
            for (frame, (slope, point)) in slopes.into_iter().enumerate() {
                let lever = point - frames[frame].translation;
                jacobian.linear_mut(frame)[0] += slope;
                jacobian.angular_mut(frame)[0] += lever.cross(slope);
            }
        }
        true
    }
}

impl CollisionModel {
    /// Whether a descent within all limits on the distance of two links, of which the shapes are given, ends where they touch, from one of
    /// some samples.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub(super) fn can_touch(
        &self,
        links: [FrameId; 2],
        shapes: [Arc<LinkShapes>; 2],
        seed: u64,
        samples: impl Iterator<Item = u64>,
    ) -> Result<bool, ModelError> {
        let mut tasks = Problem::builder(&self.model);
        tasks.parameters(self.map.clone());
        tasks.add(Numeric(Apart { links, shapes }));
        // Where nothing is free to move, nothing comes to touch.
        let Ok(problem) = tasks.build() else {
            return Ok(false);
        };
        let mut scratch = problem.scratch();
        let mut state = SolverState::default();
        let mut x = vec![0.0; self.map.variables()];
        let limits = Stopping::default().with_max_iterations(STEPS);
        let limits = limits.with_patience(Some(PATIENCE));
        for sample in samples {
            self.draw(seed, sample, &mut x)?;
            let ended = minimise(
                &mut Evaluation::new(&problem, &mut scratch),
                &LevenbergMarquardt::default(),
                &x,
                &limits,
                &mut Silent,
                &mut state,
            );
            // Rows of loops come after.
            if ended.is_ok() && state.residual().first() == Some(&0.0) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
