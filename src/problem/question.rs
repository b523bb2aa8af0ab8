//! What a solver is asked: a problem, where its targets are, and within which bounds.

use super::{Problem, Scratch, Targets};
use crate::kinematics::Tree;
use crate::model::{Limits, ParameterMap};
use crate::solver::{ConfigurationSpace, RotationSets, TurnLimit};
use crate::task::ErasedResidual;

/// One question to a [`Problem`]. A reference to a problem is one: with the targets that it was built
/// with, within all its bounds.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) targets: &'a Targets,
    lower: &'a [f64],
    upper: &'a [f64],
    /// How far balls may go from where they stood.
    moves: &'a [TurnLimit],
    /// Which variables belong together as rotations, as steps are told at their edges.
    rotations: &'a RotationSets,
    tree: &'a Tree,
}

impl<'a> From<&'a Problem> for Question<'a> {
    fn from(problem: &'a Problem) -> Self {
        Self {
            problem,
            targets: &problem.targets,
            lower: problem.lower(),
            upper: problem.upper(),
            moves: &[],
            rotations: &problem.rotations,
            tree: &problem.tree,
        }
    }
}

impl<'a> Question<'a> {
    getters! {
        /// The problem that is asked.
        pub fn problem(&self) -> &'a Problem = self.problem;
        /// How many solver variables there are.
        pub fn variables(&self) -> usize = self.problem.variables();
        /// How many residual rows there are.
        pub fn rows(&self) -> usize = self.problem.rows();
        /// The map from variables to configurations.
        pub fn parameters(&self) -> &'a ParameterMap = self.problem.parameters();
        /// Scratch memory for this problem.
        pub fn scratch(&self) -> Scratch = self.problem.scratch();
        /// Lower bounds of the variables.
        pub fn lower(&self) -> &'a [f64] = self.lower;
        /// Upper bounds of the variables.
        pub fn upper(&self) -> &'a [f64] = self.upper;
        /// How far balls may go from where they stood.
        pub(crate) fn turn_limits(&self) -> &'a [TurnLimit] = self.moves;
        /// The compiled kinematics that the tasks' slots refer to.
        pub(crate) fn tree(&self) -> &'a Tree = self.tree;
    }

    /// The space of the variables, within these bounds.
    #[must_use]
    pub fn space(&self) -> ConfigurationSpace<'a> {
        ConfigurationSpace::new(self.lower, self.upper).with_rotations(self.rotations, self.moves)
    }

    /// The same with derivatives by the variables at the edges of cones and angles too, for who knows those by himself.
    pub(crate) fn by_variables(self) -> Self {
        Self {
            rotations: const { &RotationSets::NONE },
            ..self
        }
    }

    /// The same with other targets, which are of this problem.
    pub(crate) fn with_targets(self, targets: &'a Targets) -> Self {
        Self { targets, ..self }
    }

    /// The same within other bounds, which lie within the problem's, and with balls no further than these moves.
    pub(crate) fn within(self, lower: &'a [f64], upper: &'a [f64], moves: &'a [TurnLimit]) -> Self {
        Self {
            lower,
            upper,
            moves,
            ..self
        }
    }

    /// The same where joints and frames stand elsewhere on their parents.
    pub(crate) fn with_places(self, tree: &'a Tree) -> Self {
        Self { tree, ..self }
    }

    /// Whether joints stand elsewhere than where the problem was built.
    pub(crate) fn places_moved(&self) -> bool {
        !std::ptr::eq(self.tree, &self.problem.tree)
    }

    /// A task's residual: the caller's, or of a clearance, which the caller does not see, the problem's own.
    pub(crate) fn residual(&self, task: usize) -> &'a dyn ErasedResidual {
        match self.targets.residuals.get(task) {
            Some(residual) => &**residual,
            None => &*self.problem.targets.residuals[task],
        }
    }

    /// The same tasks and bounds of a problem that has the clearance of what this one keeps clear of among its goals.
    pub(crate) fn fenced(self, by: &'a Problem) -> Self {
        Self {
            problem: by,
            tree: by.tree(),
            ..self
        }
    }

    /// Where random values of a variable are drawn from: its bounds, or where one is missing or
    /// endlessly far away π or the reach from `at`.
    pub(crate) fn sampling_range(&self, variable: usize, at: f64) -> (f64, f64) {
        let mut moves = self.moves.iter();
        if let Some(turn) = moves.find(|turn| turn.variables().contains(&variable)) {
            return turn.range_of(variable);
        }
        let bounds = Limits::new(self.lower[variable], self.upper[variable]);
        bounds.sampling_range(at, self.problem.spread(variable))
    }
}
