//! A foot that stays over the ground, and stands flat on it.

use super::sole::Sole;
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::spatial::{Placement, Vector3};
use crate::task::{LocalJacobian, Quantity, Residual, Room, Rows};

/// What a radian costs that a foot is tilted off level, in metres off a place.
const TILTED: f64 = 0.15;

/// What a radian costs that a foot which is held is turned, in metres off a place, for the most that any place counts …
const TURNED: f64 = 1.5;
/// … and one that is held firmly: by the lever of a foot as much as its place does.
const TURNED_FIRMLY: f64 = 30.0;

/// r = w min(z − radius − height, 0) for each ball of a sole, then r = w ((R e)·z − tilt) for each direction that is to be level.
///
/// A foot that is held stays as tilted as it came down. Frame by frame it stays over nothing: what is above an edge is worth
/// nothing and what is below it much, so that the few steps along a held foot would be refused.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OverGround {
    sole: Sole,
    /// What a metre below the ground costs, and what a radian that a held foot is turned, if it is held firmly too.
    weights: [f64; 3],
    footing: Footing,
    /// By how much what each ball stays over is raised, metres.
    raised: Vec<f64>,
}

/// What a foot does on the ground.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Footing {
    /// It stays over heights, ball by ball, and is to be level, which counts so many times as much as in the air.
    Over { heights: Vec<f64>, levelling: f64 },
    /// It stays as tilted as it is, direction by direction; firmly, where it would go into the ground else; and over heights, if
    /// there are any.
    Held {
        tilts: Vec<f64>,
        firmly: bool,
        heights: Vec<f64>,
    },
}

impl Footing {
    /// What each ball is kept over, if it is over anything.
    pub(super) fn heights_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Over { heights, .. } | Self::Held { heights, .. } => heights,
        }
    }
}

impl OverGround {
    /// `heaviest`: the most that any place counts.
    pub(super) fn new(sole: &Sole, over: f64, heaviest: f64) -> Self {
        Self {
            footing: Footing::Over {
                heights: vec![0.0; sole.balls.len()],
                levelling: 1.0,
            },
            raised: vec![0.0; sole.balls.len()],
            sole: sole.clone(),
            weights: [over, TURNED, TURNED_FIRMLY].map(|weight| weight * heaviest),
        }
    }

    /// Says what the foot does.
    pub(super) fn set(&mut self, footing: &Footing) {
        self.footing.clone_from(footing);
        self.raised.fill(0.0);
    }

    /// Where a ball is deeper than so many metres by the residual, raises what each stays over by as much as it is deep: the
    /// spring that the ground is comes to rest on it, however it is pressed, as by an augmented Lagrangian (Nocedal & Wright 2006,
    /// "Numerical optimization", 17.4). Whether any was.
    pub(super) fn push_out(&mut self, residual: &[f64], deeper: f64) -> bool {
        let Footing::Over { heights, .. } = &mut self.footing else {
            return false;
        };
        // As far as the spring is pressed what it pushes against is raised; the rest of it is depth.
        let pressed = residual.iter().map(|row| -row / self.weights[0]);
        let mut balls = pressed.clone().zip(&self.raised);
        if !balls.any(|(pressed, raised)| pressed - raised > deeper) {
            return false;
        }
        for ((height, raised), pressed) in heights.iter_mut().zip(&mut self.raised).zip(pressed) {
            *height += pressed - *raised;
            *raised = pressed;
        }
        true
    }

    /// What each direction's slope should be, and what a radian off it costs.
    fn tilt(&self, direction: usize) -> (f64, f64) {
        match &self.footing {
            Footing::Over { levelling, .. } => (0.0, TILTED * levelling),
            Footing::Held { tilts, firmly, .. } => {
                (tilts[direction], self.weights[1 + usize::from(*firmly)])
            }
        }
    }

    fn heights(&self) -> &[f64] {
        match &self.footing {
            Footing::Over { heights, .. } | Footing::Held { heights, .. } => heights,
        }
    }
}

impl Residual for OverGround {
    answers! {
        fn kind(&self) -> &'static str = "foot over the ground";
        fn frames(&self) -> Vec<FrameId> = vec![self.sole.frame];
    }

    fn rows(&self) -> Vec<Rows> {
        let rows = self.sole.balls.len() + self.sole.level.len();
        vec![Rows::new(Quantity::Metres, rows)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let (over, level) = residual.split_at_mut(self.sole.balls.len());
        over.fill(S::zero());
        let balls = self.sole.balls.iter().zip(self.heights());
        for (row, ((ball, _), height)) in over.iter_mut().zip(balls) {
            let at = frames[0].apply(Vector3::constant(ball.at));
            let over = at.z - S::constant(ball.radius + height);
            *row = over.min(S::zero()) * S::constant(self.weights[0]);
        }
        for (k, (row, way)) in level.iter_mut().zip(&self.sole.level).enumerate() {
            let (tilt, weight) = self.tilt(k);
            let way = frames[0].rotation * Vector3::constant(*way);
            *row = (way.z - S::constant(tilt)) * S::constant(weight);
        }
    }

    fn rooms(&self) -> Vec<Room> {
        let balls = 0..self.sole.balls.len();
        balls.map(|ball| Room::new(ball..ball + 1, 1)).collect()
    }

    fn depths<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], depths: &mut [S]) {
        let balls = self.sole.balls.iter().zip(self.heights());
        for (depth, ((ball, _), height)) in depths.iter_mut().zip(balls) {
            let at = frames[0].apply(Vector3::constant(ball.at));
            let over = at.z - S::constant(ball.radius + height);
            *depth = over * S::constant(self.weights[0]);
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
        for (k, (row, way)) in level.iter_mut().zip(&self.sole.level).enumerate() {
            // (ω × e)·z = ω · (e × z)
            *row = (foot.rotation * *way).cross(up) * self.tilt(k).1;
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
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::OverGround;
    use crate::model::Model;
    use crate::motion::retarget::foot_shapes::Ball;
    use crate::motion::retarget::sole::Sole;
    use crate::spatial::{Placement, Vector3};
    use crate::task::Residual;

    /// Deep by 5 mm a ball is raised by as much, and by 1 mm more where it is deep by that still.
    #[test]
    fn what_is_deep_is_raised_by_its_depth() {
        let mut builder = Model::builder("foot");
        let frame = builder.frame("foot", None, Placement::identity());
        builder.build().unwrap();
        let (at, radius) = (Vector3::zero(), 0.02);
        let sole = Sole {
            frame,
            balls: vec![(Ball { frame, at, radius }, 0)],
            level: Vec::new(),
        };
        let mut over = OverGround::new(&sole, 3.0, 2.0);
        let mut pushed = |height: f64| {
            let placed = Placement::translation(Vector3::new(0.0, 0.0, height));
            let mut residual = [0.0];
            over.evaluate(&[placed], &[], &mut residual);
            let pushed = over.push_out(&residual, 2e-4);
            (pushed, over.heights()[0])
        };
        for (height, expected) in [
            (0.015, (true, 0.005)),
            (0.019, (true, 0.006)),
            (0.0199, (false, 0.006)),
        ] {
            let (was, raised) = pushed(height);
            assert!(
                was == expected.0 && (raised - expected.1).abs() < 1e-12,
                "{raised}"
            );
        }
    }
}
