//! Mean, 95th percentile and maximum of a quantity.

/// Quantile of [`Spread::p95`].
const HIGH_QUANTILE: f64 = 0.95;

/// Mean, 95th percentile and maximum over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 95th percentile: the smallest sample that is at least as large as 95 % of all.
    pub p95: f64,
    /// Largest sample.
    pub max: f64,
}

impl Spread {
    /// Returns the spread of samples in any order; zeros without samples.
    pub(super) fn of(mut samples: Vec<f64>) -> Self {
        let count = samples.len();
        let Some(last) = count.checked_sub(1) else {
            return Self::default();
        };
        let mean = samples.iter().sum::<f64>() / count as f64;
        samples.sort_by(f64::total_cmp);
        let rank = (HIGH_QUANTILE * count as f64).ceil() as usize;
        Self {
            mean,
            p95: samples[rank.clamp(1, count) - 1],
            max: samples[last],
        }
    }
}

/// Returns the value in the middle of samples; 0 without samples.
pub(super) fn median(mut samples: Vec<f64>) -> f64 {
    samples.sort_by(f64::total_cmp);
    samples.get(samples.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn spread_of_hundred_ranks() {
        let spread = Spread::of((1..=100).rev().map(f64::from).collect());
        assert_eq!((spread.mean, spread.p95, spread.max), (50.5, 95.0, 100.0));
        let one = Spread::of(vec![3.0]);
        assert_eq!((one.mean, one.p95, one.max), (3.0, 3.0, 3.0));
    }
}
