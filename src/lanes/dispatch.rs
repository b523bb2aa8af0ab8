//! One place that picks the instruction set.

use super::lane::Lanes;
use super::race::{self, Query};
use super::solver::{Outcome, PoseSolver};

type Portable<const L: usize> = Lanes<L, false>;
#[cfg(target_arch = "x86_64")]
type Fused<const L: usize> = Lanes<L, true>;

pub(crate) fn race(solver: &PoseSolver, query: &Query<'_>, q: &mut [f64]) -> Outcome {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has the instructions the function is compiled for.
        #[allow(unsafe_code)]
        return unsafe { race_fused(solver, query, q) };
    }
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => race::race::<Portable<4>, 6, true>(solver, query, q),
        (7, true) => race::race::<Portable<4>, 7, true>(solver, query, q),
        _ => race::race::<Portable<4>, 64, false>(solver, query, q),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_fused(solver: &PoseSolver, query: &Query<'_>, q: &mut [f64]) -> Outcome {
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => race::race::<Fused<4>, 6, true>(solver, query, q),
        (7, true) => race::race::<Fused<4>, 7, true>(solver, query, q),
        _ => race::race::<Fused<4>, 64, false>(solver, query, q),
    }
}
