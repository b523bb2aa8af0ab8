//! Common options of tasks.

use kinopt::task::{Quantity, Residual, Role, Task};

use crate::names::{ROLES, named};
use crate::quantities::QuantityValues;
use crate::value::{Arguments, ErrorOf, OrRaise, Value};

/// Common options of a task; `None` is the default.
#[derive(Clone, Debug, Default)]
pub struct TaskOptions {
    /// Name of the task.
    pub name: Option<String>,
    /// Weights of the errors.
    pub weight: Option<QuantityValues>,
    /// Factor of all weights.
    pub scale: Option<f64>,
    /// Tolerances of the errors.
    pub tolerance: Option<QuantityValues>,
    /// Role in the problem.
    pub role: Option<Role>,
    /// Priority level.
    pub level: Option<u64>,
}

impl TaskOptions {
    /// Reads the options.
    ///
    /// # Errors
    /// If an option has another type, or a role or quantity is unknown.
    pub fn of<A: Arguments>(arguments: &A) -> Result<Self, ErrorOf<A>> {
        let name = arguments.get("name")?.map(|value| value.name("name"));
        let weight = arguments.get("weight")?;
        let scale = arguments.get("scale")?.map(|value| value.number("scale"));
        let tolerance = arguments.get("tolerance")?;
        let role = match arguments.get("role")? {
            Some(role) => {
                let role = named("role", &role.name("role")?, &ROLES);
                Some(role.or_raise::<A::Value>()?)
            }
            None => None,
        };
        let level = arguments.get("level")?;
        Ok(Self {
            name: name.transpose()?,
            weight: weight
                .map(|value| value.quantity_values("weight"))
                .transpose()?,
            scale: scale.transpose()?,
            tolerance: tolerance
                .map(|value| value.quantity_values("tolerance"))
                .transpose()?,
            role,
            level: level
                .map(|value| value.whole("level", u32::MAX.into()))
                .transpose()?,
        })
    }

    /// Fills missing options from others.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            name: self.name.or(other.name),
            weight: self.weight.or(other.weight),
            scale: self.scale.or(other.scale),
            tolerance: self.tolerance.or(other.tolerance),
            role: self.role.or(other.role),
            level: self.level.or(other.level),
        }
    }

    /// Task of a residual with these options.
    pub(super) fn task<R: Residual>(self, residual: R) -> Task<R> {
        let quantities: Vec<Quantity> = residual.rows().iter().map(|rows| rows.quantity).collect();
        let of = |values: Option<QuantityValues>| {
            values.map_or_else(Vec::new, |values| values.by(quantities.iter().copied()))
        };
        let mut task = Task::new(residual);
        if let Some(name) = self.name {
            task = task.named(name);
        }
        for (quantity, weight) in of(self.weight) {
            task = task.weight(quantity, weight);
        }
        for (quantity, tolerance) in of(self.tolerance) {
            task = task.tolerance(quantity, tolerance);
        }
        task = match self.role {
            Some(Role::Preference) => task.preference(),
            Some(_) => task.goal(),
            None => task,
        };
        if let Some(scale) = self.scale {
            task = task.scale(scale);
        }
        task.at_level(self.level.unwrap_or(0) as usize)
    }
}
