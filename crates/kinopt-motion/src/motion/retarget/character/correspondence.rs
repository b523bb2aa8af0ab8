//! Correspondence of a character's bones and captured joints.
//!
//! The map has the ends of chains. Bones between two mapped bones share the rotation of the joints between their joints.
//! Fingers correspond by name and tree, and all other bones by equal names.

use std::collections::BTreeMap;

use super::super::BodyPart;
use super::super::anatomy::{JointTree, fingers, is_twist};
use super::super::part_names::bare;

/// Source of a bone's rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BoneMotion {
    /// Rotation of a captured joint.
    Joint(usize),
    /// Rotation at a fraction between those of two captured joints.
    Between {
        lower: usize,
        upper: usize,
        fraction: f64,
    },
    /// Fraction of the twist of `end`, a bone at the end of the limb, about the limb. The bone hangs on `limb`.
    TwistToEnd {
        limb: usize,
        end: usize,
        fraction: f64,
    },
    /// Twist of the limb about its own axis, relative to its parent, reduced to a fraction.
    TwistFromRoot { limb: usize, fraction: f64 },
    /// Rigid with its parent.
    Rigid,
}

/// Kind of a chain between two mapped bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ChainKind {
    /// Spine, neck, fingers: the rotation is spread from the lower to the upper end.
    Axial,
    /// Clavicles, twist bones, metatarsals: the chain follows its lower end and its own joints.
    Limb,
}

/// Motion of each bone of a character, with the mapped parts.
#[derive(Clone, Debug)]
pub(super) struct Correspondence {
    pub(super) motions: Vec<BoneMotion>,
    /// Bone of each part.
    pub(super) bones: BTreeMap<BodyPart, usize>,
    /// Captured joint of each part.
    pub(super) joints: BTreeMap<BodyPart, usize>,
    /// Bones of the spine and the neck between mapped ends: lower end, bones, upper end.
    pub(super) axial_chains: Vec<AxialChain>,
    /// Chest, and bones between chest and shoulders.
    pub(super) shoulder_girdle: Vec<usize>,
}

/// Bones between two parts of the trunk.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AxialChain {
    pub(super) lower: BodyPart,
    pub(super) bones: Vec<usize>,
    /// Captured joints between the parts.
    pub(super) joints: Vec<usize>,
    pub(super) upper: BodyPart,
}

/// Chains of bones and joints between two anchors.
struct BoneChain {
    /// Joints at both ends.
    ends: [usize; 2],
    bones: Vec<usize>,
    joints: Vec<usize>,
    kind: ChainKind,
}

impl Correspondence {
    /// Relates bones to joints. `drives` are pairs of joint and bone, `parts` the part of each drive that has one.
    ///
    /// Without a source tree, the captured joints have no chains between the parts.
    pub(super) fn new(
        bones: &JointTree,
        source: Option<&JointTree>,
        drives: &[(usize, usize)],
        parts: &[Option<BodyPart>],
    ) -> Self {
        let mut joint_of: Vec<Option<usize>> = vec![None; bones.len()];
        let (mut part_bones, mut part_joints) = (BTreeMap::new(), BTreeMap::new());
        for ((joint, bone), part) in drives.iter().zip(parts) {
            joint_of[*bone] = Some(*joint);
            if let Some(part) = part {
                part_bones.insert(*part, *bone);
                part_joints.insert(*part, *joint);
            }
        }
        let mut builder = Builder {
            bones,
            source,
            motions: joint_of
                .iter()
                .map(|joint| joint.map_or(BoneMotion::Rigid, BoneMotion::Joint))
                .collect(),
            joint_of,
            part_of_bone: part_bones
                .iter()
                .map(|(part, bone)| (*bone, *part))
                .collect(),
            axial_chains: Vec::new(),
        };
        builder.add_chains();
        builder.add_fingers(&part_bones, &part_joints);
        builder.add_equal_names();
        builder.add_twists(&part_bones);
        let chest = part_bones.get(&BodyPart::Chest).copied();
        let shoulders = [BodyPart::LeftShoulder, BodyPart::RightShoulder];
        let shoulders = shoulders.map(|shoulder| part_bones.get(&shoulder).copied());
        let clavicles = shoulders.iter().flatten().filter_map(|shoulder| {
            let clavicle = bones.joints_between(chest?, *shoulder);
            Some(clavicle.unwrap_or_default())
        });
        let shoulder_girdle = chest.into_iter().chain(clavicles.flatten()).collect();
        Self {
            shoulder_girdle,
            motions: builder.motions,
            axial_chains: builder.axial_chains,
            bones: part_bones,
            joints: part_joints,
        }
    }
}

struct Builder<'a> {
    bones: &'a JointTree,
    source: Option<&'a JointTree>,
    motions: Vec<BoneMotion>,
    /// Joint of each bone that follows one joint.
    joint_of: Vec<Option<usize>>,
    part_of_bone: BTreeMap<usize, BodyPart>,
    axial_chains: Vec<AxialChain>,
}

