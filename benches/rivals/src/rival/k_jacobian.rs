//! `JacobianIkSolver` of the crate `k` (OpenRR), with restarts.

use std::time::{Duration, Instant};

use k::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use k::{InverseKinematicsSolver, JacobianIkSolver, SerialChain};

use super::{Answer, Rival, timed};
use crate::{Failure, Judge, Query, TOLERANCE, Workload, until_deadline};

/// Fraction of a Gauss-Newton step, and largest number of steps.
pub type Setting = (f64, usize);

/// Setting of its documentation, modified to converge to 1e-6; and full steps.
pub const SETTINGS: [Setting; 2] = [(0.5, 100), (1.0, 30)];

struct Jacobian<'a> {
    workload: &'a Workload,
    arm: SerialChain<f64>,
    solver: JacobianIkSolver<f64>,
    limit: Duration,
    setting: Setting,
}

/// Reads the robot with the reader of `k`.
pub fn new<'a>(
    workload: &'a Workload,
    limit: Duration,
    setting: Setting,
) -> Result<Box<dyn Rival + 'a>, Failure> {
    let robot = k::Chain::<f64>::from_urdf_file(&workload.urdf)?;
    let tip = robot.find_link(&workload.tip).ok_or("no such tip")?;
    let arm = SerialChain::from_end(tip);
    // It only supports poses relative to the root, and its kinematics must equal the judge's.
    let q = &workload.queries.first().ok_or("nothing is asked")?.start;
    arm.set_joint_positions(q)?;
    let pose = arm.end_transform();
    let tip = kinopt::spatial::Placement::new(
        nalgebra_rotation(&pose),
        [pose.translation.x, pose.translation.y, pose.translation.z].into(),
    );
    let (position, orientation) = Judge(&workload.chain).errors(&tip, q);
    if position > 1e-9 || orientation > 1e-9 {
        return Err("its forward kinematics differs: is the base the root?".into());
    }
    let (share, steps) = setting;
    Ok(Box::new(Jacobian {
        workload,
        arm,
        solver: JacobianIkSolver::new(TOLERANCE, TOLERANCE, share, steps),
        limit,
        setting,
    }))
}

fn nalgebra_rotation(pose: &Isometry3<f64>) -> kinopt::spatial::Matrix3<f64> {
    let matrix = pose.rotation.to_rotation_matrix();
    let column = |j| [matrix[(0, j)], matrix[(1, j)], matrix[(2, j)]].into();
    kinopt::spatial::Matrix3::from_columns(column(0), column(1), column(2))
}

impl Rival for Jacobian<'_> {
    fn name(&self) -> String {
        format!("k, steps × {}", self.setting.0)
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let [x, y, z, qw, qx, qy, qz] = query.pose;
        let target = Isometry3::from_parts(
            Translation3::new(x, y, z),
            UnitQuaternion::from_quaternion(Quaternion::new(qw, qx, qy, qz)),
        );
        Ok(timed(|| {
            let deadline = Instant::now() + self.limit;
            until_deadline(&self.workload.chain, &query.start, deadline, |q| {
                self.arm.set_joint_positions_clamped(q);
                let solved = self.solver.solve(&self.arm, &target).is_ok();
                q.copy_from_slice(&self.arm.joint_positions());
                solved
            })
        }))
    }
}
