//! Deterministic numbers, equal on every machine.

/// Numbers within [0, 1) by an additive recurrence of the golden ratio.
pub struct Sequence(f64);

impl Sequence {
    /// Starts the sequence at any number.
    #[must_use]
    pub fn new(seed: f64) -> Self {
        Self(seed)
    }

    /// Returns the next number.
    pub fn unit(&mut self) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_894_9) * 1.000_000_1;
        let mixed = (self.0 * 12.9898).sin() * 43_758.545_3;
        mixed - mixed.floor()
    }
}
