//! Task of a foot: no ground penetration, and orientation in contact.

use super::sole::Sole;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, LocalJacobian, Quantity,
    Residual, RowBlock,
};

/// Weight of the tilt of a foot, in metres of position per radian.
const TILT_WEIGHT: f64 = 0.15;

/// Weight of the tilt of a locked foot, in metres of position per radian, relative to the largest weight of a point.
const LOCKED_TILT_WEIGHT: f64 = 1.5;
/// Weight of the tilt of a foot with locked orientation: that of its position times the length of a foot.
const LOCKED_ORIENTATION_WEIGHT: f64 = 30.0;

/// Residual r = w min(z − radius − height, 0) for each ball of a foot. Rows r = w ((R e)·z − tilt) for each level
/// direction follow.
///
/// A locked foot keeps its tilt at touchdown. Online it has no ground rows, because their discontinuous slope would
/// reject the few steps along a locked foot.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OverGround {
    sole: Sole,
    /// Weights of ground penetration per metre, of the tilt of a locked foot per radian, and of a locked orientation.
    weights: [f64; 3],
    footing: Footing,
    /// Raise of the ground under each ball, metres.
    raised: Vec<f64>,
}

/// Constraint of a foot.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Footing {
    /// Stays above the ground heights of its balls, metres. `levelling` scales the weight of the tilts of its level
    /// directions; none for level ground.
    Above {
        heights: Vec<f64>,
        tilts: Vec<f64>,
        levelling: f64,
    },
    /// Keeps the tilts of its level directions, and stays above the ground heights of its balls if there are any.
    /// `orientation_locked` selects the weight of a locked orientation.
    Locked {
        tilts: Vec<f64>,
        orientation_locked: bool,
        heights: Vec<f64>,
    },
}

impl Footing {
    /// Returns the ground heights of the balls.
    pub(super) fn heights_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Above { heights, .. } | Self::Locked { heights, .. } => heights,
        }
    }
}

impl OverGround {
    /// Creates the task. `max_weight` is the largest weight of a point.
    pub(super) fn new(sole: &Sole, penetration_weight: f64, max_weight: f64) -> Self {
        Self {
            footing: Footing::Above {
                heights: vec![0.0; sole.balls.len()],
                tilts: Vec::new(),
                levelling: 1.0,
            },
            raised: vec![0.0; sole.balls.len()],
            sole: sole.clone(),
            weights: [
                penetration_weight,
                LOCKED_TILT_WEIGHT,
                LOCKED_ORIENTATION_WEIGHT,
            ]
            .map(|weight| weight * max_weight),
        }
    }

    /// Sets the constraint of the foot.
    pub(super) fn set(&mut self, footing: &Footing) {
        self.footing.clone_from(footing);
        self.raised.fill(0.0);
    }

    /// Raises the ground under all balls by their penetration if one exceeds `max_penetration` metres. Returns whether
    /// one did.
    ///
    /// The ground is a soft penalty. Raising it, as an augmented Lagrangian method does (Nocedal & Wright 2006,
    /// "Numerical optimization", 17.4), brings the foot to rest on the actual ground.
    pub(super) fn raise_ground(&mut self, residual: &[f64], max_penetration: f64) -> bool {
        let Footing::Above { heights, .. } = &mut self.footing else {
            return false;
        };
        // The penalty force balances the raise. The rest of the displacement is penetration.
        let depth = residual.iter().map(|row| -row / self.weights[0]);
        let mut balls = depth.clone().zip(&self.raised);
        if !balls.any(|(depth, raised)| depth - raised > max_penetration) {
            return false;
        }
        for ((height, raised), depth) in heights.iter_mut().zip(&mut self.raised).zip(depth) {
            *height += depth - *raised;
            *raised = depth;
        }
        true
    }

    /// Returns the target slope of a direction and its weight per radian.
    fn tilt(&self, direction: usize) -> (f64, f64) {
        match &self.footing {
            Footing::Above {
                tilts, levelling, ..
            } => {
                let tilt = tilts.get(direction).copied().unwrap_or(0.0);
                (tilt, TILT_WEIGHT * levelling)
            }
            Footing::Locked {
                tilts,
                orientation_locked,
                ..
            } => (
                tilts[direction],
                self.weights[1 + usize::from(*orientation_locked)],
            ),
        }
    }

