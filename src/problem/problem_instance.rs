//! Problem instances: a problem with targets and bounds.

use super::{Problem, Scratch, Targets};
use crate::kinematics::Tree;
use crate::model::{Limits, ParameterMap};
use crate::solver::{ConfigurationSpace, RotationSets, TurnLimit};
use crate::task::ErasedResidual;

/// An instance of a [`Problem`]. A problem reference converts to one with its own targets and bounds.
#[derive(Clone, Copy, Debug)]
pub struct ProblemInstance<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) targets: &'a Targets,
    lower: &'a [f64],
    upper: &'a [f64],
    /// Largest rotations of ball joints from their start.
    turn_limits: &'a [TurnLimit],
    /// Variables that form rotations; steps at the edges of their sets use other components.
    rotations: &'a RotationSets,
    tree: &'a Tree,
}

impl<'a> From<&'a Problem> for ProblemInstance<'a> {
    fn from(problem: &'a Problem) -> Self {
        Self {
            problem,
            targets: &problem.targets,
            lower: problem.lower(),
            upper: problem.upper(),
            turn_limits: &[],
            rotations: &problem.rotations,
            tree: &problem.tree,
        }
    }
}

impl<'a> ProblemInstance<'a> {
    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// Number of solver variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.problem.variables()
    }

    /// Number of residual rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.problem.rows()
    }

    /// The map from variables to configurations.
    #[must_use]
    pub fn parameters(&self) -> &'a ParameterMap {
        self.problem.parameters()
    }

    /// A workspace for this problem.
    #[must_use]
    pub fn scratch(&self) -> Scratch {
        self.problem.scratch()
    }

    /// Lower bounds of the variables.
    #[must_use]
    pub fn lower(&self) -> &'a [f64] {
        self.lower
    }

    /// Upper bounds of the variables.
    #[must_use]
    pub fn upper(&self) -> &'a [f64] {
        self.upper
    }

    /// Largest rotations of ball joints from their start.
    #[must_use]
    pub(crate) fn turn_limits(&self) -> &'a [TurnLimit] {
        self.turn_limits
    }

    /// The compiled kinematics that the tasks' slots refer to.
    #[must_use]
    pub(crate) fn tree(&self) -> &'a Tree {
        self.tree
    }

    /// The space of the variables, within these bounds.
    #[must_use]
    pub fn space(&self) -> ConfigurationSpace<'a> {
        ConfigurationSpace::new(self.lower, self.upper)
            .with_rotations(self.rotations, self.turn_limits)
    }

    /// The instance with derivatives by the variables even at the edges of cones and angles, for callers that handle
    /// them.
    pub(crate) fn by_variables(self) -> Self {
        Self {
            rotations: const { &RotationSets::NONE },
            ..self
        }
    }

    /// The instance with other targets of the same problem.
    pub(crate) fn with_targets(self, targets: &'a Targets) -> Self {
        Self { targets, ..self }
    }

    /// The instance with tighter bounds and limits on the rotation of ball joints.
    pub(crate) fn within(
        self,
        lower: &'a [f64],
        upper: &'a [f64],
        turn_limits: &'a [TurnLimit],
    ) -> Self {
        Self {
            lower,
            upper,
            turn_limits,
            ..self
        }
    }

    /// The instance with another tree, in which joints and frames have moved on their parents.
    pub(crate) fn with_tree(self, tree: &'a Tree) -> Self {
        Self { tree, ..self }
    }

    /// True if the tree differs from the problem's.
    pub(crate) fn has_moved_tree(&self) -> bool {
        !std::ptr::eq(self.tree, &self.problem.tree)
    }

    /// A task's residual: the caller's, or the problem's for a clearance, which the caller does not see.
    pub(crate) fn residual(&self, task: usize) -> &'a dyn ErasedResidual {
        match self.targets.residuals.get(task) {
            Some(residual) => &**residual,
            None => &*self.problem.targets.residuals[task],
        }
    }

    /// The instance for a problem with the same tasks and bounds and an added clearance.
    pub(crate) fn with_constraint(self, problem: &'a Problem) -> Self {
        Self {
            problem,
            tree: problem.tree(),
            ..self
        }
    }

    /// The sampling range of a variable: its bounds, or `at` ± (π or the reach) if a bound is absent or very distant.
    pub(crate) fn sampling_range(&self, variable: usize, at: f64) -> (f64, f64) {
        let mut limits = self.turn_limits.iter();
        if let Some(limit) = limits.find(|limit| limit.variables().contains(&variable)) {
            return limit.range_of(variable);
        }
        let bounds = Limits::new(self.lower[variable], self.upper[variable]);
        bounds.sampling_range(at, self.problem.spread(variable))
    }
}
