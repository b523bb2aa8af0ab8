//! One place that picks the instruction set.

use super::batch;
use super::lane::Lanes;
use super::race::{self, Query};
use super::solver::{Outcome, PoseSolver, Search};
use crate::spatial::Placement;

type Portable<const L: usize> = Lanes<L, false>;
#[cfg(target_arch = "x86_64")]
type Fused<const L: usize> = Lanes<L, true>;

pub(crate) fn race(solver: &PoseSolver, query: &Query<'_>, lone: bool, q: &mut [f64]) -> Outcome {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has the instructions the function is compiled for.
        #[allow(unsafe_code)]
        return unsafe { race_fused(solver, query, lone, q) };
    }
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => race::race::<Portable<4>, 6, true>(solver, query, lone, q),
        (7, true) => race::race::<Portable<4>, 7, true>(solver, query, lone, q),
        _ => race::race::<Portable<4>, 64, false>(solver, query, lone, q),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_fused(solver: &PoseSolver, query: &Query<'_>, lone: bool, q: &mut [f64]) -> Outcome {
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => race::race::<Fused<4>, 6, true>(solver, query, lone, q),
        (7, true) => race::race::<Fused<4>, 7, true>(solver, query, lone, q),
        _ => race::race::<Fused<4>, 64, false>(solver, query, lone, q),
    }
}

type Batch<'a> = (
    &'a [Placement<f64>],
    &'a [f64],
    Search,
    &'a mut [f64],
    &'a mut [Outcome],
);

const WIDE: usize = 8;

pub(crate) fn batch(solver: &PoseSolver, work: Batch<'_>) {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has the instructions the function is compiled for.
        #[allow(unsafe_code)]
        return unsafe { batch_fused(solver, work) };
    }
    let (t, s, search, q, o) = work;
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => batch::batch::<Portable<WIDE>, WIDE, 6, true>(solver, t, s, search, q, o),
        (7, true) => batch::batch::<Portable<WIDE>, WIDE, 7, true>(solver, t, s, search, q, o),
        _ => batch::batch::<Portable<WIDE>, WIDE, 64, false>(solver, t, s, search, q, o),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn batch_fused(solver: &PoseSolver, (t, s, search, q, o): Batch<'_>) {
    match (solver.links.links.len(), solver.links.all_revolute) {
        (6, true) => batch::batch::<Fused<WIDE>, WIDE, 6, true>(solver, t, s, search, q, o),
        (7, true) => batch::batch::<Fused<WIDE>, WIDE, 7, true>(solver, t, s, search, q, o),
        _ => batch::batch::<Fused<WIDE>, WIDE, 64, false>(solver, t, s, search, q, o),
    }
}