    fn heights(&self) -> &[f64] {
        match &self.footing {
            Footing::Above { heights, .. } | Footing::Locked { heights, .. } => heights,
        }
    }
}

impl Residual for OverGround {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.sole.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        let rows = self.sole.balls.len() + self.sole.level.len();
        vec![RowBlock::new(Quantity::Metres, rows)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let (ground_rows, level) = residual.split_at_mut(self.sole.balls.len());
        ground_rows.fill(S::zero());
        let balls = self.sole.balls.iter().zip(self.heights());
        for (row, ((ball, _), height)) in ground_rows.iter_mut().zip(balls) {
            let position = frames[0].apply(Vector3::constant(ball.at));
            let clearance = position.z - S::constant(ball.radius + height);
            *row = clearance.min(S::zero()) * S::constant(self.weights[0]);
        }
        for (k, (row, direction)) in level.iter_mut().zip(&self.sole.level).enumerate() {
            let (tilt, weight) = self.tilt(k);
            let direction = frames[0].rotation * Vector3::constant(*direction);
            *row = (direction.z - S::constant(tilt)) * S::constant(weight);
        }
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let up = Vector3::UNITS[2];
        let n = self.sole.balls.len();
        let foot = &frames[0];
        let level = &mut jacobian.angular_mut(0)[n..];
        for (k, (row, direction)) in level.iter_mut().zip(&self.sole.level).enumerate() {
            // Uses (ω × e)·z = ω · (e × z).
            *row = (foot.rotation * *direction).cross(up) * self.tilt(k).1;
        }
        let balls = self.sole.balls.iter().zip(self.heights()).enumerate();
        for (k, ((ball, _), height)) in balls {
            let lever = foot.rotation * ball.at;
            if lever.z + foot.translation.z - ball.radius < *height {
                jacobian.linear_mut(0)[k] = up * self.weights[0];
                jacobian.angular_mut(0)[k] = lever.cross(up) * self.weights[0];
            }
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("foot over the ground")
    }
}

impl InequalityResidual for OverGround {
    fn inequalities(&self) -> Vec<Inequality> {
        let balls = 0..self.sole.balls.len();
        balls
            .map(|ball| Inequality::new(ball..ball + 1, 1))
            .collect()
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], slacks: &mut [S]) {
        let balls = self.sole.balls.iter().zip(self.heights());
        for (slack, ((ball, _), height)) in slacks.iter_mut().zip(balls) {
            let position = frames[0].apply(Vector3::constant(ball.at));
            let clearance = position.z - S::constant(ball.radius + height);
            *slack = clearance * S::constant(self.weights[0]);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::OverGround;
    use crate::motion::contact::FootBall;
    use crate::motion::retarget::sole::Sole;
    use kinopt_kinematics::model::Model;
    use kinopt_kinematics::spatial::{Placement, Vector3};
    use kinopt_solver::task::Residual;

    /// A ball 5 mm deep is raised by 5 mm, and by 1 mm more while it is still 1 mm deep.
    #[test]
    fn ground_is_raised_by_penetration_depth() {
        let mut builder = Model::builder("foot");
        let frame = builder.frame("foot", None, Placement::identity());
        builder.build().unwrap();
        let (at, radius) = (Vector3::zero(), 0.02);
        let sole = Sole {
            frame,
            balls: vec![(FootBall { frame, at, radius }, 0)],
            level: Vec::new(),
            stance_balls: Vec::new(),
            stance_level: Vec::new(),
        };
        let mut task = OverGround::new(&sole, 3.0, 2.0);
        let mut raise = |height: f64| {
            let placed = Placement::translation(Vector3::new(0.0, 0.0, height));
            let mut residual = [0.0];
            task.evaluate(&[placed], &[], &mut residual);
            let is_raised = task.raise_ground(&residual, 2e-4);
            (is_raised, task.heights()[0])
        };
        for (height, expected) in [
            (0.015, (true, 0.005)),
            (0.019, (true, 0.006)),
            (0.0199, (false, 0.006)),
        ] {
            let (is_raised, raised) = raise(height);
            assert!(
                is_raised == expected.0 && (raised - expected.1).abs() < 1e-12,
                "{raised}"
            );
        }
    }
}
