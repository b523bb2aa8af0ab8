//! Construction of [`JointPoints`]: points for a problem's joints, and groups of joints that position them.

use super::goal::Goal;
use super::joint_points::{AttachedPoint, JointGroup, JointPoints};
use super::linkage::Pin;
use crate::problem::ProblemInstance;
use crate::search::SolveError;
use kinopt_kinematics::kinematics::TreeState;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Distance below which points coincide, relative to the model's reach.
const COINCIDENCE_TOLERANCE: f64 = 1e-9;

/// The points of a problem's joints and targets.
///
/// # Errors
/// Returns an error for a prismatic joint, or for a task without a position, by name.
pub(super) fn joint_points(
    instance: ProblemInstance<'_>,
    goals: &[Goal],
    solver: &'static str,
) -> Result<JointPoints, SolveError> {
    let tree = instance.tree();
    if let Some(joint) = (0..tree.joints()).find(|&joint| !tree.turns(joint)) {
        let (variable, _) = tree.variable_of(joint);
        return Err(SolveError::SlidingJoint {
            solver,
            joint: instance.problem.names().variables[variable].clone(),
        });
    }
    let mut layout = PointLayout::new(instance);
    let mut pins = Vec::new();
    for goal in goals {
        let Some(position) = goal.position else {
            let task = instance.problem.task_name(goal.task).unwrap_or_default();
            return Err(SolveError::UnsupportedTask {
                solver,
                task: task.to_owned(),
                valid: "`point` or `pose`",
            });
        };
        let offsets = std::iter::once((goal.offset, position.target));
        // Two more points represent the axes of a frame, at the distance that gives a radian its weight.
        let orientation = goal.orientation.into_iter().flat_map(|orientation| {
            let arm = (orientation.weight / position.weight).sqrt();
            let target = Placement::new(orientation.target, position.target);
            [[arm, 0.0, 0.0], [0.0, arm, 0.0]]
                .map(|local| (goal.offset + local.into(), target.apply(local.into())))
        });
        for (offset, target) in offsets.chain(orientation) {
            // Skip frames that no joint moves.
            pins.extend(layout.pin(goal, offset).map(|point| Pin { point, target }));
        }
    }
    Ok(layout.finish(&pins))
}

/// Points and joints during construction.
struct PointLayout<'a> {
    instance: ProblemInstance<'a>,
    state: TreeState<f64>,
    tolerance: f64,
    /// By joint: the point at its origin.
    point_of_joint: Vec<usize>,
    parents: Vec<Option<usize>>,
    positions: Vec<Vector3<f64>>,
    points: Vec<AttachedPoint>,
}

impl<'a> PointLayout<'a> {
    fn new(instance: ProblemInstance<'a>) -> Self {
        let tree = instance.tree();
        let mut near_zero = vec![0.0; instance.variables()];
        instance.space().project(&mut near_zero);
        let mut state = TreeState::new(tree);
        tree.forward(&near_zero, &mut state);
        let mut layout = Self {
            instance,
            state,
            tolerance: COINCIDENCE_TOLERANCE * instance.problem.reach(),
            point_of_joint: Vec::with_capacity(tree.joints()),
            parents: Vec::new(),
            positions: Vec::new(),
            points: Vec::new(),
        };
        for joint in 0..tree.joints() {
            let origin = tree.axis(&layout.state, joint).origin;
            let point = layout.point(tree.joint_above(joint), origin);
            layout.point_of_joint.push(point);
        }
        layout
    }

    /// The point of a joint at a position: its parent's point, an existing one, or a new one.
    fn point(&mut self, carrier: Option<usize>, position: Vector3<f64>) -> usize {
        let parent = carrier.map(|joint| self.point_of_joint[joint]);
        let coincides = |other: usize| (self.positions[other] - position).norm() <= self.tolerance;
        if let Some(parent_point) = parent.filter(|&parent_point| coincides(parent_point)) {
            return parent_point;
        }
        let siblings = (0..self.points.len()).filter(|&k| self.points[k].joint == carrier);
        if let Some(known) = siblings.into_iter().find(|&k| coincides(k)) {
            return known;
        }
        let local = match carrier {
            Some(joint) => self.instance.tree().local_to(&self.state, joint, position),
            None => position,
        };
        self.parents.push(parent);
        self.positions.push(position);
        self.points.push(AttachedPoint {
            joint: carrier,
            local,
        });
        self.points.len() - 1
    }

    /// The point of a target's frame at `offset`; `None` for a frame that no joint moves.
    fn pin(&mut self, goal: &Goal, offset: Vector3<f64>) -> Option<usize> {
        let carrier = self.instance.tree().joint_carrying(goal.frame)?;
        let position = self.state.frames()[goal.frame].apply(offset);
        Some(self.point(Some(carrier), position))
    }

    fn is_on_axis(&self, joint: usize, point: usize) -> bool {
        let axis = self.instance.tree().axis(&self.state, joint);
        let arm = self.positions[point] - axis.origin;
        axis.direction.cross(arm).norm() <= self.tolerance
    }

