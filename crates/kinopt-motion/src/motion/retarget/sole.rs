//! Soles of feet: the points of their shapes that reach the ground first.

use super::limb::DrivenLimb;
use super::limb_tree::{joints_above, moving_joint};
use crate::motion::contact::{FootBall, FootShapes};
use kinopt_kinematics::model::{FrameId, Model};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Number of horizontal directions in which the outermost points of a foot are searched, and their angles from straight
/// down, radians.
const SOLE_DIRECTIONS: usize = 8;
const TILT_ANGLES: [f64; 2] = [0.5, 1.1];

/// Largest height of a body of the sole above the lowest point of the foot, as a fraction of the limb's height.
const MAX_HEIGHT_RATIO: f64 = 0.25;

/// Contact geometry of a foot, in the axes of a frame that is fixed to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sole {
    pub(super) frame: FrameId,
    /// Balls that reach the ground first, each with the index of the nearest limb in contact.
    pub(super) balls: Vec<(FootBall, usize)>,
    /// Directions that are level if the foot is flat on the ground, and not determined by its contact points. One is
    /// across the foot; for a single contact point there are two.
    pub(super) level: Vec<Vector3<f64>>,
    /// Centres of the balls, and level directions, in the model's stance.
    pub(super) stance_balls: Vec<Vector3<f64>>,
    pub(super) stance_level: Vec<Vector3<f64>>,
}

impl Sole {
    /// Returns the tilt of each level direction, as the sine of its angle from the horizontal.
    pub(super) fn tilts(&self, placed: &Placement<f64>) -> Vec<f64> {
        let tilted = self
            .level
            .iter()
            .map(|direction| (placed.rotation * *direction).z);
        tilted.collect()
    }

    /// Returns the height of the lowest point.
    pub(super) fn lowest(&self, placed: &Placement<f64>) -> f64 {
        let heights = self.balls.iter().map(|(ball, _)| ball.height(placed));
        heights.fold(f64::INFINITY, f64::min)
    }
}

