//! Changes of tool, goal and search of an existing arm, which share its seed atlas.

use super::arm::Arm;
use super::builder::check_tool;
use super::options::{Options, Search, check_goal};
use super::serial_chain::Serial;
use super::{ArmError, PoseBounds};
use crate::simd_ik::{LaneOptions, PoseSolver};
use kinopt_kinematics::spatial::Placement;

impl Arm {
    /// The same arm with another tool, given by its placement in the tip's frame, metres; the identity for none.
    ///
    /// All other options stay. Its results are bitwise those of an arm [built](super::ArmBuilder::with_tool) with that
    /// tool. The seed atlas is shared, which makes it about a thousand times as fast to build.
    ///
    /// # Errors
    /// Returns an error for a placement that is not a rigid motion.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::{Arm, PoseBounds};
    /// # use kinopt::robot::Robot;
    /// use kinopt::spatial::{Placement, Vector3};
    ///
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// let drill = Placement::translation(Vector3::new(0.0, 0.0, 0.12));
    /// let drilling = arm.with_tool(drill)?.with_goal(PoseBounds::free_about(kinopt::arm::Axis::Z))?;
    /// let q = [0.1, -1.2, 1.0, -1.3, -1.5, 0.2];
    /// let flange = arm.base_from_tool(&q)?;
    /// let tip = drilling.base_from_tool(&q)?;
    /// assert!(((flange * drill).translation - tip.translation).norm() < 1e-12);
    /// assert!(drilling.solve(tip, &[0.0, -1.5, 1.5, -1.5, -1.5, 0.0])?.reached);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_tool(&self, tip_from_tool: impl Into<Placement<f64>>) -> Result<Self, ArmError> {
        let tip_from_tool = tip_from_tool.into();
        check_tool(&tip_from_tool)?;
        self.with_chain(self.serial.with_tool(tip_from_tool)?, self.options.clone())
    }

    /// The same arm with another goal, which shares the seed atlas as [`with_tool`](Self::with_tool) does.
    ///
    /// # Errors
    /// Returns an error for a goal without components, or half widths that are NaN or negative.
    pub fn with_goal(&self, goal: PoseBounds) -> Result<Self, ArmError> {
        check_goal(&goal)?;
        let mut options = self.options.clone();
        options.goal = goal;
        self.with_chain(self.serial.clone(), options)
    }

    /// The same arm with another search, which shares the seed atlas.
    ///
    /// Example: several distinct solutions, from an arm that otherwise gives the one from the start.
    ///
    /// # Errors
    /// Returns an error for a search whose numbers are out of range, or that is incompatible with the arm's posture.
    pub fn with_search(&self, search: Search) -> Result<Self, ArmError> {
        let mut options = self.options.clone();
        options.search = search;
        options.check(&self.joints().collect::<Vec<_>>())?;
        self.with_chain(self.serial.clone(), options)
    }

    fn with_chain(&self, serial: Serial, mut options: Options) -> Result<Self, ArmError> {
        options.weigh_radians(serial.model.reach());
        let simd_solver = self.simd_solver_for(&serial, &options)?;
        let changed = self.changed(serial, options, simd_solver)?;
        #[cfg(feature = "collision")]
        let changed = match &self.collisions {
            Some(avoidance) => changed.with_checker(avoidance.checker(), avoidance.rest())?,
            None => changed,
        };
        Ok(changed)
    }

    /// SIMD solver for another chain and other options, which shares the seed atlas.
    pub(super) fn simd_solver_for(
        &self,
        serial: &Serial,
        options: &Options,
    ) -> Result<Option<PoseSolver>, ArmError> {
        let simd_solver = self.simd_solver.as_ref().zip(serial.chain.as_ref());
        let simd_solver = simd_solver.map(|(simd_solver, chain)| {
            let lane_options = LaneOptions {
                metres_per_radian: options.metres_per_radian,
                axes: options.goal.into(),
                ..simd_solver.options().clone()
            };
            simd_solver.retargeted(chain, lane_options)
        });
        Ok(simd_solver.transpose()?)
    }
}
