//! A frame should move at a velocity.

use super::orientation::check_rotation;
use super::residual::{moved, no_time_step, not_finite};
use super::{Orientation, Quantity, Residual, Rows};
use crate::model::FrameId;
use crate::scalar::Scalar;
use crate::spatial::{Placement, Vector3};

/// r = ((x − x₀)/Δt − v, log(R R₀ᵀ)/Δt − ω): the twist that led a frame from where it stood a time step ago to
/// where it stands, less the one that is wanted. Three rows in metres per second, of its origin, and three in
/// radians per second; world axes.
///
/// Six rows of a [`Smoothness`](super::Smoothness) of one frame: a velocity of zero keeps a hand or a head still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameVelocity {
    frame: FrameId,
    previous: Placement<f64>,
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    time_step_s: f64,
}

impl FrameVelocity {
    /// The frame, which stood at `previous` (world_from_frame) `time_step_s` seconds ago, should have moved at
    /// `linear`, m/s, and turned at `angular`, rad/s.
    #[must_use]
    pub fn new(
        frame: FrameId,
        previous: impl Into<Placement<f64>>,
        time_step_s: f64,
        (linear, angular): (impl Into<Vector3<f64>>, impl Into<Vector3<f64>>),
    ) -> Self {
        Self {
            frame,
            previous: previous.into(),
            linear: linear.into(),
            angular: angular.into(),
            time_step_s,
        }
    }

    /// Takes the next step's starting point.
    pub fn set_previous(&mut self, previous: impl Into<Placement<f64>>) {
        self.previous = previous.into();
    }

    /// Wants another velocity: m/s, rad/s.
    pub fn set_velocity(
        &mut self,
        linear: impl Into<Vector3<f64>>,
        angular: impl Into<Vector3<f64>>,
    ) {
        self.linear = linear.into();
        self.angular = angular.into();
    }

    /// The residual where frames stand so, with the target moved by a step.
    fn evaluate_frames<S: Scalar>(&self, frames: &[Placement<S>], step: &[S], residual: &mut [S]) {
        let way = frames[0].translation - Vector3::constant(self.previous.translation);
        let turn = Vector3::from(Orientation::miss(
            self.previous.rotation,
            frames[0].rotation,
        ));
        let per_second = S::constant(1.0 / self.time_step_s);
        let linear = way * per_second - moved(self.linear, step);
        let angular = turn * per_second - moved(self.angular, step.get(3..).unwrap_or_default());
        residual[..3].copy_from_slice(&linear.to_array());
        residual[3..].copy_from_slice(&angular.to_array());
    }
}

impl Residual for FrameVelocity {
    answers! {
        fn kind(&self) -> &'static str = "frame velocity";
        fn frames(&self) -> Vec<FrameId> = vec![self.frame];
        fn target_len(&self) -> usize = 6;
        fn has_edges(&self) -> bool = false;
    }

    fn rows(&self) -> Vec<Rows> {
        vec![
            Rows::new(Quantity::MetresPerSecond, 3),
            Rows::new(Quantity::RadiansPerSecond, 3),
        ]
    }

    evaluate_by_frames!();

    fn validate(&self) -> Result<(), String> {
        not_finite("its previous place", self.previous.translation.to_array())?;
        check_rotation("its previous place has", &self.previous.rotation)?;
        not_finite("its velocity", self.linear.to_array())?;
        not_finite("its angular velocity", self.angular.to_array())?;
        no_time_step(self.time_step_s)
    }
}
