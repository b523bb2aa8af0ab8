//! Random models with a free base, ball joints of every kind, revolute and prismatic joints. Their kinematics and
//! limits use nalgebra's isometries and quaternions.

use std::f64::consts::PI;

use super::random::Random;
use super::{Rigid, placement};
use kinopt::model::{BallLimits, FrameId, JointId, Limits, Model};
use nalgebra as na;

/// Limits of a ball joint as the tests check them.
#[derive(Clone, Debug)]
pub struct Cone {
    pub axis: na::Unit<na::Vector3<f64>>,
    pub about: na::Unit<na::Vector3<f64>>,
    pub swing: [f64; 2],
    pub twist: Limits,
}

#[derive(Clone, Debug)]
pub enum Kind {
    Free([Limits; 3]),
    Ball(Option<Cone>),
    Hinge(na::Unit<na::Vector3<f64>>, Limits),
    Slide(na::Unit<na::Vector3<f64>>, Limits),
}

#[derive(Clone, Debug)]
pub struct Part {
    pub name: String,
    pub parent: Option<usize>,
    pub parent_from_joint: Rigid,
    pub kind: Kind,
    pub id: JointId,
}

/// Free base and joints of every kind in chains that branch.
#[derive(Clone, Debug)]
pub struct Figure {
    pub model: Model,
    pub parts: Vec<Part>,
    /// One frame on every part, at most half a metre from its joint.
    pub frames: Vec<FrameId>,
    pub offsets: Vec<Rigid>,
}

impl Figure {
    pub fn new(seed: u64, joints: usize) -> Self {
        let mut random = Random::new(seed);
        let mut builder = Model::builder(format!("figure {seed}"));
        let mut parts: Vec<Part> = Vec::new();
        for index in 0..joints {
            let parent = (index > 0).then(|| index - 1 - random.below(index.min(2)));
            let on = parent.map(|p: usize| parts[p].id);
            let parent_from_joint = random.rigid(0.4);
            let at = placement(&parent_from_joint);
            let name = format!("joint {index}");
            let axis = random.direction();
            let kind = match (index, (index + seed as usize) % 5) {
                (0, _) => Kind::Free(if seed.is_multiple_of(2) {
                    [Limits::new(-0.5, 0.4); 3]
                } else {
                    [Limits::UNBOUNDED; 3]
                }),
                (_, 0) => Kind::Ball(None),
                (_, 1) => Kind::Ball(Some(Cone {
                    axis,
                    about: across(&axis),
                    swing: [random.within(0.3, 1.5); 2],
                    twist: Limits::new(random.within(-1.5, -0.1), random.within(0.1, 1.5)),
                })),
                (_, 2) => Kind::Ball(Some(Cone {
                    axis,
                    about: across(&axis),
                    swing: [random.within(0.2, 0.8), random.within(0.8, 2.5)],
                    twist: if random.below(2) == 0 {
                        Limits::UNBOUNDED
                    } else {
                        Limits::new(-0.6, 0.9)
                    },
                })),
                (_, 3) => Kind::Slide(axis, Limits::new(-0.2, 0.3)),
                _ => Kind::Hinge(axis, Limits::new(-1.2, 1.7)),
            };
            let along = |axis: &na::Unit<na::Vector3<f64>>| super::vector(axis.into_inner());
            let id = match &kind {
                Kind::Free(position_limits) => builder.free(&*name, on, at, *position_limits),
                Kind::Ball(None) => builder.ball(&*name, on, at, along(&axis), None),
                Kind::Ball(Some(cone)) => {
                    let limits = BallLimits::elliptic(along(&cone.about), cone.swing, cone.twist);
                    builder.ball(&*name, on, at, along(&axis), Some(limits))
                }
                Kind::Hinge(axis, limits) => builder.revolute(&*name, on, at, along(axis), *limits),
                Kind::Slide(axis, limits) => {
                    builder.prismatic(&*name, on, at, along(axis), *limits)
                }
            };
            parts.push(Part {
                name,
                parent,
                parent_from_joint,
                kind,
                id,
            });
        }
        let offsets: Vec<Rigid> = parts.iter().map(|_| random.rigid(0.3)).collect();
        let frames = (parts.iter().zip(&offsets))
            .map(|(part, offset)| {
                builder.frame(
                    format!("on {}", part.name),
                    Some(part.id),
                    placement(offset),
                )
            })
            .collect();
        Self {
            model: builder.build().unwrap(),
            parts,
            frames,
            offsets,
        }
    }

