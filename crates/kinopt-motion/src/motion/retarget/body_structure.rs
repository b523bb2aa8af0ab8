//! Body parts of a humanoid robot from its kinematic tree.
//!
//! Names of links differ from robot to robot, and origins of links are seldom at the anatomical joints. The tree
//! determines both: legs and arms are mirrored branches, and the axes of a hip, shoulder, wrist or ankle nearly
//! intersect in its centre.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3 as Column};

use super::limb_tree::moving_joint;
use super::{BodyPart, Drive};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{JointId, Model};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Largest distance of mirrored branches from their mirror image, relative to the height of the robot.
const MIRROR_TOLERANCE: f64 = 0.06;
/// Smallest number of joints of a leg and of an arm.
const MIN_LEG_JOINTS: usize = 4;
const MIN_ARM_JOINTS: usize = 3;
/// Range of the height of a knee above the ground, relative to the hip's.
const KNEE_HEIGHTS: [f64; 2] = [0.2, 0.8];
/// Largest height of an ankle above the ground, relative to the hip's.
const MAX_ANKLE_HEIGHT: f64 = 0.35;
/// Largest distance of the axes of one ankle, relative to the height of the hip.
const ANKLE_EXTENT: f64 = 0.12;
/// Distance from ankle to toe, relative to the shin.
const TOE_RATIO: f64 = 0.45;
/// Sine of the angle to a direction up to which an axis is along or across it.
const MAX_OFF_AXIS: f64 = 0.5;
/// Weight of the mean origin in the intersection of axes.
const CENTRE_REGULARISATION: f64 = 1e-2;
/// Shortest forearm, relative to the upper arm, whose end counts as wrist.
const MIN_FOREARM: f64 = 0.5;
/// Resolution of the offsets of a map, metres, so that rounding errors are zero.
const OFFSET_RESOLUTION: f64 = 1e-6;
/// Largest number of joints between the shoulders' link and a head.
const MAX_NECK_JOINTS: usize = 4;

/// Moving joint in the neutral configuration.
#[derive(Clone, Debug)]
struct MovingAxis {
    id: JointId,
    origin: Vector3<f64>,
    direction: Vector3<f64>,
    slides: bool,
    /// Middle of the joint's range, radians; its sign is that of flexion.
    middle: f64,
    parent: Option<usize>,
    children: Vec<usize>,
}

/// Moving joints of a robot in the neutral configuration, without those of a free base.
#[derive(Clone, Debug)]
struct JointBranches<'m> {
    model: &'m Model,
    placed: Vec<Placement<f64>>,
    axes: Vec<MovingAxis>,
    /// Moving joint of each frame; `None` for the root link.
    carriers: Vec<Option<usize>>,
    height: f64,
}

