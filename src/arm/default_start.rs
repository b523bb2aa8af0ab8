//! Default start of an arm's searches.

use super::Arm;
use crate::model::Limits;

impl Arm {
    /// The configuration to start from where nothing better is known, one number a free joint, base to tip, radians or metres.
    ///
    /// It is the middle of each joint's limits, or the value closest to 0 for a joint that has no limit on one side. With
    /// [`with_srdf`](Self::with_srdf) it is the state `ready` or `home`. The middle is far from the limits and from the
    /// configurations in which a stretched arm is singular.
    ///
    /// ```
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::new(&robot, "base", "hand")?;
    /// let start = arm.default_start();
    /// assert!(start[3] < -1.4, "the elbow is bent");
    /// let target = arm.base_from_tool(&[0.3, -0.4, 0.2, -1.9, 0.1, 1.6, 0.5])?;
    /// assert!(arm.solve(target, start)?.reached);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn default_start(&self) -> &[f64] {
        &self.default_start
    }

    /// The same arm with its [default start](Self::default_start) at the first of these states that the SRDF file has for joints of the
    /// arm: `ready`, then `home`, in any case. Joints without a value in the state stay at the middle of their limits.
    #[cfg(feature = "xml")]
    #[must_use]
    pub fn with_srdf(mut self, srdf: &crate::robot::Srdf) -> Self {
        let middle: Vec<f64> = self.limits().map(middle_of).collect();
        self.default_start = middle;
        for wanted in STATES {
            let named =
                (srdf.states.iter()).filter(|state| state.name.eq_ignore_ascii_case(wanted));
            let values: Vec<(usize, f64)> =
                named.flat_map(|state| &state.values).copied().collect();
            let mut found = false;
            let bounds: Vec<Limits> = self.limits().collect();
            for ((own, start), limits) in (self.coordinates.own.iter())
                .zip(&mut self.default_start)
                .zip(bounds)
            {
                if let Some((_, value)) = values
                    .iter()
                    .rev()
                    .find(|(coordinate, _)| coordinate == own)
                {
                    *start = limits.clamp(*value);
                    found = true;
                }
            }
            if found {
                break;
            }
        }
        self
    }
}

/// The SRDF states that an arm starts from, the first that exists.
#[cfg(feature = "xml")]
const STATES: [&str; 2] = ["ready", "home"];

/// The middle of limits, or the value closest to 0 if a limit is missing.
pub(super) fn middle_of(limits: Limits) -> f64 {
    match limits.lower.is_finite() && limits.upper.is_finite() {
        true => limits.clamp(0.5 * limits.lower + 0.5 * limits.upper),
        false => limits.clamp(0.0),
    }
}
