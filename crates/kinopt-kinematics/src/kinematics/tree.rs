//! A model compiled for evaluation: moving joints only, with constants folded in.

use std::ops::Mul;

use super::motion::{BallPart, NodeMotion};
use crate::buffer::refill;
use crate::model::{FrameId, JointKind, Model, ParameterMap, RotationChart, Source, quaternion_at};
use crate::scalar::Scalar;
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// Index of a frame in the list that a tree was compiled for.
#[doc(hidden)]
pub type FrameSlot = usize;

/// A constant placement, classified so that the identity costs nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FixedPlacement {
    Identity,
    Translation(Vector3<f64>),
    Rigid(Placement<f64>),
}

impl FixedPlacement {
    pub(super) fn new(placement: Placement<f64>) -> Self {
        if placement.rotation != Matrix3::identity() {
            Self::Rigid(placement)
        } else if placement.translation != Vector3::zero() {
            Self::Translation(placement.translation)
        } else {
            Self::Identity
        }
    }

    fn translation(&self) -> Vector3<f64> {
        match self {
            Self::Identity => Vector3::zero(),
            Self::Translation(offset) => *offset,
            Self::Rigid(placement) => placement.translation,
        }
    }

    /// The placement translated by `offset` in its parent's axes.
    fn shifted(&self, offset: Vector3<f64>) -> Self {
        let rotation = match self {
            Self::Rigid(placement) => placement.rotation,
            Self::Identity | Self::Translation(_) => Matrix3::identity(),
        };
        Self::new(Placement::new(rotation, self.translation() + offset))
    }
}

impl<S: Scalar> Mul<&FixedPlacement> for &Placement<S> {
    type Output = Placement<S>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, parent_from_child: &FixedPlacement) -> Placement<S> {
        match parent_from_child {
            FixedPlacement::Identity => *self,
            FixedPlacement::Translation(offset) => {
                Placement::new(self.rotation, self.apply(Vector3::constant(*offset)))
            }
            FixedPlacement::Rigid(placement) => *self * Placement::constant(placement),
        }
    }
}

/// One moving joint of the tree.
///
/// Its placement is `parent_from_node · motion(value)` with `value = ratio · x[variable] + offset`, in radians or
/// metres.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// The next moving joint towards the root; `None` for a joint of the world.
    pub(super) parent: Option<usize>,
    /// Placement of the joint at value 0, with the fixed joints in between folded in.
    pub(super) parent_from_node: FixedPlacement,
    pub(super) motion: NodeMotion,
    pub(super) variable: usize,
    pub(super) ratio: f64,
    pub(super) offset: f64,
}

/// A ball joint: three nodes at one point. The last one rotates by the values of all three.
#[derive(Clone, Debug)]
pub(super) struct BallNodes {
    pub(super) last: usize,
    /// Map from the three values to a rotation.
    pub(super) chart: RotationChart,
}

/// The attachment of a requested frame.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    /// The last moving joint above it; `None` for a frame fixed in the world.
    pub(super) node: Option<usize>,
    pub(super) node_from_frame: FixedPlacement,
}

/// A model compiled for one list of frames and one parameter map.
///
/// Nodes are ordered parents first. Joints that are fixed, locked, or move none of the frames are removed.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) balls: Vec<BallNodes>,
    frames: Vec<FrameId>,
    /// Position of the first root joint in the world.
    ///
    /// Nodes are placed relative to it, so that levers lose no digits in a model far from the world's origin.
    pub(super) origin: Vector3<f64>,
    variables: usize,
}

/// Workspace for compiling a tree again.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct TreeWorkspace {
    /// By joint: true if it carries a requested frame.
    needed: Vec<bool>,
    /// By joint: the node that carries it, and node_from_joint after its motion.
    carried: Vec<(Option<usize>, Placement<f64>)>,
}

