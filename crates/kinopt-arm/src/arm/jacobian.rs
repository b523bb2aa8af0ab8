//! Jacobian of an arm's tool.

use super::QueryError;
use super::arm::Arm;
use kinopt_kinematics::kinematics::{ForwardKinematics, Jacobian};

impl Arm {
    /// Compiles the tool's Jacobian: six rows, and one column per free joint, base to tip.
    ///
    /// The rows are the velocity of the tool's origin, m/s, and its angular velocity, rad/s, both in the base's axes. A
    /// column includes the mimic joints of its joint.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::builder(&robot, "base", "flange").build()?;
    /// let mut jacobian = arm.jacobian()?;
    /// let j = jacobian.at(&[0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5])?;
    /// assert_eq!(j.shape(), (6, 7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None in practice: the chain was compiled when the arm was built.
    pub fn jacobian(&self) -> Result<Jacobian, QueryError> {
        let serial = &self.serial;
        let tool = [serial.tool];
        let kinematics = ForwardKinematics::under(&serial.model, &serial.map, &tool)?;
        Ok(Jacobian::new(kinematics))
    }
}
