//! The soles of feet: the points of their shapes that come to the ground first.

use super::foot_shapes::{Ball, FootShapes};
use super::limb_tree::{joints_above, moving_joint};
use super::limbs::Limb;
use crate::model::{FrameId, Model};
use crate::scalar::elementary;
use crate::spatial::{Placement, Vector3};

/// A foot's outermost points are looked for in so many directions around, each leaning from straight down by these angles.
const AROUND: usize = 8;
const LEANING: [f64; 2] = [0.5, 1.1];

/// A body whose lowest point is over that of its foot by less than this share of the limb's height is a part of the sole.
const NEAR_GROUND: f64 = 0.25;

/// A foot with a shape, in the axes of a frame that is fixed to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sole {
    pub(super) frame: FrameId,
    /// Balls that come to the ground first, and the limb that each stands with: the nearest that stands.
    pub(super) balls: Vec<(Ball, usize)>,
    /// Directions that are level where the foot stands flat and its limbs do not tell: across it, and along it where it has
    /// one point only.
    pub(super) level: Vec<Vector3<f64>>,
}

impl Sole {
    /// How far from level each of its directions is, where its frame is: the sine of the angle.
    pub(super) fn tilts(&self, placed: &Placement<f64>) -> Vec<f64> {
        let tilted = self.level.iter().map(|way| (placed.rotation * *way).z);
        tilted.collect()
    }

    /// How high its lowest point is, where its frame is.
    pub(super) fn lowest(&self, placed: &Placement<f64>) -> f64 {
        let heights = self.balls.iter().map(|(ball, _)| ball.height(placed));
        heights.fold(f64::INFINITY, f64::min)
    }
}

/// The bodies that a limb stands on in a configuration: the lowest at its end or beyond it, as an ankle's frame may be of no foot
/// yet, and those nearly as low, as the heel and the toes of a foot with a joint between them. Each by the frame of its lowest ball.
fn bodies_below(
    model: &Model,
    limb: &Limb,
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> Vec<FrameId> {
    let moving = |frame: FrameId| moving_joint(model, frame);
    let Some(own) = moving(limb.frame) else {
        return Vec::new();
    };
    let height = |ball: &Ball| ball.height(&placed[ball.frame.index()]);
    let beyond = |ball: &&Ball| joints_above(model, ball.frame).contains(&own);
    let mut balls: Vec<&Ball> = shapes.balls.iter().filter(beyond).collect();
    balls.sort_by(|a, b| height(a).total_cmp(&height(b)));
    let Some(ground) = balls.first().map(|lowest| height(lowest)) else {
        return Vec::new();
    };
    let end = placed[limb.frame.index()].apply(limb.offset);
    let highest = ground + (NEAR_GROUND * (end.z - ground)).max(0.0);
    let mut bodies: Vec<FrameId> = Vec::new();
    for ball in balls.into_iter().take_while(|ball| height(ball) <= highest) {
        if bodies
            .iter()
            .all(|frame| moving(*frame) != moving(ball.frame))
        {
            bodies.push(ball.frame);
        }
    }
    bodies
}

/// Whether a limb ends on a body that stands on the ground, as an ankle does on a foot whose toes have a joint.
pub(super) fn ends_on_ground(
    model: &Model,
    limb: &Limb,
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> bool {
    let own = moving_joint(model, limb.frame);
    let mut bodies = bodies_below(model, limb, shapes, placed).into_iter();
    bodies.any(|frame| moving_joint(model, frame) == own)
}

/// The soles of all that stands and has a shape, where the body is in a configuration.
pub(super) fn soles(
    model: &Model,
    all: &[Limb],
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> Vec<Sole> {
    let moving = |frame: FrameId| moving_joint(model, frame);
    let standing = all.iter().enumerate().filter(|(_, limb)| limb.stands);
    let standing = standing.flat_map(|(k, limb)| {
        let at = placed[limb.frame.index()].apply(limb.offset);
        let bodies = bodies_below(model, limb, shapes, placed).into_iter();
        bodies.map(move |frame| (frame, Standing { limb: k, at }))
    });
    let mut feet: Vec<(FrameId, Vec<Standing>)> = Vec::new();
    for (frame, own) in standing {
        let foot = feet.iter_mut().find(|foot| moving(foot.0) == moving(frame));
        match foot {
            Some((_, limbs)) => limbs.push(own),
            None => feet.push((frame, vec![own])),
        }
    }
    let sole = |(frame, limbs): (FrameId, Vec<Standing>)| {
        let foot = moving(frame);
        let of_foot = shapes
            .balls
            .iter()
            .filter(|ball| moving(ball.frame) == foot);
        let of_foot = of_foot.map(|ball| (placed[ball.frame.index()].apply(ball.at), ball.radius));
        let foot_from_world = placed[frame.index()].inverse();
        let balls = outermost(&of_foot.collect::<Vec<_>>()).into_iter();
        let balls = balls.filter_map(|(at, radius)| {
            let off = |own: &&Standing| (own.at - at).norm();
            let limb = limbs.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?.limb;
            let at = foot_from_world.apply(at);
            Some((Ball { frame, at, radius }, limb))
        });
        let level = level_directions(&limbs).into_iter();
        let level = level.map(|way| foot_from_world.rotation * way);
        Sole {
            frame,
            balls: balls.collect(),
            level: level.collect(),
        }
    };
    feet.into_iter().map(sole).collect()
}

/// A limb that stands, and where its end is.
#[derive(Clone, Copy, Debug)]
struct Standing {
    limb: usize,
    at: Vector3<f64>,
}

/// The balls that are farthest out downward and aside.
fn outermost(balls: &[(Vector3<f64>, f64)]) -> Vec<(Vector3<f64>, f64)> {
    let mut found: Vec<usize> = Vec::new();
    let turn = std::f64::consts::TAU / AROUND as f64;
    for leaning in LEANING {
        let (aside, down) = elementary::sin_cos(leaning);
        for k in 0..AROUND {
            let (sine, cosine) = elementary::sin_cos(turn * (k as f64 + 0.5));
            let way = Vector3::new(aside * cosine, aside * sine, -down);
            let out = |k: &usize| balls[*k].0.dot(way) + balls[*k].1;
            let outer = (0..balls.len()).max_by(|a, b| out(a).total_cmp(&out(b)));
            found.extend(outer.filter(|own| !found.contains(own)));
        }
    }
    found.into_iter().map(|k| balls[k]).collect()
}

/// Across a foot, and along one of a single point.
fn level_directions(limbs: &[Standing]) -> Vec<Vector3<f64>> {
    let [x, y, z] = Vector3::UNITS;
    // Limbs come from the joint outward.
    let along = match limbs {
        [first, .., last] => last.at - first.at,
        _ => Vector3::zero(),
    };
    let along = Vector3::new(along.x, along.y, 0.0);
    match along.norm() {
        0.0 => vec![x, y],
        length => vec![z.cross(along * (1.0 / length))],
    }
}
