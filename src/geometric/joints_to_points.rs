//! Fit of joints to points: from the base outwards, each group of joints positions its points within limits.

use super::joint_points::{Group, JointPoints};
use super::turn::{BoundedVariable, Turn, move_joint, turned, two_turns};
use crate::kinematics::{JointAxis, TreeState};
use crate::problem::ProblemInstance;
use crate::scalar::elementary;
use crate::spatial::Vector3;

/// Largest number of sweeps over the joints of one group, if the closed form does not reach the points.
const CYCLES: usize = 4;

/// Error that counts as rounding, relative to the model's reach.
const ROUNDING: f64 = 1e-14;

/// Fit of a problem's joints to points.
pub(super) struct JointFit<'a> {
    question: ProblemInstance<'a>,
    joint_points: JointPoints,
    /// By point: the point about which its bone rotates.
    centres: Vec<Option<usize>>,
    /// By joint: true if no joint nearer to the base has the same variable.
    leads: Vec<bool>,
    /// Error that counts as rounding, metres.
    rounding: f64,
    state: TreeState<f64>,
}

impl<'a> JointFit<'a> {
    pub(super) fn new(question: ProblemInstance<'a>, joint_points: JointPoints) -> Self {
        let tree = question.tree();
        let linkage = joint_points.linkage();
        let points = 0..joint_points.points.len();
        let mut taken = vec![false; question.problem.variables()];
        let mut lead = |joint| {
            let (variable, _) = tree.variable_of(joint);
            !std::mem::replace(&mut taken[variable], true)
        };
        Self {
            question,
            centres: points.map(|point| linkage.parent(point)).collect(),
            leads: (0..tree.joints()).map(&mut lead).collect(),
            rounding: ROUNDING * question.problem.reach(),
            state: TreeState::new(tree),
            joint_points,
        }
    }

    /// Writes the positions of the points for the variables `x`.
    pub(super) fn points_at(&mut self, x: &[f64], points: &mut [Vector3<f64>]) {
        self.question.tree().forward(x, &mut self.state);
        for (k, point) in points.iter_mut().enumerate() {
            *point = self.point(k);
        }
    }

    /// Moves the variables so that the points approach `wanted`, from the base outwards.
    ///
    /// Points that no further joint moves are then set to their actual positions. If one is not at its target, `replan`
    /// may change the targets of the other points; it gets the `fixed` points.
    pub(super) fn follow(
        &mut self,
        wanted: &mut [Vector3<f64>],
        x: &mut [f64],
        mut replan: impl FnMut(&mut [Vector3<f64>], &[bool]),
    ) {
        let mut fixed: Vec<bool> = self.centres.iter().map(Option::is_none).collect();
        for index in 0..self.joint_points.groups.len() {
            let group = std::mem::take(&mut self.joint_points.groups[index]);
            let missed = self.serve(&group, wanted, x);
            let later = &self.joint_points.groups[index + 1..];
            for &point in &group.serves {
                if !later.iter().any(|other| other.serves.contains(&point)) {
                    wanted[point] = self.point(point);
                    fixed[point] = true;
                }
            }
            if missed > self.rounding {
                replan(wanted, &fixed);
            }
            self.joint_points.groups[index] = group;
        }
    }

    /// The joints that position one point, from the base outwards.
    pub(super) fn joints_for(&self, point: usize) -> &[usize] {
        let mut groups = self.joint_points.groups.iter();
        let group = groups.find(|group| group.serves == [point]);
        group.map_or(&[], |group| &group.joints)
    }

    /// The axis of a joint after the last forward pass.
    pub(super) fn axis(&self, joint: usize) -> JointAxis {
        self.question.tree().axis(&self.state, joint)
    }

    /// Rotates one joint until `point` is at `distance` from the point `root`, or as close to that as possible.
    ///
    /// The joint must not move `root`. `counter_clockwise` selects the side of the angle with the largest distance.
    pub(super) fn bend(
        &mut self,
        joint: usize,
        [root, point]: [usize; 2],
        (distance, counter_clockwise): (f64, bool),
        x: &mut [f64],
    ) {
        self.question.tree().forward(x, &mut self.state);
        let JointAxis {
            direction, origin, ..
        } = self.axis(joint);
        let (u, w) = (origin - self.point(root), self.point(point) - origin);
        // ‖u + R(φ) w‖² = ‖u‖² + ‖w‖² + 2 (u∥ w∥ + cosine cos φ + sine sin φ)
        let along = direction.dot(u) * direction.dot(w);
        let (cosine, sine) = (u.dot(w) - along, direction.dot(w.cross(u)));
        let squares = distance * distance - u.norm_squared() - w.norm_squared();
        let size = elementary::hypot(cosine, sine);
        if !self.leads[joint] || size <= self.rounding * self.rounding {
            return;
        }
        let apart = elementary::acos(((0.5 * squares - along) / size).clamp(-1.0, 1.0));
        let farthest = elementary::atan2(sine, cosine);
        let angle = match counter_clockwise {
            true => farthest + apart,
            false => farthest - apart,
        };
        move_joint(self.question, joint, x, |room| {
            Turn::towards(angle).best(room)
        });
    }

