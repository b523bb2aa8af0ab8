//! Joint velocity, acceleration and jerk limits.

/// Joint velocity, acceleration and jerk limits for [`Drag::with_motion_limits`](super::Drag::with_motion_limits).
///
/// Each list has one limit for every number of a configuration. Infinity means no limit. The smallest of the four
/// limits of a ball joint applies to its angular rate. The smallest limit of the three prismatic joints of a free base
/// applies to the norm of its linear rate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionLimits {
    /// Velocity limits, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Acceleration limits, rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// Jerk limits, rad/s³ or m/s³.
    pub jerk: Vec<f64>,
}

impl MotionLimits {
    /// Creates infinite limits for configurations of `configuration_len` numbers.
    #[must_use]
    pub fn unlimited(configuration_len: usize) -> Self {
        let unlimited = vec![f64::INFINITY; configuration_len];
        Self {
            velocity: unlimited.clone(),
            acceleration: unlimited.clone(),
            jerk: unlimited,
        }
    }

    /// Sets the velocity limits.
    #[must_use]
    pub fn with_velocity(mut self, limits: impl Into<Vec<f64>>) -> Self {
        self.velocity = limits.into();
        self
    }

    /// Sets the acceleration limits.
    #[must_use]
    pub fn with_acceleration(mut self, limits: impl Into<Vec<f64>>) -> Self {
        self.acceleration = limits.into();
        self
    }

    /// Sets the jerk limits.
    #[must_use]
    pub fn with_jerk(mut self, limits: impl Into<Vec<f64>>) -> Self {
        self.jerk = limits.into();
        self
    }
}
