//! Conversion between joint values of an arm and configurations of the whole model.

use super::QueryError;
use super::arm::Arm;
use kinopt_kinematics::Buffer;
use kinopt_kinematics::model::Source;

impl Arm {
    /// Writes the arm's joint values into a configuration of the source model (shape: its degrees of freedom).
    ///
    /// Also writes the locked joints between base and tip, and the mimic joints of the arm's joints. Other values stay
    /// unchanged.
    ///
    /// # Errors
    /// Returns an error for slices of the wrong length.
    pub fn configuration(&self, q_arm: &[f64], q_model: &mut [f64]) -> Result<(), QueryError> {
        self.check_lengths(q_arm, q_model)?;
        for (coordinate, source, limits) in &self.coordinates.entries {
            q_model[*coordinate] = match *source {
                Source::Constant(value) => value,
                source => limits.clamp(source.at(q_arm)),
            };
        }
        Ok(())
    }

    /// Reads the arm's joint values from a configuration of the model, into a slice of that length or a `Vec`.
    ///
    /// # Errors
    /// Returns an error for slices of the wrong length, and for joint values that are not finite.
    pub fn joint_values(
        &self,
        q_model: &[f64],
        q_arm: &mut (impl Buffer<f64> + ?Sized),
    ) -> Result<(), QueryError> {
        let q_arm = q_arm.sized(self.joint_count());
        self.check_lengths(q_arm, q_model)?;
        for (value, &coordinate) in q_arm.iter_mut().zip(&self.coordinates.joint_coordinates) {
            *value = q_model[coordinate];
        }
        self.check_finite("q", q_arm)
    }

    fn check_lengths(&self, q_arm: &[f64], q_model: &[f64]) -> Result<(), QueryError> {
        let degrees_of_freedom = self.coordinates.degrees_of_freedom;
        self.check_length("q_arm", q_arm.len(), self.joint_count())?;
        self.check_length("q_model", q_model.len(), degrees_of_freedom)
    }
}
