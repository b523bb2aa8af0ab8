//! A robot in another unit of length.

use super::Robot;
use kinopt_kinematics::model::ModelError;

impl Robot {
    /// The same robot with all lengths of its model and its drives times a factor. Its links stay in the unit of its file.
    #[doc(hidden)]
    pub fn scaled(&self, factor: f64) -> Result<Self, ModelError> {
        let model = self.model.scaled(factor);
        let slides: Vec<bool> = model.joints().iter().map(|j| j.kind.slides()).collect();
        let mut robot = self.clone();
        for mimic in &mut robot.mimics.joints {
            let [joint, master] = [mimic.joint, mimic.master].map(|id| slides[id.index()]);
            mimic.ratio *= if joint { factor } else { 1.0 };
            mimic.ratio /= if master { factor } else { 1.0 };
            mimic.offset *= if joint { factor } else { 1.0 };
        }
        for (drive, _) in robot
            .drives
            .iter_mut()
            .zip(&slides)
            .filter(|entry| *entry.1)
        {
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
        robot.map = super::coupled(&model, &robot.mimics.joints).build()?;
        robot.model = model;
        Ok(robot)
    }
}
