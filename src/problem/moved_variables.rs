//! Reduced problem over the variables that move a task.
//!
//! All other variables keep their values. Most bones of a character move no task of a drag. The cost of a step grows
//! with the square and the cube of the number of variables.

use std::ops::ControlFlow;

use nalgebra::DMatrix;

use super::{Evaluation, Problem, ProblemInstance};
use crate::buffer::refill;
use crate::solver::{
    ConfigurationSpace, Iteration, LeastSquares, Observer, RotationSets, SolverState, Swing,
    TurnLimit,
};

/// Smallest number of variables for which the problem is reduced.
const MIN_REDUCED_VARIABLES: usize = 60;
/// Largest share of moved variables for which the problem is reduced.
const MAX_MOVED_FRACTION: f64 = 0.5;

/// Variables that move a task, with the rotation sets among them.
#[derive(Clone, Debug)]
pub(crate) struct MovedVariables {
    variables: Vec<usize>,
    /// Indices count the moved variables.
    rotations: RotationSets,
    step_scale: Vec<f64>,
}

impl MovedVariables {
    /// Selects the variables marked in `moving`; `None` if the reduction does not pay.
    pub(super) fn of(
        moving: &[bool],
        rotations: &RotationSets,
        step_scale: &[f64],
    ) -> Option<Self> {
        let marked = moving.iter().enumerate().filter(|(_, moving)| **moving);
        let variables: Vec<usize> = marked.map(|(variable, _)| variable).collect();
        let max_variables = MAX_MOVED_FRACTION * moving.len() as f64;
        if moving.len() < MIN_REDUCED_VARIABLES
            || variables.is_empty()
            || variables.len() as f64 > max_variables
        {
            return None;
        }
        let index_of = |variable: usize| variables.binary_search(&variable).ok();
        let mut rotation_sets = RotationSets::NONE;
        for first in &rotations.vectors {
            rotation_sets.vectors.extend(index_of(*first));
        }
        for swing in &rotations.swings {
            let first = index_of(swing.first);
            rotation_sets
                .swings
                .extend(first.map(|first| Swing { first, ..*swing }));
        }
        for turn in &rotations.turns {
            rotation_sets.turns.extend(renumbered(turn, &variables));
        }
        let scales = step_scale.len() == moving.len();
        let scaled = variables.iter().filter(|_| scales);
        Some(Self {
            step_scale: scaled.map(|&variable| step_scale[variable]).collect(),
            rotations: rotation_sets,
            variables,
        })
    }
}

fn renumbered(turn: &TurnLimit, variables: &[usize]) -> Option<TurnLimit> {
    let first = variables.binary_search(&turn.first).ok()?;
    let mut renumbered_turn = turn.clone();
    renumbered_turn.first = first;
    Some(renumbered_turn)
}

/// Scratch memory of a search over moved variables.
#[derive(Clone, Debug, Default)]
pub(crate) struct ReducedWorkspace {
    pub(crate) state: SolverState,
    /// All variables.
    pub(crate) x: Vec<f64>,
    /// All variables of the iterate that an observer sees.
    observed_x: Vec<f64>,
    gradient: Vec<f64>,
    jacobian: DMatrix<f64>,
    /// Start and bounds of the moved variables.
    start: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    turns: Vec<TurnLimit>,
}

impl ReducedWorkspace {
    /// Sets the start, given for all variables, and the bounds of a problem instance.
    pub(crate) fn begin(
        &mut self,
        instance: ProblemInstance<'_>,
        moved_variables: &MovedVariables,
        x: &[f64],
    ) {
        self.x.clear();
        self.x.extend_from_slice(x);
        instance.space().project(&mut self.x);
        self.observed_x.clone_from(&self.x);
        refill(&mut self.gradient, x.len(), 0.0);
        let selections = [
            (&mut self.start, x),
            (&mut self.lower, instance.lower()),
            (&mut self.upper, instance.upper()),
        ];
        for (to, from) in selections {
            to.clear();
            to.extend(
                moved_variables
                    .variables
                    .iter()
                    .map(|&variable| from[variable]),
            );
        }
        self.turns.clear();
        let turns = instance.turn_limits().iter();
        self.turns
            .extend(turns.filter_map(|turn| renumbered(turn, &moved_variables.variables)));
    }

    /// Writes the final moved variables into [`x`](Self::x).
    pub(crate) fn end(&mut self, moved_variables: &MovedVariables) {
        scatter(moved_variables, self.state.x(), &mut self.x);
    }
}

