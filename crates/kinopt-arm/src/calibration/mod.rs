//! Calibration of an arm: the kinematic parameters that explain measured poses or points of its tool.
//!
//! Real arms differ from their models by millimetres. [`Calibration`] estimates joint offsets and link parameters by least
//! squares: it minimises the weighted errors of all measurements, and deviations from the model in units of their prior.
//! The prior decides about parameters that the measurements do not determine, such as a translation along parallel axes.
//!
//! ```
//! # std::env::set_current_dir("../..")?;
//! # #[cfg(feature = "urdf")] {
//! use kinopt::Arm;
//! use kinopt::calibration::{Calibration, Measurements};
//! use kinopt::robot::Robot;
//! use kinopt::spatial::{Placement, Vector3};
//!
//! let text = std::fs::read_to_string("models/universal_ur5e.urdf")?;
//! let robot = Robot::parse(&text, "universal_ur5e.urdf")?;
//! let arm = Arm::new(&robot, "base", "flange")?;
//! // Measurements of an arm whose flange is 3 mm farther out than in its model.
//! let longer = Placement::translation(Vector3::new(0.0, 0.0, 0.003));
//! let configurations: Vec<f64> = (0..180).map(|k| (1.7 * f64::from(k)).sin()).collect();
//! let poses = configurations.chunks(6).map(|q| Ok(arm.base_from_tool(q)? * longer));
//! let poses = poses.collect::<Result<Vec<_>, kinopt::arm::QueryError>>()?;
//!
//! let fit = Calibration::new(&robot, "base", "flange")?.fit(&configurations, Measurements::Poses(&poses))?;
//! assert!(fit.before.position > 2.9e-3 && fit.after.position < 1e-4);
//! let calibrated = Robot::parse(&fit.urdf(&text, "universal_ur5e.urdf")?, "calibrated.urdf")?;
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod calibrated;
mod chain;
mod estimate;
mod measurements;
mod parameters;
mod residuals;

use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::model::{FrameRef, UnknownName};
use kinopt_robot::robot::Robot;

pub use calibrated::{Calibrated, Correction, ParameterEstimate, Rms};
pub use measurements::{Measurements, Noise};
pub use parameters::{ParameterSet, Prior};

use chain::Chain;

/// Smallest number of measurements.
const MIN_MEASUREMENTS: usize = 3;

/// Error of a calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A frame that the robot does not have.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// An option out of range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The base is not above the tip in the tree of links.
    #[error(
        "`{base}` does not carry `{tip}`: the base of a calibration is a link below which the tip is mounted"
    )]
    NotBelow {
        /// Name of the base.
        base: String,
        /// Name of the tip.
        tip: String,
    },
    /// A ball joint in the chain.
    #[error("joint `{joint}` is a ball joint; calibration needs joints of one number")]
    BallJoint {
        /// Name of the joint.
        joint: String,
    },
    /// Numbers of configurations and measurements that do not match.
    #[error(
        "{numbers} numbers of configurations and {measurements} measurements do not match: expected {joints} numbers for \
         each measurement ({names})"
    )]
    Count {
        /// Number of numbers of all configurations.
        numbers: usize,
        /// Number of measurements.
        measurements: usize,
        /// Number of joints of the chain.
        joints: usize,
        /// Names of the joints, from base to tip.
        names: String,
    },
    /// Too few measurements.
    #[error(
        "{measurements} measurements are too few for {parameters} parameters: expected at least {needed}, better 30 or more"
    )]
    TooFew {
        /// Number of measurements.
        measurements: usize,
        /// Number of estimated parameters.
        parameters: usize,
        /// Smallest number of measurements.
        needed: usize,
    },
    /// The calibrated model does not explain the measurements.
    #[error(
        "the measurements do not fit: half of them are more than {:.2e} m or {:.2e} rad off after the calibration, while \
         deviations of {position} m and {angle} rad are expected; check the units (metres, radians), the order of the joints, \
         base and tip",
        residual.position, residual.angle
    )]
    NoFit {
        /// Residual of the fit, by its median.
        residual: Noise,
        /// Expected deviation by the prior and the noise, metres.
        position: f64,
        /// Expected deviation by the prior and the noise, radians.
        angle: f64,
    },
    /// A measurement or configuration that is not finite, or a pose that is no rigid motion.
    #[error("measurement {index}: {problem}")]
    Measurement {
        /// Index of the measurement.
        index: usize,
        /// Defect.
        problem: &'static str,
    },
    /// No parameter is estimated.
    #[error("no parameter is free: enable at least one part of the parameter set")]
    NoParameters,
}

