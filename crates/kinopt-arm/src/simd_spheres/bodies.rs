//! The bodies between the joints of a chain, each covered by spheres.

use crate::simd_ik::{Chain, Links};
use kinopt_collision::collision::Ball;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// The part of a robot that moves with one joint of a chain, or that is fixed to its base.
#[derive(Clone, Debug)]
pub(crate) struct ChainBody {
    /// Number of joints that move it; 0 if it is fixed to the base.
    pub(crate) joints: usize,
    /// Bounding sphere of all its spheres.
    pub(crate) bound: Ball,
    pub(crate) spheres: Vec<Ball>,
}

/// A chain's links and its bodies from base to tip. Each body is in the frame after the last joint that moves it.
#[derive(Clone, Debug)]
pub(crate) struct BodyChain {
    pub(super) links: Links,
    pub(super) bodies: Vec<ChainBody>,
    /// Index of the first sphere of each body among all spheres.
    pub(super) first_sphere: Vec<usize>,
    /// Enabled collision pairs.
    pub(super) pairs: Vec<BodyPair>,
}

/// Two bodies by index, and the sum of the radii of their bounds, metres.
#[derive(Clone, Debug)]
pub(super) struct BodyPair {
    pub(super) bodies: [usize; 2],
    pub(super) radii: f64,
}

impl BodyChain {
    /// Attaches bodies to a chain. Each comes with the placement of its spheres' frame in the base frame at `q`.
    pub(crate) fn new(
        chain: &Chain,
        q: &[f64],
        bodies: impl IntoIterator<Item = (ChainBody, Placement<f64>)>,
        pairs: Vec<[usize; 2]>,
    ) -> Self {
        let links = Links::new(chain);
        let frames = links.frames(q);
        let bodies = bodies.into_iter().map(|(mut body, base_from_body)| {
            let frame_from_body = frames[body.joints].inverse() * base_from_body;
            for ball in body.spheres.iter_mut().chain([&mut body.bound]) {
                ball.centre = frame_from_body.apply(ball.centre);
            }
            body
        });
        let bodies: Vec<ChainBody> = bodies.collect();
        let mut first = 0;
        let first_sphere = bodies.iter().map(|body| {
            first += body.spheres.len();
            first - body.spheres.len()
        });
        let pairs = pairs.into_iter().map(|[a, b]| BodyPair {
            bodies: [a, b],
            radii: bodies[a].bound.radius + bodies[b].bound.radius,
        });
        Self {
            first_sphere: first_sphere.collect(),
            pairs: pairs.collect(),
            bodies,
            links,
        }
    }

    /// Balls in the base frame that contain the bodies' bounds at all joint values.
    pub(crate) fn reach_bounds(&self) -> Vec<Ball> {
        let links = &self.links;
        let centre = links.base_from_first.translation * links.metres_per_length;
        // Largest distance of the origin after each joint; unbounded after a prismatic joint.
        let mut reach = vec![0.0];
        for link in &links.links {
            let link_offset = Vector3::new(link.along_x, link.along_y, 0.0).norm();
            let prismatic_reach = if link.kind.turns() {
                0.0
            } else {
                f64::INFINITY
            };
            reach.push(
                reach[reach.len() - 1] + link_offset * links.metres_per_length + prismatic_reach,
            );
        }
        let reach_bound = |body: &ChainBody| match body.joints {
            0 => body.bound,
            joints => Ball {
                centre,
                radius: reach[joints] + body.bound.centre.norm() + body.bound.radius,
            },
        };
        self.bodies.iter().map(reach_bound).collect()
    }
}