    /// Moves the points of one group towards `wanted` and returns their remaining error.
    pub(super) fn serve(&mut self, group: &Group, wanted: &[Vector3<f64>], x: &mut [f64]) -> f64 {
        self.question.tree().forward(x, &mut self.state);
        let mut missed = self.missed(group, wanted);
        if missed > self.rounding && self.point_with_two(group, wanted, x) {
            self.question.tree().forward(x, &mut self.state);
            missed = self.missed(group, wanted);
        }
        for _ in 0..CYCLES {
            if missed <= self.rounding {
                break;
            }
            self.turn_each(group, wanted, x);
            self.question.tree().forward(x, &mut self.state);
            let left = self.missed(group, wanted);
            let gained = left < 0.99 * missed;
            missed = left;
            if !gained {
                break;
            }
        }
        missed
    }

    fn point(&self, index: usize) -> Vector3<f64> {
        let point = &self.joint_points.points[index];
        match point.joint {
            Some(joint) => self
                .question
                .tree()
                .carried(&self.state, joint, point.local),
            None => point.local,
        }
    }

    /// The error of a group's points relative to the best positions that their bones allow.
    fn missed(&self, group: &Group, wanted: &[Vector3<f64>]) -> f64 {
        let miss = |&k: &usize| (self.aim(group, k, wanted) - self.point(k)).norm_squared();
        let squared = group.serves.iter().map(miss);
        squared.sum::<f64>().sqrt()
    }

    /// The best position of a point: from the actual centre of its bone towards its target, at the bone's length.
    fn aim(&self, group: &Group, point: usize, wanted: &[Vector3<f64>]) -> Vector3<f64> {
        let Some(centre) = self.centre(group, point) else {
            return wanted[point];
        };
        let way = wanted[point] - centre;
        let (length, distance) = ((self.point(point) - centre).norm(), way.norm());
        match distance > 0.0 {
            true => way.mul_add(length / distance, centre),
            false => self.point(point),
        }
    }

    /// The position of the point about which a group rotates `point`.
    fn centre(&self, group: &Group, point: usize) -> Option<Vector3<f64>> {
        let centre = group.about.or(self.centres[point]);
        centre.map(|centre| self.point(centre))
    }

    /// Points a bone in closed form by the last two joints of its group, if their axes meet in the bone's centre.
    ///
    /// Returns true if it moved them.
    fn point_with_two(&self, group: &Group, wanted: &[Vector3<f64>], x: &mut [f64]) -> bool {
        let ([point], [.., outer, inner]) = (&*group.serves, &*group.joints) else {
            return false;
        };
        let Some(centre) = self.centre(group, *point) else {
            return false;
        };
        let tree = self.question.tree();
        let [outer_axis, inner_axis] = [outer, inner].map(|&j| tree.axis(&self.state, j));
        let meets = |axis: &JointAxis| {
            axis.direction.cross(centre - axis.origin).norm() <= self.joint_points.same
        };
        let leads = self.leads[*outer] && self.leads[*inner];
        if !(leads && meets(&outer_axis) && meets(&inner_axis)) {
            return false;
        }
        let u = self.point(*point) - centre;
        let v = self.aim(group, *point, wanted) - centre;
        let Some(ways) = two_turns(outer_axis.direction, inner_axis.direction, u, v) else {
            return false;
        };
        let [(first, outer_variable), (second, inner_variable)] =
            [outer, inner].map(|&j| BoundedVariable::of(self.question, j));
        let mut best = ((u - v).norm(), None);
        for (by_outer, by_inner) in ways {
            let outer_turn = Turn::towards(by_outer).best(outer_variable.room(x[first]));
            let inner_turn = Turn::towards(by_inner).best(inner_variable.room(x[second]));
            let turn =
                turned(outer_axis.direction, outer_turn) * turned(inner_axis.direction, inner_turn);
            let left = (turn * u - v).norm();
            let effort = outer_turn.abs() + inner_turn.abs();
            let same = (left - best.0).abs() <= self.rounding;
            let less = best.1.is_some_and(|(_, _, most)| effort < most);
            if (same && less) || (!same && left < best.0) {
                best = (left, Some((outer_turn, inner_turn, effort)));
            }
        }
        let Some((outer_turn, inner_turn, _)) = best.1 else {
            return false;
        };
        x[first] = outer_variable.moved(x[first], outer_turn);
        x[second] = inner_variable.moved(x[second], inner_turn);
        true
    }

    /// One sweep of coordinate descent within a group, from its last joint to its first.
    ///
    /// In this order no axis moves before its joint does.
    fn turn_each(&self, group: &Group, wanted: &[Vector3<f64>], x: &mut [f64]) {
        let tree = self.question.tree();
        let points = group.serves.iter();
        let mut points: Vec<(Vector3<f64>, Vector3<f64>)> = points
            .map(|&k| (self.point(k), self.aim(group, k, wanted)))
            .collect();
        let joints = group.joints.iter().rev();
        for &joint in joints.filter(|&&joint| self.leads[joint]) {
            let axis = tree.axis(&self.state, joint);
            let mut turn = Turn::default();
            for &(at, to) in &points {
                turn.pull(axis.direction, at - axis.origin, to - axis.origin, 1.0);
            }
            let by = move_joint(self.question, joint, x, |room| turn.best(room));
            let turn = turned(axis.direction, by);
            for (at, _) in &mut points {
                *at = turn * (*at - axis.origin) + axis.origin;
            }
        }
    }
}
