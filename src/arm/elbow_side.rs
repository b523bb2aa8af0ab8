//! The side that an arm came from when it was stretched out.
//!
//! The nearest place to a target out of reach is singular: two ways of standing, an elbow's two sides, meet
//! there, and q tells no more which of them the arm came from. So the direction back is remembered: what leaves
//! the tool where it is (in first order) and bends away from the target (in second: r · ∂²r along it is
//! above 0). While the target is missed it is carried along, and each step begins a little to that side.

use nalgebra::Vector6;

use super::arm::Arm;
use super::workspace::ArmWorkspace;

/// Offset of a step's start to the side of a stretched arm, radians. It is constant: one that grows with the arm's motion
/// along the side feeds on itself, and the arm swings.
const LEANING: f64 = 2e-3;
/// Directions that move the tool by less than this share of the longest column count as leaving it: where the
/// arm bends away, and where it is stretched out.
const BLUNT: f64 = 0.05;
const SHARP: f64 = 0.01;
/// The share of a direction that must leave the tool where it is.
const LEAST_SHARE: f64 = 0.5;
/// How strongly it must bend away, as a share of the error times the longest column.
const LEAST_BEND: f64 = 0.02;
/// The way to a second difference, radians.
const PROBE: f64 = 1e-3;
/// Turns to where it bends at first, and later.
const ROUNDS: usize = 3;
/// How far a joint moves until a place is noted, radians.
const STRIDE: f64 = 0.1;

/// A direction of joints, radians each (a slide's by the metres that weigh as much), or none. Its length is 1
/// where the target is missed, and shrinks as the arm bends away.
#[derive(Clone, Debug)]
pub(super) struct Bend {
    way: Vec<f64>,
    known: bool,
    /// Where the arm was lately, and before: by a stride of one joint apart.
    lately: Vec<f64>,
    earlier: Vec<f64>,
}

impl Bend {
    pub(super) fn unknown(start: &[f64]) -> Self {
        Self {
            way: vec![0.0; start.len()],
            known: false,
            lately: start.to_vec(),
            earlier: start.to_vec(),
        }
    }

    pub(super) fn is_known(&self) -> bool {
        self.known
    }

    /// Begins anew where the arm has jumped to.
    pub(super) fn begin(&mut self, q: &[f64]) {
        self.known = false;
        self.lately.copy_from_slice(q);
        self.earlier.copy_from_slice(q);
    }

    /// Notes where the arm reached its target.
    pub(super) fn note(&mut self, arm: &Arm, q: &[f64]) {
        if arm.longest_move(&self.lately, q).1 > STRIDE {
            std::mem::swap(&mut self.earlier, &mut self.lately);
            self.lately.copy_from_slice(q);
        }
    }

    /// Takes the part along this side off a motion, radians.
    pub(super) fn take_from(&self, motion: &mut [f64]) {
        let along: f64 = motion.iter().zip(&self.way).map(|(a, b)| a * b).sum();
        for (by, way) in motion.iter_mut().zip(&self.way) {
            *by -= along * way;
        }
    }

    /// Moves the workspace's x a little to this side, within the bounds.
    pub(super) fn lean(&self, workspace: &mut ArmWorkspace) {
        if self.known {
            for (projected, way) in workspace.projected.iter_mut().zip(&self.way) {
                *projected = LEANING * way;
            }
            workspace.go_by_projected();
        }
    }

    /// Carries the side on to the workspace's x, or finds it there, from where the arm was before. A side
    /// is found where a target is missed, and lost where it does no more meet another.
    pub(super) fn carry_on(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        ease: &[f64],
        missed: bool,
    ) {
        if !(self.known || missed) {
            return;
        }
        let x = std::mem::take(&mut workspace.x);
        let residual = Vector6::from(workspace.linearise(&x));
        if !self.known {
            let before = match arm.has_freedom() {
                true => ease,
                false => &self.earlier,
            };
            for (i, way) in self.way.iter_mut().enumerate() {
                *way = (before[i] - x[i]) * arm.scale[i];
            }
            normalise(&mut self.way);
        }
        let carried = self.known;
        self.known = self.turn_into_null(workspace, &x, BLUNT);
        if self.known && missed {
            let rounds = if carried { 1 } else { ROUNDS };
            let mut bend = 0.0;
            for _ in 0..rounds {
                bend = self.turn_where_it_bends(workspace, &x, &residual);
            }
            self.known = carried || bend > LEAST_BEND;
            if arm.has_freedom() {
                self.turn_to(arm, &x, ease);
            }
        }
        workspace.x = x;
    }

    /// Turns to the side on which ease is: that of a redundant arm is where its freedom leads.
    fn turn_to(&mut self, arm: &Arm, x: &[f64], ease: &[f64]) {
        let ways = self.way.iter().zip(ease).zip(x).zip(&arm.scale);
        let along: f64 = ways
            .map(|(((way, ease), x), scale)| way * (ease - x) * scale)
            .sum();
        for way in &mut self.way {
            *way *= 1.0_f64.copysign(along);
        }
    }

    /// Keeps what of the way leaves the tool at x; whether that is most of it. The Jacobian at x is here. Of joints
    /// that limits hold back next to nothing is left: no free joint makes up for their slope.
    fn turn_into_null(&mut self, workspace: &mut ArmWorkspace, x: &[f64], blunt: f64) -> bool {
        let blunt = blunt * workspace.longest_column();
        workspace.project_to_null(x, &self.way, blunt);
        self.way.copy_from_slice(&workspace.projected);
        length(&self.way) > LEAST_SHARE
    }

    /// Turns the way, of those that leave the tool, to the one along which the error grows (a step of the power
    /// method on r · ∂²r), if there is one; how strongly it grows along the way that it was, as a share of the error
    /// times the longest column.
    fn turn_where_it_bends(
        &mut self,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        residual: &Vector6<f64>,
    ) -> f64 {
        let scale = residual.norm() * workspace.longest_column();
        let mut bend = std::mem::take(&mut workspace.wanted);
        let mut trial = std::mem::take(&mut workspace.trial);
        bend.fill(0.0);
        // That of x, which is needed again, stands by.
        std::mem::swap(&mut workspace.jacobian, &mut workspace.aside);
        for side in [PROBE, -PROBE] {
            for (i, trial) in trial.iter_mut().enumerate() {
                *trial = x[i] + side * self.way[i] / workspace.scale[i];
            }
            workspace.differentiate_beside(&trial);
            for (i, bend) in bend.iter_mut().enumerate() {
                *bend += workspace.column(i).dot(residual) / (2.0 * side);
            }
        }
        std::mem::swap(&mut workspace.jacobian, &mut workspace.aside);
        let along: f64 = self.way.iter().zip(&bend).map(|(a, b)| a * b).sum();
        let square = self.way.iter().map(|by| by * by).sum::<f64>();
        let bends = along / (square * scale);
        if bends > 0.0 {
            normalise(&mut bend);
            std::mem::swap(&mut self.way, &mut bend);
            self.turn_into_null(workspace, x, SHARP);
            normalise(&mut self.way);
        }
        workspace.wanted = bend;
        workspace.trial = trial;
        bends
    }
}

/// Makes a way of length 1; one without a length stays.
fn normalise(way: &mut [f64]) {
    let length = length(way);
    if length > 0.0 {
        for by in way {
            *by /= length;
        }
    }
}

fn length(way: &[f64]) -> f64 {
    way.iter().map(|by| by * by).sum::<f64>().sqrt()
}
