//! The one place that picks the instruction set and the kernel's size.

use super::batch::{self, Work};
use super::chain::MAX_JOINTS;
use super::lane::Lanes;
use super::options::Outcome;
use super::prepared::Prepared;
use super::query::{Answer, Query};
use super::race;

/// Lanes of a single query and of a batch: a batch has independent work to hide latencies with.
const RACE: usize = 4;
const BATCH: usize = 8;

/// Whether this processor family has no faster lanes than the portable ones.
const PORTABLE_IS_MAIN: bool = !cfg!(target_arch = "x86_64");

/// Calls `$run` with the lane type and the kernel for this chain: number of joints, whether that is
/// exact, whether the goal has weighted axes.
macro_rules! by_chain {
    ($prepared:expr, $race:ident, $fma:literal, $($argument:expr),*) => {{
        let links = &$prepared.links;
        match (links.links.len(), links.all_revolute, $prepared.weighted) {
            (_, _, true) => by_chain!(@ $race, $fma, MAX_JOINTS, false, true, $($argument),*),
            // Where the portable lanes are only the fallback, one kernel of them is enough code.
            (6, true, false) if $fma || PORTABLE_IS_MAIN => by_chain!(@ $race, $fma, 6, true, false, $($argument),*),
            (7, true, false) if $fma || PORTABLE_IS_MAIN => by_chain!(@ $race, $fma, 7, true, false, $($argument),*),
            _ => by_chain!(@ $race, $fma, MAX_JOINTS, false, false, $($argument),*),
        }
    }};
    (@ race, $fma:literal, $n:expr, $exact:literal, $axes:literal, $($argument:expr),*) => {
        race::race::<Lanes<RACE, $fma>, { $n }, $exact, $axes>($($argument),*)
    };
    (@ batch, $fma:literal, $n:expr, $exact:literal, $axes:literal, $($argument:expr),*) => {
        batch::batch::<Lanes<BATCH, $fma>, BATCH, { $n }, $exact, $axes>($($argument),*)
    };
}

/// Whether the fused functions below may run.
#[cfg(target_arch = "x86_64")]
fn has_fused(prepared: &Prepared) -> bool {
    !prepared.options.portable && crate::processor::has_avx2_and_fma()
}

pub(crate) fn race(
    prepared: &Prepared,
    query: &Query<'_>,
    lone: bool,
    answer: &mut Answer<'_>,
) -> Outcome {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: the processor has the instructions the function is compiled for. Measured: four
        // times as fast as the portable lanes.
        #[allow(unsafe_code)]
        return unsafe { race_fused(prepared, query, lone, answer) };
    }
    by_chain!(prepared, race, false, prepared, query, lone, answer)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_fused(
    prepared: &Prepared,
    query: &Query<'_>,
    lone: bool,
    answer: &mut Answer<'_>,
) -> Outcome {
    by_chain!(prepared, race, true, prepared, query, lone, answer)
}

pub(crate) fn batch(prepared: &Prepared, work: Work<'_>) {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: as above.
        #[allow(unsafe_code)]
        return unsafe { batch_fused(prepared, work) };
    }
    by_chain!(prepared, batch, false, prepared, work)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn batch_fused(prepared: &Prepared, work: Work<'_>) {
    by_chain!(prepared, batch, true, prepared, work)
}
