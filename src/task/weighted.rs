//! Tasks: residuals with weights, tolerances, role and name.

use super::{Quantity, Residual, Role};

/// A residual with its weights, tolerances, role and name.
///
/// Any residual converts to a task with the defaults of the problem it is added to.
#[derive(Clone, Debug)]
pub struct Task<R> {
    pub(crate) residual: R,
    pub(crate) name: Option<String>,
    pub(crate) weights: Vec<(Quantity, f64)>,
    pub(crate) factor: f64,
    pub(crate) tolerances: Vec<(Quantity, f64)>,
    pub(crate) role: Role,
    pub(crate) level: usize,
}

impl<R: Residual> Task<R> {
    /// A task with default weights, tolerances and role.
    #[must_use]
    pub fn new(residual: R) -> Self {
        Self {
            residual,
            name: None,
            weights: Vec::new(),
            factor: 1.0,
            tolerances: Vec::new(),
            role: R::ROLE,
            level: 0,
        }
    }

    /// Sets the name of the task in reports; by default its kind and first frame.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Sets the factor on the rows of one quantity: cost units (√) per metre, per radian, …
    ///
    /// It must be finite and not negative. Rows of weight 0 report their error but never count as not reached.
    #[must_use]
    pub fn weight(mut self, quantity: Quantity, weight: f64) -> Self {
        self.weights.push((quantity, weight));
        self
    }

    /// Multiplies all weights of the task, given or default. The factor must be finite and not negative.
    #[must_use]
    pub fn scale(mut self, factor: f64) -> Self {
        self.factor *= factor;
        self
    }

    /// Sets the error at which the rows of a quantity count as reached, in the quantity's unit before weighting.
    ///
    /// It must not be negative; infinity accepts any error.
    #[must_use]
    pub fn tolerance(mut self, quantity: Quantity, tolerance: f64) -> Self {
        self.tolerances.push((quantity, tolerance));
        self
    }

    /// Makes it a soft task: its error never counts as not reached.
    #[must_use]
    pub fn preference(mut self) -> Self {
        self.role = Role::Preference;
        self
    }

    /// Sets the strict priority level of the task, 0 by default.
    ///
    /// Required tasks of level 0 are solved as if they were alone. Those of level 1 are minimised without
    /// increasing the error of level 0, and so on; weights count within a level only. Soft tasks come after all
    /// required tasks, by their own levels.
    #[must_use]
    pub fn at_level(mut self, level: usize) -> Self {
        self.level = level;
        self
    }

    /// Makes it a required task: a solution counts as reached only if the task is within its tolerances.
    #[must_use]
    pub fn goal(mut self) -> Self {
        self.role = Role::Goal;
        self
    }
}

impl<R: Residual> From<R> for Task<R> {
    fn from(residual: R) -> Self {
        Self::new(residual)
    }
}