/// Returns the drives of a robot's body parts; `None` if its tree has no two legs and two arms.
///
/// The robot is upright along z in the neutral configuration.
pub(super) fn parts_of_structure(model: &Model) -> Option<BTreeMap<BodyPart, Drive>> {
    let tree = JointBranches::of(model)?;
    let pairs = tree.mirrored_pairs();
    let lowest = |pair: &[usize; 2]| tree.lowest(pair[0]).min(tree.lowest(pair[1]));
    let has = |pair: &&[usize; 2], joints| {
        pair.iter()
            .all(|&root| tree.descendants(root).len() >= joints)
    };
    let legs = pairs.iter().filter(|pair| has(pair, MIN_LEG_JOINTS));
    let legs = *legs.min_by(|a, b| lowest(a).total_cmp(&lowest(b)))?;
    let arms = pairs
        .iter()
        .filter(|pair| **pair != legs && has(pair, MIN_ARM_JOINTS));
    let arms = *arms.max_by(|a, b| tree.extent(a[0]).total_cmp(&tree.extent(b[0])))?;
    // The front legs of a quadruped are no arms.
    if tree.axes[arms[0]].origin.z < tree.axes[legs[0]].origin.z + MIRROR_TOLERANCE * tree.height {
        return None;
    }
    let ground = lowest(&legs);
    let [a, b] = [tree.leg(legs[0], ground)?, tree.leg(legs[1], ground)?];
    let forward = tree.forward(&a)?;
    let left = Vector3::UNITS[2].cross(forward);
    let in_order = |a: Vector3<f64>, b: Vector3<f64>| (a - b).dot(left) > 0.0;
    let legs = match in_order(a.hip, b.hip) {
        true => [a, b],
        false => [b, a],
    };
    let arms = match in_order(tree.centroid(arms[0]), tree.centroid(arms[1])) {
        true => arms,
        false => [arms[1], arms[0]],
    };
    let mut parts = BTreeMap::new();
    let hips = (legs[0].hip + legs[1].hip) * 0.5;
    let trunk = tree.axes[legs[0].hip_joints[0]].parent;
    let mut add = |part: BodyPart, carrier: Option<usize>, position: Vector3<f64>| {
        if let Some(drive) = tree.drive(carrier, position) {
            parts.insert(part, drive);
        }
    };
    add(BodyPart::Pelvis, trunk, hips);
    for (leg, [hip, knee, ankle, toe]) in legs.iter().zip([
        [
            BodyPart::LeftHip,
            BodyPart::LeftKnee,
            BodyPart::LeftAnkle,
            BodyPart::LeftToe,
        ],
        [
            BodyPart::RightHip,
            BodyPart::RightKnee,
            BodyPart::RightAnkle,
            BodyPart::RightToe,
        ],
    ]) {
        add(hip, leg.hip_joints.last().copied(), leg.hip);
        add(knee, Some(leg.knee_joint), leg.knee);
        add(ankle, Some(leg.foot_joint), leg.ankle);
        let length = TOE_RATIO * (leg.knee - leg.ankle).norm();
        let mut end = leg.ankle + forward * length;
        end.z = tree.lowest(leg.foot_joint).min(end.z);
        add(toe, Some(leg.foot_joint), end);
    }
    for (root, [shoulder, elbow, hand]) in arms.into_iter().zip([
        [
            BodyPart::LeftShoulder,
            BodyPart::LeftElbow,
            BodyPart::LeftHand,
        ],
        [
            BodyPart::RightShoulder,
            BodyPart::RightElbow,
            BodyPart::RightHand,
        ],
    ]) {
        let arm = tree.arm(root)?;
        add(shoulder, arm.shoulder_joints.last().copied(), arm.shoulder);
        add(elbow, Some(arm.elbow_joint), arm.elbow);
        if let Some((joint, position)) = arm.hand {
            add(hand, Some(joint), position);
        }
    }
    if let Some((joint, position)) = tree.head(arms) {
        add(BodyPart::Head, Some(joint), position);
    }
    Some(parts)
}

/// Joints and centres of a leg.
#[derive(Clone, Debug)]
struct LegChain {
    hip_joints: Vec<usize>,
    hip: Vector3<f64>,
    knee_joint: usize,
    knee: Vector3<f64>,
    foot_joint: usize,
    ankle: Vector3<f64>,
}

/// Joints and centres of an arm.
#[derive(Clone, Debug)]
struct ArmChain {
    shoulder_joints: Vec<usize>,
    shoulder: Vector3<f64>,
    elbow_joint: usize,
    elbow: Vector3<f64>,
    /// Joint that carries the hand, and its position.
    hand: Option<(usize, Vector3<f64>)>,
}

impl<'m> JointBranches<'m> {
    fn of(model: &'m Model) -> Option<Self> {
        let mut kinematics = ForwardKinematics::new(model);
        let placed = kinematics.place(&model.neutral()).ok()?.to_vec();
        let is_base = |id: JointId| {
            let free = model.free_joints().iter();
            free.into_iter()
                .any(|free| (free.index()..free.index() + 4).contains(&id.index()))
        };
        let moving = |id: &JointId| model.joints()[id.index()].kind.moves() && !is_base(*id);
        let ids: Vec<JointId> = model.joint_ids().filter(moving).collect();
        if ids
            .iter()
            .any(|id| model.joints()[id.index()].kind.is_ball())
        {
            return None;
        }
        let index_of = |id: JointId| ids.iter().position(|other| *other == id);
        let carriers: Vec<Option<usize>> = model
            .frame_ids()
            .map(|frame| moving_joint(model, frame).and_then(index_of))
            .collect();
        let mut axes: Vec<MovingAxis> = Vec::with_capacity(ids.len());
        for &id in &ids {
            let joint = &model.joints()[id.index()];
            let frame =
                (0..carriers.len()).find(|&frame| model.frames()[frame].joint == Some(id))?;
            // In the neutral configuration the axis is also that of the joint's own frame.
            let world_from_joint = placed[frame] * model.frames()[frame].joint_from_frame.inverse();
            let mut above =
                std::iter::successors(joint.parent, |id| model.joints()[id.index()].parent);
            let parent = above.find_map(index_of);
            let (lower, upper) = (joint.limits.lower.max(-10.0), joint.limits.upper.min(10.0));
            axes.push(MovingAxis {
                id,
                origin: world_from_joint.translation,
                direction: world_from_joint.rotation * joint.axis,
                slides: joint.kind.slides(),
                middle: 0.5 * (lower + upper),
                parent,
                children: Vec::new(),
            });
        }
        for k in 0..axes.len() {
            if let Some(parent) = axes[k].parent {
                axes[parent].children.push(k);
            }
        }
        let heights = || placed.iter().map(|frame| frame.translation.z);
        let height =
            heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        (height > 0.0).then_some(Self {
            model,
            placed,
            axes,
            carriers,
            height,
        })
    }

