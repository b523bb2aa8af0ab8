//! One search by cyclic coordinate descent: the motion of each joint in a sweep.

use super::goal::Goal;
use super::grouped::Grouped;
use super::joint_motion::{RotationCost, TranslationCost, move_joint, rotation_matrix};
use super::sweeps::Sweep;
use crate::problem::ProblemInstance;
use kinopt_kinematics::kinematics::{JointAxis, TreeState};
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// State of a search: the frames of the targets and the joints that move them.
pub(super) struct GeometricDescent<'a> {
    instance: ProblemInstance<'a>,
    state: TreeState<f64>,
    goals: Vec<Goal>,
    /// The present placement of each target's frame.
    frame_placements: Vec<Placement<f64>>,
    /// By joint: the targets whose frames it moves.
    goals_of_joint: Grouped,
    /// By variable: the joints that it moves, if these move a target's frame.
    joints_of_variable: Grouped,
}

impl<'a> GeometricDescent<'a> {
    pub(super) fn new(instance: ProblemInstance<'a>, goals: Vec<Goal>) -> Self {
        let tree = instance.tree();
        let mut joint_goal_pairs = Vec::with_capacity(tree.joints());
        for (index, goal) in goals.iter().enumerate() {
            let first = tree.joint_carrying(goal.frame);
            let carrying_joints = std::iter::successors(first, |&joint| tree.joint_above(joint));
            joint_goal_pairs.extend(carrying_joints.map(|joint| (joint, index)));
        }
        let goals_of_joint = Grouped::new(tree.joints(), &joint_goal_pairs);
        let moving_joints =
            (0..tree.joints()).filter(|&joint| !goals_of_joint.of(joint).is_empty());
        let variable_joint_pairs: Vec<_> = moving_joints
            .map(|joint| (tree.variable_of(joint).0, joint))
            .collect();
        let joints_of_variable = Grouped::new(instance.problem.variables(), &variable_joint_pairs);
        Self {
            instance,
            state: TreeState::new(tree),
            frame_placements: vec![Placement::identity(); goals.len()],
            goals,
            goals_of_joint,
            joints_of_variable,
        }
    }

    fn forward(&mut self, x: &[f64]) {
        self.instance.tree().forward(x, &mut self.state);
        let frames = self.state.frames();
        for (frame_placement, goal) in self.frame_placements.iter_mut().zip(&self.goals) {
            *frame_placement = frames[goal.frame];
        }
    }

    /// The cost of all targets as a function of one rotating joint.
    #[inline]
    fn rotation_cost(&self, joint: usize, axis: &JointAxis) -> RotationCost {
        let mut cost = RotationCost::default();
        for &index in self.goals_of_joint.of(joint) {
            let (goal, frame) = (&self.goals[index], &self.frame_placements[index]);
            if let Some(position) = goal.position {
                let (point, target_point) = (frame.apply(goal.offset), position.target);
                let weight = position.weight;
                cost.add_target(
                    axis.direction,
                    point - axis.origin,
                    target_point - axis.origin,
                    weight,
                );
            }
            if let Some(orientation) = goal.orientation {
                let (rotation, target) = (frame.rotation, orientation.target);
                for (u, v) in [
                    (rotation.x, target.x),
                    (rotation.y, target.y),
                    (rotation.z, target.z),
                ] {
                    cost.add_target(axis.direction, u, v, 0.5 * orientation.weight);
                }
            }
        }
        cost
    }

    /// The cost of all targets as a function of one prismatic joint.
    fn translation_cost(&self, joint: usize, axis: &JointAxis) -> TranslationCost {
        let mut cost = TranslationCost::default();
        for &index in self.goals_of_joint.of(joint) {
            let (goal, frame) = (&self.goals[index], &self.frame_placements[index]);
            if let Some(position) = goal.position {
                cost.add_target(
                    axis,
                    position.target - frame.apply(goal.offset),
                    position.weight,
                );
            }
        }
        cost
    }

    /// Moves one joint to its best value, and the frames of the targets with it.
    ///
    /// The state of joints towards the tips is not updated, because this sweep does not use it again.
    fn move_joint(&mut self, joint: usize, x: &mut [f64]) {
        let axis = self.instance.tree().axis(&self.state, joint);
        let motion = move_joint(self.instance, joint, x, |range| match axis.turns {
            true => self.rotation_cost(joint, &axis).best(range),
            false => self.translation_cost(joint, &axis).best(range),
        });
        let transform = match axis.turns {
            true => {
                let rotation = rotation_matrix(axis.direction, motion);
                Placement::new(rotation, axis.origin - rotation * axis.origin)
            }
            false => Placement::translation(axis.direction * motion),
        };
        for &index in self.goals_of_joint.of(joint) {
            self.frame_placements[index] = transform * self.frame_placements[index];
        }
    }

