//! Following of paths and targets: whole paths, one target at a time, and control cycles.

use super::QueryError;
use super::arm::Arm;
use super::follower::Follower;
use super::joint_path::JointPath;
use super::servo::Servo;
use super::track::follow;
#[cfg(feature = "collision")]
use super::track::unchecked_path_if_free;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;

impl Arm {
    /// Follows a path: every step continues from the one before on the same branch, whatever the arm's search.
    ///
    /// The first target, if the start is far from it, is solved as by [`solve`](Self::solve). If the branch ends,
    /// mostly at a limit that the null space reached, the arm looks for another joint path through the steps before. If
    /// there is none, it stays on its branch at the closest pose to each target, until a target is reached again. If
    /// jumps are [enabled](super::ArmBuilder::with_global_search_on_miss), it jumps to the nearest solution instead.
    /// [`JointPath::jumps`] lists the steps in which a joint moves farther than 0.2 rad. The report has one solution a
    /// target.
    ///
    /// An arm with a [checker](Self::with_checker) makes only collision-free motions. If it misses a target, it takes
    /// the path of the same arm without a checker, provided that path is complete and free.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve), for the first invalid target.
    pub fn track(
        &self,
        base_from_tools: &[Placement<f64>],
        start: &[f64],
    ) -> Result<JointPath<Vec<Solution>>, QueryError> {
        let mut follower = self.follower(start)?;
        for (query, target) in base_from_tools.iter().enumerate() {
            self.check_query(Some(query), target, start)?;
        }
        let path = follow(self, &mut follower, base_from_tools)?;
        #[cfg(feature = "collision")]
        if let (true, false) = (self.avoids_collisions(), path.reached())
            && let Some(unchecked_path) = unchecked_path_if_free(self, base_from_tools, start)?
        {
            return Ok(unchecked_path);
        }
        Ok(path)
    }

    /// Starts a path follower at `start`.
    ///
    /// The follower stays on its branch. If the branch does not reach a target, the result is the closest pose on it.
    /// The arm returns from there on the same side of the elbow. The null space of a redundant arm goes to the posture
    /// of the start, or to the [given one](super::ArmBuilder::with_posture), also while a target rests. The follower
    /// changes its branch only if that is [enabled](super::ArmBuilder::with_global_search_on_miss), and reports it.
    ///
    /// Joints that start outside their limits return first, by at most 0.2 rad per step; no such step is reached. For
    /// velocity limits see [`servo`](Self::servo).
    ///
    /// # Errors
    /// Returns an error for a start of the wrong length or not finite.
    pub fn follower(&self, start: &[f64]) -> Result<Follower<'_>, QueryError> {
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(None, &Placement::identity(), start)?;
        Ok(Follower::new(self, start))
    }

    /// Starts a servo at rest at `start`, which takes a target every `time_step` seconds.
    ///
    /// Velocity, acceleration and jerk limits hold in every cycle. They come from the robot's files, or from
    /// [`with_velocity_limits`](Servo::with_velocity_limits),
    /// [`with_acceleration_limits`](Servo::with_acceleration_limits) and
    /// [`with_jerk_limits`](Servo::with_jerk_limits). A joint without a velocity limit moves by at most 0.1 rad per cycle (a
    /// prismatic joint by the metres that weigh as much). A joint faster than 0.1 rad/s comes to rest for a cycle
    /// before it reverses.
    ///
    /// Within reach the arm keeps its branch. For a target out of reach it comes to rest at the closest pose, with status
    /// [`Nearest`](super::ServoStatus::Nearest). Branches meet there: on about 1 % of lines out of reach and back, the arm
    /// returns on another branch.
    ///
    /// An arm with a [checker](Self::with_checker) brakes before a collision, with status
    /// [`Blocked`](super::ServoStatus::Blocked). It does not go round the obstacle.
    ///
    /// The null space of a redundant arm goes to the posture of the start, or to a
    /// [given one](super::ArmBuilder::with_posture). It uses half of the velocity limits while the target moves. A joint
    /// that starts outside its position limits returns at its velocity limit.
    ///
    /// # Errors
    /// Returns an error for a start of the wrong length or not finite, or a time step that is not above 0 and at most 1 s.
    pub fn servo(&self, start: &[f64], time_step: f64) -> Result<Servo<'_>, QueryError> {
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(None, &Placement::identity(), start)?;
        Servo::new(self, start, time_step)
    }
}