    /// Returns a joint and all joints beyond it.
    fn descendants(&self, root: usize) -> Vec<usize> {
        let mut found = vec![root];
        let mut next = 0;
        while next < found.len() {
            found.extend(&self.axes[found[next]].children);
            next += 1;
        }
        found
    }

    /// Returns the positions of the frames that a joint and those beyond it carry.
    fn carried(&self, root: usize) -> Vec<Vector3<f64>> {
        let joints = self.descendants(root);
        let frames = self.carriers.iter().zip(&self.placed);
        let carried =
            frames.filter(|(carrier, _)| carrier.is_some_and(|joint| joints.contains(&joint)));
        carried.map(|(_, placed)| placed.translation).collect()
    }

    fn lowest(&self, root: usize) -> f64 {
        let heights = self.carried(root).into_iter().map(|position| position.z);
        heights.fold(self.axes[root].origin.z, f64::min)
    }

    /// Returns the mean position of the joints of a branch.
    fn centroid(&self, root: usize) -> Vector3<f64> {
        let joints = self.descendants(root);
        let sum = joints
            .iter()
            .fold(Vector3::zero(), |sum, &joint| sum + self.axes[joint].origin);
        sum * (1.0 / joints.len() as f64)
    }

    /// Returns the mean position of all joints, which is on the plane of symmetry.
    fn centre_of_joints(&self) -> Vector3<f64> {
        let sum = self
            .axes
            .iter()
            .fold(Vector3::zero(), |sum, axis| sum + axis.origin);
        sum * (1.0 / self.axes.len() as f64)
    }

    /// Returns the largest distance of a carried frame from the first joint.
    fn extent(&self, root: usize) -> f64 {
        let origin = self.axes[root].origin;
        let distances = self
            .carried(root)
            .into_iter()
            .map(|position| (position - origin).norm());
        distances.fold(0.0, f64::max)
    }

    /// Returns the pairs of branches that are mirror images of each other, the outermost only.
    fn mirrored_pairs(&self) -> Vec<[usize; 2]> {
        let roots = (0..self.axes.len()).filter(|&joint| self.axes[joint].parent.is_none());
        let mut groups: Vec<Vec<usize>> = vec![roots.collect()];
        let mut pairs = Vec::new();
        while let Some(group) = groups.pop() {
            let mut unpaired = group.clone();
            for (k, &a) in group.iter().enumerate() {
                let is_partner = |b: &&usize| {
                    [a, **b].iter().all(|joint| unpaired.contains(joint))
                        && self.are_mirrored(a, **b)
                };
                let mirrored = group[k + 1..].iter().find(is_partner);
                if let Some(&b) = mirrored {
                    unpaired.retain(|joint| *joint != a && *joint != b);
                    pairs.push([a, b]);
                }
            }
            groups.extend(
                unpaired
                    .into_iter()
                    .map(|joint| self.axes[joint].children.clone()),
            );
        }
        pairs
    }

    fn are_mirrored(&self, a: usize, b: usize) -> bool {
        let tolerance = MIRROR_TOLERANCE * self.height;
        let [joints_a, joints_b] = [a, b].map(|root| self.descendants(root).len());
        let [a, b] = [self.centroid(a), self.centroid(b)];
        let apart = a - b;
        // Either horizontal axis may be the lateral one.
        let lateral = apart.x.abs().max(apart.y.abs());
        let other = apart.x.abs().min(apart.y.abs()).max(apart.z.abs());
        let middle = (a + b) * 0.5 - self.centre_of_joints();
        let off_plane = middle.dot(apart).abs() / lateral;
        other < tolerance
            && lateral > tolerance
            && off_plane < tolerance
            && joints_a.abs_diff(joints_b) <= 1
    }

