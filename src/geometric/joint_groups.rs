//! Construction of [`JointPoints`]: points for a problem's joints, and groups of joints that position them.

use super::GeometricError;
use super::goal::Goal;
use super::joint_points::{Carried, Group, JointPoints};
use super::linkage::Pin;
use crate::kinematics::TreeState;
use crate::problem::ProblemInstance;
use crate::spatial::{Placement, Vector3};

/// Distance below which points coincide, relative to the model's reach.
const SAME: f64 = 1e-9;

/// The points of a problem's joints and targets.
///
/// # Errors
/// Returns an error for a prismatic joint, or for a task without a position, by name.
pub(super) fn joint_points(
    question: ProblemInstance<'_>,
    goals: &[Goal],
    solver: &'static str,
) -> Result<JointPoints, GeometricError> {
    let tree = question.tree();
    if let Some(joint) = (0..tree.joints()).find(|&joint| !tree.turns(joint)) {
        let (variable, _) = tree.variable_of(joint);
        return Err(GeometricError::SlidingJoint {
            solver,
            joint: question.problem.names().variables[variable].clone(),
        });
    }
    let mut layout = PointLayout::new(question);
    let mut pins = Vec::new();
    for goal in goals {
        let Some(place) = goal.place else {
            let task = question.problem.task_name(goal.task).unwrap_or_default();
            return Err(GeometricError::UnsupportedTask {
                solver,
                task: task.to_owned(),
                valid: "`point` or `pose`",
            });
        };
        let offsets = std::iter::once((goal.offset, place.target));
        // Two more points represent the axes of a frame, at the distance that gives a radian its weight.
        let axes = goal.axes.into_iter().flat_map(|axes| {
            let arm = (axes.weight / place.weight).sqrt();
            let target = Placement::new(axes.target, place.target);
            [[arm, 0.0, 0.0], [0.0, arm, 0.0]]
                .map(|local| (goal.offset + local.into(), target.apply(local.into())))
        });
        for (offset, target) in offsets.chain(axes) {
            // Skip frames that no joint moves.
            pins.extend(layout.pin(goal, offset).map(|point| Pin { point, target }));
        }
    }
    Ok(layout.finish(&pins))
}

/// Points and joints during construction.
struct PointLayout<'a> {
    question: ProblemInstance<'a>,
    state: TreeState<f64>,
    same: f64,
    /// By joint: the point at its origin.
    at: Vec<usize>,
    parents: Vec<Option<usize>>,
    places: Vec<Vector3<f64>>,
    points: Vec<Carried>,
}

impl<'a> PointLayout<'a> {
    fn new(question: ProblemInstance<'a>) -> Self {
        let tree = question.tree();
        let mut near_zero = vec![0.0; question.variables()];
        question.space().project(&mut near_zero);
        let mut state = TreeState::new(tree);
        tree.forward(&near_zero, &mut state);
        let mut layout = Self {
            question,
            state,
            same: SAME * question.problem.reach(),
            at: Vec::with_capacity(tree.joints()),
            parents: Vec::new(),
            places: Vec::new(),
            points: Vec::new(),
        };
        for joint in 0..tree.joints() {
            let origin = tree.axis(&layout.state, joint).origin;
            let point = layout.point(tree.joint_above(joint), origin);
            layout.at.push(point);
        }
        layout
    }

    /// The point of a joint at a position: its parent's point, an existing one, or a new one.
    fn point(&mut self, carrier: Option<usize>, place: Vector3<f64>) -> usize {
        let parent = carrier.map(|joint| self.at[joint]);
        let is_here = |other: usize| (self.places[other] - place).norm() <= self.same;
        if let Some(own) = parent.filter(|&own| is_here(own)) {
            return own;
        }
        let siblings = (0..self.points.len()).filter(|&k| self.points[k].joint == carrier);
        if let Some(known) = siblings.into_iter().find(|&k| is_here(k)) {
            return known;
        }
        let local = match carrier {
            Some(joint) => self.question.tree().local_to(&self.state, joint, place),
            None => place,
        };
        self.parents.push(parent);
        self.places.push(place);
        self.points.push(Carried {
            joint: carrier,
            local,
        });
        self.points.len() - 1
    }

    /// The point of a target's frame at `offset`; `None` for a frame that no joint moves.
    fn pin(&mut self, goal: &Goal, offset: Vector3<f64>) -> Option<usize> {
        let carrier = self.question.tree().joint_carrying(goal.frame)?;
        let place = self.state.frames()[goal.frame].apply(offset);
        Some(self.point(Some(carrier), place))
    }

