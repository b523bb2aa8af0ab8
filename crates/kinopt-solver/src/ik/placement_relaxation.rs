//! Relaxation of joint placements that depend on the configuration.

use kinopt_kinematics::model::{FrameId, JointId, Model};
use kinopt_kinematics::spatial::Vector3;

/// Smallest relaxation factor.
const MIN_FACTOR: f64 = 0.05;

/// Relaxed fixed-point iteration of joint placements.
///
/// A frame that solves with the placements p has a configuration with the placements F(p). If bones shear strongly, the
/// iteration p ← F(p) oscillates. The relaxed iteration is p ← p + ω (F(p) − p), with Aitken's secant estimate of ω
/// (Irons & Tuck 1969). Only translations are relaxed.
#[derive(Clone, Debug)]
pub(super) struct Relaxation {
    /// Translations of joints and frames in use, p.
    used: Vec<Vector3<f64>>,
    /// F(p) − p of the last update; empty before the second one.
    residuals: Vec<Vector3<f64>>,
    /// ω of the last update.
    factor: f64,
}

impl Default for Relaxation {
    fn default() -> Self {
        Self {
            used: Vec::new(),
            residuals: Vec::new(),
            factor: 1.0,
        }
    }
}

impl Relaxation {
    /// Returns the model with relaxed placements, or `None` if they are those of `model`.
    pub(super) fn relaxed(&mut self, model: &Model) -> Option<Model> {
        if self.used.len() != translations(model).count() {
            *self = Self::default();
            self.used.extend(translations(model));
            return None;
        }
        self.factor = self.next_factor(model);
        let factor = self.factor;
        let pairs = translations(model).zip(&mut self.used);
        self.residuals.clear();
        self.residuals.extend(pairs.map(|(given, used)| {
            let residual = given - *used;
            *used = match factor < 1.0 {
                true => *used + residual * factor,
                false => given,
            };
            residual
        }));
        if factor >= 1.0 {
            return None;
        }
        let mut relaxed = model.clone();
        let (joints, frames) = self.used.split_at(model.joints().len());
        for (index, translation) in joints.iter().enumerate() {
            relaxed.move_joint(JointId::new(index), *translation);
        }
        for (index, translation) in frames.iter().enumerate() {
            relaxed.move_frame(FrameId::new(index), *translation);
        }
        Some(relaxed)
    }

    /// ω ← −ω r·(r′ − r) / ‖r′ − r‖², with the last residual r and the new one r′, within bounds. 1 if the residual
    /// grows in one direction, as for joints that move by themselves.
    fn next_factor(&self, model: &Model) -> f64 {
        let placements = translations(model).zip(&self.used);
        let (mut along, mut square) = (0.0, 0.0);
        for ((given, used), last) in placements.zip(&self.residuals) {
            let change = given - *used - *last;
            along += last.dot(change);
            square += change.dot(change);
        }
        match along < 0.0 {
            true => (-self.factor * along / square).clamp(MIN_FACTOR, 1.0),
            false => 1.0,
        }
    }
}

/// Translations of all joints on their parents, then of all frames on their joints.
fn translations(model: &Model) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let joints = model.joints().iter();
    let joints = joints.map(|joint| joint.parent_from_joint.translation);
    let frames = model.frames().iter();
    joints.chain(frames.map(|frame| frame.joint_from_frame.translation))
}
