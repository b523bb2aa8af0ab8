//! Forward and reverse products with the derivative, from one factorisation.

use nalgebra::DMatrix;

use super::kkt_point::Evaluator;
use super::system::inner;
use super::{Parts, SolutionDerivative};
use crate::problem::{ParameterVector, ProblemInstance};
use crate::search::SolveError;
use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::model::Model;

impl SolutionDerivative<'_> {
    /// Writes the velocity of the configuration for rates of the parameters (forward product).
    ///
    /// [`differentiability`](Self::differentiability) reports if it is the shortest of many, or invalid.
    ///
    /// # Errors
    /// Returns an error if `rates` has another shape or `v` has the wrong length.
    pub fn velocity(&mut self, rates: &ParameterVector, v: &mut [f64]) -> Result<(), SolveError> {
        self.check(v.len(), rates)?;
        let (instance, model) = (self.instance, self.model);
        if let Some((mut evaluator, parts)) = self.memory.split(instance) {
            parts.forward(&mut evaluator, model, rates, v);
        }
        Ok(())
    }

    /// Writes the gradient of a scalar by all parameters (reverse product).
    ///
    /// `slope` is the gradient of the scalar by the velocity of the configuration.
    ///
    /// # Errors
    /// Returns an error if `gradient` has another shape or `slope` has the wrong length.
    pub fn gradient(
        &mut self,
        slope: &[f64],
        gradient: &mut ParameterVector,
    ) -> Result<(), SolveError> {
        self.check(slope.len(), gradient)?;
        gradient.clear();
        let (instance, model) = (self.instance, self.model);
        if let Some((mut evaluator, parts)) = self.memory.split(instance) {
            parts.reverse(&mut evaluator, model, slope, gradient);
        }
        Ok(())
    }

    /// Returns the Jacobian by the target of one task: a row for each velocity element, a column for each target
    /// element.
    ///
    /// # Errors
    /// Returns an error if the task does not exist.
    pub fn by_target(&mut self, task: usize) -> Result<DMatrix<f64>, SolveError> {
        let problem = self.instance.problem();
        if task >= problem.tasks() {
            return Err(SolveError::NoSuchTask {
                given: task,
                tasks: problem.tasks(),
            });
        }
        let columns = self.instance.residual(task).target_len();
        let mut matrix = DMatrix::zeros(self.degrees_of_freedom(), columns);
        let instance = self.instance;
        if let Some((mut evaluator, parts)) = self.memory.split(instance)
            && !parts.slope_depends_on_parameters()
        {
            parts.velocities_of_target(&mut evaluator, task, &mut matrix);
            return Ok(matrix);
        }
        let mut rates = ParameterVector::new(problem);
        for k in 0..columns {
            rates.clear();
            rates.target_mut(task)[k] = 1.0;
            self.velocity(&rates, matrix.column_mut(k).as_mut_slice())?;
        }
        Ok(matrix)
    }

    fn check(&self, len: usize, parameters: &ParameterVector) -> Result<(), SolveError> {
        let expected = self.degrees_of_freedom();
        if len != expected {
            return Err(SolveError::VelocityLength {
                given: len,
                expected,
            });
        }
        let joints = self.model.map(|model| model.joints().len());
        match parameters.fits(self.instance.problem(), joints) {
            true => Ok(()),
            false => Err(SolveError::ForeignParameters),
        }
    }
}

impl super::DerivativeWorkspace {
    fn split<'s>(
        &'s mut self,
        instance: ProblemInstance<'s>,
    ) -> Option<(Evaluator<'s, 's>, &'s mut Parts)> {
        let scratch = self.scratch.as_mut()?;
        Some((Evaluator { instance, scratch }, &mut self.parts))
    }
}

impl Parts {
    fn forward(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        model: Option<&Model>,
        rates: &ParameterVector,
        v: &mut [f64],
    ) {
        refill(&mut self.rows, self.point.r.len(), 0.0);
        let mut evaluation = evaluator.evaluation();
        let (x, parameters) = (&self.point.x, &mut self.parameters);
        evaluation.rows_by_parameters(x, rates, model, parameters, &mut self.rows);
        self.velocity_of_rows(evaluator, Some((model, rates)), v);
    }

    /// Returns whether parameters change the gradient of the minimised rows beyond the change of their residual.
    fn slope_depends_on_parameters(&self) -> bool {
        self.system.has_curvature() && !self.point.roles.minimised.is_empty()
    }

    /// Writes the velocities for each element of a task's target. Valid if `slope_depends_on_parameters` is false.
    fn velocities_of_target(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        task: usize,
        matrix: &mut DMatrix<f64>,
    ) {
        let instance = evaluator.instance;
        let Some(target_task) = instance.problem().compiled_tasks().get(task) else {
            return;
        };
        let mut columns = std::mem::take(&mut self.columns);
        let mut evaluation = evaluator.evaluation();
        let point = &self.point;
        evaluation.rows_by_target(&point.x, task, &mut self.parameters, &mut columns);
        let row_count = target_task.rows.len().max(1);
        for (k, column) in columns.chunks_exact(row_count).enumerate() {
            refill(&mut self.rows, self.point.r.len(), 0.0);
            self.rows[target_task.rows.clone()].copy_from_slice(column);
            let mut v = matrix.column_mut(k);
            self.velocity_of_rows(evaluator, None, v.as_mut_slice());
        }
        self.columns = columns;
    }