/// Calibration of the chain from a base to a tip.
#[derive(Clone, Debug)]
pub struct Calibration {
    chain: Chain,
    parameters: ParameterSet,
    prior: Prior,
    noise: Option<Noise>,
    is_robust: bool,
}

impl Calibration {
    /// Calibration of the moving joints between two frames of a robot, with all parameters.
    ///
    /// # Errors
    /// Returns an error for unknown frames, a base that does not carry the tip, and ball joints.
    pub fn new<'a>(
        robot: &Robot,
        base: impl Into<FrameRef<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> Result<Self, CalibrationError> {
        Ok(Self {
            chain: Chain::new(robot, base.into(), tip.into())?,
            parameters: ParameterSet::default(),
            prior: Prior::default(),
            noise: None,
            is_robust: true,
        })
    }

    /// Names of the joints, from base to tip: the order of a configuration.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &str> {
        self.chain.joints()
    }

    /// Sets the estimated parameters. Default: all.
    #[must_use]
    pub fn with_parameters(mut self, parameters: ParameterSet) -> Self {
        self.parameters = parameters;
        self
    }

    /// Sets the expected deviations of the arm from its model.
    #[must_use]
    pub fn with_prior(mut self, prior: Prior) -> Self {
        self.prior = prior;
        self
    }

    /// Sets the standard deviation of the measurements. Default: estimated from the residuals.
    #[must_use]
    pub fn with_noise(mut self, noise: impl Into<Option<Noise>>) -> Self {
        self.noise = noise.into();
        self
    }

    /// Sets whether measurements far from the fit count less (Cauchy's loss). Default true.
    #[must_use]
    pub fn with_robust_loss(mut self, enabled: bool) -> Self {
        self.is_robust = enabled;
        self
    }

    /// Estimates the parameters.
    ///
    /// `configurations` has one number for each joint of a measurement, radians or metres, measurement by measurement. A
    /// measurement is in the frame of the measuring device, which may differ from the base if [`ParameterSet::base`] is on.
    ///
    /// # Errors
    /// Returns an error for numbers that do not match or are not finite, poses that are no rigid motions, and options out of
    /// range. Returns an error for less than three measurements, or fewer numbers than parameters if the noise is estimated.
    /// Returns an error if the residual is above ten times the prior and the noise, as for joint positions in degrees.
    pub fn fit(
        &self,
        configurations: &[f64],
        measured: Measurements<'_>,
    ) -> Result<Calibrated, CalibrationError> {
        self.check(configurations, measured)?;
        estimate::estimate(self, configurations, measured)
    }

    fn check(
        &self,
        configurations: &[f64],
        measured: Measurements<'_>,
    ) -> Result<(), CalibrationError> {
        for (option, value) in [
            ("prior.position", self.prior.position),
            ("prior.angle", self.prior.angle),
            (
                "noise.position",
                self.noise.map_or(1.0, |noise| noise.position),
            ),
            ("noise.angle", self.noise.map_or(1.0, |noise| noise.angle)),
        ] {
            BadOption::check(option, value, POSITIVE)?;
        }
        if self.parameters.is_empty() {
            return Err(CalibrationError::NoParameters);
        }
        let (joints, measurements) = (self.joints().len(), measured.len());
        if configurations.len() != joints * measurements {
            return Err(CalibrationError::Count {
                numbers: configurations.len(),
                measurements,
                joints,
                names: self.joints().collect::<Vec<_>>().join(", "),
            });
        }
        for (index, q) in configurations.chunks_exact(joints.max(1)).enumerate() {
            if q.iter().any(|value| !value.is_finite()) {
                let problem = "the configuration is not finite";
                return Err(CalibrationError::Measurement { index, problem });
            }
        }
        if let Some((index, problem)) = measured.first_defect() {
            return Err(CalibrationError::Measurement { index, problem });
        }
        let has_rotations = measured.has_rotations();
        let parameters = parameters::parameters(&self.chain, &self.parameters, has_rotations).len();
        let needed = match self.noise {
            Some(_) => MIN_MEASUREMENTS,
            // One number more than parameters, for the noise.
            None => MIN_MEASUREMENTS.max(parameters / measured.rows() + 1),
        };
        match measurements < needed {
            true => Err(CalibrationError::TooFew {
                measurements,
                parameters,
                needed,
            }),
            false => Ok(()),
        }
    }
}
