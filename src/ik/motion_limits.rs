//! Velocity, acceleration and jerk limits of a configuration.

/// Limits of velocity, acceleration and jerk of the joints of a model, for [`Drag::with_motion_limits`](super::Drag::with_motion_limits).
///
/// Each list has one limit for every number of a configuration, in rad/s or m/s (or with s² and s³); infinity is no limit. The four
/// numbers of a ball joint limit its angular rate, by the smallest of them. The three slides of a free base are limited together: the norm
/// of the base's linear rate keeps the smallest of their limits.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionLimits {
    /// rad/s or m/s.
    pub velocity: Vec<f64>,
    /// rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// rad/s³ or m/s³.
    pub jerk: Vec<f64>,
}

impl MotionLimits {
    /// No limits, for configurations of so many numbers.
    #[must_use]
    pub fn unlimited(configuration_len: usize) -> Self {
        let unlimited = vec![f64::INFINITY; configuration_len];
        Self {
            velocity: unlimited.clone(),
            acceleration: unlimited.clone(),
            jerk: unlimited,
        }
    }

    setters! {
        /// Sets the velocity limits.
        pub fn with_velocity(mut self, limits: impl Into<Vec<f64>>) { self.velocity = limits.into() }
        /// Sets the acceleration limits.
        pub fn with_acceleration(mut self, limits: impl Into<Vec<f64>>) { self.acceleration = limits.into() }
        /// Sets the jerk limits.
        pub fn with_jerk(mut self, limits: impl Into<Vec<f64>>) { self.jerk = limits.into() }
    }
}
