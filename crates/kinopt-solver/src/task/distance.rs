//! Distance task between two frames.

use super::residual::{check_finite, error_if, moved_by};
use super::{Description, DifferentiableTarget, Extensions, Inputs, Quantity, Residual, RowBlock};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// r = ‖x_a − x_b‖ − distance, one row in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    frames: [FrameId; 2],
    distance: f64,
}

impl Distance {
    /// A task that keeps the origins of two frames `distance` metres apart (not negative).
    #[must_use]
    pub fn new(a: FrameId, b: FrameId, distance: f64) -> Self {
        Self {
            frames: [a, b],
            distance,
        }
    }

    /// Sets the distance, metres.
    pub fn set_distance(&mut self, distance: f64) {
        self.distance = distance;
    }
}

impl Residual for Distance {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn description(&self) -> Description {
        Description::new("distance").with_validity(self.validate())
    }
}

impl Distance {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its distance", [self.distance])?;
        error_if(self.distance < 0.0, || {
            format!("its distance {} is negative", self.distance)
        })?;
        error_if(self.frames[0] == self.frames[1], || {
            "it is from a frame to itself".to_owned()
        })
    }
}

impl DifferentiableTarget for Distance {
    fn target_len(&self) -> usize {
        1
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let offset = frames[0].translation - frames[1].translation;
        let squared = offset.norm_squared();
        // At distance zero every direction is valid; x gives a derivative.
        let coincide = squared.less_than(S::constant(f64::MIN_POSITIVE));
        let unit_x = Vector3::constant(Vector3::UNITS[0]);
        let length = S::select(
            coincide,
            offset.dot(unit_x),
            S::select(coincide, S::one(), squared).sqrt(),
        );
        residual[0] = length - moved_by(self.distance, step);
    }
}
