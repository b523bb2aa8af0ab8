//! Masses of a robot, from the inertials of its links.

use nalgebra::Matrix3xX;

use super::{Link, MissingInertia, Robot};
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::kinematics::{centre_of_mass, centre_of_mass_jacobian};
use kinopt_kinematics::model::ModelError;
use kinopt_kinematics::model::{Masses, PointMass, moving_joint};
use kinopt_kinematics::spatial::Vector3;

impl Robot {
    /// Masses of the links, from `<inertial>` in the file. Links that are fixed to the world are left out.
    ///
    /// ```
    /// # use kinopt::robot::Robot;
    /// let text = r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial>
    ///     <origin xyz="0 0 -1"/><mass value="2"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>
    /// </inertial></link><joint name="hinge" type="continuous">
    ///     <parent link="base"/><child link="bob"/><axis xyz="1 0 0"/></joint></robot>"#;
    /// let robot = Robot::reader().parse(text, "pendulum.urdf")?;
    /// assert_eq!(robot.masses()?.total(), 2.0);
    /// assert_eq!(robot.centre_of_mass(&[0.0])?.to_array(), [0.0, 0.0, -1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A negative mass, no mass at all, or a mass that depends on a mesh file
    /// ([`Link::left_to_meshes`](super::Link::left_to_meshes)). The error names the link.
    pub fn masses(&self) -> Result<Masses, ModelError> {
        self.collect_masses(|link| link.left_to_meshes.is_some())
    }

    /// Sum of the [`masses`](Self::masses), kilograms. A link whose mass is known and whose centre is not still counts.
    ///
    /// # Errors
    /// As [`masses`](Self::masses), except for links of which only the centre of mass depends on a mesh file.
    pub fn total_mass(&self) -> Result<f64, ModelError> {
        let masses =
            self.collect_masses(|link| link.left_to_meshes == Some(MissingInertia::Mass))?;
        Ok(masses.total())
    }

    /// The masses of links that joints move; an error if `unknown` holds for one of them.
    fn collect_masses(&self, unknown: impl Fn(&Link) -> bool) -> Result<Masses, ModelError> {
        let links = || self.model.frame_ids().zip(&self.links);
        let mut missing = links()
            .filter(|(frame, link)| unknown(link) && moving_joint(&self.model, *frame).is_some());
        if let Some((frame, _)) = missing.next() {
            let frame = self.model.frames()[frame.index()].name.clone();
            let others = missing.count();
            return Err(ModelError::MissingInertia { frame, others });
        }
        let masses = links().filter_map(|(frame, link)| {
            let (position, mass) = match (&link.inertial, link.left_to_meshes) {
                (Some(inertial), _) => (inertial.link_from_inertia.translation, inertial.mass),
                (None, Some(MissingInertia::Centre { mass })) => (Vector3::zero(), mass),
                (None, _) => return None,
            };
            Some(PointMass {
                frame,
                at: position,
                mass,
            })
        });
        Masses::new(&self.model, masses)
    }

    /// Position of the centre of mass in the world at a configuration (radians and metres), metres.
    ///
    /// # Errors
    /// As [`masses`](Self::masses), or an invalid configuration.
    pub fn centre_of_mass(&self, q: &[f64]) -> Result<Vector3<f64>, KinematicsError> {
        centre_of_mass(&self.model, &self.masses()?, q)
    }

    /// Jacobian of the centre of mass: see [`centre_of_mass_jacobian`].
    ///
    /// # Errors
    /// As [`centre_of_mass`](Self::centre_of_mass).
    pub fn centre_of_mass_jacobian(&self, q: &[f64]) -> Result<Matrix3xX<f64>, KinematicsError> {
        centre_of_mass_jacobian(&self.model, &self.masses()?, q)
    }
}
