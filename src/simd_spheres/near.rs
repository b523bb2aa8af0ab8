//! SIMD collision check of up to one configuration a lane.

use std::ops::Range;

use super::bodies::BodyChain;
use super::solid_tree::SolidTree;
use super::solids::{Solids, in_lane};
use crate::collision::Ball;
use crate::simd_ik::lane::LaneScalar;
use crate::spatial::{Matrix3, Placement, Vector3};

/// Workspace of a check.
#[derive(Clone, Debug)]
pub(crate) struct SphereWorkspace<V> {
    /// Joint values in lanes, radians and metres.
    pub(super) q: Vec<V>,
    /// Number of lanes with a configuration; these are the first lanes.
    pub(super) used_lanes: usize,
    /// Frames after 0, 1, … joints, in the base frame.
    frames: Vec<Placement<V>>,
    /// Centres of the bodies' bounding spheres.
    centres: Vec<Vector3<V>>,
    /// Centres of all spheres, body by body; valid for placed bodies only.
    spheres: Vec<Vector3<V>>,
    /// True for each body whose spheres are computed.
    placed: Vec<bool>,
    /// Indices of the solids near a body's bounding sphere.
    near_solids: Vec<u32>,
    /// Index and radius of each sphere of a body that is near another body's bounding sphere.
    near: Vec<(usize, f64)>,
}

impl<V> Default for SphereWorkspace<V> {
    fn default() -> Self {
        Self {
            q: Vec::new(),
            used_lanes: 0,
            frames: Vec::new(),
            centres: Vec::new(),
            spheres: Vec::new(),
            placed: Vec::new(),
            near_solids: Vec::new(),
            near: Vec::new(),
        }
    }
}

/// Bit mask of the lanes in which a body is nearer than the margin to a solid or to a body of an enabled pair.
///
/// The configurations are in the workspace's `q`.
///
/// Masks stay in SIMD form as long as possible: gathering their bits takes as long as the distances.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn near<V: LaneScalar>(
    chain: &BodyChain,
    solids: &Solids,
    workspace: &mut SphereWorkspace<V>,
) -> u32 {
    let margin = solids.margin();
    place(chain, workspace);
    let mut touched = unused_lanes(workspace);
    // The end of the chain first: it is the most likely to be in contact.
    for index in (0..chain.bodies.len()).rev() {
        // Fixed bodies are excluded: their distances are constant, and their spheres may protrude into the mounting
        // surface.
        if chain.bodies[index].joints == 0 {
            continue;
        }
        touched = near_solids(chain, index, solids, margin, workspace, touched);
        if let Some(solid_tree) = solids.solid_tree() {
            touched = near_tree(chain, index, solid_tree, margin, workspace, touched);
        }
        if !V::any(!touched) {
            return V::mask_bits(touched);
        }
    }
    for pair in &chain.pairs {
        let [a, b] = pair.bodies;
        let centres = (workspace.centres[a], workspace.centres[b]);
        if V::any(are_within(centres, pair.radii + margin) & !touched) {
            touched = near_each_other(chain, [a, b], margin, workspace, touched);
            if !V::any(!touched) {
                break;
            }
        }
    }
    V::mask_bits(touched)
}

/// Mask of the lanes without a configuration, which are ignored.
#[cfg_attr(not(debug_assertions), inline(always))]
fn unused_lanes<V: LaneScalar>(workspace: &SphereWorkspace<V>) -> V::Mask {
    let mut unused_lanes = V::zero();
    if workspace.used_lanes == V::WIDTH {
        return unused_lanes.less_than(unused_lanes);
    }
    for lane in workspace.used_lanes..V::WIDTH {
        unused_lanes.set_lane(lane, 1.0);
    }
    V::zero().less_than(unused_lanes)
}

/// Computes the frames and the centres of the bounding spheres.
#[cfg_attr(not(debug_assertions), inline(always))]
fn place<V: LaneScalar>(chain: &BodyChain, workspace: &mut SphereWorkspace<V>) {
    let c = V::constant;
    let links = &chain.links;
    let metres = links.metres_per_length;
    let mut r = Matrix3::<V>::constant(links.base_from_first.rotation);
    let mut p = Vector3::<V>::constant(links.base_from_first.translation * metres);
    workspace.frames.clear();
    workspace.frames.push(Placement::identity());
    for (link, &q) in links.links.iter().zip(&workspace.q) {
        if link.kind.turns() {
            r = r.rotated_about_z((q + c(link.offset)).sin_cos());
        } else {
            p = r.z.mul_add(q, p);
            r = r.rotated_about_z((c(link.offset_sin_cos.0), c(link.offset_sin_cos.1)));
        }
        let (x, y) = (link.along_x * metres, link.along_y * metres);
        p = r.x.mul_add(c(x), r.y.mul_add(c(y), p));
        r = r.rotated_about_x((c(link.twist.0), c(link.twist.1)));
        workspace.frames.push(Placement::new(r, p));
    }
    workspace.centres.clear();
    for body in &chain.bodies {
        let frame = &workspace.frames[body.joints];
        workspace.centres.push(ball_centre(frame, &body.bound));
    }
    workspace.placed.clear();
    workspace.placed.resize(chain.bodies.len(), false);
    let count = chain.bodies.iter().map(|body| body.spheres.len()).sum();
    workspace.spheres.resize(count, Vector3::zero());
}

