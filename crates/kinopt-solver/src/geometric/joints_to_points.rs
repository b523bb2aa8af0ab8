//! Fit of joints to points: from the base outwards, each group of joints positions its points within limits.

use super::joint_motion::{
    BoundedVariable, RotationCost, move_joint, rotation_matrix, two_rotations,
};
use super::joint_points::{JointGroup, JointPoints};
use crate::problem::ProblemInstance;
use kinopt_kinematics::kinematics::{JointAxis, TreeState};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;

/// Largest number of sweeps over the joints of one group, if the closed form does not reach the points.
const MAX_SWEEPS: usize = 4;

/// Error that counts as rounding, relative to the model's reach.
const RELATIVE_ROUNDING: f64 = 1e-14;

/// Fit of a problem's joints to points.
pub(super) struct JointFit<'a> {
    instance: ProblemInstance<'a>,
    joint_points: JointPoints,
    /// By point: the point about which its bone rotates.
    centres: Vec<Option<usize>>,
    /// By joint: true if no joint nearer to the base has the same variable.
    is_leading: Vec<bool>,
    /// Error that counts as rounding, metres.
    rounding: f64,
    state: TreeState<f64>,
}

impl<'a> JointFit<'a> {
    pub(super) fn new(instance: ProblemInstance<'a>, joint_points: JointPoints) -> Self {
        let tree = instance.tree();
        let linkage = joint_points.linkage();
        let points = 0..joint_points.points.len();
        let mut is_taken = vec![false; instance.problem.variables()];
        let mut is_first_joint = |joint| {
            let (variable, _) = tree.variable_of(joint);
            !std::mem::replace(&mut is_taken[variable], true)
        };
        Self {
            instance,
            centres: points.map(|point| linkage.parent(point)).collect(),
            is_leading: (0..tree.joints()).map(&mut is_first_joint).collect(),
            rounding: RELATIVE_ROUNDING * instance.problem.reach(),
            state: TreeState::new(tree),
            joint_points,
        }
    }

    /// Writes the positions of the points for the variables `x`.
    pub(super) fn points_at(&mut self, x: &[f64], points: &mut [Vector3<f64>]) {
        self.instance.tree().forward(x, &mut self.state);
        for (k, point) in points.iter_mut().enumerate() {
            *point = self.point(k);
        }
    }

    /// Moves the variables so that the points approach `targets`, from the base outwards.
    ///
    /// Points that no further joint moves are then set to their actual positions. If one is not at its target, `replan`
    /// may change the targets of the other points; it gets the `fixed` points.
    pub(super) fn move_to(
        &mut self,
        targets: &mut [Vector3<f64>],
        x: &mut [f64],
        mut replan: impl FnMut(&mut [Vector3<f64>], &[bool]),
    ) {
        let mut fixed: Vec<bool> = self.centres.iter().map(Option::is_none).collect();
        for index in 0..self.joint_points.groups.len() {
            let group = std::mem::take(&mut self.joint_points.groups[index]);
            let error = self.position_group(&group, targets, x);
            let later = &self.joint_points.groups[index + 1..];
            for &point in &group.points {
                if !later.iter().any(|other| other.points.contains(&point)) {
                    targets[point] = self.point(point);
                    fixed[point] = true;
                }
            }
            if error > self.rounding {
                replan(targets, &fixed);
            }
            self.joint_points.groups[index] = group;
        }
    }

    /// The joints that position one point, from the base outwards.
    pub(super) fn joints_for(&self, point: usize) -> &[usize] {
        let mut groups = self.joint_points.groups.iter();
        let group = groups.find(|group| group.points == [point]);
        group.map_or(&[], |group| &group.joints)
    }

    /// The axis of a joint after the last forward pass.
    pub(super) fn axis(&self, joint: usize) -> JointAxis {
        self.instance.tree().axis(&self.state, joint)
    }

    /// Rotates one joint until `point` is at `distance` from the point `root`, or as close to that as possible.
    ///
    /// The joint must not move `root`. `counter_clockwise` selects the side of the angle with the largest distance.
    pub(super) fn set_distance(
        &mut self,
        joint: usize,
        [root, point]: [usize; 2],
        (distance, counter_clockwise): (f64, bool),
        x: &mut [f64],
    ) {
        self.instance.tree().forward(x, &mut self.state);
        let JointAxis {
            direction, origin, ..
        } = self.axis(joint);
        let (u, w) = (origin - self.point(root), self.point(point) - origin);
        // ‖u + R(φ) w‖² = ‖u‖² + ‖w‖² + 2 (u∥ w∥ + cosine cos φ + sine sin φ)
        let axial = direction.dot(u) * direction.dot(w);
        let (cosine, sine) = (u.dot(w) - axial, direction.dot(w.cross(u)));
        let squared_excess = distance * distance - u.norm_squared() - w.norm_squared();
        let amplitude = elementary::hypot(cosine, sine);
        if !self.is_leading[joint] || amplitude <= self.rounding * self.rounding {
            return;
        }
        let half_angle =
            elementary::acos(((0.5 * squared_excess - axial) / amplitude).clamp(-1.0, 1.0));
        let farthest_angle = elementary::atan2(sine, cosine);
        let angle = match counter_clockwise {
            true => farthest_angle + half_angle,
            false => farthest_angle - half_angle,
        };
        move_joint(self.instance, joint, x, |range| {
            RotationCost::towards(angle).best(range)
        });
    }

