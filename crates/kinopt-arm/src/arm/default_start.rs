//! Default start configuration of an arm.

#[cfg(feature = "xml")]
use std::collections::HashMap;

use super::Arm;
use kinopt_kinematics::model::Limits;

impl Arm {
    /// Default start configuration: one number per free joint, base to tip, radians or metres.
    ///
    /// It is the middle of each joint's limits, or the value closest to 0 for a joint without a limit on one side. With
    /// [`with_srdf`](Self::with_srdf) it is the state `ready` or `home`. The middle is far from the limits and from the
    /// singularities of a stretched arm.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
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

    /// Sets the [default start](Self::default_start) to a state of the SRDF file: `ready`, else `home`, in any case.
    ///
    /// The state must have values for joints of the arm. Joints without a value stay at the middle of their limits.
    #[cfg(feature = "xml")]
    #[must_use]
    pub fn with_srdf(mut self, srdf: &kinopt_robot::robot::Srdf) -> Self {
        let joint_coordinates = &self.coordinates.joint_coordinates;
        // Groups may share a state's name; the last value of a joint counts.
        let values_of = |name: &str| -> HashMap<usize, f64> {
            let states = srdf.states.iter();
            let named = states.filter(|state| state.name.eq_ignore_ascii_case(name));
            named.flat_map(|state| &state.values).copied().collect()
        };
        let mut states = STATES.into_iter().map(values_of);
        let state = states.find(|values| {
            joint_coordinates
                .iter()
                .any(|coordinate| values.contains_key(coordinate))
        });
        let state = state.unwrap_or_default();
        let start = (joint_coordinates.iter().zip(self.limits())).map(|(coordinate, limits)| {
            match state.get(coordinate) {
                Some(value) => limits.clamp(*value),
                None => middle_of(limits),
            }
        });
        self.default_start = start.collect();
        self
    }
}

/// SRDF states for the default start, in order of preference.
#[cfg(feature = "xml")]
const STATES: [&str; 2] = ["ready", "home"];

/// The middle of limits, or the value closest to 0 if a limit is missing.
pub(super) fn middle_of(limits: Limits) -> f64 {
    match limits.lower.is_finite() && limits.upper.is_finite() {
        true => limits.clamp(0.5 * limits.lower + 0.5 * limits.upper),
        false => limits.clamp(0.0),
    }
}
