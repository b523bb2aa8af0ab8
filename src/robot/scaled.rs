//! A robot in another unit of length.

use super::Robot;
use crate::model::ModelError;

impl Robot {
    /// The same robot with all lengths of its model and its drives times a factor. Its links stay in the unit of its file.
    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, ModelError> {
        let model = self.model.scaled(factor);
        let slides: Vec<bool> = model.joints().iter().map(|j| j.kind.slides()).collect();
        let mut own = self.clone();
        for mimic in &mut own.mimics.joints {
            let [joint, master] = [mimic.joint, mimic.master].map(|id| slides[id.index()]);
            mimic.ratio *= if joint { factor } else { 1.0 };
            mimic.ratio /= if master { factor } else { 1.0 };
            mimic.offset *= if joint { factor } else { 1.0 };
        }
        for (drive, _) in own.drives.iter_mut().zip(&slides).filter(|own| *own.1) {
            let limits = [
                &mut drive.velocity,
                &mut drive.acceleration,
                &mut drive.jerk,
            ];
            for limit in limits.into_iter().flatten() {
                *limit *= factor;
            }
            if let Some(soft) = &mut drive.soft_limits {
                soft.lower *= factor;
                soft.upper *= factor;
            }
        }
        own.map = super::coupled(&model, &own.mimics.joints).build()?;
        own.model = model;
        Ok(own)
    }
}
