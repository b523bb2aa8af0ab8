//! SIMD collision check of up to one configuration a lane.

use std::ops::Range;

use super::bodies::BodyChain;
use super::many_solids::ManySolids;
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
    pub(super) asked: usize,
    /// Frames after 0, 1, … joints, in the base frame.
    frames: Vec<Placement<V>>,
    /// Centres of the bodies' bounding spheres.
    middles: Vec<Vector3<V>>,
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
            asked: 0,
            frames: Vec::new(),
            middles: Vec::new(),
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
    room: &mut SphereWorkspace<V>,
) -> u32 {
    let margin = solids.margin();
    place(chain, room);
    let mut touched = unasked(room);
    // The end of the chain first: it is the most likely to be in contact.
    for index in (0..chain.bodies.len()).rev() {
        // Fixed bodies are excluded: their distances are constant, and their spheres may protrude into the mounting
        // surface.
        if chain.bodies[index].joints == 0 {
            continue;
        }
        touched = near_solids(chain, index, solids, margin, room, touched);
        if let Some(many) = solids.many() {
            touched = near_many(chain, index, many, margin, room, touched);
        }
        if !V::any(!touched) {
            return V::mask_bits(touched);
        }
    }
    for pair in &chain.pairs {
        let [a, b] = pair.bodies;
        let middles = (room.middles[a], room.middles[b]);
        if V::any(within(middles, pair.radii + margin) & !touched) {
            touched = near_each_other(chain, [a, b], margin, room, touched);
            if !V::any(!touched) {
                break;
            }
        }
    }
    V::mask_bits(touched)
}

/// Mask of the lanes without a configuration, which are ignored.
#[cfg_attr(not(debug_assertions), inline(always))]
fn unasked<V: LaneScalar>(room: &SphereWorkspace<V>) -> V::Mask {
    let mut unasked = V::zero();
    if room.asked == V::WIDTH {
        return unasked.less_than(unasked);
    }
    for lane in room.asked..V::WIDTH {
        unasked.set_lane(lane, 1.0);
    }
    V::zero().less_than(unasked)
}

/// Computes the frames and the centres of the bounding spheres.
#[cfg_attr(not(debug_assertions), inline(always))]
fn place<V: LaneScalar>(chain: &BodyChain, room: &mut SphereWorkspace<V>) {
    let c = V::constant;
    let links = &chain.links;
    let metres = links.metres_per_length;
    let mut r = Matrix3::<V>::constant(links.base_from_first.rotation);
    let mut p = Vector3::<V>::constant(links.base_from_first.translation * metres);
    room.frames.clear();
    room.frames.push(Placement::identity());
    for (link, &q) in links.links.iter().zip(&room.q) {
        if link.kind.turns() {
            r = r.rotated_about_z((q + c(link.offset)).sin_cos());
        } else {
            p = r.z.mul_add(q, p);
            r = r.rotated_about_z((c(link.offset_sin_cos.0), c(link.offset_sin_cos.1)));
        }
        let (x, y) = (link.along_x * metres, link.along_y * metres);
        p = r.x.mul_add(c(x), r.y.mul_add(c(y), p));
        r = r.rotated_about_x((c(link.twist.0), c(link.twist.1)));
        room.frames.push(Placement::new(r, p));
    }
    room.middles.clear();
    for body in &chain.bodies {
        let frame = &room.frames[body.joints];
        room.middles.push(at(frame, &body.bound));
    }
    room.placed.clear();
    room.placed.resize(chain.bodies.len(), false);
    let count = chain.bodies.iter().map(|body| body.spheres.len()).sum();
    room.spheres.resize(count, Vector3::zero());
}

/// Computes the spheres of a body on first use and returns their index range.
#[cfg_attr(not(debug_assertions), inline(always))]
fn place_spheres<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    room: &mut SphereWorkspace<V>,
) -> Range<usize> {
    let body = &chain.bodies[index];
    let first = chain.first_sphere[index];
    let range = first..first + body.spheres.len();
    if !std::mem::replace(&mut room.placed[index], true) {
        let frame = &room.frames[body.joints];
        for (middle, sphere) in room.spheres[range.clone()].iter_mut().zip(&body.spheres) {
            *middle = at(frame, sphere);
        }
    }
    range
}

