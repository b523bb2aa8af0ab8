//! The one place that picks the instruction set and the kernel's size.

use super::batch::{self, Work};
use super::chain::MAX_JOINTS;
use super::lane::{LaneScalar, Lanes};
use super::options::{PoseOutcome, Prefer};
use super::prepared::Prepared;
use super::query::{Answer, Query};
use super::single_query;
use super::stages::{self, Stages};

/// Lanes of a single query and of a batch: a batch has independent work to hide latencies with.
const RACE: usize = 4;
const BATCH: usize = 8;
/// Portable lanes of a single query whose start comes first: a register of two. That attempt takes some ten steps and two lanes
/// step in little more than half the time of four, in which the other lane has long found who wins if it fails.
const PORTABLE_START: usize = 2;
/// What a lane of a batch does depends on no other, so where the portable lanes are only the
/// fallback, both share one kernel.
const PORTABLE_BATCH: usize = if cfg!(target_arch = "x86_64") {
    RACE
} else {
    BATCH
};

/// Room for the joints of the kernels made for one number of them.
const FEW: usize = 8;

/// Calls the driver `$run` with the stages of `$set` for lanes `$lanes`.
macro_rules! run {
    // Kernels for every chain.
    (any, $set:ident, $run:path, $lanes:ty; $prepared:expr $(, $argument:expr)*) => {{
        let mut stages = run!(@ $set, $lanes, MAX_JOINTS, 0);
        if $prepared.settings.weighted {
            stages.step = stages::$set::step::<$lanes, MAX_JOINTS, 0, true>;
        }
        $run(&stages, $prepared $(, $argument)*)
    }};
    // Others for the usual numbers of turning joints and full poses.
    (each, $set:ident, $run:path, $lanes:ty; $prepared:expr $(, $argument:expr)*) => {
        match usual_joints($prepared) {
            Some(joints) => {
                let mut stages = run!(@ $set, $lanes, FEW, 6);
                if joints == 7 {
                    stages.step = stages::$set::step::<$lanes, FEW, 7, false>;
                }
                $run(&stages, $prepared $(, $argument)*)
            }
            // What has room for the longest chain takes some microseconds to make and to move.
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
            // These work on one lane or four: all widths share them.
            judge: stages::$set::judge::<<$lanes as LaneScalar>::Four, { $room }>,
            seed: stages::$set::seed::<<$lanes as LaneScalar>::Four>,
        }
    };
}

/// Where the portable lanes are only the fallback, kernels for every chain are enough code.
#[cfg(target_arch = "x86_64")]
macro_rules! portable {
    ($($rest:tt)*) => { run!(any, portable, $($rest)*) };
}
#[cfg(not(target_arch = "x86_64"))]
macro_rules! portable {
    ($($rest:tt)*) => { run!(each, portable, $($rest)*) };
}

/// The number of joints, if there are kernels made for it.
fn usual_joints(prepared: &Prepared) -> Option<usize> {
    let joints = prepared.joints();
    let usual = prepared.links.all_revolute && !prepared.settings.weighted;
    (usual && (joints == 6 || joints == 7)).then_some(joints)
}

/// Whether a kernel with room for few joints is enough, for goals of the full pose.
fn is_short(prepared: &Prepared) -> bool {
    prepared.joints() <= FEW && !prepared.settings.weighted
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
) -> PoseOutcome {
    #[cfg(target_arch = "x86_64")]
    if has_fused(prepared) {
        // SAFETY: the processor has the instructions the function is compiled for. Measured: four
        // times as fast as the portable lanes.
        #[allow(unsafe_code)]
        return unsafe { race_fused(prepared, query, lone, answer) };
    }
    match query.search {
        // Which attempt wins depends on no other then, so any number of lanes has the same answer.
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
        // SAFETY: as above.
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
