//! Batch operations for whole paths: continuation of many configurations, attempts at one target, null-space data.

use super::QueryError;
use super::arm::Arm;
use super::distances::pose_distance;
use super::general_solver::append_general_attempts;
use super::move_bounds::bound_by_limits;
use super::query::Query;
use crate::simd_ik::{Attempts, Prefer, Work};
use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::model::Source;
use kinopt_kinematics::spatial::Placement;

pub(crate) use crate::simd_ik::PoseOutcome;

/// End configurations of several attempts, in sequence, and their outcomes.
#[derive(Debug, Default)]
pub(crate) struct Ends {
    pub(crate) q: Vec<f64>,
    pub(crate) outcomes: Vec<PoseOutcome>,
}

/// Joint of the chain, base to tip, as needed to bound the tool's motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainMotion {
    pub(crate) slides: bool,
    /// Index of the arm's joint that drives it: the value is ratio × variable + offset.
    pub(crate) variable: usize,
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
    /// Length of the constant translation to the next joint, or to the tool, metres.
    pub(crate) length_after: f64,
}

impl Arm {
    /// Continues each start to its target by one attempt.
    pub(crate) fn continue_all(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        ends: &mut Ends,
    ) -> Result<(), QueryError> {
        let n = self.joint_count();
        refill(&mut ends.q, targets.len() * n, 0.0);
        refill(&mut ends.outcomes, targets.len(), PoseOutcome::default());
        let Some(simd_solver) = &self.simd_solver else {
            let queries = targets.iter().zip(starts.chunks_exact(n));
            let ends = ends.q.chunks_exact_mut(n).zip(&mut ends.outcomes);
            for ((target, start), (q, outcome)) in queries.zip(ends) {
                run_general_attempts(self, target, start, 0, 1, |end, result| {
                    q.copy_from_slice(end);
                    *outcome = *result;
                })?;
            }
            return Ok(());
        };
        simd_solver.run(Work {
            targets,
            starts,
            search: Prefer::Start,
            attempts: Attempts::UpTo(1),
            deadline: None,
            q: &mut ends.q,
            outcomes: &mut ends.outcomes,
        });
        Ok(())
    }

    /// Continues each start to one target by one attempt, to within about 1e-4 of the arm's length.
    ///
    /// That is close enough to continue from there.
    pub(crate) fn carry_all(
        &self,
        target: &Placement<f64>,
        starts: &[f64],
        ends: &mut Ends,
    ) -> Result<(), QueryError> {
        let count = starts.len() / self.joint_count();
        let Some(simd_solver) =
            (self.simd_solver.as_ref()).filter(|_| self.options.goal.is_full_pose())
        else {
            return self.continue_all(&vec![*target; count], starts, ends);
        };
        refill(&mut ends.q, starts.len(), 0.0);
        refill(&mut ends.outcomes, count, PoseOutcome::default());
        simd_solver.run(Work {
            targets: std::slice::from_ref(target),
            starts,
            search: Prefer::Start,
            attempts: Attempts::Continued,
            deadline: None,
            q: &mut ends.q,
            outcomes: &mut ends.outcomes,
        });
        Ok(())
    }

    /// Runs attempts `first`, `first + 1`, … at one target.
    pub(crate) fn attempt_several(
        &self,
        target: &Placement<f64>,
        start: &[f64],
        first: u32,
        count: u32,
        ends: &mut Ends,
    ) -> Result<(), QueryError> {
        ends.q.clear();
        ends.outcomes.clear();
        let (q, outcomes) = (&mut ends.q, &mut ends.outcomes);
        if let Some(simd_solver) = &self.simd_solver {
            q.resize(count as usize * self.joint_count(), 0.0);
            outcomes.resize(count as usize, PoseOutcome::default());
            simd_solver.run(Work {
                targets: std::slice::from_ref(target),
                starts: start,
                search: Prefer::Start,
                attempts: Attempts::From(first),
                deadline: None,
                q,
                outcomes,
            });
            return Ok(());
        }
        run_general_attempts(self, target, start, first, count, |end, result| {
            q.extend_from_slice(end);
            outcomes.push(*result);
        })
    }

