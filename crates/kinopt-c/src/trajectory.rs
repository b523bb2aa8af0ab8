//! Trajectories: time-optimal motion along a joint path.

use std::ffi::c_char;

use kinopt::motion::Trajectory;
use kinopt::motion::path::{TimedSpline, TimingLimits, TrajectoryPoint};
use kinopt_bindings::option::trajectory::options;
use kinopt_bindings::option::{apply, names};

use crate::arm::KinoptArm;
use crate::error::{KinoptStatus, guard, of_json};
use crate::path::KinoptJointPath;
use crate::pointer;
use crate::settings::settings;

/// Trajectory along a joint path. One thread uses it at a time.
pub struct KinoptTrajectory {
    inner: Trajectory<TimedSpline>,
    point: TrajectoryPoint,
}

/// Computes the time-optimal trajectory along a joint path of the arm, from rest to rest.
///
/// Limits have one number for each joint, infinite for none: velocities (rad/s or m/s), accelerations and jerks. Null is the
/// limits of the robot's files; of jerks it is none.
///
/// A path with missed points or blocked steps is an error, unless the setting `allow_unreached` is true. Other settings are
/// `corner_tolerance`, the largest distance of a joint from the path at a blended corner (radians or metres), and `grid_points`
/// of the speed profile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_trajectory(
    path: *const KinoptJointPath,
    arm: *const KinoptArm,
    velocity_limits: *const f64,
    acceleration_limits: *const f64,
    jerk_limits: *const f64,
    limit_count: usize,
    settings: *const c_char,
    trajectory: *mut *mut KinoptTrajectory,
) -> KinoptStatus {
    guard(|| unsafe {
        let path = &pointer::object(path, "path")?.inner;
        let mut limits = TimingLimits::of(&pointer::object(arm, "arm")?.inner);
        let array = |pointer, name| pointer::optional_array(pointer, limit_count, name);
        if let Some(velocities) = array(velocity_limits, "velocity_limits")? {
            limits = limits.with_velocity_limits(velocities);
        }
        if let Some(accelerations) = array(acceleration_limits, "acceleration_limits")? {
            limits = limits.with_acceleration_limits(accelerations);
        }
        if let Some(jerks) = array(jerk_limits, "jerk_limits")? {
            limits = limits.with_jerk_limits(jerks);
        }
        let options = options();
        let settings = self::settings(settings, "option of a trajectory", &names(&options), &[])?;
        let limits = apply(&settings, &options, limits).map_err(of_json)?;
        let inner = path.trajectory(&limits)?;
        let point = TrajectoryPoint::default();
        pointer::give(trajectory, KinoptTrajectory { inner, point }, "trajectory")
    })
}

/// Frees a trajectory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_trajectory_free(trajectory: *mut KinoptTrajectory) {
    unsafe { pointer::free(trajectory) }
}

/// Time of the end, seconds; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_trajectory_duration(trajectory: *const KinoptTrajectory) -> f64 {
    let trajectory = unsafe { pointer::object(trajectory, "trajectory") };
    trajectory.map_or(0.0, |trajectory| trajectory.inner.duration())
}

/// Writes the time of each row of the path, seconds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_trajectory_times(
    trajectory: *const KinoptTrajectory,
    times: *mut f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let trajectory = pointer::object(trajectory, "trajectory")?;
        pointer::copy(&trajectory.inner.times, times, length, "times")
    })
}

/// Writes joint positions, velocities and accelerations at a time in seconds; null for those that are not needed. Before the
/// start and after the end the arm is at rest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_trajectory_at(
    trajectory: *mut KinoptTrajectory,
    time: f64,
    q: *mut f64,
    velocity: *mut f64,
    acceleration: *mut f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let KinoptTrajectory { inner, point } = pointer::object_mut(trajectory, "trajectory")?;
        inner.report.write_at(time, point);
        let places = [
            (&point.q, q, "q"),
            (&point.velocity, velocity, "velocity"),
            (&point.acceleration, acceleration, "acceleration"),
        ];
        for (numbers, place, name) in places {
            if !place.is_null() {
                pointer::copy(numbers, place, length, name)?;
            }
        }
        Ok(())
    })
}