/// Mask of the known lanes and those in which a body is near the listed solids.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_solids<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    solids: &Solids,
    margin: f64,
    room: &mut SphereWorkspace<V>,
    known: V::Mask,
) -> V::Mask {
    let body = &chain.bodies[index];
    solids.near(index, room.middles[index], chain, &mut room.near_solids);
    if room.near_solids.is_empty() {
        return known;
    }
    let range = place_spheres(chain, index, room);
    let mut touched = known;
    for (&middle, sphere) in room.spheres[range].iter().zip(&body.spheres) {
        for &number in &room.near_solids {
            touched = touched | solids.near_one(number, middle, sphere.radius + margin);
        }
    }
    touched
}

/// Mask of the known lanes and those in which a body is near any of `many`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_many<V: LaneScalar>(
    chain: &BodyChain,
    index: usize,
    many: &ManySolids,
    margin: f64,
    room: &mut SphereWorkspace<V>,
    known: V::Mask,
) -> V::Mask {
    let body = &chain.bodies[index];
    let known_bits = V::mask_bits(known);
    let mut touched = V::zero();
    for lane in 0..V::WIDTH {
        if known_bits >> lane & 1 != 0 {
            continue;
        }
        // One loop with one call for the bounding sphere and the spheres: the callee is long and is inlined here.
        let (mut next, mut ball, mut middle) = (0, &body.bound, room.middles[index]);
        let mut placed = 0..0;
        loop {
            let is_near = many.near(in_lane(&middle, lane), ball.radius + margin);
            if next == 0 {
                if !is_near {
                    break;
                }
                placed = place_spheres(chain, index, room);
            } else if is_near {
                touched.set_lane(lane, 1.0);
                break;
            }
            let Some(sphere) = body.spheres.get(next) else {
                break;
            };
            (ball, middle) = (sphere, room.spheres[placed.start + next]);
            next += 1;
        }
    }
    known | V::zero().less_than(touched)
}

/// Mask of the known lanes and those in which two bodies are near each other.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_each_other<V: LaneScalar>(
    chain: &BodyChain,
    [a, b]: [usize; 2],
    margin: f64,
    room: &mut SphereWorkspace<V>,
    known: V::Mask,
) -> V::Mask {
    // No closures: they are not compiled for the selected instruction set.
    let of_a = place_spheres(chain, a, room);
    let of_b = place_spheres(chain, b, room);
    let (about_a, about_b) = (room.middles[a], room.middles[b]);
    let (a, b) = (&chain.bodies[a], &chain.bodies[b]);
    // Spheres of B near the bound of A, then spheres of A near the bound of B.
    room.near.clear();
    let placed = &room.spheres[of_b.clone()];
    for ((place, middle), ball) in of_b.zip(placed).zip(&b.spheres) {
        let reach = ball.radius + margin + a.bound.radius;
        if V::any(within((*middle, about_a), reach) & !known) {
            room.near.push((place, ball.radius));
        }
    }
    if room.near.is_empty() {
        return known;
    }
    let mut touched = known;
    for (&middle, ball) in room.spheres[of_a].iter().zip(&a.spheres) {
        let reach = ball.radius + margin;
        if !V::any(within((middle, about_b), reach + b.bound.radius) & !known) {
            continue;
        }
        for &(other, radius) in &room.near {
            touched = touched | within((middle, room.spheres[other]), reach + radius);
        }
    }
    touched
}

/// Centre of a ball of a body, in the base frame.
#[cfg_attr(not(debug_assertions), inline(always))]
fn at<V: LaneScalar>(frame: &Placement<V>, ball: &Ball) -> Vector3<V> {
    frame.apply(Vector3::constant(ball.centre))
}

/// Mask of the lanes in which two points are nearer than `reach` metres.
#[cfg_attr(not(debug_assertions), inline(always))]
fn within<V: LaneScalar>((a, b): (Vector3<V>, Vector3<V>), reach: f64) -> V::Mask {
    (a - b).norm_squared().less_than(V::constant(reach * reach))
}
