//! Problem of one sample, with the memory to solve it.

use super::bounded_descent::BoundedDescent;
use crate::problem::{Evaluation, Problem, ProblemInstance, Scratch, Targets};
use crate::solver::LeastSquares;
use crate::spatial::Placement;

/// Problem that is solved sample by sample, each from the previous solution.
#[derive(Clone, Debug)]
pub(super) struct FrameProblem {
    problem: Problem,
    scratch: Scratch,
    descent: BoundedDescent,
}

impl FrameProblem {
    /// Creates it. `size` is that of [`BoundedDescent::new`].
    pub(super) fn new(problem: Problem, size: f64) -> Self {
        Self {
            scratch: problem.scratch(),
            descent: BoundedDescent::new(&problem, size),
            problem,
        }
    }

    #[must_use]
    pub(super) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Residual r at the end of the last descent.
    #[must_use]
    pub(super) fn residual(&self) -> &[f64] {
        self.descent.residual()
    }

    /// Descends from x within the bounds. Returns false and keeps x if a cost is not finite.
    pub(super) fn descend(
        &mut self,
        targets: &Targets,
        [lower, upper]: [&[f64]; 2],
        x: &mut [f64],
        steps: usize,
    ) -> bool {
        let instance = ProblemInstance::from(&self.problem).with_targets(targets);
        let instance = instance.within(lower, upper, &[]);
        let mut evaluation = Evaluation::new(instance, &mut self.scratch);
        let solved = self.descent.descend(&mut evaluation, x, steps);
        if solved {
            instance.space().project(x);
        }
        solved
    }

    /// Writes r at x, without collision avoidance.
    pub(super) fn residual_at(&mut self, targets: &Targets, x: &[f64], residual: &mut [f64]) {
        let instance = ProblemInstance::from(&self.problem).with_targets(targets);
        Evaluation::new(instance, &mut self.scratch).residual(x, residual);
    }

    /// Returns the pose of a task's first frame at x.
    pub(super) fn first_frame(&mut self, x: &[f64], task: usize) -> Option<Placement<f64>> {
        Evaluation::new(&self.problem, &mut self.scratch).first_frame(x, task)
    }

    /// Moves x back to a fraction `fraction` of its distance from `from`.
    pub(super) fn move_back(
        &self,
        [lower, upper]: [&[f64]; 2],
        from: &[f64],
        fraction: f64,
        x: &mut [f64],
    ) {
        let instance = ProblemInstance::from(&self.problem).within(lower, upper, &[]);
        let space = instance.space();
        let mut displacement = vec![0.0; x.len()];
        space.difference(x, from, &mut displacement);
        space.integrate_share(from, fraction, &displacement, x);
        space.project(x);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::FrameProblem;
    use crate::model::{Limits, Model};
    use crate::problem::Problem;
    use crate::spatial::{Placement, Vector3};
    use crate::task::Posture;

    #[test]
    fn move_back_scales_distance() {
        let mut builder = Model::builder("hinge");
        let (placement, z) = (Placement::identity(), Vector3::UNITS[2]);
        builder.revolute("hinge", None, placement, z, Limits::new(-2.0, 2.0));
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Posture::new(&model, &model.neutral()));
        let frame = FrameProblem::new(tasks.build().unwrap(), 1.0);
        let mut x = [1.1];
        // Half of 0.8, then a quarter of 0.4.
        for (fraction, remaining) in [(0.5, 0.4), (0.25, 0.1)] {
            frame.move_back([&[-2.0], &[2.0]], &[0.3], fraction, &mut x);
            assert!((x[0] - 0.3 - remaining).abs() < 1e-12, "{x:?}");
        }
    }
}
