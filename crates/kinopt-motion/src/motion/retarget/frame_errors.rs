//! Position errors of a retargeted motion, sample by sample.

use super::{RetargetError, RetargetReport, Retargeting};
use kinopt_kinematics::Trajectory;
use kinopt_kinematics::kinematics::ForwardKinematics;

impl Retargeting<'_> {
    /// Returns for each of [`driven`](Self::driven) the index of its captured joint.
    #[must_use]
    pub fn driving(&self) -> Vec<usize> {
        self.limbs.all.iter().map(|limb| limb.joint).collect()
    }

    /// Returns the distance of each driven point from its target, in the model's unit. The distances are sorted by
    /// sample, then in the order of [`driven`](Self::driven).
    ///
    /// # Errors
    /// Returns an error if the configurations do not fit the model.
    pub fn errors(
        &self,
        retargeted: &Trajectory<RetargetReport>,
    ) -> Result<Vec<f64>, RetargetError> {
        let map_error = |error: kinopt_kinematics::kinematics::KinematicsError| {
            RetargetError::Map(error.to_string())
        };
        let mut kinematics =
            ForwardKinematics::of_frames(self.robot.model(), &self.driven()).map_err(map_error)?;
        let mut errors = Vec::with_capacity(retargeted.rows().len() * self.limbs.all.len());
        for (frame, q) in retargeted.rows().enumerate() {
            let placed = kinematics.place(q).map_err(map_error)?;
            let targets = self.targets(frame).unwrap_or_default();
            let limbs = self.limbs.all.iter().zip(placed).zip(targets);
            errors.extend(limbs.map(|((limb, placed), target)| {
                let offset = limb.offset * self.unit.inverse_scale();
                (placed.apply(offset) - *target).norm()
            }));
        }
        Ok(errors)
    }
}
