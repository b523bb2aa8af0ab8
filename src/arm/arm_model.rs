//! Models from which arms can be built.

use crate::model::{JointId, Model};
use crate::robot::{Mimic, Robot};

/// Model of an arm: a [`Model`], or a [`Robot`] with mimic joints.
pub trait ArmModel {
    /// Joints and frames of the model.
    fn model(&self) -> &Model;
    /// Mimic joints of the model.
    fn followers(&self) -> &[Mimic];
    /// Velocity limit of a joint, rad/s or m/s; none for a bare model.
    fn velocity_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
    /// Acceleration limit of a joint, rad/s² or m/s²; none for a bare model.
    fn acceleration_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
    /// Jerk limit of a joint, rad/s³ or m/s³; none for a bare model.
    fn jerk_limit(&self, joint: JointId) -> Option<f64> {
        let _ = joint;
        None
    }
}

impl ArmModel for Model {
    fn model(&self) -> &Model {
        self
    }

    fn followers(&self) -> &[Mimic] {
        &[]
    }
}

impl ArmModel for Robot {
    fn model(&self) -> &Model {
        self.model()
    }

    fn followers(&self) -> &[Mimic] {
        self.mimics()
    }

    fn velocity_limit(&self, joint: JointId) -> Option<f64> {
        Self::velocity_limit(self, joint)
    }

    fn acceleration_limit(&self, joint: JointId) -> Option<f64> {
        Self::acceleration_limit(self, joint)
    }

    fn jerk_limit(&self, joint: JointId) -> Option<f64> {
        Self::jerk_limit(self, joint)
    }
}
