//! Closed intervals of joint values.

/// Distance, in spreads, beyond which a limit counts as absent: four full rotations for angles.
const MAX_SPREADS: f64 = 8.0;

/// A closed interval, in radians or metres; infinite ends are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(from = "[Option<f64>; 2]", into = "[Option<f64>; 2]")
)]
pub struct Limits {
    /// The smallest value allowed.
    pub lower: f64,
    /// The largest value allowed.
    pub upper: f64,
}

impl Limits {
    /// No limit on either side.
    pub const UNBOUNDED: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };

    /// The interval from `lower` to `upper`, unchecked; model builders check the order.
    #[must_use]
    pub const fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper }
    }

    /// True if both ends are equal.
    #[must_use]
    pub fn is_locked(&self) -> bool {
        self.lower == self.upper
    }

    /// True if the interval is not empty, has no NaN and contains a finite number.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY
    }

    /// True if `lower <= value && value <= upper`, compared exactly.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// The nearest value within the limits. NaN stays NaN.
    #[must_use]
    #[inline(always)]
    pub fn clamp(&self, value: f64) -> f64 {
        if value < self.lower {
            self.lower
        } else if value > self.upper {
            self.upper
        } else {
            value
        }
    }

    /// The range for random values near `centre`.
    ///
    /// A limit that is absent or farther than [`MAX_SPREADS`] spreads away is replaced by `centre` ± `spread`.
    #[doc(hidden)]
    pub fn sampling_range(&self, centre: f64, spread: f64) -> (f64, f64) {
        let lower = if centre - self.lower <= MAX_SPREADS * spread {
            self.lower
        } else {
            centre - spread
        };
        let upper = if self.upper - centre <= MAX_SPREADS * spread {
            self.upper
        } else {
            centre + spread
        };
        (lower, upper)
    }

    /// The intersection of both intervals; invalid if they are disjoint.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self::new(self.lower.max(other.lower), self.upper.min(other.upper))
    }
}

/// An infinite end becomes `None`: JSON has no infinity.
#[cfg(feature = "serde")]
impl From<Limits> for [Option<f64>; 2] {
    fn from(limits: Limits) -> Self {
        let unbounded = [f64::NEG_INFINITY, f64::INFINITY];
        let ends = [(limits.lower, unbounded[0]), (limits.upper, unbounded[1])];
        ends.map(|(end, unbounded)| (end != unbounded).then_some(end))
    }
}

#[cfg(feature = "serde")]
impl From<[Option<f64>; 2]> for Limits {
    fn from([lower, upper]: [Option<f64>; 2]) -> Self {
        Self::new(
            lower.unwrap_or(f64::NEG_INFINITY),
            upper.unwrap_or(f64::INFINITY),
        )
    }
}