/// Returns the bodies on which a limb is in contact in a configuration, each by the frame of its lowest ball.
///
/// The first is the lowest body at or beyond the limb's end, because an ankle's frame may be on the shin. Bodies almost
/// as low follow, such as heel and toes of a foot with a joint between them.
fn bodies_below(
    model: &Model,
    limb: &DrivenLimb,
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> Vec<FrameId> {
    let moving = |frame: FrameId| moving_joint(model, frame);
    let Some(limb_joint) = moving(limb.frame) else {
        return Vec::new();
    };
    let height = |ball: &FootBall| ball.height(&placed[ball.frame.index()]);
    let is_at_or_beyond = |ball: &&FootBall| joints_above(model, ball.frame).contains(&limb_joint);
    let mut balls: Vec<&FootBall> = shapes.balls.iter().filter(is_at_or_beyond).collect();
    balls.sort_by(|a, b| height(a).total_cmp(&height(b)));
    let Some(ground) = balls.first().map(|lowest| height(lowest)) else {
        return Vec::new();
    };
    let end = placed[limb.frame.index()].apply(limb.offset);
    let max_height = ground + (MAX_HEIGHT_RATIO * (end.z - ground)).max(0.0);
    let mut bodies: Vec<FrameId> = Vec::new();
    for ball in balls
        .into_iter()
        .take_while(|ball| height(ball) <= max_height)
    {
        if bodies
            .iter()
            .all(|frame| moving(*frame) != moving(ball.frame))
        {
            bodies.push(ball.frame);
        }
    }
    bodies
}

/// Returns whether a limb ends on a body in contact with the ground. An example is an ankle on a foot with a toe joint.
pub(super) fn ends_on_ground(
    model: &Model,
    limb: &DrivenLimb,
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> bool {
    let limb_joint = moving_joint(model, limb.frame);
    let mut bodies = bodies_below(model, limb, shapes, placed).into_iter();
    bodies.any(|frame| moving_joint(model, frame) == limb_joint)
}

/// Returns the soles of all limbs that make contact and have shapes. `placed` are the frames of the model in a
/// configuration.
pub(super) fn soles(
    model: &Model,
    all: &[DrivenLimb],
    shapes: &FootShapes,
    placed: &[Placement<f64>],
) -> Vec<Sole> {
    let moving = |frame: FrameId| moving_joint(model, frame);
    let contacts = all
        .iter()
        .enumerate()
        .filter(|(_, limb)| limb.makes_contact);
    let contacts = contacts.flat_map(|(k, limb)| {
        let position = placed[limb.frame.index()].apply(limb.offset);
        let bodies = bodies_below(model, limb, shapes, placed).into_iter();
        bodies.map(move |frame| (frame, ContactPoint { limb: k, position }))
    });
    let mut feet: Vec<(FrameId, Vec<ContactPoint>)> = Vec::new();
    for (frame, contact) in contacts {
        let foot = feet.iter_mut().find(|foot| moving(foot.0) == moving(frame));
        match foot {
            Some((_, limbs)) => limbs.push(contact),
            None => feet.push((frame, vec![contact])),
        }
    }
    let sole = |(frame, limbs): (FrameId, Vec<ContactPoint>)| {
        let foot = moving(frame);
        let foot_balls = shapes
            .balls
            .iter()
            .filter(|ball| moving(ball.frame) == foot);
        let foot_balls =
            foot_balls.map(|ball| (placed[ball.frame.index()].apply(ball.at), ball.radius));
        let foot_from_world = placed[frame.index()].inverse();
        let balls = outermost(&foot_balls.collect::<Vec<_>>()).into_iter();
        let balls = balls.filter_map(|(at, radius)| {
            let distance = |contact: &&ContactPoint| (contact.position - at).norm();
            let limb = limbs
                .iter()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))?
                .limb;
            let at = foot_from_world.apply(at);
            Some((FootBall { frame, at, radius }, limb))
        });
        let balls: Vec<(FootBall, usize)> = balls.collect();
        let stance_level = level_directions(&limbs);
        let level = stance_level
            .iter()
            .map(|direction| foot_from_world.rotation * *direction);
        Sole {
            frame,
            stance_balls: balls
                .iter()
                .map(|(ball, _)| placed[frame.index()].apply(ball.at))
                .collect(),
            balls,
            level: level.collect(),
            stance_level,
        }
    };
    feet.into_iter().map(sole).collect()
}

/// Limb that makes contact, with the position of its end.
#[derive(Clone, Copy, Debug)]
struct ContactPoint {
    limb: usize,
    position: Vector3<f64>,
}

/// Returns the balls that are outermost downward and sideways.
fn outermost(balls: &[(Vector3<f64>, f64)]) -> Vec<(Vector3<f64>, f64)> {
    let mut indices: Vec<usize> = Vec::new();
    let angle_step = std::f64::consts::TAU / SOLE_DIRECTIONS as f64;
    for tilt in TILT_ANGLES {
        let (sideways, down) = elementary::sin_cos(tilt);
        for k in 0..SOLE_DIRECTIONS {
            let (sine, cosine) = elementary::sin_cos(angle_step * (k as f64 + 0.5));
            let direction = Vector3::new(sideways * cosine, sideways * sine, -down);
            let extent = |k: &usize| balls[*k].0.dot(direction) + balls[*k].1;
            let outer = (0..balls.len()).max_by(|a, b| extent(a).total_cmp(&extent(b)));
            indices.extend(outer.filter(|index| !indices.contains(index)));
        }
    }
    indices.into_iter().map(|k| balls[k]).collect()
}

/// Returns the level directions: across a foot, or two for a single contact point.
fn level_directions(limbs: &[ContactPoint]) -> Vec<Vector3<f64>> {
    let [x, y, z] = Vector3::UNITS;
    // Limbs are sorted from the joint outward.
    let along = match limbs {
        [first, .., last] => last.position - first.position,
        _ => Vector3::zero(),
    };
    let along = Vector3::new(along.x, along.y, 0.0);
    match along.norm() {
        0.0 => vec![x, y],
        length => vec![z.cross(along * (1.0 / length))],
    }
}
