//! Placement of an arm's base for a set of goals.

use super::super::QueryError;
use super::super::arm::Arm;
use super::ReachMap;
use super::error::ReachMapError;
use super::query::CellReach;
use kinopt_kinematics::spatial::Placement;

/// A candidate placement of a base with the goals that the arm reaches from it.
#[derive(Clone, Debug, PartialEq)]
pub struct BasePlacement {
    /// Index among the candidates.
    pub candidate: usize,
    /// Number of goals that exact inverse kinematics reaches.
    pub reached: usize,
    /// Number of goals that the map proves unreachable.
    pub unreachable: usize,
    /// Configurations of all goals in sequence, radians or metres; NaN for a goal that is not reached.
    pub q: Vec<f64>,
}

/// Goals of a candidate by their cells.
struct Count {
    candidate: usize,
    reached: usize,
    unreachable: usize,
}

impl ReachMap {
    /// Ranks candidate placements of the arm's base by the number of goals that the arm reaches.
    ///
    /// `world_from_tools` are the goals and `world_from_bases` the candidates, metres. The map ranks all candidates by
    /// reached cells, then by fewest unreachable ones. Exact inverse kinematics then solves the goals of the best `exact`
    /// candidates. The result holds these, most reached goals first; those of equal number in the order of the map.
    /// The arm's obstacles, if any, move with the base.
    ///
    /// # Errors
    /// Returns an error for placements that are not rigid motions, and for an arm that differs from the map's.
    pub fn place_base(
        &self,
        arm: &Arm,
        world_from_tools: &[Placement<f64>],
        world_from_bases: &[Placement<f64>],
        exact: usize,
    ) -> Result<Vec<BasePlacement>, ReachMapError> {
        self.check_arm(arm)?;
        let mut counts = Vec::with_capacity(world_from_bases.len());
        for (index, base) in world_from_bases.iter().enumerate() {
            if let Err(problem) = base.check_rigid(0.9e-6) {
                return Err(ReachMapError::Base { index, problem });
            }
            counts.push(self.count(index, base, world_from_tools)?);
        }
        counts.sort_by_key(|count| (usize::MAX - count.reached, count.unreachable));
        counts.truncate(exact);
        let placements: Result<Vec<_>, ReachMapError> = counts
            .iter()
            .map(|count| self.solve_goals(arm, count, world_from_tools, world_from_bases))
            .collect();
        let mut placements = placements?;
        placements.sort_by_key(|placement| usize::MAX - placement.reached);
        Ok(placements)
    }

    fn count(
        &self,
        candidate: usize,
        world_from_base: &Placement<f64>,
        world_from_tools: &[Placement<f64>],
    ) -> Result<Count, QueryError> {
        let base_from_world = world_from_base.inverse();
        let (mut reached, mut unreachable) = (0, 0);
        for tool in world_from_tools {
            match self.query(&(base_from_world * *tool))? {
                CellReach::Reached { .. } => reached += 1,
                CellReach::Unreachable => unreachable += 1,
                CellReach::Unknown => {}
            }
        }
        Ok(Count {
            candidate,
            reached,
            unreachable,
        })
    }

    fn solve_goals(
        &self,
        arm: &Arm,
        count: &Count,
        world_from_tools: &[Placement<f64>],
        world_from_bases: &[Placement<f64>],
    ) -> Result<BasePlacement, ReachMapError> {
        let base_from_world = world_from_bases[count.candidate].inverse();
        let goals: Vec<Placement<f64>> = world_from_tools
            .iter()
            .map(|tool| base_from_world * *tool)
            .collect();
        let mut q = vec![0.0; arm.joint_count() * goals.len()];
        let mut reached = vec![None; goals.len()];
        self.decide_into(arm, &goals, 0, &mut q, &mut reached)?;
        Ok(BasePlacement {
            candidate: count.candidate,
            reached: reached
                .iter()
                .filter(|&&reached| reached == Some(true))
                .count(),
            unreachable: count.unreachable,
            q,
        })
    }
}
