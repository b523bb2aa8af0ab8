//! Dispatch by instruction set and kernel size.

use super::batch::{self, Work};
use super::chain::MAX_JOINTS;
use super::lane::{LaneScalar, Lanes};
use super::options::{PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Query, QueryOutput};
use super::single_query;
use super::stages::{self, Stages};

/// Lanes of a single query.
const QUERY_LANES: usize = 4;
/// Lanes of a batch: more than for a query, as independent work hides latencies.
const BATCH_LANES: usize = 8;
/// Portable lanes of a single query under `Prefer::Start`: a step of two lanes takes about half the time of four.
const PORTABLE_QUERY_LANES: usize = 2;
/// Portable lanes of a batch. On x86-64 they are only the fallback, and share the kernel of single queries.
const PORTABLE_BATCH_LANES: usize = if cfg!(target_arch = "x86_64") {
    QUERY_LANES
} else {
    BATCH_LANES
};

/// Capacity in joints of the kernels for short chains.
const MAX_SHORT_CHAIN_JOINTS: usize = 8;

/// Calls the driver `$run` with the stages of `$set` for lanes `$lanes`.
macro_rules! run {
    // Kernels for any chain.
    (any, $set:ident, $run:path, $lanes:ty; $prepared:expr $(, $argument:expr)*) => {{
        let mut stages = run!(@ $set, $lanes, MAX_JOINTS, 0);
        if $prepared.settings.weighted {
            stages.step = stages::$set::step::<$lanes, MAX_JOINTS, 0, true>;
        }
        $run(&stages, $prepared $(, $argument)*)
    }};
    // Specialised kernels for full poses: of 6 or 7 revolute joints, or of short chains.
    (each, $set:ident, $run:path, $lanes:ty; $prepared:expr $(, $argument:expr)*) => {
        match specialised_joints($prepared) {
            Some(joints) => {
                let mut stages = run!(@ $set, $lanes, MAX_SHORT_CHAIN_JOINTS, 6);
                if joints == 7 {
                    stages.step = stages::$set::step::<$lanes, MAX_SHORT_CHAIN_JOINTS, 7, false>;
                }
                $run(&stages, $prepared $(, $argument)*)
            }
            // Arrays for the longest chain take microseconds to create and move.
            None if is_short($prepared) => {
                let stages = run!(@ $set, $lanes, MAX_SHORT_CHAIN_JOINTS, 0);
                $run(&stages, $prepared $(, $argument)*)
            }
            None => run!(any, $set, $run, $lanes; $prepared $(, $argument)*),
        }
    };
    (@ $set:ident, $lanes:ty, $capacity:expr, $joints:literal) => {
        Stages::<$lanes, { $capacity }> {
            step: stages::$set::step::<$lanes, { $capacity }, $joints, false>,
            // These work on one lane or four, so all widths share them.
            judge: stages::$set::judge::<<$lanes as LaneScalar>::Four, { $capacity }>,
            seed: stages::$set::seed::<<$lanes as LaneScalar>::Four>,
        }
    };
}

/// On x86-64 portable lanes are only the fallback: the kernels for any chain suffice.
#[cfg(target_arch = "x86_64")]
macro_rules! portable {
    ($($rest:tt)*) => { run!(any, portable, $($rest)*) };
}
#[cfg(not(target_arch = "x86_64"))]
macro_rules! portable {
    ($($rest:tt)*) => { run!(each, portable, $($rest)*) };
}

/// Number of joints, if there is a specialised kernel for it.
fn specialised_joints(prepared: &Prepared) -> Option<usize> {
    let joints = prepared.joints();
    let has_kernel = prepared.links.all_revolute && !prepared.settings.weighted;
    (has_kernel && (joints == 6 || joints == 7)).then_some(joints)
}

/// Returns true if the kernel for short chains fits: few joints and a full-pose goal.
fn is_short(prepared: &Prepared) -> bool {
    prepared.joints() <= MAX_SHORT_CHAIN_JOINTS && !prepared.settings.weighted
}

/// Returns true if the options and the processor allow AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
fn has_fused(prepared: &Prepared) -> bool {
    !prepared.options.portable && kinopt_kinematics::processor::has_avx2_and_fma()
}

pub(crate) fn race(
    prepared: &Prepared,
    query: &Query<'_>,
    first_alone: bool,
    output: &mut QueryOutput<'_>,
) -> PoseOutcome {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: `has_fused` checked that the processor has the instructions. Four times as fast as the portable
        // lanes.
        #[allow(unsafe_code)]
        return unsafe { race_fused(prepared, query, first_alone, output) };
    }
    match query.search {
        // The winner of this search does not depend on the number of lanes.
        Prefer::Start => {
            portable!(single_query::race, Lanes<PORTABLE_QUERY_LANES, false>; prepared, query, first_alone, output)
        }
        Prefer::First => {
            portable!(single_query::race, Lanes<QUERY_LANES, false>; prepared, query, first_alone, output)
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_fused(
    prepared: &Prepared,
    query: &Query<'_>,
    first_alone: bool,
    output: &mut QueryOutput<'_>,
) -> PoseOutcome {
    run!(each, fused, single_query::race, Lanes<QUERY_LANES, true>; prepared, query, first_alone, output)
}

pub(crate) fn batch(prepared: &Prepared, work: Work<'_>) {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: `has_fused` checked that the processor has the instructions.
        #[allow(unsafe_code)]
        return unsafe { batch_fused(prepared, work) };
    }
    portable!(batch::batch::<_, PORTABLE_BATCH_LANES, _>, Lanes<PORTABLE_BATCH_LANES, false>; prepared, work)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn batch_fused(prepared: &Prepared, work: Work<'_>) {
    run!(each, fused, batch::batch::<_, BATCH_LANES, _>, Lanes<BATCH_LANES, true>; prepared, work)
}