impl Builder<'_> {
    fn is_free(&self, bone: usize) -> bool {
        self.motions[bone] == BoneMotion::Rigid
    }

    fn is_used(&self, joint: usize) -> bool {
        self.joint_of.contains(&Some(joint))
    }

    fn set_joint(&mut self, bone: usize, joint: usize) {
        self.motions[bone] = BoneMotion::Joint(joint);
        self.joint_of[bone] = Some(joint);
    }

    /// Nearest bone above with a joint.
    fn anchor_above(&self, bone: usize) -> Option<usize> {
        let mut above = self.bones.up_from(bone).skip(1);
        above.find(|above| self.joint_of[*above].is_some())
    }

    /// Spreads rotations along the chains between mapped bones.
    fn add_chains(&mut self) {
        let mut anchors: Vec<usize> = (0..self.bones.len())
            .filter(|bone| self.joint_of[*bone].is_some())
            .collect();
        // The trunk before the limbs, which may share its bones.
        anchors.sort_by_key(|bone| match self.part_of_bone.get(bone) {
            Some(BodyPart::Chest) => 0,
            Some(BodyPart::Head) => 1,
            _ => 2,
        });
        for upper in anchors {
            let Some(lower) = self.anchor_above(upper) else {
                continue;
            };
            let (Some(first), Some(last)) = (self.joint_of[lower], self.joint_of[upper]) else {
                continue;
            };
            let part = |bone: usize| self.part_of_bone.get(&bone).copied();
            let kind = match part(upper) {
                None | Some(BodyPart::Chest | BodyPart::Head) => ChainKind::Axial,
                Some(_) => ChainKind::Limb,
            };
            let between = self.bones.joints_between(lower, upper).unwrap_or_default();
            let chain: Vec<usize> = between
                .into_iter()
                .filter(|bone| self.is_free(*bone))
                .collect();
            let path = self
                .source
                .and_then(|source| source.joints_between(first, last));
            let joints: Vec<usize> = path
                .unwrap_or_default()
                .into_iter()
                .filter(|joint| !self.is_used(*joint))
                .collect();
            if let (Some(lower), Some(upper), ChainKind::Axial) = (part(lower), part(upper), kind) {
                self.axial_chains.push(AxialChain {
                    lower,
                    bones: chain.clone(),
                    joints: joints.clone(),
                    upper,
                });
            }
            self.spread(&BoneChain {
                ends: [first, last],
                bones: chain,
                joints,
                kind,
            });
        }
    }

    /// Gives the bones of a chain the rotations of its joints, along their arc lengths.
    fn spread(&mut self, chain: &BoneChain) {
        let [first, last] = chain.ends;
        if chain.bones.len() == chain.joints.len() {
            for (bone, joint) in chain.bones.iter().zip(&chain.joints) {
                self.set_joint(*bone, *joint);
            }
            return;
        }
        // Rotations along the chain: at its lower end, in the middle of each joint's bone, and at its upper end.
        let mut nodes = vec![(0.0, first)];
        if let Some(source) = self.source {
            let middles = middles(source, first, &chain.joints, last);
            nodes.extend(middles.into_iter().zip(chain.joints.iter().copied()));
        }
        if chain.kind == ChainKind::Axial {
            nodes.push((1.0, last));
        }
        let (Some(below), Some(above)) = (chain.bones.first(), chain.bones.last()) else {
            return;
        };
        let lower = self.bones.parents[*below].unwrap_or(*below);
        let upper = self.bones.children(*above).first().copied();
        let upper = self.upper_end(*above).or(upper).unwrap_or(*above);
        let at = middles(self.bones, lower, &chain.bones, upper);
        self.follow_nodes(&chain.bones, &at, &nodes);
    }

    /// Gives bones the rotations at their places among nodes: fractions along a chain, with the joint of each.
    fn follow_nodes(&mut self, bones: &[usize], at: &[f64], nodes: &[(f64, usize)]) {
        for (bone, at) in bones.iter().zip(at) {
            let next = nodes.partition_point(|(node, _)| node < at);
            let (below, above) = (next.checked_sub(1).map(|k| nodes[k]), nodes.get(next));
            self.motions[*bone] = match (below, above) {
                (Some((from, lower)), Some(&(to, upper))) => BoneMotion::Between {
                    lower,
                    upper,
                    fraction: (at - from) / (to - from).max(f64::MIN_POSITIVE),
                },
                (Some((_, joint)), None) | (None, Some(&(_, joint))) => BoneMotion::Joint(joint),
                (None, None) => BoneMotion::Rigid,
            };
        }
    }

    /// Child of a bone that has a joint or carries one.
    fn upper_end(&self, bone: usize) -> Option<usize> {
        let below = self.bones.subtree(bone).into_iter().skip(1);
        below
            .into_iter()
            .find(|below| self.joint_of[*below].is_some())
    }

    fn add_fingers(
        &mut self,
        part_bones: &BTreeMap<BodyPart, usize>,
        part_joints: &BTreeMap<BodyPart, usize>,
    ) {
        let Some(source) = self.source else { return };
        for hand in [BodyPart::LeftHand, BodyPart::RightHand] {
            let (Some(&bone), Some(&joint)) = (part_bones.get(&hand), part_joints.get(&hand))
            else {
                continue;
            };
            let captured = fingers(source, joint);
            for (finger, chain) in fingers(self.bones, bone) {
                let Some(joints) = captured.get(&finger) else {
                    continue;
                };
                let is_free = |bone: &usize| self.is_free(*bone);
                let chain: Vec<usize> = chain.into_iter().filter(is_free).collect();
                let is_unused = |joint: &usize| !self.is_used(*joint);
                let joints: Vec<usize> = joints.iter().copied().filter(is_unused).collect();
                self.add_finger(source, &chain, &joints);
            }
        }
    }

    /// Gives the bones of a finger the rotations of a captured finger.
    fn add_finger(&mut self, source: &JointTree, bones: &[usize], joints: &[usize]) {
        if bones.len() == joints.len() {
            for (bone, joint) in bones.iter().zip(joints) {
                self.set_joint(*bone, *joint);
            }
            return;
        }
        let (Some(&first), Some(&last)) = (bones.first(), bones.last()) else {
            return;
        };
        let [Some(first_joint), Some(last_joint)] =
            [joints.first(), joints.last()].map(|j| j.copied())
        else {
            return;
        };
        let nodes: Vec<(f64, usize)> = middles(source, first_joint, joints, last_joint)
            .into_iter()
            .zip(joints.iter().copied())
            .collect();
        let at = middles(self.bones, first, bones, last);
        self.follow_nodes(bones, &at, &nodes);
    }

    /// Relates remaining bones to remaining joints of equal names below corresponding bones.
    fn add_equal_names(&mut self) {
        let Some(source) = self.source else { return };
        let mut joints: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (joint, name) in source.names.iter().enumerate() {
            joints.entry(bare(name)).or_default().push(joint);
        }
        for bone in 0..self.bones.len() {
            if !self.is_free(bone) {
                continue;
            }
            let Some(named) = joints.get(&bare(&self.bones.names[bone])) else {
                continue;
            };
            let above = self
                .anchor_above(bone)
                .and_then(|above| self.joint_of[above]);
            let found = named.iter().copied().find(|joint| {
                let mut over = source.up_from(*joint).skip(1);
                !self.is_used(*joint) && over.find(|over| self.is_used(*over)) == above
            });
            if let Some(joint) = found {
                self.set_joint(bone, joint);
            }
        }
    }

    /// Gives remaining twist bones of arms and legs their fraction of the twist.
    fn add_twists(&mut self, parts: &BTreeMap<BodyPart, usize>) {
        use BodyPart::*;
        for (start, end, ends_in_twist) in [
            (LeftElbow, LeftHand, true),
            (RightElbow, RightHand, true),
            (LeftShoulder, LeftElbow, false),
            (RightShoulder, RightElbow, false),
            (LeftHip, LeftKnee, false),
            (RightHip, RightKnee, false),
        ] {
            let (Some(&limb), Some(&end)) = (parts.get(&start), parts.get(&end)) else {
                continue;
            };
            let axis = self.bones.positions[end] - self.bones.positions[limb];
            let along = |bone: usize| {
                let offset = self.bones.positions[bone] - self.bones.positions[limb];
                (offset.dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
            };
            let in_line = self.bones.joints_between(limb, end).unwrap_or_default();
            let below: Vec<usize> = self.bones.subtree(limb).into_iter().skip(1).collect();
            for bone in below {
                let is_of_limb = self.bones.parents[bone]
                    .is_some_and(|parent| parent == limb || in_line.contains(&parent));
                let is_in_line = in_line.contains(&bone);
                let has_chain_motion = is_in_line && self.joint_of[bone].is_none();
                let is_candidate = (self.is_free(bone) || has_chain_motion) && is_of_limb;
                if !is_candidate
                    || !(is_twist(&self.bones.names[bone]) || is_in_line && ends_in_twist)
                {
                    continue;
                }
                self.motions[bone] = match (ends_in_twist, is_in_line) {
                    (true, _) => BoneMotion::TwistToEnd {
                        limb,
                        end,
                        fraction: along(bone),
                    },
                    (false, false) => BoneMotion::TwistFromRoot {
                        limb,
                        fraction: along(bone),
                    },
                    (false, true) => BoneMotion::Rigid,
                };
            }
        }
    }
}

/// Returns the middle of each joint's bone along the chain from `first` to `last`, as a fraction of the arc length.
fn middles(tree: &JointTree, first: usize, joints: &[usize], last: usize) -> Vec<f64> {
    let mut at = 0.0;
    let mut starts = Vec::with_capacity(joints.len() + 1);
    let mut before = first;
    for &joint in joints.iter().chain([&last]) {
        at += tree.distance(before, joint);
        starts.push(at);
        before = joint;
    }
    let count = joints.len() as f64;
    let middle = |k: usize| match at > 0.0 {
        true => 0.5 * (starts[k] + starts[k + 1]) / at,
        false => (k as f64 + 1.0) / (count + 1.0),
    };
    (0..joints.len()).map(middle).collect()
}