    fn is_on_axis(&self, joint: usize, point: usize) -> bool {
        let axis = self.question.tree().axis(&self.state, joint);
        let arm = self.places[point] - axis.origin;
        axis.direction.cross(arm).norm() <= self.same
    }

    /// Assigns points to each joint, from the tips to the root, and removes points about which no joint rotates.
    fn finish(mut self, pins: &[Pin]) -> JointPoints {
        let tree = self.question.tree();
        let joints = tree.joints();
        let is_pinned = |point: usize| pins.iter().any(|pin| pin.point == point);
        // By joint: the first points beyond it; true if it moves none of them; the points it positions.
        let mut beyond: Vec<Vec<usize>> = vec![Vec::new(); joints];
        let mut defers = vec![false; joints];
        let mut serves: Vec<Vec<usize>> = vec![Vec::new(); joints];
        let mut turns_here = vec![false; self.points.len()];
        for joint in (0..joints).rev() {
            let mut next = Vec::new();
            let mut further = Vec::new();
            let mut rigid = true;
            for point in (0..self.points.len()).filter(|&p| self.points[p].joint == Some(joint)) {
                let stands = turns_here[point] || is_pinned(point);
                if stands {
                    next.push(point);
                }
                for other in (joint + 1..joints).filter(|&k| self.at[k] == point) {
                    let enters = tree.joint_above(other) == Some(joint);
                    match (enters, turns_here[point]) {
                        // No joint rotates about the point, so the joint also carries the points beyond it.
                        (true, false) => {
                            next.extend(&beyond[other]);
                            further.extend(&serves[other]);
                        }
                        (true, true) if defers[other] => further.extend(&serves[other]),
                        (true, true) => further.extend(&beyond[other]),
                        (false, _) => {}
                    }
                }
            }
            for other in (joint + 1..joints).filter(|&k| tree.joint_above(k) == Some(joint)) {
                if self.at[other] == self.at[joint] {
                    rigid &= defers[other];
                    next.extend(&beyond[other]);
                    if defers[other] {
                        further.extend(&serves[other]);
                    }
                }
            }
            for list in [&mut next, &mut further] {
                list.sort_unstable();
                list.dedup();
            }
            defers[joint] = rigid && next.iter().all(|&point| self.is_on_axis(joint, point));
            turns_here[self.at[joint]] |= !defers[joint];
            serves[joint] = if defers[joint] { further } else { next.clone() };
            beyond[joint] = next;
        }

        let points = (0..self.points.len()).map(|point| turns_here[point] || is_pinned(point));
        let keep: Vec<bool> = points.collect();
        let groups = group(&serves, |joint| tree.joint_above(joint));
        self.compact(&keep, &turns_here, groups, pins)
    }

    /// Numbers the kept points.
    ///
    /// A point whose parent is removed is attached to the nearest kept ancestor; without one it is a root.
    fn compact(
        &mut self,
        keep: &[bool],
        turns_here: &[bool],
        mut groups: Vec<Group>,
        pins: &[Pin],
    ) -> JointPoints {
        let mut number = vec![0; keep.len()];
        let mut kept = 0;
        for point in 0..keep.len() {
            number[point] = kept;
            kept += usize::from(keep[point]);
        }
        let parent_of = |point: usize| {
            let above = std::iter::successors(self.parents[point], |&p| self.parents[p]);
            let mut above = above.filter(|&p| turns_here[p]);
            above.next().map(|p| number[p])
        };
        let kept = (0..keep.len()).filter(|&point| keep[point]);
        let kept: Vec<usize> = kept.collect();
        for point in groups.iter_mut().flat_map(|group| &mut group.serves) {
            *point = number[*point];
        }
        let pins = pins.iter().map(|pin| Pin {
            point: number[pin.point],
            ..*pin
        });
        JointPoints {
            points: kept.iter().map(|&point| self.points[point]).collect(),
            groups,
            same: self.same,
            parents: kept.iter().map(|&point| parent_of(point)).collect(),
            rest: kept.iter().map(|&point| self.places[point]).collect(),
            pins: pins.collect(),
        }
    }
}

/// Groups successive joints that position the same points. Omits joints that position none.
fn group(serves: &[Vec<usize>], above: impl Fn(usize) -> Option<usize>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (joint, points) in serves.iter().enumerate().filter(|(_, s)| !s.is_empty()) {
        let continued = groups.iter_mut().find(|group| {
            let last = group.joints.last().copied();
            group.serves == *points && above(joint) == last
        });
        match continued {
            Some(group) => group.joints.push(joint),
            None => groups.push(Group {
                joints: vec![joint],
                serves: points.clone(),
                about: None,
            }),
        }
    }
    groups
}
