//! A solution as the derivative sees it: its rows, and how they bend.

use nalgebra::DMatrix;

use super::directions::{Bound, Directions, list_bounds};
use super::rows::Roles;
use crate::buffer::refill;
use crate::problem::{Evaluation, Question, Scratch, Share, Standing};
use crate::solver::LeastSquares;

/// How far a place is moved for a difference of slopes, as a share of a radian or of the reach: with central
/// differences both what they leave out and what they lose to rounding are then near 1e-11.
const SHIFT: f64 = 1e-5;

/// What is differentiated, and the memory to evaluate it.
pub(super) struct Evaluator<'q, 's> {
    pub(super) question: Question<'q>,
    pub(super) scratch: &'s mut Scratch,
}

impl Evaluator<'_, '_> {
    pub(super) fn evaluation(&mut self) -> Evaluation<'_> {
        Evaluation::of(Share::All, self.question, self.scratch)
    }
}

/// A place, and the memory to look at it and around it.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub(super) x: Vec<f64>,
    /// The configuration that goes with x.
    q: Vec<f64>,
    /// The weighted residual of all tasks.
    pub(super) r: Vec<f64>,
    /// Its derivative by the variables.
    pub(super) jacobian: DMatrix<f64>,
    pub(super) roles: Roles,
    pub(super) bounds: Vec<Bound>,
    pub(super) directions: Directions,
    /// The derivative along the directions, column by column.
    pub(super) along: Vec<f64>,
    /// What each row counts in the slope: its residual where it pulls, its multiplier where it is held.
    pub(super) counts: Vec<f64>,
    shifted: Vec<f64>,
    slope: Vec<f64>,
    reduced: Vec<f64>,
}

impl Place {
    /// Goes to a configuration, which is of the problem's shape and finite.
    pub(super) fn go(&mut self, evaluator: &mut Evaluator<'_, '_>, q: &[f64]) {
        let question = evaluator.question;
        let problem = question.problem();
        let (n, m) = (problem.variables(), problem.rows());
        for (vector, len) in [
            (&mut self.x, n),
            (&mut self.r, m),
            (&mut self.counts, m),
            (&mut self.shifted, n),
            (&mut self.slope, n),
        ] {
            refill(vector, len, 0.0);
        }
        if self.jacobian.shape() != (m, n) {
            self.jacobian = DMatrix::zeros(m, n);
        }
        problem.parameters().gather(q, &mut self.x);
        question.space().project(&mut self.x);
        list_bounds(question, &mut self.x, &mut self.bounds);
        let mut evaluation = evaluator.evaluation();
        evaluation.residual(&self.x, &mut self.r);
        evaluation.analytic_jacobian(&self.x, &mut self.jacobian);
        self.roles.take(question, &self.r);
        evaluator.scratch.q().clone_into(&mut self.q);
    }

    /// Where it is, for what knows how variables move the model.
    pub(super) fn standing<'a>(&'a self, question: Question<'a>) -> Standing<'a> {
        Standing {
            map: question.parameters(),
            x: &self.x,
            q: &self.q,
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        let mut numbers = self.r.iter().chain(self.jacobian.as_slice());
        numbers.all(|value| value.is_finite())
    }

    /// Takes the directions that the held bounds leave free.
    pub(super) fn set_free(&mut self, question: Question<'_>) {
        let at = Standing {
            map: question.parameters(),
            x: &self.x,
            q: &self.q,
        };
        self.directions.take(question, &at, &self.bounds);
        let (rows, entries) = (self.jacobian.nrows(), self.jacobian.as_slice());
        self.directions.reduce(rows, entries, &mut self.along);
    }

    /// How far a direction is followed for a difference.
    pub(super) fn shift(&self, question: Question<'_>, y: &[f64]) -> f64 {
        let length = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        let problem = question.problem();
        let slides = problem.names().variable_is_angle.contains(&false);
        let reach = problem.reach();
        let unit = if slides && reach > 0.0 {
            reach.min(1.0)
        } else {
            1.0
        };
        SHIFT * unit / length
    }

    /// Writes x moved along directions.
    pub(super) fn moved(&mut self, y: &[f64], share: f64) -> &[f64] {
        self.shifted.copy_from_slice(&self.x);
        self.directions.expand(y, share, &mut self.shifted);
        &self.shifted
    }

    /// Where it was moved to last.
    pub(super) fn shifted(&self) -> &[f64] {
        &self.shifted
    }

    /// Adds what the rows' own bending does to a direction: Σ cᵢ ∇²rᵢ y, along the directions.
    pub(super) fn add_bend(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        y: &[f64],
        bend: &mut [f64],
    ) {
        let question = evaluator.question;
        let shift = self.shift(question, y);
        if !shift.is_finite() {
            return;
        }
        for share in [shift, -shift] {
            self.moved(y, share);
            let mut evaluation = evaluator.evaluation();
            evaluation.reverse_gradient(&self.shifted, &self.counts, &mut self.slope);
            self.directions.reduce(1, &self.slope, &mut self.reduced);
            for (bend, slope) in bend.iter_mut().zip(&self.reduced) {
                *bend += slope / (2.0 * share);
            }
        }
    }

    /// Writes Σ cᵢ ∇rᵢ by the variables, from the Jacobian that is here.
    pub(super) fn slope(&self, slope: &mut [f64]) {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        for (slope, column) in slope.iter_mut().zip(columns) {
            *slope = column.iter().zip(&self.counts).map(|(j, c)| j * c).sum();
        }
    }

    /// The largest Σ |cᵢ ∇rᵢ| of a variable: what cancels in a slope.
    pub(super) fn slope_scale(&self) -> f64 {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        let sums = columns.map(|column| {
            let terms = column.iter().zip(&self.counts);
            terms.map(|(j, c)| (j * c).abs()).sum()
        });
        sums.fold(0.0, f64::max)
    }

    /// The longest column of the Jacobian.
    pub(super) fn longest_column(&self) -> f64 {
        let rows = self.jacobian.nrows();
        let columns = self.jacobian.as_slice().chunks_exact(rows.max(1));
        let squares = columns.map(|column| column.iter().map(|j| j * j).sum::<f64>());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// The entries of one row along the directions.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = f64> + '_ {
        let rows = self.jacobian.nrows();
        (0..self.directions.len()).map(move |k| self.along[k * rows + row])
    }
}