    /// Moves the points of one group towards `targets` and returns their remaining error.
    pub(super) fn position_group(
        &mut self,
        group: &JointGroup,
        targets: &[Vector3<f64>],
        x: &mut [f64],
    ) -> f64 {
        self.instance.tree().forward(x, &mut self.state);
        let mut error = self.error_of(group, targets);
        if error > self.rounding && self.point_by_two_joints(group, targets, x) {
            self.instance.tree().forward(x, &mut self.state);
            error = self.error_of(group, targets);
        }
        for _ in 0..MAX_SWEEPS {
            if error <= self.rounding {
                break;
            }
            self.sweep_group(group, targets, x);
            self.instance.tree().forward(x, &mut self.state);
            let new_error = self.error_of(group, targets);
            let has_improved = new_error < 0.99 * error;
            error = new_error;
            if !has_improved {
                break;
            }
        }
        error
    }

    fn point(&self, index: usize) -> Vector3<f64> {
        let point = &self.joint_points.points[index];
        match point.joint {
            Some(joint) => self
                .instance
                .tree()
                .carried(&self.state, joint, point.local),
            None => point.local,
        }
    }

    /// The error of a group's points relative to the best positions that their bones allow.
    fn error_of(&self, group: &JointGroup, targets: &[Vector3<f64>]) -> f64 {
        let squared_error =
            |&k: &usize| (self.best_position(group, k, targets) - self.point(k)).norm_squared();
        let squared = group.points.iter().map(squared_error);
        squared.sum::<f64>().sqrt()
    }

    /// The best position of a point: from the actual centre of its bone towards its target, at the bone's length.
    fn best_position(
        &self,
        group: &JointGroup,
        point: usize,
        targets: &[Vector3<f64>],
    ) -> Vector3<f64> {
        let Some(centre) = self.centre(group, point) else {
            return targets[point];
        };
        let offset = targets[point] - centre;
        let (length, distance) = ((self.point(point) - centre).norm(), offset.norm());
        match distance > 0.0 {
            true => offset.mul_add(length / distance, centre),
            false => self.point(point),
        }
    }

    /// The position of the point about which a group rotates `point`.
    fn centre(&self, group: &JointGroup, point: usize) -> Option<Vector3<f64>> {
        let centre = group.centre.or(self.centres[point]);
        centre.map(|centre| self.point(centre))
    }

    /// Points a bone in closed form by the last two joints of its group, if their axes meet in the bone's centre.
    ///
    /// Returns true if it moved them.
    fn point_by_two_joints(
        &self,
        group: &JointGroup,
        targets: &[Vector3<f64>],
        x: &mut [f64],
    ) -> bool {
        let ([point], [.., outer, inner]) = (&*group.points, &*group.joints) else {
            return false;
        };
        let Some(centre) = self.centre(group, *point) else {
            return false;
        };
        let tree = self.instance.tree();
        let [outer_axis, inner_axis] = [outer, inner].map(|&j| tree.axis(&self.state, j));
        let passes_centre = |axis: &JointAxis| {
            axis.direction.cross(centre - axis.origin).norm() <= self.joint_points.tolerance
        };
        let are_leading = self.is_leading[*outer] && self.is_leading[*inner];
        if !(are_leading && passes_centre(&outer_axis) && passes_centre(&inner_axis)) {
            return false;
        }
        let u = self.point(*point) - centre;
        let v = self.best_position(group, *point, targets) - centre;
        let Some(angle_pairs) = two_rotations(outer_axis.direction, inner_axis.direction, u, v)
        else {
            return false;
        };
        let [(first, outer_variable), (second, inner_variable)] =
            [outer, inner].map(|&j| BoundedVariable::of(self.instance, j));
        let mut best = ((u - v).norm(), None);
        for (outer_angle, inner_angle) in angle_pairs {
            let outer_turn =
                RotationCost::towards(outer_angle).best(outer_variable.motion_range(x[first]));
            let inner_turn =
                RotationCost::towards(inner_angle).best(inner_variable.motion_range(x[second]));
            let rotation = rotation_matrix(outer_axis.direction, outer_turn)
                * rotation_matrix(inner_axis.direction, inner_turn);
            let error = (rotation * u - v).norm();
            let effort = outer_turn.abs() + inner_turn.abs();
            let is_equal = (error - best.0).abs() <= self.rounding;
            let has_less_effort = best
                .1
                .is_some_and(|(_, _, best_effort)| effort < best_effort);
            if (is_equal && has_less_effort) || (!is_equal && error < best.0) {
                best = (error, Some((outer_turn, inner_turn, effort)));
            }
        }
        let Some((outer_turn, inner_turn, _)) = best.1 else {
            return false;
        };
        x[first] = outer_variable.moved_by(x[first], outer_turn);
        x[second] = inner_variable.moved_by(x[second], inner_turn);
        true
    }

    /// One sweep of coordinate descent within a group, from its last joint to its first.
    ///
    /// In this order no axis moves before its joint does.
    fn sweep_group(&self, group: &JointGroup, targets: &[Vector3<f64>], x: &mut [f64]) {
        let tree = self.instance.tree();
        let points = group.points.iter();
        let mut points: Vec<(Vector3<f64>, Vector3<f64>)> = points
            .map(|&k| (self.point(k), self.best_position(group, k, targets)))
            .collect();
        let joints = group.joints.iter().rev();
        for &joint in joints.filter(|&&joint| self.is_leading[joint]) {
            let axis = tree.axis(&self.state, joint);
            let mut cost = RotationCost::default();
            for &(point, target) in &points {
                cost.add_target(
                    axis.direction,
                    point - axis.origin,
                    target - axis.origin,
                    1.0,
                );
            }
            let angle = move_joint(self.instance, joint, x, |range| cost.best(range));
            let rotation = rotation_matrix(axis.direction, angle);
            for (point, _) in &mut points {
                *point = rotation * (*point - axis.origin) + axis.origin;
            }
        }
    }
}