    /// Radians that a radian or metre of each joint counts as.
    #[must_use]
    pub(crate) fn scales(&self) -> &[f64] {
        &self.scale
    }

    /// True if the goal leaves a null space.
    #[must_use]
    pub(crate) fn is_redundant(&self) -> bool {
        self.has_null_space()
    }

    /// Number of joints beyond the rows of the goal.
    #[must_use]
    pub(crate) fn spare_joints(&self) -> usize {
        self.joint_count().saturating_sub(self.options.goal.rows())
    }

    /// Flags of the prismatic joints.
    pub(crate) fn slides(&self) -> Vec<bool> {
        let (model, map) = (&self.serial.model, &self.serial.map);
        let joint = |&c: &usize| &model.joints()[model.moving_joints()[c].index()];
        map.leaders()
            .iter()
            .map(|c| joint(c).kind.slides())
            .collect()
    }

    /// Distance of two poses in radians; metres convert by the arm's weight.
    pub(crate) fn apart(&self, a: &Placement<f64>, b: &Placement<f64>) -> f64 {
        pose_distance(self, a, b)
    }

    /// Errors at a configuration against a target: metres, radians, and true if both are within tolerance.
    pub(crate) fn errors_at(
        &self,
        target: &Placement<f64>,
        q: &[f64],
    ) -> Result<(f64, f64, bool), QueryError> {
        self.with_workspace(|workspace| {
            workspace.set_target(target);
            let errors = workspace.judge(q);
            (errors.position, errors.orientation, errors.reached)
        })
    }

    /// Distance of a target from the chain's base and the chain's reach, metres; `None` unless it is proven
    /// unreachable.
    pub(crate) fn falls_short(&self, target: &Placement<f64>) -> Option<(f64, f64)> {
        if !self.options.goal.is_exact_in_position() {
            return None;
        }
        let anchor = self.names.anchors.first().and_then(Option::as_ref)?;
        let tolerance = self.options.position_tolerance;
        anchor.falls_short_of(
            target.translation,
            kinopt_kinematics::spatial::Vector3::zero(),
            tolerance,
        )
    }

    /// Writes the Jacobian of the goal's residual at q, six rows per joint, in the arm's weights.
    pub(crate) fn write_slopes(
        &self,
        target: &Placement<f64>,
        q: &[f64],
        slopes: &mut [f64],
    ) -> Result<(), QueryError> {
        if let (Some(simd_solver), true) = (&self.simd_solver, self.options.goal.is_full_pose()) {
            simd_solver.write_twists(q, self.options.metres_per_radian, slopes);
            return Ok(());
        }
        self.with_workspace(|workspace| {
            workspace.set_target(target);
            workspace.linearise(q);
            slopes.copy_from_slice(workspace.jacobian.as_slice());
        })
    }

    /// Joints of the chain, base to tip.
    pub(crate) fn chain_motions(&self) -> Vec<ChainMotion> {
        let (model, map) = (&self.serial.model, &self.serial.map);
        let length = |id: kinopt_kinematics::model::JointId| {
            let placement = &model.joints()[id.index()].parent_from_joint;
            placement.translation.norm()
        };
        let ids = model.moving_joints();
        let tool = &model.frames()[self.serial.tool.index()].joint_from_frame;
        let joints = ids.iter().zip(map.sources()).enumerate();
        let motions = joints.filter_map(|(index, (id, source))| match *source {
            Source::Variable {
                variable,
                ratio,
                offset,
            } => Some(ChainMotion {
                slides: model.joints()[id.index()].kind.slides(),
                variable,
                ratio,
                offset,
                length_after: match ids.get(index + 1) {
                    Some(&next) => length(next),
                    None => tool.translation.norm(),
                },
            }),
            Source::Constant(_) | Source::Rotation { .. } => None,
        });
        motions.collect()
    }
}

