//! Restarts for solvers without restarts of their own: the start, then random configurations until the deadline.

use std::time::Instant;

use kinopt::simd_ik::Chain;
use kinopt_benches::{Sequence, random_configuration};

/// Finite limits for optimisers; unbounded joints get ±4π.
pub struct Limits {
    /// Smallest values, radians and metres.
    pub lower: Vec<f64>,
    /// Largest values, radians and metres.
    pub upper: Vec<f64>,
}

impl Limits {
    /// Limits of all joints of a chain.
    #[must_use]
    pub fn of(chain: &Chain) -> Self {
        let unbounded_range = 4.0 * std::f64::consts::PI;
        let joints = chain.joints();
        Self {
            lower: joints
                .iter()
                .map(|j| j.lower.max(-unbounded_range))
                .collect(),
            upper: joints
                .iter()
                .map(|j| j.upper.min(unbounded_range))
                .collect(),
        }
    }
}

/// Runs attempts from `start` and then from random configurations, equal in each run. Returns q of the first successful
/// attempt, or `None` after the deadline.
pub fn until_deadline(
    chain: &Chain,
    start: &[f64],
    deadline: Instant,
    mut attempt: impl FnMut(&mut [f64]) -> bool,
) -> Option<Vec<f64>> {
    let mut random = Sequence::new(0.75);
    let mut q = start.to_vec();
    loop {
        if attempt(&mut q) {
            return Some(q);
        }
        if Instant::now() >= deadline {
            return None;
        }
        q = random_configuration(chain, &mut random);
    }
}