    /// Returns the joints from a joint outward, up to the first branch into fingers or the last joint. `deepest` selects
    /// the branch that reaches lowest.
    fn chain(&self, root: usize, deepest: bool) -> Vec<usize> {
        let mut chain = vec![root];
        while let Some(&last) = chain.last() {
            let children: Vec<usize> = self.axes[last]
                .children
                .iter()
                .copied()
                .filter(|&child| !self.axes[child].slides)
                .collect();
            let next = match children.as_slice() {
                [] => None,
                [only] => Some(*only),
                several if deepest => several
                    .iter()
                    .copied()
                    .min_by(|&a, &b| self.lowest(a).total_cmp(&self.lowest(b))),
                several => several
                    .iter()
                    .copied()
                    .find(|&child| self.descendants(child).len() >= MIN_ARM_JOINTS + 2),
            };
            match next {
                Some(next) => chain.push(next),
                None => break,
            }
        }
        chain
    }

    /// Returns the point nearest to all axes.
    fn centre(&self, joints: &[usize]) -> Vector3<f64> {
        let mut matrix = Matrix3::zeros();
        let mut rhs = Column::zeros();
        let column = |v: Vector3<f64>| Column::new(v.x, v.y, v.z);
        for &joint in joints {
            let (origin, direction) = (
                column(self.axes[joint].origin),
                column(self.axes[joint].direction),
            );
            let across = Matrix3::identity() * (1.0 + CENTRE_REGULARISATION)
                - direction * direction.transpose();
            matrix += across;
            rhs += across * origin;
        }
        let solved = matrix.cholesky().map(|factor| factor.solve(&rhs));
        solved.map_or(Vector3::zero(), |point| {
            Vector3::new(point.x, point.y, point.z)
        })
    }

    /// Returns the point of an axis that is nearest to the segment between two points.
    fn on_axis_near(&self, joint: usize, from: Vector3<f64>, to: Vector3<f64>) -> Vector3<f64> {
        let axis = &self.axes[joint];
        let middle = (from + to) * 0.5;
        axis.origin + axis.direction * (middle - axis.origin).dot(axis.direction)
    }

    fn leg(&self, root: usize, ground: f64) -> Option<LegChain> {
        let joints = self.chain(root, true);
        let hip_height = self.axes[root].origin.z - ground;
        let height = |joint: usize| (self.axes[joint].origin.z - ground) / hip_height;
        let is_level = |joint: usize| self.axes[joint].direction.z.abs() < MAX_OFF_AXIS;
        let knee_index = (1..joints.len())
            .filter(|&k| {
                is_level(joints[k])
                    && (KNEE_HEIGHTS[0]..KNEE_HEIGHTS[1]).contains(&height(joints[k]))
            })
            .min_by(|&a, &b| {
                (height(joints[a]) - 0.5)
                    .abs()
                    .total_cmp(&(height(joints[b]) - 0.5).abs())
            })?;
        let beyond = &joints[knee_index + 1..];
        let first_ankle = *beyond
            .iter()
            .find(|&&joint| height(joint) < MAX_ANKLE_HEIGHT)?;
        let ankle_origin = self.axes[first_ankle].origin;
        let is_ankle = |joint: &&usize| {
            (self.axes[**joint].origin - ankle_origin).norm() < ANKLE_EXTENT * hip_height
        };
        let ankle_joints: Vec<usize> = beyond
            .iter()
            .skip_while(|joint| **joint != first_ankle)
            .take_while(is_ankle)
            .copied()
            .collect();
        // The hip's group ends where the thigh begins.
        let hip_joints = joints[..knee_index].to_vec();
        let (hip, ankle) = (self.centre(&hip_joints), self.centre(&ankle_joints));
        Some(LegChain {
            hip,
            knee_joint: joints[knee_index],
            knee: self.on_axis_near(joints[knee_index], hip, ankle),
            foot_joint: *ankle_joints.last()?,
            ankle,
            hip_joints,
        })
    }

    /// Returns the horizontal direction in which the robot looks: opposite to that in which the knee moves the foot.
    fn forward(&self, leg: &LegChain) -> Option<Vector3<f64>> {
        let knee = &self.axes[leg.knee_joint];
        let moved = knee.direction.cross(leg.ankle - leg.knee) * knee.middle.signum();
        let backward = Vector3::new(moved.x, moved.y, 0.0);
        let length = backward.norm();
        // Robots look along a horizontal axis of their root.
        let forward = backward * (-1.0 / length);
        let [x, y, _] = Vector3::UNITS;
        let axes = [x, y, -x, -y];
        let nearest = axes
            .into_iter()
            .max_by(|a, b| a.dot(forward).total_cmp(&b.dot(forward)));
        nearest.filter(|_| length > 0.0)
    }

