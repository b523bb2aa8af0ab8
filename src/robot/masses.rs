//! A robot's masses, as the inertials of its links give them.

use nalgebra::Matrix3xX;

use super::Robot;
use crate::kinematics::{CentreOfMassError, centre_of_mass, centre_of_mass_jacobian};
use crate::model::{MassError, Masses, PointMass};
use crate::spatial::Vector3;

impl Robot {
    /// The masses that the file gives the links (`<inertial>`), but for those that stand in the world.
    ///
    /// ```
    /// # #[cfg(feature = "urdf")] {
    /// # use kinopt::robot::Robot;
    /// let text = r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial>
    ///     <origin xyz="0 0 -1"/><mass value="2"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>
    /// </inertial></link><joint name="hinge" type="continuous">
    ///     <parent link="base"/><child link="bob"/><axis xyz="1 0 0"/></joint></robot>"#;
    /// let robot = Robot::reader().parse(text, "pendulum.urdf")?;
    /// assert_eq!(robot.masses()?.total(), 2.0);
    /// assert_eq!(robot.centre_of_mass(&[0.0])?.to_array(), [0.0, 0.0, -1.0]);
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A negative mass, by the link's name, or none at all.
    pub fn masses(&self) -> Result<Masses, MassError> {
        let links = self.model.frame_ids().zip(&self.links);
        let masses = links.filter_map(|(frame, link)| {
            let inertial = link.inertial.as_ref()?;
            Some(PointMass {
                frame,
                at: inertial.link_from_inertia.translation,
                mass: inertial.mass,
            })
        });
        Masses::new(&self.model, masses)
    }

    /// Where the centre of its masses is at a configuration (radians and metres), in the world, metres.
    ///
    /// # Errors
    /// As [`masses`](Self::masses), or a configuration that is none.
    pub fn centre_of_mass(&self, q: &[f64]) -> Result<Vector3<f64>, CentreOfMassError> {
        Ok(centre_of_mass(&self.model, &self.masses()?, q)?)
    }

    /// How the centre of mass moves: see [`centre_of_mass_jacobian`].
    ///
    /// # Errors
    /// As [`centre_of_mass`](Self::centre_of_mass).
    pub fn centre_of_mass_jacobian(&self, q: &[f64]) -> Result<Matrix3xX<f64>, CentreOfMassError> {
        Ok(centre_of_mass_jacobian(&self.model, &self.masses()?, q)?)
    }
}
