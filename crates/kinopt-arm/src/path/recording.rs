//! Recording of a joint path and its report: length, reconfigurations, unreached points, collisions and deviation.

use super::cartesian_path::CartesianPath;
use super::deviation::{self, PathStep};
use super::error::PathError;
use super::knot_configurations::KnotPath;
use super::knots::Knots;
use super::path_report::{Blocked, MissReason, Missed, PathReport};
use super::shorten::step_length;
use super::solver::PathSolver;
use crate::arm::{JointJump, JointPath};

impl PathSolver<'_> {
    /// Reports on a joint path. The knots in `touching` are in collision.
    pub(super) fn record(
        &self,
        path: &CartesianPath,
        knots: &Knots,
        joint_path: &KnotPath,
        touching: &[usize],
    ) -> Result<JointPath<PathReport>, PathError> {
        let n = self.tools.primary().joint_count();
        let weights = self.weights();
        let count = path.points.len();
        let mut solution = JointPath::<PathReport> {
            nq: n,
            ..JointPath::default()
        };
        let mut steps = Vec::new();
        for knot in 0..knots.len() {
            let q = joint_path.row(knot, n);
            // A cyclic path repeats its first point at the end.
            if knot < count {
                solution.q.extend_from_slice(q);
                let in_contact = touching.binary_search(&knot).is_ok();
                if let Some(missed) = self.missed(knots, knot, joint_path, in_contact)? {
                    solution.report.missed.push(missed);
                }
            }
            if let Some(from) = knot.checked_sub(1) {
                let row = knot % count;
                let before = joint_path.row(from, n);
                solution.report.length += step_length(before, q, &weights);
                if !joint_path.joined[knot] {
                    let (joint, distance) = self.longest_move(before, q);
                    solution.jumps.push(JointJump {
                        index: row,
                        joint,
                        distance,
                        reconfiguration: true,
                    });
                } else {
                    self.check_step(&mut solution.report.blocked, row, before, q)?;
                    if joint_path.reached[from]
                        && joint_path.reached[knot]
                        && knots.has_segment_to(knot)
                    {
                        steps.push(PathStep {
                            row,
                            points: [from, row],
                            q: [before, q],
                        });
                    }
                }
            }
        }
        let missed = solution.report.missed.iter().map(|missed| missed.index);
        let blocked = solution.report.blocked.iter().map(|blocked| blocked.index);
        solution.unreached = missed.chain(blocked).collect();
        solution.unreached.sort_unstable();
        solution.unreached.dedup();
        solution.report.largest_deviation = deviation::largest(&self.tools, path, &steps)?;
        Ok(solution)
    }

    #[cfg(feature = "collision")]
    fn check_step(
        &self,
        blocked: &mut Vec<Blocked>,
        index: usize,
        from: &[f64],
        to: &[f64],
    ) -> Result<(), PathError> {
        if let Some(by) = self.tools.primary().motion_collision(from, to)? {
            blocked.push(Blocked { index, by });
        }
        Ok(())
    }

    #[cfg(not(feature = "collision"))]
    #[expect(clippy::unused_self, reason = "nothing is in the way")]
    fn check_step(
        &self,
        _blocked: &mut Vec<Blocked>,
        _index: usize,
        _from: &[f64],
        _to: &[f64],
    ) -> Result<(), PathError> {
        Ok(())
    }

    /// Returns the reason if a point is unreached or in collision.
    fn missed(
        &self,
        knots: &Knots,
        knot: usize,
        joint_path: &KnotPath,
        in_contact: bool,
    ) -> Result<Option<Missed>, PathError> {
        if joint_path.reached[knot] && !in_contact {
            return Ok(None);
        }
        let arm = self.tools.arm(knots.tool(knot));
        let q = joint_path.row(knot, arm.joint_count());
        #[cfg(feature = "collision")]
        let touching = match in_contact {
            true => arm.touching(q)?.into_iter().next(),
            false => None,
        };
        #[cfg(not(feature = "collision"))]
        let touching = None;
        let target = &knots.targets[knot];
        let (position_error, orientation_error, reached) = arm.errors_at(target, q)?;
        let reason = match (arm.falls_short(target), touching) {
            (Some((distance, reach)), _) => MissReason::BeyondReach { distance, reach },
            (None, Some(collision)) if reached => MissReason::Touches(collision),
            _ => MissReason::NotFound,
        };
        Ok(Some(Missed {
            index: knot,
            position_error,
            orientation_error,
            reason,
        }))
    }

    fn longest_move(&self, from: &[f64], to: &[f64]) -> (usize, f64) {
        let scales = self.tools.primary().scales();
        let moves = from.iter().zip(to).zip(scales);
        let moves = moves.map(|((a, b), scale)| (a - b).abs() * scale);
        let longest = moves.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        longest.unwrap_or((0, 0.0))
    }
}
