//! A residual with its weights, tolerances, role and name.

use super::{Quantity, Residual, Role};

/// A residual and how much it matters.
///
/// Any residual turns into a task with the defaults of the problem it is added to.
#[derive(Clone, Debug)]
pub struct Task<R> {
    pub(crate) residual: R,
    pub(crate) name: Option<String>,
    pub(crate) weights: Vec<(Quantity, f64)>,
    pub(crate) factor: f64,
    pub(crate) tolerances: Vec<(Quantity, f64)>,
    pub(crate) role: Role,
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
        }
    }

    /// Names the task in reports; otherwise its kind and first frame do.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Multiplies the rows of one quantity: cost units (√) per metre, per radian, …
    /// Must be finite and not negative. Rows of weight 0 are not asked for: they tell their error but
    /// never count as missed.
    #[must_use]
    pub fn weight(mut self, quantity: Quantity, weight: f64) -> Self {
        self.weights.push((quantity, weight));
        self
    }

    /// How much the task counts beside others: multiplies all its weights, given or default. Must be
    /// finite and not negative.
    #[must_use]
    pub fn times(mut self, factor: f64) -> Self {
        self.factor *= factor;
        self
    }

    /// The error, in the quantity's own unit and before weighting, at which those rows count as
    /// reached. Must not be negative; infinity means "any error will do".
    #[must_use]
    pub fn tolerance(mut self, quantity: Quantity, tolerance: f64) -> Self {
        self.tolerances.push((quantity, tolerance));
        self
    }

    /// Only a preference: it pulls, but missing it is no failure.
    #[must_use]
    pub fn preference(mut self) -> Self {
        self.role = Role::Preference;
        self
    }

    /// A goal: it must be met for the solution to count as reached.
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