    /// The cost that the joint motions decrease.
    fn chord_cost(&self) -> f64 {
        let goal_cost = |(goal, frame): (&Goal, &Placement<f64>)| {
            let position = goal.position.map_or(0.0, |position| {
                position.weight * (frame.apply(goal.offset) - position.target).norm_squared()
            });
            let orientation = goal.orientation.map_or(0.0, |orientation| {
                let (rotation, target) = (frame.rotation, orientation.target);
                let chords = [
                    rotation.x - target.x,
                    rotation.y - target.y,
                    rotation.z - target.z,
                ];
                let squared: f64 = chords.iter().map(|chord| chord.norm_squared()).sum();
                0.5 * orientation.weight * squared
            });
            0.5 * (position + orientation)
        };
        self.goals
            .iter()
            .zip(&self.frame_placements)
            .map(goal_cost)
            .sum()
    }

    /// Minus the derivative of the cost by a variable, and its Gauss-Newton curvature.
    ///
    /// Sums the velocities of the frames over all joints that the variable moves.
    fn slope(&self, variable: usize) -> (f64, f64) {
        let tree = self.instance.tree();
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (index, goal) in self.goals.iter().enumerate() {
            let frame = &self.frame_placements[index];
            let point = frame.apply(goal.offset);
            let (mut velocity, mut angular_velocity) = (Vector3::zero(), Vector3::zero());
            let moving = self.joints_of_variable.of(variable).iter();
            for &joint in moving.filter(|&&joint| self.goals_of_joint.of(joint).contains(&index)) {
                let axis = tree.axis(&self.state, joint);
                let unit_motion = axis.direction * tree.variable_of(joint).1;
                if axis.turns {
                    velocity += unit_motion.cross(point - axis.origin);
                    angular_velocity += unit_motion;
                } else {
                    velocity += unit_motion;
                }
            }
            if let Some(position) = goal.position {
                slope += position.weight * velocity.dot(position.target - point);
                curvature += position.weight * velocity.norm_squared();
            }
            if let Some(orientation) = goal.orientation {
                let (rotation, target) = (frame.rotation, orientation.target);
                for (u, v) in [
                    (rotation.x, target.x),
                    (rotation.y, target.y),
                    (rotation.z, target.z),
                ] {
                    let velocity = angular_velocity.cross(u);
                    slope += 0.5 * orientation.weight * velocity.dot(v - u);
                    curvature += 0.5 * orientation.weight * velocity.norm_squared();
                }
            }
        }
        (slope, curvature)
    }

    /// A Gauss-Newton step along one variable, halved until it decreases the cost.
    fn move_coupled_variable(&mut self, variable: usize, x: &mut [f64]) {
        const HALVINGS: usize = 10;
        self.forward(x);
        let start_cost = self.chord_cost();
        let (slope, curvature) = self.slope(variable);
        let (lower, upper) = (
            self.instance.lower()[variable],
            self.instance.upper()[variable],
        );
        let bounds = Limits::new(lower, upper);
        let start_value = x[variable];
        let mut step = if curvature > 0.0 {
            slope / curvature
        } else {
            0.0
        };
        for _ in 0..HALVINGS {
            x[variable] = bounds.clamp(start_value + step);
            self.forward(x);
            if self.chord_cost() < start_cost {
                return;
            }
            step *= 0.5;
        }
        x[variable] = start_value;
    }
}

impl Sweep for GeometricDescent<'_> {
    #[doc(hidden)]
    fn sweep(&mut self, x: &mut [f64]) {
        for variable in 0..self.joints_of_variable.groups() {
            if self.joints_of_variable.of(variable).len() > 1 {
                self.move_coupled_variable(variable, x);
            }
        }
        self.forward(x);
        // Joints are numbered parents first, so this order is from the tips to the root.
        for joint in (0..self.goals_of_joint.groups()).rev() {
            let (variable, _) = self.instance.tree().variable_of(joint);
            if !self.goals_of_joint.of(joint).is_empty()
                && self.joints_of_variable.of(variable).len() == 1
            {
                self.move_joint(joint, x);
            }
        }
    }
}