    fn arm(&self, root: usize) -> Option<ArmChain> {
        let joints = self.chain(root, false);
        let last = *joints.last()?;
        let first = self.axes[root].origin;
        let tip = self.tip(&joints);
        // A tool at the end of an arm is no part of the forearm, unless the elbow is the last joint.
        let end = |k: usize| match joints[k] == last {
            true => tip,
            false => self.axes[last].origin,
        };
        let score = |k: usize| {
            let axis = &self.axes[joints[k]];
            let forearm = end(k) - axis.origin;
            let (upper, lower) = ((axis.origin - first).norm(), forearm.norm());
            let along = forearm.dot(axis.direction).abs();
            (along < MAX_OFF_AXIS * lower).then(|| upper.min(lower))
        };
        let (elbow_index, _) = (1..joints.len())
            .filter_map(|k| Some((k, score(k)?)))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        let shoulder_joints = joints[..elbow_index].to_vec();
        let shoulder = self.centre(&shoulder_joints);
        let elbow_joint = joints[elbow_index];
        let wrist_joints = &joints[elbow_index + 1..];
        let elbow = self.on_axis_near(elbow_joint, shoulder, tip);
        let upper_arm = (elbow - shoulder).norm();
        let is_forearm =
            |position: &Vector3<f64>| (*position - elbow).norm() > MIN_FOREARM * upper_arm;
        let bends = wrist_joints.iter().copied().filter(|&joint| {
            let axis = &self.axes[joint];
            (axis.origin - elbow).norm() > MIN_FOREARM * upper_arm
        });
        let bends: Vec<usize> = bends.collect();
        let wrist = (!bends.is_empty()).then(|| self.centre(&bends));
        let position = wrist.filter(is_forearm).or(Some(tip).filter(is_forearm));
        Some(ArmChain {
            shoulder_joints,
            shoulder,
            elbow_joint,
            elbow,
            hand: position.map(|position| (last, position)),
        })
    }

    /// Returns the end of an arm: the farthest frame of its last link, or its last joint.
    fn tip(&self, joints: &[usize]) -> Vector3<f64> {
        let (first, last) = (self.axes[joints[0]].origin, joints[joints.len() - 1]);
        let frames = self.carriers.iter().zip(&self.placed);
        let own = frames
            .filter(|(carrier, _)| **carrier == Some(last))
            .map(|(_, placed)| placed.translation);
        let farthest = own.max_by(|a, b| (*a - first).norm().total_cmp(&(*b - first).norm()));
        farthest.unwrap_or(self.axes[last].origin)
    }

    /// Returns the last joint of the neck and the centre of its axes.
    fn head(&self, arms: [usize; 2]) -> Option<(usize, Vector3<f64>)> {
        let torso = self.axes[arms[0]].parent;
        let siblings: Vec<usize> = (0..self.axes.len())
            .filter(|&joint| self.axes[joint].parent == torso)
            .collect();
        let shoulders = self.axes[arms[0]].origin.z;
        let necks = siblings.into_iter().filter(|joint| {
            !arms.contains(joint) && self.descendants(*joint).len() <= MAX_NECK_JOINTS
        });
        let neck = necks.filter(|&joint| {
            self.axes[joint].origin.z > shoulders - MIRROR_TOLERANCE * self.height
        });
        let root = neck.max_by(|&a, &b| self.axes[a].origin.z.total_cmp(&self.axes[b].origin.z))?;
        let joints = self.chain(root, false);
        Some((*joints.last()?, self.centre(&joints)))
    }

    /// Returns a drive of a point of the link that a joint carries.
    fn drive(&self, carrier: Option<usize>, position: Vector3<f64>) -> Option<Drive> {
        let frame = (0..self.carriers.len()).find(|&frame| match carrier {
            Some(joint) => self.model.frames()[frame].joint == Some(self.axes[joint].id),
            None => self.carriers[frame].is_none(),
        })?;
        let mut drive = Drive::new("", self.model.frames()[frame].name.clone());
        let offset = self.placed[frame].inverse().apply(position);
        let [x, y, z] = offset
            .to_array()
            .map(|length| (length / OFFSET_RESOLUTION).round() * OFFSET_RESOLUTION);
        drive.offset = Vector3::new(x + 0.0, y + 0.0, z + 0.0);
        Some(drive)
    }
}