/// Computes the spheres of a body on first use and returns their index range.
#[cfg_attr(not(debug_assertions), inline(always))]
fn place_spheres<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    workspace: &mut SphereWorkspace<V>,
) -> Range<usize> {
    let body = &chain.bodies[index];
    let first = chain.first_sphere[index];
    let range = first..first + body.spheres.len();
    if !std::mem::replace(&mut workspace.placed[index], true) {
        let frame = &workspace.frames[body.joints];
        for (centre, sphere) in workspace.spheres[range.clone()]
            .iter_mut()
            .zip(&body.spheres)
        {
            *centre = ball_centre(frame, sphere);
        }
    }
    range
}

/// Mask of `touched_before` and of the lanes in which a body is near the listed solids.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_solids<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    solids: &Solids,
    margin: f64,
    workspace: &mut SphereWorkspace<V>,
    touched_before: V::Mask,
) -> V::Mask {
    let body = &chain.bodies[index];
    solids.near(
        index,
        workspace.centres[index],
        chain,
        &mut workspace.near_solids,
    );
    if workspace.near_solids.is_empty() {
        return touched_before;
    }
    let range = place_spheres(chain, index, workspace);
    let mut touched = touched_before;
    for (&centre, sphere) in workspace.spheres[range].iter().zip(&body.spheres) {
        for &solid in &workspace.near_solids {
            touched = touched | solids.near_one(solid, centre, sphere.radius + margin);
        }
    }
    touched
}

/// Mask of `touched_before` and of the lanes in which a body is near any of `solid_tree`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_tree<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    solid_tree: &SolidTree,
    margin: f64,
    workspace: &mut SphereWorkspace<V>,
    touched_before: V::Mask,
) -> V::Mask {
    let body = &chain.bodies[index];
    let touched_bits = V::mask_bits(touched_before);
    let mut touched = V::zero();
    for lane in 0..V::WIDTH {
        if touched_bits >> lane & 1 != 0 {
            continue;
        }
        // One loop with one call for the bounding sphere and the spheres: the callee is long and is inlined here.
        let (mut next_sphere, mut ball, mut centre) = (0, &body.bound, workspace.centres[index]);
        let mut placed = 0..0;
        loop {
            let is_near = solid_tree.near(in_lane(&centre, lane), ball.radius + margin);
            if next_sphere == 0 {
                if !is_near {
                    break;
                }
                placed = place_spheres(chain, index, workspace);
            } else if is_near {
                touched.set_lane(lane, 1.0);
                break;
            }
            let Some(sphere) = body.spheres.get(next_sphere) else {
                break;
            };
            (ball, centre) = (sphere, workspace.spheres[placed.start + next_sphere]);
            next_sphere += 1;
        }
    }
    touched_before | V::zero().less_than(touched)
}

/// Mask of `touched_before` and of the lanes in which two bodies are near each other.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_each_other<V: LaneScalar>(
    chain: &BodyChain,
    [a, b]: [usize; 2],
    margin: f64,
    workspace: &mut SphereWorkspace<V>,
    touched_before: V::Mask,
) -> V::Mask {
    // No closures: they are not compiled for the selected instruction set.
    let range_a = place_spheres(chain, a, workspace);
    let range_b = place_spheres(chain, b, workspace);
    let (centre_a, centre_b) = (workspace.centres[a], workspace.centres[b]);
    let (a, b) = (&chain.bodies[a], &chain.bodies[b]);
    // Spheres of B near the bound of A, then spheres of A near the bound of B.
    workspace.near.clear();
    let placed = &workspace.spheres[range_b.clone()];
    for ((index, centre), ball) in range_b.zip(placed).zip(&b.spheres) {
        let reach = ball.radius + margin + a.bound.radius;
        if V::any(are_within((*centre, centre_a), reach) & !touched_before) {
            workspace.near.push((index, ball.radius));
        }
    }
    if workspace.near.is_empty() {
        return touched_before;
    }
    let mut touched = touched_before;
    for (&centre, ball) in workspace.spheres[range_a].iter().zip(&a.spheres) {
        let reach = ball.radius + margin;
        if !V::any(are_within((centre, centre_b), reach + b.bound.radius) & !touched_before) {
            continue;
        }
        for &(other, radius) in &workspace.near {
            touched = touched | are_within((centre, workspace.spheres[other]), reach + radius);
        }
    }
    touched
}

/// Centre of a ball of a body, in the base frame.
#[cfg_attr(not(debug_assertions), inline(always))]
fn ball_centre<V: LaneScalar>(frame: &Placement<V>, ball: &Ball) -> Vector3<V> {
    frame.apply(Vector3::constant(ball.centre))
}

/// Mask of the lanes in which two points are nearer than `reach` metres.
#[cfg_attr(not(debug_assertions), inline(always))]
fn are_within<V: LaneScalar>((a, b): (Vector3<V>, Vector3<V>), reach: f64) -> V::Mask {
    (a - b).norm_squared().less_than(V::constant(reach * reach))
}
