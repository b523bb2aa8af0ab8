//! Dispatch by instruction set and kernel size.

use super::batch::{self, Work};
use super::chain::MAX_JOINTS;
use super::lane::{LaneScalar, Lanes};
use super::options::{PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Answer, Query};
use super::single_query;
use super::stages::{self, Stages};

/// Lanes of a single query.
const RACE: usize = 4;
/// Lanes of a batch: more than for a query, as independent work hides latencies.
const BATCH: usize = 8;
/// Portable lanes of a single query under `Prefer::Start`: a step of two lanes takes about half the time of four.
const PORTABLE_START: usize = 2;
/// Portable lanes of a batch. On x86-64 they are only the fallback, and share the kernel of single queries.
const PORTABLE_BATCH: usize = if cfg!(target_arch = "x86_64") {
    RACE
} else {
    BATCH
};

/// Capacity in joints of the kernels for short chains.
const FEW: usize = 8;

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
        match usual_joints($prepared) {
            Some(joints) => {
                let mut stages = run!(@ $set, $lanes, FEW, 6);
                if joints == 7 {
                    stages.step = stages::$set::step::<$lanes, FEW, 7, false>;
                }
                $run(&stages, $prepared $(, $argument)*)
            }
            // Arrays for the longest chain take microseconds to create and move.
            None if is_short($prepared) => {
                let stages = run!(@ $set, $lanes, FEW, 0);
                $run(&stages, $prepared $(, $argument)*)
            }
            None => run!(any, $set, $run, $lanes; $prepared $(, $argument)*),
        }
    };
    (@ $set:ident, $lanes:ty, $room:expr, $joints:literal) => {
        Stages::<$lanes, { $room }> {
            step: stages::$set::step::<$lanes, { $room }, $joints, false>,
            // These work on one lane or four, so all widths share them.
            judge: stages::$set::judge::<<$lanes as LaneScalar>::Four, { $room }>,
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
fn usual_joints(prepared: &Prepared) -> Option<usize> {
    let joints = prepared.joints();
    let usual = prepared.links.all_revolute && !prepared.settings.weighted;
    (usual && (joints == 6 || joints == 7)).then_some(joints)
}

/// Returns true if the kernel for short chains fits: few joints and a full-pose goal.
fn is_short(prepared: &Prepared) -> bool {
    prepared.joints() <= FEW && !prepared.settings.weighted
}

/// Returns true if the options and the processor allow AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
fn has_fused(prepared: &Prepared) -> bool {
    !prepared.options.portable && crate::processor::has_avx2_and_fma()
}

pub(crate) fn race(
    prepared: &Prepared,
    query: &Query<'_>,
    lone: bool,
    answer: &mut Answer<'_>,
) -> PoseOutcome {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: `has_fused` checked that the processor has the instructions. Four times as fast as the portable
        // lanes.
        #[allow(unsafe_code)]
        return unsafe { race_fused(prepared, query, lone, answer) };
    }
    match query.search {
        // The winner of this search does not depend on the number of lanes.
        Prefer::Start => {
            portable!(single_query::race, Lanes<PORTABLE_START, false>; prepared, query, lone, answer)
        }
        Prefer::First => {
            portable!(single_query::race, Lanes<RACE, false>; prepared, query, lone, answer)
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_fused(
    prepared: &Prepared,
    query: &Query<'_>,
    lone: bool,
    answer: &mut Answer<'_>,
) -> PoseOutcome {
    run!(each, fused, single_query::race, Lanes<RACE, true>; prepared, query, lone, answer)
}

pub(crate) fn batch(prepared: &Prepared, work: Work<'_>) {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: `has_fused` checked that the processor has the instructions.
        #[allow(unsafe_code)]
        return unsafe { batch_fused(prepared, work) };
    }
    portable!(batch::batch::<_, PORTABLE_BATCH, _>, Lanes<PORTABLE_BATCH, false>; prepared, work)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn batch_fused(prepared: &Prepared, work: Work<'_>) {
    run!(each, fused, batch::batch::<_, BATCH, _>, Lanes<BATCH, true>; prepared, work)
}
