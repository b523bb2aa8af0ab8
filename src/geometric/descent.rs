//! One search by cyclic coordinate descent: the motion of each joint in a sweep.

use super::goal::Goal;
use super::grouped::Grouped;
use super::sweeps::Sweep;
use super::turn::{Slide, Turn, move_joint, turned};
use crate::kinematics::{JointAxis, TreeState};
use crate::model::Limits;
use crate::problem::ProblemInstance;
use crate::spatial::{Placement, Vector3};

/// State of a search: the frames of the targets and the joints that move them.
pub(super) struct Descent<'a> {
    question: ProblemInstance<'a>,
    state: TreeState<f64>,
    goals: Vec<Goal>,
    /// The present placement of each target's frame.
    placed: Vec<Placement<f64>>,
    /// By joint: the targets whose frames it moves.
    moves: Grouped,
    /// By variable: the joints that it moves, if these move a target's frame.
    drives: Grouped,
}

impl<'a> Descent<'a> {
    pub(super) fn new(question: ProblemInstance<'a>, goals: Vec<Goal>) -> Self {
        let tree = question.tree();
        let mut moved = Vec::with_capacity(tree.joints());
        for (index, goal) in goals.iter().enumerate() {
            let first = tree.joint_carrying(goal.frame);
            let carrying = std::iter::successors(first, |&joint| tree.joint_above(joint));
            moved.extend(carrying.map(|joint| (joint, index)));
        }
        let moves = Grouped::new(tree.joints(), &moved);
        let moving = (0..tree.joints()).filter(|&joint| !moves.of(joint).is_empty());
        let driven: Vec<_> = moving
            .map(|joint| (tree.variable_of(joint).0, joint))
            .collect();
        let drives = Grouped::new(question.problem.variables(), &driven);
        Self {
            question,
            state: TreeState::new(tree),
            placed: vec![Placement::identity(); goals.len()],
            goals,
            moves,
            drives,
        }
    }

    fn forward(&mut self, x: &[f64]) {
        self.question.tree().forward(x, &mut self.state);
        let frames = self.state.frames();
        for (placed, goal) in self.placed.iter_mut().zip(&self.goals) {
            *placed = frames[goal.frame];
        }
    }

    /// The cost of all targets as a function of one rotating joint.
    fn turn(&self, joint: usize, axis: &JointAxis) -> Turn {
        let mut turn = Turn::default();
        for &index in self.moves.of(joint) {
            let (goal, frame) = (&self.goals[index], &self.placed[index]);
            if let Some(place) = goal.place {
                let (at, to) = (frame.apply(goal.offset), place.target);
                let weight = place.weight;
                turn.pull(axis.direction, at - axis.origin, to - axis.origin, weight);
            }
            if let Some(axes) = goal.axes {
                let (now, target) = (frame.rotation, axes.target);
                for (u, v) in [(now.x, target.x), (now.y, target.y), (now.z, target.z)] {
                    turn.pull(axis.direction, u, v, 0.5 * axes.weight);
                }
            }
        }
        turn
    }

    /// The cost of all targets as a function of one prismatic joint.
    fn slide(&self, joint: usize, axis: &JointAxis) -> Slide {
        let mut slide = Slide::default();
        for &index in self.moves.of(joint) {
            let (goal, frame) = (&self.goals[index], &self.placed[index]);
            if let Some(place) = goal.place {
                slide.pull(axis, place.target - frame.apply(goal.offset), place.weight);
            }
        }
        slide
    }

    /// Moves one joint to its best value, and the frames of the targets with it.
    ///
    /// The state of joints towards the tips is not updated, because this sweep does not use it again.
    fn move_joint(&mut self, joint: usize, x: &mut [f64]) {
        let axis = self.question.tree().axis(&self.state, joint);
        let by = move_joint(self.question, joint, x, |room| match axis.turns {
            true => self.turn(joint, &axis).best(room),
            false => self.slide(joint, &axis).best(room),
        });
        let carried = match axis.turns {
            true => {
                let turn = turned(axis.direction, by);
                Placement::new(turn, axis.origin - turn * axis.origin)
            }
            false => Placement::translation(axis.direction * by),
        };
        for &index in self.moves.of(joint) {
            self.placed[index] = carried * self.placed[index];
        }
    }

