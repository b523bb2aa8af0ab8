//! Numbers by quantity: weights and tolerances.

use kinopt::task::Quantity;

/// One number for all quantities, or one for each.
#[derive(Clone, Debug)]
pub enum QuantityValues {
    /// A number for all.
    All(f64),
    /// Numbers by quantity.
    Each(Vec<(Quantity, f64)>),
}

impl QuantityValues {
    /// Numbers by quantity; `all` are the quantities of a single number.
    #[must_use]
    pub fn by(&self, all: impl IntoIterator<Item = Quantity>) -> Vec<(Quantity, f64)> {
        match self {
            Self::All(number) => all
                .into_iter()
                .map(|quantity| (quantity, *number))
                .collect(),
            Self::Each(each) => each.clone(),
        }
    }
}