/// Runs attempts `first`, `first + 1`, … with the general solver, in sequence.
fn run_general_attempts(
    arm: &Arm,
    target: &Placement<f64>,
    start: &[f64],
    first: u32,
    count: u32,
    mut record: impl FnMut(&[f64], &PoseOutcome),
) -> Result<(), QueryError> {
    let query = Query {
        target,
        start,
        deadline: None,
    };
    arm.with_workspace(|workspace| {
        workspace.set_target(target);
        bound_by_limits(arm, workspace);
        workspace.start.copy_from_slice(start);
        workspace.attempt_ends.clear();
        workspace.outcomes.clear();
        append_general_attempts(arm, workspace, &query, first, count);
        for index in 0..workspace.outcomes.len() {
            record(workspace.attempt_end(index), &workspace.outcomes[index]);
        }
    })
}

#[cfg(all(test, feature = "urdf"))]
mod tests {
    use super::{Arm, Ends};
    use kinopt_kinematics::random::mix;
    use kinopt_kinematics::spatial::{Placement, Vector3, rotation_exp};
    use kinopt_robot::robot::Robot;

    /// Continued configurations stay within limits and end near their target.
    ///
    /// Nearly all starts that a full attempt brings to the target are also continued there.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn continued_starts_end_near_the_target() {
        let robot = Robot::read("../../models/franka_panda.urdf").unwrap();
        let arm = Arm::new(&robot, "base", "tool").unwrap();
        let (n, mut state) = (arm.joint_count(), 7);
        let mut unit = || {
            state = mix(state);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut carried, mut closer) = (Ends::default(), Ends::default());
        let (mut reached, mut reached_by_both) = (0, 0);
        for case in 0..200 {
            let starts: Vec<f64> = (0..3)
                .flat_map(|_| arm.limits())
                .map(|l| l.lower + (1.1 * unit() - 0.05).clamp(0.0, 1.0) * (l.upper - l.lower))
                .collect();
            let start_pose = arm.base_from_tool(&starts[..n]).unwrap();
            let max_offset = if case % 4 == 0 { 3.0 } else { 0.03 };
            let mut offset = || Vector3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) * max_offset;
            let target = Placement::new(
                start_pose.rotation * rotation_exp(offset()),
                start_pose.translation + offset(),
            );
            arm.carry_all(&target, &starts, &mut carried).unwrap();
            arm.continue_all(&[target; 3], &starts, &mut closer)
                .unwrap();
            for index in 0..3 {
                let [is_carried, is_reached] =
                    [&carried, &closer].map(|ends| ends.outcomes[index].reached);
                (reached, reached_by_both) = (
                    reached + usize::from(is_reached),
                    reached_by_both + usize::from(is_carried && is_reached),
                );
                let q = &carried.q[index * n..(index + 1) * n];
                let mut limits = arm.limits().zip(q);
                assert!(
                    limits.all(|(l, q)| l.lower <= *q && *q <= l.upper),
                    "{case}"
                );
                if is_carried {
                    let (metres, radians, _) = arm.errors_at(&target, q).unwrap();
                    assert!(
                        metres < 4e-4 && radians < 4e-4,
                        "{case}: {metres} {radians}"
                    );
                }
            }
        }
        assert!(
            reached > 150 && reached_by_both > reached * 98 / 100,
            "{reached} {reached_by_both}"
        );
    }

    /// Many equal starts, more than lanes: every start has its full number of steps.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn continuation_takes_all_steps_of_each_start() {
        let robot = Robot::read("../../models/franka_panda.urdf").unwrap();
        let arm = Arm::new(&robot, "base", "tool").unwrap();
        let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
        let start_pose = arm.base_from_tool(&start).unwrap();
        let offset = Vector3::new(0.1, 0.05, -0.1);
        let target = Placement::new(
            start_pose.rotation * rotation_exp(offset),
            start_pose.translation + offset,
        );
        let mut ends = Ends::default();
        arm.carry_all(&target, &start.repeat(4000), &mut ends)
            .unwrap();
        assert!(ends.outcomes.iter().all(|end| end.reached));
    }
}