    /// The cost that the joint motions decrease.
    fn chord_cost(&self) -> f64 {
        let of = |(goal, frame): (&Goal, &Placement<f64>)| {
            let place = goal.place.map_or(0.0, |place| {
                place.weight * (frame.apply(goal.offset) - place.target).norm_squared()
            });
            let axes = goal.axes.map_or(0.0, |axes| {
                let (now, target) = (frame.rotation, axes.target);
                let chords = [now.x - target.x, now.y - target.y, now.z - target.z];
                let squared: f64 = chords.iter().map(|chord| chord.norm_squared()).sum();
                0.5 * axes.weight * squared
            });
            0.5 * (place + axes)
        };
        self.goals.iter().zip(&self.placed).map(of).sum()
    }

    /// Minus the derivative of the cost by a variable, and its Gauss-Newton curvature.
    ///
    /// Sums the velocities of the frames over all joints that the variable moves.
    fn slope(&self, variable: usize) -> (f64, f64) {
        let tree = self.question.tree();
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (index, goal) in self.goals.iter().enumerate() {
            let frame = &self.placed[index];
            let at = frame.apply(goal.offset);
            let (mut velocity, mut spin) = (Vector3::zero(), Vector3::zero());
            let moving = self.drives.of(variable).iter();
            for &joint in moving.filter(|&&joint| self.moves.of(joint).contains(&index)) {
                let axis = tree.axis(&self.state, joint);
                let share = axis.direction * tree.variable_of(joint).1;
                if axis.turns {
                    velocity += share.cross(at - axis.origin);
                    spin += share;
                } else {
                    velocity += share;
                }
            }
            if let Some(place) = goal.place {
                slope += place.weight * velocity.dot(place.target - at);
                curvature += place.weight * velocity.norm_squared();
            }
            if let Some(axes) = goal.axes {
                let (now, target) = (frame.rotation, axes.target);
                for (u, v) in [(now.x, target.x), (now.y, target.y), (now.z, target.z)] {
                    let velocity = spin.cross(u);
                    slope += 0.5 * axes.weight * velocity.dot(v - u);
                    curvature += 0.5 * axes.weight * velocity.norm_squared();
                }
            }
        }
        (slope, curvature)
    }

    /// A Gauss-Newton step along one variable, halved until it decreases the cost.
    fn move_shared(&mut self, variable: usize, x: &mut [f64]) {
        const HALVINGS: usize = 10;
        self.forward(x);
        let before = self.chord_cost();
        let (slope, curvature) = self.slope(variable);
        let (lower, upper) = (
            self.question.lower()[variable],
            self.question.upper()[variable],
        );
        let bounds = Limits::new(lower, upper);
        let from = x[variable];
        let mut step = if curvature > 0.0 {
            slope / curvature
        } else {
            0.0
        };
        for _ in 0..HALVINGS {
            x[variable] = bounds.clamp(from + step);
            self.forward(x);
            if self.chord_cost() < before {
                return;
            }
            step *= 0.5;
        }
        x[variable] = from;
    }
}

impl Sweep for Descent<'_> {
    fn sweep(&mut self, x: &mut [f64]) {
        for variable in 0..self.drives.groups() {
            if self.drives.of(variable).len() > 1 {
                self.move_shared(variable, x);
            }
        }
        self.forward(x);
        // Joints are numbered parents first, so this order is from the tips to the root.
        for joint in (0..self.moves.groups()).rev() {
            let (variable, _) = self.question.tree().variable_of(joint);
            if !self.moves.of(joint).is_empty() && self.drives.of(variable).len() == 1 {
                self.move_joint(joint, x);
            }
        }
    }
}
