//! Selection of the instruction set for a check.

use super::bodies::BodyChain;
use super::near::{self, SphereWorkspace};
use super::solids::Solids;
use crate::simd_ik::lane::{LaneScalar, Lanes};

/// Number of configurations a check.
pub(crate) const CHECKED: usize = 8;

/// Largest number of configurations for half the lanes, which take half the time. Most queries end with few
/// configurations.
#[cfg(target_arch = "x86_64")]
const HALF_CHECKED: usize = 4;

/// Workspaces for checks, one for each instruction set.
#[derive(Clone, Debug, Default)]
pub(crate) struct SphereWorkspaces {
    portable: SphereWorkspace<Lanes<CHECKED, false>>,
    #[cfg(target_arch = "x86_64")]
    fused: SphereWorkspace<Lanes<CHECKED, true>>,
    #[cfg(target_arch = "x86_64")]
    fused_half: SphereWorkspace<Lanes<HALF_CHECKED, true>>,
}

/// Bit mask of the configurations in which a body is nearer than the margin to a solid or to another body.
///
/// `q` holds up to [`CHECKED`] configurations one after another, with joint values in radians and metres.
pub(crate) fn near(
    chain: &BodyChain,
    solids: &Solids,
    q: &[f64],
    workspaces: &mut SphereWorkspaces,
) -> u32 {
    #[cfg(target_arch = "x86_64")]
    if crate::processor::has_avx2_and_fma() {
        // SAFETY: the processor has the instructions the function is compiled for. Four times as fast as the portable
        // lanes.
        #[allow(unsafe_code)]
        return unsafe {
            match q.len() > HALF_CHECKED * chain.links.links.len() {
                true => near_fused(chain, solids, q, &mut workspaces.fused),
                false => near_fused(chain, solids, q, &mut workspaces.fused_half),
            }
        };
    }
    near_any(chain, solids, q, &mut workspaces.portable)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn near_fused<const L: usize>(
    chain: &BodyChain,
    solids: &Solids,
    q: &[f64],
    workspace: &mut SphereWorkspace<Lanes<L, true>>,
) -> u32 {
    near_any(chain, solids, q, workspace)
}

/// Fills the lanes and runs the check. Surplus lanes repeat the last configuration.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_any<V: LaneScalar>(
    chain: &BodyChain,
    solids: &Solids,
    q: &[f64],
    workspace: &mut SphereWorkspace<V>,
) -> u32 {
    let joints = chain.links.links.len();
    let count = (q.len() / joints.max(1)).min(V::WIDTH);
    if count == 0 {
        return 0;
    }
    workspace.q.resize(joints, V::zero());
    for lane in 0..V::WIDTH {
        let first = lane.min(count - 1) * joints;
        for (lanes, &value) in workspace.q.iter_mut().zip(&q[first..first + joints]) {
            lanes.set_lane(lane, value);
        }
    }
    workspace.used_lanes = count;
    near::near(chain, solids, workspace) & ((1u32 << count) - 1)
}
