//! Velocity task for a frame.

use super::orientation::check_rotation;
use super::residual::{check_finite, check_time_step, moved};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, Orientation, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = ((x − x₀)/Δt − v, log(R R₀ᵀ)/Δt − ω): the mean twist of a frame over the last time step, minus its target.
///
/// Three rows in metres per second, of the frame's origin, and three in radians per second, in world axes. It is a
/// [`Smoothness`](super::Smoothness) of one frame: a target of zero keeps a hand or a head still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameVelocity {
    frame: FrameId,
    previous: Placement<f64>,
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    time_step_s: f64,
}

impl FrameVelocity {
    /// A task for a frame to have moved at `linear`, m/s, and rotated at `angular`, rad/s, since `previous`.
    ///
    /// `previous` is world_from_frame `time_step_s` seconds ago.
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

    /// Sets the placement at the start of the next time step.
    pub fn set_previous(&mut self, previous: impl Into<Placement<f64>>) {
        self.previous = previous.into();
    }

    /// Sets the target velocity: m/s and rad/s.
    pub fn set_velocity(
        &mut self,
        linear: impl Into<Vector3<f64>>,
        angular: impl Into<Vector3<f64>>,
    ) {
        self.linear = linear.into();
        self.angular = angular.into();
    }
}

impl Residual for FrameVelocity {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::MetresPerSecond, 3),
            RowBlock::new(Quantity::RadiansPerSecond, 3),
        ]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn description(&self) -> Description {
        Description::new("frame velocity").with_validity(self.validate())
    }
}

impl FrameVelocity {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its previous place", self.previous.translation.to_array())?;
        check_rotation("its previous place has", &self.previous.rotation)?;
        check_finite("its velocity", self.linear.to_array())?;
        check_finite("its angular velocity", self.angular.to_array())?;
        check_time_step(self.time_step_s)
    }
}

impl DifferentiableTarget for FrameVelocity {
    fn target_len(&self) -> usize {
        6
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let translation = frames[0].translation - Vector3::constant(self.previous.translation);
        let rotation = Vector3::from(Orientation::error(
            self.previous.rotation,
            frames[0].rotation,
        ));
        let per_second = S::constant(1.0 / self.time_step_s);
        let linear = translation * per_second - moved(self.linear, step);
        let angular =
            rotation * per_second - moved(self.angular, step.get(3..).unwrap_or_default());
        residual[..3].copy_from_slice(&linear.to_array());
        residual[3..].copy_from_slice(&angular.to_array());
    }

    fn has_edges(&self) -> bool {
        false
    }
}
