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

    setters! {
        /// Names the task in reports; otherwise its kind and first frame do.
        pub fn named(mut self, name: impl Into<String>) { self.name = Some(name.into()) }
        /// Multiplies the rows of one quantity: cost units (√) per metre, per radian, …
        /// Must be finite and not negative. Rows of weight 0 are not asked for: they tell their error but
        /// never count as missed.
        pub fn weight(mut self, quantity: Quantity, weight: f64) {
            self.weights.push((quantity, weight));
        }
        /// How much the task counts beside others: multiplies all its weights, given or default. Must be
        /// finite and not negative.
        pub fn times(mut self, factor: f64) { self.factor *= factor }
        /// The error, in the quantity's own unit and before weighting, at which those rows count as
        /// reached. Must not be negative; infinity means "any error will do".
        pub fn tolerance(mut self, quantity: Quantity, tolerance: f64) {
            self.tolerances.push((quantity, tolerance));
        }
        /// Only a preference: it pulls, but missing it is no failure.
        pub fn preference(mut self) { self.role = Role::Preference }
        /// Puts the task on a strict level, 0 unless set. Goals of level 0 are met first, as if they were alone;
        /// those of level 1 come as near as they can at no cost to level 0, and so on, however large their weights
        /// are: weights count within a level. Preferences come after all goals, by their own levels.
        pub fn at_level(mut self, level: usize) { self.level = level }
        /// A goal: it must be met for the solution to count as reached.
        pub fn goal(mut self) { self.role = Role::Goal }
    }
}

impl<R: Residual> From<R> for Task<R> {
    fn from(residual: R) -> Self {
        Self::new(residual)
    }
}