    /// Placement of every frame.
    pub fn frames_at(&self, q: &[f64]) -> Vec<Rigid> {
        let mut remaining_q = q;
        let mut take = |count: usize| {
            let (values, remaining) = remaining_q.split_at(count);
            remaining_q = remaining;
            values
        };
        let mut world: Vec<Rigid> = Vec::new();
        for part in &self.parts {
            let moved = match &part.kind {
                Kind::Free(_) => {
                    let q = take(7);
                    let at = na::Translation3::new(q[0], q[1], q[2]);
                    Rigid::from_parts(at, unit(&q[3..]).to_rotation_matrix())
                }
                Kind::Ball(_) => {
                    let turned = unit(take(4)).to_rotation_matrix();
                    Rigid::from_parts(na::Translation3::identity(), turned)
                }
                Kind::Hinge(axis, _) => {
                    let turned = na::Rotation3::from_axis_angle(axis, take(1)[0]);
                    Rigid::from_parts(na::Translation3::identity(), turned)
                }
                Kind::Slide(axis, _) => {
                    let displacement = axis.into_inner() * take(1)[0];
                    Rigid::from_parts(displacement.into(), na::Rotation3::identity())
                }
            };
            let parent = part.parent.map_or(Rigid::identity(), |p| world[p]);
            world.push(parent * part.parent_from_joint * moved);
        }
        let placed = world.iter().zip(&self.offsets);
        placed.map(|(world, offset)| world * offset).collect()
    }

    /// First value of a configuration outside of its limits, if any.
    ///
    /// Swing and twist are computed by another method than the library's. The twist axis is rotated to its direction,
    /// and the remaining rotation is about that direction.
    pub fn broken(&self, q: &[f64]) -> Option<String> {
        let mut at = 0;
        for part in &self.parts {
            let fault = match &part.kind {
                Kind::Free(position_limits) => {
                    let out = (0..3).find(|&k| !position_limits[k].contains(q[at + k]));
                    let length = quaternion_length(&q[at + 3..]);
                    at += 7;
                    out.map(|k| format!("slides out along {k}")).or_else(|| {
                        (length > 1e-12).then(|| format!("quaternion off by {length:e}"))
                    })
                }
                Kind::Ball(cone) => {
                    let quaternion = &q[at..at + 4];
                    at += 4;
                    let length = quaternion_length(quaternion);
                    (length > 1e-12)
                        .then(|| format!("quaternion off by {length:e}"))
                        .or_else(|| {
                            cone.as_ref()
                                .and_then(|cone| cone.broken(&unit(quaternion)))
                        })
                }
                Kind::Hinge(_, limits) | Kind::Slide(_, limits) => {
                    at += 1;
                    let value = q[at - 1];
                    (!limits.contains(value)).then(|| format!("{value} outside {limits:?}"))
                }
            };
            if let Some(fault) = fault {
                return Some(format!("{}: {fault}", part.name));
            }
        }
        None
    }
}

impl Cone {
    /// Swing about the two perpendicular axes, and twist, radians.
    pub fn part(&self, turned: &na::UnitQuaternion<f64>) -> ([f64; 2], f64) {
        let tipped = turned * self.axis.into_inner();
        let swing = na::UnitQuaternion::rotation_between(&self.axis, &tipped)
            .unwrap_or_else(|| na::UnitQuaternion::from_axis_angle(&self.about, PI));
        let twist = swing.inverse() * turned;
        let vector = swing.scaled_axis();
        let second = self.axis.cross(&self.about);
        let turned = twist.scaled_axis().dot(&self.axis);
        ([vector.dot(&self.about), vector.dot(&second)], turned)
    }

    fn broken(&self, turned: &na::UnitQuaternion<f64>) -> Option<String> {
        let ([first, second], twist) = self.part(turned);
        let share = (first / self.swing[0]).hypot(second / self.swing[1]);
        if share > 1.0 + 1e-9 {
            return Some(format!("swung to {share} of its cone"));
        }
        let Limits { lower, upper } = self.twist;
        let out = twist < lower - 1e-9 || twist > upper + 1e-9;
        out.then(|| format!("twisted by {twist}, outside {:?}", self.twist))
    }
}

pub fn unit(q: &[f64]) -> na::UnitQuaternion<f64> {
    na::UnitQuaternion::new_normalize(na::Quaternion::new(q[0], q[1], q[2], q[3]))
}

fn quaternion_length(q: &[f64]) -> f64 {
    (na::Vector4::new(q[0], q[1], q[2], q[3]).norm() - 1.0).abs()
}

fn across(axis: &na::Unit<na::Vector3<f64>>) -> na::Unit<na::Vector3<f64>> {
    let any = if axis.x.abs() < 0.7 {
        na::Vector3::x()
    } else {
        na::Vector3::y()
    };
    na::Unit::new_normalize(axis.cross(&any))
}
