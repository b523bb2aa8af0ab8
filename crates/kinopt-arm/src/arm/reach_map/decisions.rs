//! Exact decisions for many poses.

use super::super::arm::Arm;
use super::super::{PoseOutcome, QueryError};
use super::ReachMap;
use super::error::ReachMapError;
use super::query::PoseReach;
use kinopt_kinematics::spatial::Placement;

/// Poses that one thread decides at a time.
const POSES_AT_A_TIME: usize = 1024;

/// Some poses, their configurations and results.
struct Piece<'a> {
    /// Index of the first pose.
    first: usize,
    poses: &'a [Placement<f64>],
    q: &'a mut [f64],
    reached: &'a mut [Option<bool>],
}

impl ReachMap {
    /// Decides poses as [`decide`](Self::decide) does, into slices: `Some(true)` for a reached pose, `Some(false)` for
    /// one that is proven unreachable, `None` for an undecided one. Configurations in `q`, a row for each pose, are NaN
    /// unless the pose is reached.
    ///
    /// # Errors
    /// Returns the errors of [`decide`](Self::decide), and an error for slices of the wrong length.
    pub fn decide_into(
        &self,
        arm: &Arm,
        base_from_tools: &[Placement<f64>],
        max_boxes: usize,
        q: &mut [f64],
        reached: &mut [Option<bool>],
    ) -> Result<(), ReachMapError> {
        let pieces = self.pieces(arm, base_from_tools, q, reached)?;
        for piece in pieces {
            self.decide_piece(arm, max_boxes, piece)?;
        }
        Ok(())
    }

    /// [`decide_into`](Self::decide_into) over the threads of the current rayon pool, with bitwise equal results.
    ///
    /// # Errors
    /// Returns the errors of [`decide_into`](Self::decide_into).
    #[cfg(feature = "rayon")]
    pub fn decide_into_parallel(
        &self,
        arm: &Arm,
        base_from_tools: &[Placement<f64>],
        max_boxes: usize,
        q: &mut [f64],
        reached: &mut [Option<bool>],
    ) -> Result<(), ReachMapError> {
        use rayon::prelude::*;
        let pieces = self.pieces(arm, base_from_tools, q, reached)?;
        (pieces.into_par_iter()).try_for_each(|piece| self.decide_piece(arm, max_boxes, piece))
    }

    fn pieces<'a>(
        &self,
        arm: &Arm,
        poses: &'a [Placement<f64>],
        q: &'a mut [f64],
        reached: &'a mut [Option<bool>],
    ) -> Result<Vec<Piece<'a>>, ReachMapError> {
        self.check_arm(arm)?;
        let joints = arm.joint_count();
        arm.check_length("q", q.len(), joints * poses.len())?;
        arm.check_length("reached", reached.len(), poses.len())?;
        let outputs = q
            .chunks_mut(POSES_AT_A_TIME * joints)
            .zip(reached.chunks_mut(POSES_AT_A_TIME));
        let pieces = poses.chunks(POSES_AT_A_TIME).zip(outputs).enumerate();
        let pieces = pieces.map(|(index, (poses, (q, reached)))| Piece {
            first: index * POSES_AT_A_TIME,
            poses,
            q,
            reached,
        });
        Ok(pieces.collect())
    }

    fn decide_piece(
        &self,
        arm: &Arm,
        max_boxes: usize,
        piece: Piece<'_>,
    ) -> Result<(), ReachMapError> {
        let Piece {
            first,
            poses,
            q,
            reached,
        } = piece;
        let joints = arm.joint_count();
        if let Err(QueryError::Target { query, problem }) = self.query_into(poses, q, reached) {
            let query = query.map(|index| first + index);
            return Err(QueryError::Target { query, problem }.into());
        }
        let solved: Vec<usize> = (0..poses.len())
            .filter(|&pose| reached[pose] != Some(false))
            .collect();
        let targets: Vec<Placement<f64>> = solved.iter().map(|&pose| poses[pose]).collect();
        let mut starts = Vec::with_capacity(joints * targets.len());
        for &pose in &solved {
            starts.extend_from_slice(match reached[pose] {
                Some(_) => &q[pose * joints..(pose + 1) * joints],
                None => arm.default_start(),
            });
        }
        let mut found_q = vec![0.0; starts.len()];
        let mut found = vec![PoseOutcome::default(); targets.len()];
        arm.solve_batch_into(&targets, &starts, &mut found_q, &mut found)?;
        for ((&pose, outcome), found_q) in solved.iter().zip(&found).zip(found_q.chunks(joints)) {
            let row = &mut q[pose * joints..(pose + 1) * joints];
            reached[pose] = match outcome.reached {
                true => {
                    row.copy_from_slice(found_q);
                    Some(true)
                }
                false if max_boxes == 0 => None,
                false => match self.decide_checked(arm, None, &poses[pose], max_boxes)? {
                    PoseReach::Reachable(solution) => {
                        row.copy_from_slice(&solution.q);
                        Some(true)
                    }
                    PoseReach::Unreachable => Some(false),
                    PoseReach::Undecided(_) => None,
                },
            };
            if reached[pose] != Some(true) {
                row.fill(f64::NAN);
            }
        }
        Ok(())
    }
}
