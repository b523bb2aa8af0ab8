//! Minimisation of the distance of two links, to find out if they can touch.

use std::sync::Arc;

use super::CollisionModel;
use super::link_shapes::LinkShapes;
use crate::collision::{ROUNDING, Separation};
use kinopt_kinematics::model::{FrameId, ModelError};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::Problem;
use kinopt_solver::problem::Evaluation;
use kinopt_solver::solver::{LevenbergMarquardt, Silent, SolverState, Stopping, minimise};
use kinopt_solver::task::{
    Description, Inputs, LocalJacobian, Numeric, NumericResidual, Quantity, RowBlock,
};

/// Penetration depth that a descent aims at, metres. A descent to depth 0 ends slightly before contact.
const TARGET_PENETRATION: f64 = 1e-3;
/// Largest number of iterations of a descent, and of iterations that do not halve the cost.
const MAX_ITERATIONS: usize = 60;
const MAX_STALLED_ITERATIONS: usize = 12;

/// Residual: the distance of two links; 0 if they touch.
#[derive(Clone, Debug)]
struct LinkDistance {
    links: [FrameId; 2],
    shapes: [Arc<LinkShapes>; 2],
}

impl LinkDistance {
    fn separation(&self, frames: &[Placement<f64>]) -> Option<Separation> {
        let [first, second] = &self.shapes;
        first.separation(&frames[0], second, &frames[1], f64::INFINITY)
    }
}

impl NumericResidual for LinkDistance {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.links)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate(&self, frames: &[Placement<f64>], _joints: &[f64], residual: &mut [f64]) {
        let distance = self
            .separation(frames)
            .map_or(0.0, |separation| separation.distance);
        residual[0] = match distance <= ROUNDING {
            true => 0.0,
            false => distance + TARGET_PENETRATION,
        };
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        if let Some(separation) = self.separation(frames) {
            // The distance grows as the second link moves along the normal or the first against it.
            let slopes = [
                (-separation.normal, separation.on_first),
                (separation.normal, separation.on_second),
            ];
            for (frame, (slope, point)) in slopes.into_iter().enumerate() {
                let lever = point - frames[frame].translation;
                jacobian.linear_mut(frame)[0] += slope;
                jacobian.angular_mut(frame)[0] += lever.cross(slope);
            }
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("distance of links")
    }
}

impl CollisionModel {
    /// True if minimising the distance of two links with the given shapes makes them touch, from one of the samples.
    ///
    /// The joints stay within their limits.
    ///
    /// # Errors
    /// Returns an error if a sampled configuration contains NaN.
    pub(super) fn can_touch(
        &self,
        links: [FrameId; 2],
        shapes: [Arc<LinkShapes>; 2],
        seed: u64,
        samples: impl Iterator<Item = u64>,
    ) -> Result<bool, ModelError> {
        let mut tasks = Problem::builder(&self.model);
        tasks.parameters(self.map.clone());
        tasks.add(Numeric(LinkDistance { links, shapes }));
        // Without a free variable the links cannot be brought into contact.
        let Ok(problem) = tasks.build() else {
            return Ok(false);
        };
        let mut scratch = problem.scratch();
        let mut state = SolverState::default();
        let mut x = vec![0.0; self.map.variables()];
        let limits = Stopping::default().with_max_iterations(MAX_ITERATIONS);
        let limits = limits.with_patience(Some(MAX_STALLED_ITERATIONS));
        for sample in samples {
            self.sample_configuration(seed, sample, &mut x)?;
            let result = minimise(
                &mut Evaluation::new(&problem, &mut scratch),
                &LevenbergMarquardt::default(),
                &x,
                &limits,
                &mut Silent,
                &mut state,
            );
            // The rows of loop closures follow the distance.
            if result.is_ok() && state.residual().first() == Some(&0.0) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::LinkDistance;
    use crate::collision::{CollisionModel, CollisionObject, Shape};
    use kinopt_kinematics::model::{Limits, Model};
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::spatial::{Placement, Vector3, rotation_exp};
    use kinopt_solver::task::{
        Inputs, LocalJacobian, Numeric, NumericResidual, Residual, RowBlock,
    };

    /// The same residual with numerical derivatives.
    #[derive(Clone)]
    struct NumericalDistance(LinkDistance);

    impl NumericResidual for NumericalDistance {
        fn inputs(&self) -> Inputs {
            self.0.inputs()
        }

        fn rows(&self) -> Vec<RowBlock> {
            self.0.rows()
        }

        fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
            self.0.evaluate(frames, joints, residual);
        }
    }

    /// For two capsules, whose closest points move smoothly with the links.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn link_distance_derivatives_match_differences() {
        let (z, limits) = (Vector3::UNITS[2], Limits::new(-1.0, 1.0));
        let mut builder = Model::builder("two links");
        let links = ["first", "second"].map(|name| {
            let joint = builder.revolute(name, None, Placement::identity(), z, limits);
            builder.frame(format!("{name} link"), Some(joint), Placement::identity())
        });
        let model = builder.build().unwrap();
        let capsule = Shape::capsule(0.05, 0.3).unwrap();
        let offset = Placement::translation(Vector3::new(0.4, 0.1, -0.2));
        let objects =
            links.map(|link| CollisionObject::new("capsule", link, offset, capsule.clone()));
        let bodies = CollisionModel::new(&model, objects.into()).unwrap();
        let mut shapes = bodies.link_shapes().into_iter().map(Arc::new);
        let shapes = [shapes.next().unwrap(), shapes.next().unwrap()];
        let distance = LinkDistance { links, shapes };

        let mut random = RandomStream::new(5, 0);
        let mut vector = |size: f64| {
            let [x, y, z] = [(); 3].map(|()| random.unit() - 0.5);
            Vector3::new(x, y, z) * size
        };
        let [mut analytic, mut numerical] = [(); 2].map(|()| LocalJacobian::default());
        for case in 0..50 {
            let frames = [(); 2].map(|()| Placement::new(rotation_exp(vector(4.0)), vector(1.0)));
            let separation = distance.separation(&frames);
            if separation.is_none_or(|separation| separation.distance < 0.05) {
                continue;
            }
            analytic.reset(1, 2, 0);
            distance.differentiate(&frames, &[], &mut analytic);
            numerical.reset(1, 2, 0);
            Numeric(NumericalDistance(distance.clone())).differentiate(
                &frames,
                &[],
                &mut numerical,
            );
            for frame in 0..2 {
                let [analytic, numerical] = [&analytic, &numerical]
                    .map(|slopes| [slopes.linear(frame)[0], slopes.angular(frame)[0]]);
                let difference = [analytic[0] - numerical[0], analytic[1] - numerical[1]];
                let is_close = |difference: &Vector3<f64>| {
                    difference
                        .to_array()
                        .iter()
                        .all(|difference| difference.abs() < 1e-6)
                };
                assert!(difference.iter().all(is_close), "{case}: {difference:?}");
            }
        }
    }
}