fn scatter(moved_variables: &MovedVariables, x: &[f64], all_x: &mut [f64]) {
    for (&variable, value) in moved_variables.variables.iter().zip(x) {
        all_x[variable] = *value;
    }
}

/// Least-squares problem over the moved variables.
pub(crate) struct ReducedProblem<'a, 'q> {
    pub(crate) evaluation: &'a mut Evaluation<'q>,
    pub(crate) moved_variables: &'a MovedVariables,
    pub(crate) buffers: ReducedBuffers<'a>,
}

/// Parts of a [`ReducedWorkspace`] that an evaluation uses.
pub(crate) struct ReducedBuffers<'a> {
    x: &'a mut [f64],
    gradient: &'a mut [f64],
    jacobian: &'a mut DMatrix<f64>,
    lower: &'a [f64],
    upper: &'a [f64],
    turns: &'a [TurnLimit],
}

impl ReducedBuffers<'_> {
    /// Sizes the Jacobian of all variables for a number of rows.
    fn fit_jacobian(&mut self, rows: usize) {
        let shape = (rows, self.x.len());
        if self.jacobian.shape() != shape {
            *self.jacobian = DMatrix::zeros(shape.0, shape.1);
        }
    }
}

impl ReducedWorkspace {
    /// The buffers, the start and the state of a search, and the variables that an observer sees.
    pub(crate) fn parts(&mut self) -> (ReducedBuffers<'_>, &[f64], &mut SolverState, &mut [f64]) {
        let buffers = ReducedBuffers {
            x: &mut self.x,
            gradient: &mut self.gradient,
            jacobian: &mut self.jacobian,
            lower: &self.lower,
            upper: &self.upper,
            turns: &self.turns,
        };
        (buffers, &self.start, &mut self.state, &mut self.observed_x)
    }
}

impl LeastSquares for ReducedProblem<'_, '_> {
    fn variables(&self) -> usize {
        self.moved_variables.variables.len()
    }

    fn rows(&self) -> usize {
        self.evaluation.rows()
    }

    fn lower(&self) -> &[f64] {
        self.buffers.lower
    }

    fn upper(&self) -> &[f64] {
        self.buffers.upper
    }

    fn step_scale(&self) -> &[f64] {
        &self.moved_variables.step_scale
    }

    fn is_reached(&self, residual: &[f64]) -> bool {
        self.evaluation.is_reached(residual)
    }

    fn stops_when_reached(&self) -> bool {
        self.evaluation.stops_when_reached()
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        let space = ConfigurationSpace::new(self.buffers.lower, self.buffers.upper);
        space.with_rotations(&self.moved_variables.rotations, self.buffers.turns)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        scatter(self.moved_variables, x, self.buffers.x);
        self.evaluation.residual(self.buffers.x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        scatter(self.moved_variables, x, self.buffers.x);
        let rows = jacobian.nrows();
        self.buffers.fit_jacobian(rows);
        let full_jacobian = &mut *self.buffers.jacobian;
        self.evaluation.jacobian(self.buffers.x, full_jacobian);
        let columns = jacobian.as_mut_slice().chunks_exact_mut(rows.max(1));
        for (column, &variable) in columns.zip(&self.moved_variables.variables) {
            column
                .copy_from_slice(&full_jacobian.as_slice()[variable * rows..(variable + 1) * rows]);
        }
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        _: &mut DMatrix<f64>,
    ) {
        scatter(self.moved_variables, x, self.buffers.x);
        self.buffers.fit_jacobian(residual.len());
        let buffers = &mut self.buffers;
        let (full_gradient, full_jacobian) = (&mut *buffers.gradient, &mut *buffers.jacobian);
        self.evaluation
            .gradient(buffers.x, residual, full_gradient, full_jacobian);
        for (entry, &variable) in gradient.iter_mut().zip(&self.moved_variables.variables) {
            *entry = self.buffers.gradient[variable];
        }
    }
}

/// Observer that receives all variables from a search over the moved ones.
pub(crate) struct FullObserver<'a> {
    pub(crate) observer: &'a mut dyn Observer,
    pub(crate) moved_variables: &'a MovedVariables,
    pub(crate) x: &'a mut [f64],
}

impl Observer for FullObserver<'_> {
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        scatter(self.moved_variables, iteration.x, self.x);
        let x = &*self.x;
        self.observer.observe(&Iteration { x, ..*iteration })
    }
}

impl Problem {
    /// The variables that move a task; `None` if the problem is not reduced.
    pub(crate) fn moved_variables(&self) -> Option<&MovedVariables> {
        self.moved_variables.as_ref()
    }
}