    /// Assigns points to each joint, from the tips to the root, and removes points about which no joint rotates.
    fn finish(mut self, pins: &[Pin]) -> JointPoints {
        let tree = self.instance.tree();
        let joints = tree.joints();
        let is_pinned = |point: usize| pins.iter().any(|pin| pin.point == point);
        // By joint: the first points beyond it; true if it moves none of them; the points it positions.
        let mut beyond: Vec<Vec<usize>> = vec![Vec::new(); joints];
        let mut moves_no_point = vec![false; joints];
        let mut positioned: Vec<Vec<usize>> = vec![Vec::new(); joints];
        let mut is_rotation_centre = vec![false; self.points.len()];
        for joint in (0..joints).rev() {
            let mut next = Vec::new();
            let mut positioned_beyond = Vec::new();
            let mut is_rigid = true;
            for point in (0..self.points.len()).filter(|&p| self.points[p].joint == Some(joint)) {
                let is_kept = is_rotation_centre[point] || is_pinned(point);
                if is_kept {
                    next.push(point);
                }
                for other in (joint + 1..joints).filter(|&k| self.point_of_joint[k] == point) {
                    let is_child = tree.joint_above(other) == Some(joint);
                    match (is_child, is_rotation_centre[point]) {
                        // No joint rotates about the point, so the joint also carries the points beyond it.
                        (true, false) => {
                            next.extend(&beyond[other]);
                            positioned_beyond.extend(&positioned[other]);
                        }
                        (true, true) if moves_no_point[other] => {
                            positioned_beyond.extend(&positioned[other])
                        }
                        (true, true) => positioned_beyond.extend(&beyond[other]),
                        (false, _) => {}
                    }
                }
            }
            for other in (joint + 1..joints).filter(|&k| tree.joint_above(k) == Some(joint)) {
                if self.point_of_joint[other] == self.point_of_joint[joint] {
                    is_rigid &= moves_no_point[other];
                    next.extend(&beyond[other]);
                    if moves_no_point[other] {
                        positioned_beyond.extend(&positioned[other]);
                    }
                }
            }
            for list in [&mut next, &mut positioned_beyond] {
                list.sort_unstable();
                list.dedup();
            }
            moves_no_point[joint] =
                is_rigid && next.iter().all(|&point| self.is_on_axis(joint, point));
            is_rotation_centre[self.point_of_joint[joint]] |= !moves_no_point[joint];
            positioned[joint] = if moves_no_point[joint] {
                positioned_beyond
            } else {
                next.clone()
            };
            beyond[joint] = next;
        }

        let points =
            (0..self.points.len()).map(|point| is_rotation_centre[point] || is_pinned(point));
        let is_kept: Vec<bool> = points.collect();
        let groups = group(&positioned, |joint| tree.joint_above(joint));
        self.compact(&is_kept, &is_rotation_centre, groups, pins)
    }

    /// Numbers the kept points.
    ///
    /// A point whose parent is removed is attached to the nearest kept ancestor; without one it is a root.
    fn compact(
        &mut self,
        is_kept: &[bool],
        is_rotation_centre: &[bool],
        mut groups: Vec<JointGroup>,
        pins: &[Pin],
    ) -> JointPoints {
        let mut new_index = vec![0; is_kept.len()];
        let mut kept_count = 0;
        for point in 0..is_kept.len() {
            new_index[point] = kept_count;
            kept_count += usize::from(is_kept[point]);
        }
        let parent_of = |point: usize| {
            let ancestors = std::iter::successors(self.parents[point], |&p| self.parents[p]);
            let mut ancestors = ancestors.filter(|&p| is_rotation_centre[p]);
            ancestors.next().map(|p| new_index[p])
        };
        let kept_points = (0..is_kept.len()).filter(|&point| is_kept[point]);
        let kept_points: Vec<usize> = kept_points.collect();
        for point in groups.iter_mut().flat_map(|group| &mut group.points) {
            *point = new_index[*point];
        }
        let pins = pins.iter().map(|pin| Pin {
            point: new_index[pin.point],
            ..*pin
        });
        JointPoints {
            points: kept_points
                .iter()
                .map(|&point| self.points[point])
                .collect(),
            groups,
            tolerance: self.tolerance,
            parents: kept_points.iter().map(|&point| parent_of(point)).collect(),
            rest: kept_points
                .iter()
                .map(|&point| self.positions[point])
                .collect(),
            pins: pins.collect(),
        }
    }
}

/// Groups successive joints that position the same points. Omits joints that position none.
fn group(
    positioned: &[Vec<usize>],
    parent_joint: impl Fn(usize) -> Option<usize>,
) -> Vec<JointGroup> {
    let mut groups: Vec<JointGroup> = Vec::new();
    for (joint, points) in positioned.iter().enumerate().filter(|(_, s)| !s.is_empty()) {
        let existing = groups.iter_mut().find(|group| {
            let last = group.joints.last().copied();
            group.points == *points && parent_joint(joint) == last
        });
        match existing {
            Some(group) => group.joints.push(joint),
            None => groups.push(JointGroup {
                joints: vec![joint],
                points: points.clone(),
                centre: None,
            }),
        }
    }
    groups
}
