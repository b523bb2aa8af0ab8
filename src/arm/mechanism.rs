//! What arms are made of.

use crate::model::{JointId, Model};
use crate::robot::{Mimic, Robot};

/// What an arm can be made of: a [`Model`], or a [`Robot`] with joints that follow others.
pub trait Mechanism {
    /// The joints and frames.
    fn model(&self) -> &Model;
    /// The joints that follow others.
    fn followers(&self) -> &[Mimic];
    /// The speed a joint is allowed, radians or metres a second; none known for a bare model.
    fn velocity_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
    /// Acceleration limit of a joint, rad/s² or m/s²; none for a model, which has no drives.
    fn acceleration_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
    /// Jerk limit of a joint, rad/s³ or m/s³; none for a model, which has no drives.
    fn jerk_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
}

impl Mechanism for Model {
    fn model(&self) -> &Model {
        self
    }

    fn followers(&self) -> &[Mimic] {
        &[]
    }
}

impl Mechanism for Robot {
    answers! {
        fn model(&self) -> &Model = self.model();
        fn followers(&self) -> &[Mimic] = self.mimics();
        fn velocity_limit(&self, joint: JointId) -> Option<f64> = Self::velocity_limit(self, joint);
    }

    fn acceleration_limit(&self, joint: JointId) -> Option<f64> {
        Self::acceleration_limit(self, joint)
    }

    fn jerk_limit(&self, joint: JointId) -> Option<f64> {
        Self::jerk_limit(self, joint)
    }
}