impl Tree {
    /// Compiles `model` for the given frames under its map `map`; slot k of the tree is `frames[k]`.
    #[doc(hidden)]
    pub fn new(model: &Model, map: &ParameterMap, frames: &[FrameId]) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::new(),
            balls: Vec::new(),
            frames: frames.to_vec(),
            origin: Vector3::zero(),
            variables: map.variables(),
        };
        tree.compile(model, map, &mut TreeWorkspace::default());
        tree
    }

    /// Compiles again from the same model after its joints or frames moved; allocates on the first call only.
    #[doc(hidden)]
    pub fn compile(&mut self, model: &Model, map: &ParameterMap, workspace: &mut TreeWorkspace) {
        let joints = model.joints();
        let Self {
            nodes,
            leaves,
            balls,
            frames,
            ..
        } = self;
        let TreeWorkspace { needed, carried } = workspace;
        refill(needed, joints.len(), false);
        for frame in &*frames {
            let mut joint_of_frame = model.frames()[frame.index()].joint;
            while let Some(joint) = joint_of_frame.filter(|j| !needed[j.index()]) {
                needed[joint.index()] = true;
                joint_of_frame = joints[joint.index()].parent;
            }
        }

        nodes.clear();
        balls.clear();
        refill(carried, joints.len(), (None, Placement::identity()));
        for (index, joint) in joints.iter().enumerate().filter(|(i, _)| needed[*i]) {
            let (node, node_from_parent) = match joint.parent {
                Some(parent) => carried[parent.index()],
                None => (None, Placement::identity()),
            };
            // Before the joint's own motion.
            let node_from_joint = node_from_parent * joint.parent_from_joint;
            let motion = NodeMotion::new(joint.kind, joint.axis);
            let coordinate = model.coordinate(crate::model::JointId::new(index));
            let source = coordinate.map(|coordinate| map.sources()[coordinate]);
            if let (JointKind::Ball, Some(coordinate)) = (joint.kind, coordinate) {
                carried[index] = match map.balls().iter().find(|b| b.coordinate == coordinate) {
                    Some(ball) => {
                        for part in 0..3 {
                            nodes.push(Node {
                                parent: if part == 0 {
                                    node
                                } else {
                                    Some(nodes.len() - 1)
                                },
                                parent_from_node: match part {
                                    0 => FixedPlacement::new(node_from_joint),
                                    _ => FixedPlacement::Identity,
                                },
                                motion: NodeMotion::Ball(BallPart {
                                    ball: balls.len() as u32,
                                    part: part as u32,
                                }),
                                variable: ball.variable + part,
                                ratio: 1.0,
                                offset: 0.0,
                            });
                        }
                        let last = nodes.len() - 1;
                        let chart = ball.chart;
                        balls.push(BallNodes { last, chart });
                        (Some(last), Placement::identity())
                    }
                    None => {
                        let locked = map.sources()[coordinate..].first_chunk::<4>();
                        let locked = locked.map(|locked| locked.map(|source| source.at(&[])));
                        let rotation = locked.and_then(|locked| quaternion_at(&locked));
                        let locked_rotation =
                            rotation.map_or(Matrix3::identity(), Quaternion::to_matrix);
                        let locked_placement = Placement::new(locked_rotation, Vector3::zero());
                        (node, node_from_joint * locked_placement)
                    }
                };
                continue;
            }
            carried[index] = match (motion, source) {
                (Some(motion), Some(Source::Constant(value))) => (
                    node,
                    motion.apply(node_from_joint, value, elementary::sin_cos(value)),
                ),
                (
                    Some(motion),
                    Some(Source::Variable {
                        variable,
                        ratio,
                        offset,
                    }),
                ) => {
                    nodes.push(Node {
                        parent: node,
                        parent_from_node: FixedPlacement::new(node_from_joint),
                        motion,
                        variable,
                        ratio,
                        offset,
                    });
                    (Some(nodes.len() - 1), Placement::identity())
                }
                _ => (node, node_from_joint),
            };
        }

        // Only root joints are placed in the world.
        let first = nodes.iter().find(|node| node.parent.is_none());
        let origin = first.map_or(Vector3::zero(), |root| root.parent_from_node.translation());
        for node in nodes.iter_mut().filter(|node| node.parent.is_none()) {
            node.parent_from_node = node.parent_from_node.shifted(-origin);
        }

        leaves.clear();
        leaves.extend(frames.iter().map(|frame| {
            let frame = &model.frames()[frame.index()];
            let (node, node_from_joint) = match frame.joint {
                Some(joint) => carried[joint.index()],
                None => (None, Placement::identity()),
            };
            Leaf {
                node,
                node_from_frame: FixedPlacement::new(node_from_joint * frame.joint_from_frame),
            }
        }));
        self.origin = origin;
    }

    /// Number of variables.
    pub(crate) fn variables(&self) -> usize {
        self.variables
    }

    /// The model's frames of the tree, by slot.
    #[doc(hidden)]
    pub fn frames(&self) -> impl Iterator<Item = FrameId> + '_ {
        self.frames.iter().copied()
    }

    /// The model's frame of a slot.
    #[doc(hidden)]
    pub fn frame(&self, slot: FrameSlot) -> FrameId {
        self.frames[slot]
    }

    /// The variables that move a frame, from the frame to the root; none for an unknown slot.
    #[doc(hidden)]
    pub fn variables_moving(&self, slot: FrameSlot) -> impl Iterator<Item = usize> + '_ {
        let first = self.leaves.get(slot).and_then(|leaf| leaf.node);
        let nodes = std::iter::successors(first, |&node| self.nodes[node].parent);
        nodes.map(|node| self.nodes[node].variable)
    }
}
