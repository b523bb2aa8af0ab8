//! The check itself.

use super::bodies::{Body, BodyChain};
use super::solids::Solids;
use crate::collision::Ball;
use crate::lanes::lane::LaneScalar;
use crate::spatial::{Matrix3, Placement, Vector3};

/// Room for checks.
#[derive(Clone, Debug)]
pub(crate) struct Room<V> {
    /// Joint values in lanes, radians and metres.
    pub(super) q: Vec<V>,
    /// After so many joints.
    frames: Vec<Placement<V>>,
    /// The middles of the bodies' bounds.
    middles: Vec<Vector3<V>>,
    /// The solids that a body's bound is near.
    near: Vec<u32>,
}

impl<V> Default for Room<V> {
    fn default() -> Self {
        Self {
            q: Vec::new(),
            frames: Vec::new(),
            middles: Vec::new(),
            near: Vec::new(),
        }
    }
}

/// The lanes, bit by bit, in which some body comes nearer than `margin` to a solid, or to a body that it is kept
/// apart from, at the room's q.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn near<V: LaneScalar>(
    chain: &BodyChain,
    solids: &Solids,
    margin: f64,
    room: &mut Room<V>,
) -> u32 {
    let all = (1u32 << V::WIDTH) - 1;
    place(chain, room);
    let mut touched = 0;
    // Hands first, as they are where things are.
    for (index, body) in chain.bodies.iter().enumerate().rev() {
        touched |= near_solids(body, index, solids, margin, room);
        if touched == all {
            return touched;
        }
    }
    for &[a, b] in &chain.pairs {
        let bodies = (&chain.bodies[a], &chain.bodies[b]);
        let middles = (room.middles[a], room.middles[b]);
        let reach = bodies.0.bound.radius + bodies.1.bound.radius + margin;
        if within(middles, reach) & !touched != 0 {
            touched |= near_each_other(bodies, margin, room, touched);
            if touched == all {
                return touched;
            }
        }
    }
    touched
}

/// Where the bodies stand.
#[cfg_attr(not(debug_assertions), inline(always))]
fn place<V: LaneScalar>(chain: &BodyChain, room: &mut Room<V>) {
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
}

/// The lanes in which a body is near solids.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_solids<V: LaneScalar>(
    body: &Body,
    index: usize,
    solids: &Solids,
    margin: f64,
    room: &mut Room<V>,
) -> u32 {
    solids.near(room.middles[index], &body.bound, margin, &mut room.near);
    if room.near.is_empty() {
        return 0;
    }
    let frame = &room.frames[body.joints];
    let mut touched = 0;
    for sphere in &body.spheres {
        let centre = at(frame, sphere);
        for &number in &room.near {
            touched |= V::mask_bits(solids.is_near(number, centre, sphere.radius + margin));
        }
    }
    touched
}

/// The lanes, beside those known already, in which two bodies are near each other.
#[cfg_attr(not(debug_assertions), inline(always))]
fn near_each_other<V: LaneScalar>(
    (a, b): (&Body, &Body),
    margin: f64,
    room: &Room<V>,
    known: u32,
) -> u32 {
    let (of_a, of_b) = (&room.frames[a.joints], &room.frames[b.joints]);
    let bound = at(of_b, &b.bound);
    let mut touched = 0;
    for sphere in &a.spheres {
        let centre = at(of_a, sphere);
        let reach = sphere.radius + margin;
        if within((centre, bound), reach + b.bound.radius) & !known == 0 {
            continue;
        }
        for other in &b.spheres {
            touched |= within((centre, at(of_b, other)), reach + other.radius);
        }
    }
    touched
}

/// The middle of a ball of a body.
#[cfg_attr(not(debug_assertions), inline(always))]
fn at<V: LaneScalar>(frame: &Placement<V>, ball: &Ball) -> Vector3<V> {
    frame.apply(Vector3::constant(ball.centre))
}

/// The lanes in which two points are nearer than so far.
#[cfg_attr(not(debug_assertions), inline(always))]
fn within<V: LaneScalar>((a, b): (Vector3<V>, Vector3<V>), reach: f64) -> u32 {
    V::mask_bits((a - b).norm_squared().less_than(V::constant(reach * reach)))
}