    /// Writes the velocity for the row rates in `rows`.
    ///
    /// With curvature, the gradient also changes with the parameters `rates` directly.
    fn velocity_of_rows(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        rates: Option<(Option<&Model>, &ParameterVector)>,
        v: &mut [f64],
    ) {
        let instance = evaluator.instance;
        let needs_curvature = self.slope_depends_on_parameters();
        let Self {
            point,
            system,
            parameters,
            slope,
            step,
            rows,
            ..
        } = self;
        let (m, free) = (point.r.len(), point.directions.len());
        system.restore(point, rows, step);
        if !point.roles.minimised.is_empty() {
            refill(slope, free, 0.0);
            for (k, slope) in slope.iter_mut().enumerate() {
                let column = &point.reduced_jacobian[k * m..(k + 1) * m];
                let minimised = point.roles.minimised.iter();
                *slope = minimised.map(|&row| column[row] * rows[row]).sum();
            }
            if step.iter().any(|step| *step != 0.0) {
                system.add_hessian(evaluator, point, (step, slope));
            }
            if let Some((model, rates)) = rates.filter(|_| needs_curvature) {
                for k in 0..system.nullity() {
                    let direction = system.null_direction(k).to_vec();
                    let shift = point.difference_step(instance, &direction);
                    let mut curvature = 0.0;
                    for offset in [shift, -shift] {
                        let shifted_x = point.shift_x(&direction, offset).to_vec();
                        let mut evaluation = evaluator.evaluation();
                        evaluation.rows_by_parameters(&shifted_x, rates, model, parameters, rows);
                        curvature += inner(&point.row_weights, rows) / (2.0 * offset);
                    }
                    for (slope, entry) in slope.iter_mut().zip(direction) {
                        *slope += curvature * entry;
                    }
                }
            }
            system.add_minimising_step(slope, -1.0, step);
        }
        refill(&mut self.rates, point.x.len(), 0.0);
        point.directions.expand(step, 1.0, &mut self.rates);
        let tangent_point = point.tangent_point(instance);
        instance
            .problem()
            .tangent()
            .velocity(&tangent_point, &self.rates, v);
    }

    fn reverse(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        model: Option<&Model>,
        slope_by_v: &[f64],
        gradient: &mut ParameterVector,
    ) {
        let instance = evaluator.instance;
        let Self {
            point,
            system,
            rates,
            slope,
            step,
            image,
            rows,
            ..
        } = self;
        refill(rates, point.x.len(), 0.0);
        let tangent = instance.problem().tangent();
        tangent.add_slope(&point.tangent_point(instance), slope_by_v, rates);
        point.directions.reduce(1, rates, slope);
        refill(step, point.directions.len(), 0.0);
        refill(rows, point.r.len(), 0.0);
        if !point.roles.minimised.is_empty() {
            system.add_minimising_step(slope, -1.0, step);
        }
        if !point.roles.constrained.is_empty() {
            refill(image, step.len(), 0.0);
            if step.iter().any(|step| *step != 0.0) {
                system.add_hessian(evaluator, point, (step, image));
            }
            // `step` is the negative adjoint a: −(g − W a) = −(g + W step).
            for (slope, image) in slope.iter_mut().zip(&*image) {
                *slope = -(*slope + image);
            }
            system.add_constraint_multipliers(point, slope, rows);
        }
        self.add_slopes(evaluator, model, gradient);
    }

    /// Adds the derivative by the parameters of the Lagrangian gradient along `step`.
    pub(super) fn add_slopes_along(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        gradient: &mut ParameterVector,
    ) {
        refill(&mut self.rows, self.point.r.len(), 0.0);
        self.add_slopes(evaluator, None, gradient);
    }

    /// Adds that derivative and the derivatives of the rows, weighted by `rows`.
    fn add_slopes(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        model: Option<&Model>,
        gradient: &mut ParameterVector,
    ) {
        let instance = evaluator.instance;
        let Self {
            point,
            system,
            parameters,
            step,
            rows,
            ..
        } = self;
        let m = rows.len();
        for &row in &point.roles.minimised {
            let terms = step.iter().enumerate();
            rows[row] += terms
                .map(|(k, step)| step * point.reduced_jacobian[k * m + row])
                .sum::<f64>();
        }
        let mut evaluation = evaluator.evaluation();
        let row_weights = (&**rows, 1.0);
        evaluation.add_parameter_slopes(&point.x, row_weights, model, parameters, gradient);
        let shift = point.difference_step(instance, step);
        if !system.has_curvature() || !shift.is_finite() {
            return;
        }
        for offset in [shift, -shift] {
            let shifted_x = point.shift_x(step, offset).to_vec();
            let mut evaluation = evaluator.evaluation();
            let row_weights = (&*point.row_weights, 0.5 / offset);
            evaluation.add_parameter_slopes(&shifted_x, row_weights, model, parameters, gradient);
        }
    }
}
