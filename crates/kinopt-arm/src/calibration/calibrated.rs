//! Result of a calibration.

use kinopt_kinematics::spatial::Placement;

use super::measurements::Noise;

/// Corrected placement of a joint's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// Name of the joint.
    pub joint: String,
    /// The corrected joint frame in the joint frame of the model, metres.
    pub placement: Placement<f64>,
}

/// Root mean square errors of measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rms {
    /// Distance of the tip from its measurement, metres.
    pub position: f64,
    /// Angle between the tip and its measurement, radians; 0 for points.
    pub angle: f64,
}

/// An estimated parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterEstimate {
    /// The joint, "base" or "tool", and the direction, such as "elbow position x" or "elbow offset".
    pub name: String,
    /// Deviation from the model, metres or radians.
    pub value: f64,
    /// Standard deviation of the value by the noise and the prior, metres or radians.
    pub standard_deviation: f64,
    /// False if the measurements do not determine the parameter alone: the prior decides about its value, or about that of a
    /// parameter that it sums with, such as the rotation of the base and the offset of the first joint.
    pub is_determined: bool,
}

/// Result of a calibration.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Calibrated {
    /// Corrections of the joints, from base to tip.
    pub corrections: Vec<Correction>,
    /// Placement of the base in the frame of the measuring device, metres.
    pub device_from_base: Placement<f64>,
    /// Placement of the measured frame in the tip of the model, metres.
    pub tip_from_tool: Placement<f64>,
    pub(super) tip_joint: Option<String>,
    /// Errors of the model.
    pub before: Rms,
    /// Errors of the calibrated model, without outliers.
    pub after: Rms,
    /// Noise of the measurements, given or estimated.
    pub noise: Noise,
    /// Indices of measurements that do not fit, in order.
    pub outliers: Vec<usize>,
    /// Estimated parameters.
    pub parameters: Vec<ParameterEstimate>,
}

impl Calibrated {
    /// Returns true if [`urdf`](Self::urdf) contains the correction of the tool: the tip's link is mounted by a fixed joint.
    ///
    /// Otherwise pass [`tip_from_tool`](Self::tip_from_tool) to [`ArmBuilder::with_tool`](crate::arm::ArmBuilder::with_tool).
    #[must_use]
    pub fn urdf_has_tool(&self) -> bool {
        self.tip_joint.is_some()
    }

    /// Returns the robot's URDF with corrected `<origin>` elements; all other text stays. `file` is its name in messages.
    ///
    /// The placement of the base in the frame of the measuring device is not part of it.
    ///
    /// # Errors
    /// Returns an error for text that is no URDF.
    #[cfg(feature = "urdf")]
    pub fn urdf(
        &self,
        text: &str,
        file: &str,
    ) -> Result<String, kinopt_robot::robot::RobotFileError> {
        let of_joints = self.corrections.iter();
        let mut corrections: Vec<(String, Placement<f64>)> = of_joints
            .map(|correction| (correction.joint.clone(), correction.placement))
            .collect();
        corrections.extend(
            self.tip_joint
                .clone()
                .map(|joint| (joint, self.tip_from_tool)),
        );
        kinopt_robot::robot::with_origin_corrections(text, file, &corrections)
    }
}
