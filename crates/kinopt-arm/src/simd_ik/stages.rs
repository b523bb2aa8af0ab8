//! Functions that the drivers call, each compiled once per instruction set.
//!
//! They are not inlined into the drivers, which would compile the same code many times.

use super::evaluation::Errors;
use super::group::LaneGroup;
use super::links::Links;
use super::lm_step::EndMasks;
use super::prepared::Prepared;
use super::query::Query;
use super::seeds::QuerySeeds;
use super::settings::Settings;
use kinopt_kinematics::spatial::Placement;

type Step<V, const N: usize> = fn(&mut LaneGroup<V, N>, &Links, &Settings) -> EndMasks;
type Judge = fn(&Prepared, &Placement<f64>, &[f64]) -> (bool, Errors);
type Seed = fn(&mut QuerySeeds, &Prepared, &Query<'_>, &Placement<f64>, u32, &mut [f64]);

/// Functions of a search in lanes `V`, over groups of up to `N` joints.
pub(crate) struct Stages<V, const N: usize> {
    /// [`step`](super::lm_step::step).
    pub(crate) step: Step<V, N>,
    /// [`judge`](super::judge::judge).
    pub(crate) judge: Judge,
    /// [`QuerySeeds::fill`].
    pub(crate) seed: Seed,
}

/// Defines a module of these functions, with an attribute for their instruction set.
macro_rules! stages {
    ($name:ident $(, #[$features:meta])?) => {
        pub(crate) mod $name {
            use crate::simd_ik::evaluation::Errors;
            use crate::simd_ik::group::LaneGroup;
            use crate::simd_ik::judge;
            use crate::simd_ik::lm_step::{self, EndMasks};
            use crate::simd_ik::lane::LaneScalar;
            use crate::simd_ik::links::Links;
            use crate::simd_ik::prepared::Prepared;
            use crate::simd_ik::query::Query;
            use crate::simd_ik::seeds::QuerySeeds;
            use crate::simd_ik::settings::Settings;
            use kinopt_kinematics::spatial::Placement;

            #[inline(never)]
            $(#[$features])?
            pub(crate) fn step<V: LaneScalar, const N: usize, const JOINTS: usize, const AXES: bool>(
                group: &mut LaneGroup<V, N>,
                links: &Links,
                settings: &Settings,
            ) -> EndMasks {
                lm_step::step::<V, N, JOINTS, AXES>(group, links, settings)
            }

            #[inline(never)]
            $(#[$features])?
            pub(crate) fn judge<V: LaneScalar, const N: usize>(
                prepared: &Prepared,
                goal_from_first: &Placement<f64>,
                q: &[f64],
            ) -> (bool, Errors) {
                judge::judge::<V, N>(prepared, goal_from_first, q)
            }

            #[inline(never)]
            $(#[$features])?
            pub(crate) fn seed<V: LaneScalar>(
                seeds: &mut QuerySeeds,
                prepared: &Prepared,
                query: &Query<'_>,
                goal_from_first: &Placement<f64>,
                attempt: u32,
                q: &mut [f64],
            ) {
                seeds.fill::<V>(prepared, query, goal_from_first, attempt, q);
            }
        }
    };
}

stages!(portable);
#[cfg(target_arch = "x86_64")]
stages!(fused, #[target_feature(enable = "avx2,fma")]);
