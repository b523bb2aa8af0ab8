//! Random trees of joints of every kind, and their forward kinematics as a plain product.

use super::random::Random;
use super::{Rigid, placement};
use kinopt::model::{FrameId, Joint, JointId, JointKind, Limits, Model};
use nalgebra as na;

#[derive(Clone, Debug)]
pub struct Part {
    pub parent: Option<usize>,
    pub parent_from_joint: Rigid,
    pub kind: JointKind,
    pub axis: na::Unit<na::Vector3<f64>>,
}

/// Model with the numbers it was built from.
#[derive(Clone, Debug)]
pub struct RandomTree {
    pub model: Model,
    pub parts: Vec<Part>,
    pub joints: Vec<JointId>,
    /// Joint index and offset of every frame.
    pub frame_offsets: Vec<(Option<usize>, Rigid)>,
    pub frames: Vec<FrameId>,
}

const KINDS: [JointKind; 4] = [
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Fixed,
    JointKind::Continuous,
];

impl RandomTree {
    /// Random tree of `joints` joints of every kind in turn, about skew and coordinate axes, in chains that branch.
    /// Links are about half a metre long. Every joint has one frame, and the world has one.
    pub fn new(seed: u64, joints: usize) -> Self {
        Self::placed(seed, joints, Rigid::identity())
    }

    /// Tree of the same seed, moved as a whole.
    pub fn placed(seed: u64, joints: usize, world_from_base: Rigid) -> Self {
        let mut random = Random::new(seed);
        let mut builder = Model::builder(format!("tree {seed}"));
        let mut tree = Self {
            model: Model::builder("").build().unwrap(),
            parts: Vec::new(),
            joints: Vec::new(),
            frame_offsets: Vec::new(),
            frames: Vec::new(),
        };
        let first_kind = random.below(4);
        for index in 0..joints {
            let parent = (index > 0).then(|| index - 1 - random.below(index.min(2)));
            let kind = KINDS[(index + first_kind) % 4];
            let offset = random.rigid(0.5);
            let offset = match parent {
                Some(_) => offset,
                None => world_from_base * offset,
            };
            let axis = match random.below(5) {
                0 => na::Vector3::x_axis(),
                1 => na::Vector3::y_axis(),
                2 => na::Vector3::z_axis(),
                _ => random.direction(),
            };
            let limits = match kind {
                JointKind::Revolute => {
                    Limits::new(random.within(-2.5, -0.3), random.within(0.3, 2.5))
                }
                JointKind::Prismatic => {
                    Limits::new(random.within(-0.4, 0.05), random.within(0.1, 0.6))
                }
                JointKind::Continuous => Limits::UNBOUNDED,
                _ => Limits::new(0.0, 0.0),
            };
            let unnormalised = axis.into_inner() * [1.0, 4.0, 0.25][random.below(3)];
            tree.joints.push(builder.joint(Joint::new(
                format!("joint {index}"),
                parent.map(|p| tree.joints[p]),
                placement(&offset),
                kind,
                unnormalised,
                limits,
            )));
            tree.parts.push(Part {
                parent,
                parent_from_joint: offset,
                kind,
                axis,
            });
            let hung = (Some(index), random.rigid(0.3));
            tree.hang(&mut builder, format!("frame {index}"), hung);
        }
        let fixed = (None, world_from_base * random.rigid(1.0));
        tree.hang(&mut builder, "anchor".to_owned(), fixed);
        tree.model = builder.build().unwrap();
        tree
    }

    fn hang(
        &mut self,
        builder: &mut kinopt::model::ModelBuilder,
        name: String,
        (joint, offset): (Option<usize>, Rigid),
    ) {
        let on = joint.map(|j| self.joints[j]);
        self.frames
            .push(builder.frame(name, on, placement(&offset)));
        self.frame_offsets.push((joint, offset));
    }

    /// Placement of every frame, as products of nalgebra's isometries.
    pub fn frames_at(&self, q: &[f64]) -> Vec<Rigid> {
        let mut coordinate = 0;
        let mut world_from_joint: Vec<Rigid> = Vec::new();
        for part in &self.parts {
            let moved = match part.kind {
                JointKind::Fixed => Rigid::identity(),
                kind => {
                    let value = q[coordinate];
                    coordinate += 1;
                    if kind == JointKind::Prismatic {
                        Rigid::translation(
                            part.axis.x * value,
                            part.axis.y * value,
                            part.axis.z * value,
                        )
                    } else {
                        let turn = na::Rotation3::from_axis_angle(&part.axis, value);
                        Rigid::from_parts(na::Translation3::identity(), turn)
                    }
                }
            };
            let parent = part
                .parent
                .map_or(Rigid::identity(), |p| world_from_joint[p]);
            world_from_joint.push(parent * part.parent_from_joint * moved);
        }
        self.frame_offsets
            .iter()
            .map(|(joint, offset)| match joint {
                Some(joint) => world_from_joint[*joint] * offset,
                None => *offset,
            })
            .collect()
    }

    /// Random configuration within the limits; joints without limits are within one turn.
    pub fn configuration(&self, random: &mut Random) -> Vec<f64> {
        configuration_of(&self.model, random)
    }

    /// Frame of the last joint, which many joints move.
    pub fn far_frame(&self) -> FrameId {
        self.frames[self.frames.len() - 2]
    }
}

/// Random configuration of any model within its limits; joints without limits are within one turn.
pub fn configuration_of(model: &Model, random: &mut Random) -> Vec<f64> {
    model
        .limits()
        .map(|limits| {
            let low = limits.lower.max(-std::f64::consts::PI);
            let high = limits.upper.min(std::f64::consts::PI);
            limits.clamp(random.within(low, high))
        })
        .collect()
}
