//! The bodies between the joints of a chain, each covered by spheres.

use crate::collision::Ball;
use crate::lanes::{Chain, Links};
use crate::spatial::Placement;

/// What moves with one joint of a chain, or stands with its base.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// How many joints move it: 0 for what stands with the base.
    pub(crate) joints: usize,
    /// Around all its spheres.
    pub(crate) bound: Ball,
    pub(crate) spheres: Vec<Ball>,
}

/// A chain's links and its bodies, base to tip, each in the frame after the last joint that moves it.
#[derive(Clone, Debug)]
pub(crate) struct BodyChain {
    pub(super) links: Links,
    pub(super) bodies: Vec<Body>,
    /// The bodies, by place, that are kept apart.
    pub(super) pairs: Vec<[usize; 2]>,
}

impl BodyChain {
    /// The bodies of a chain, each with the placement of what its spheres are given in, in the base's frame at `q`.
    pub(crate) fn new(
        chain: &Chain,
        q: &[f64],
        bodies: impl IntoIterator<Item = (Body, Placement<f64>)>,
        pairs: Vec<[usize; 2]>,
    ) -> Self {
        let links = Links::new(chain);
        let frames = links.frames(q);
        let bodies = bodies.into_iter().map(|(mut body, base_from_own)| {
            let frame_from_own = frames[body.joints].inverse() * base_from_own;
            for ball in body.spheres.iter_mut().chain([&mut body.bound]) {
                ball.centre = frame_from_own.apply(ball.centre);
            }
            body
        });
        Self {
            bodies: bodies.collect(),
            links,
            pairs,
        }
    }
}
