//! Queries of a reach map.

use super::super::QueryError;
use super::super::arm::Arm;
use super::super::reachability::Reachability;
use super::ReachMap;
use super::configuration_codes::decode;
use super::data::{ABSENT, EXCLUDED, UNKNOWN, UNREACHABLE};
use super::error::ReachMapError;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::ik::Solution;

/// Content of the cell of a pose.
#[derive(Clone, Debug, PartialEq)]
pub enum CellReach {
    /// No configuration within the joint limits reaches any pose of the cell, whatever the obstacles: it is proven.
    Unreachable,
    /// A configuration reaches the centre of the cell, free of collisions if the arm has a checker.
    Reached {
        /// Configuration, radians or metres, up to 1/65 535 of the joint ranges.
        configuration: Vec<f64>,
    },
    /// Neither a configuration nor a proof was found.
    Unknown,
}

/// Result of [`ReachMap::decide`] for one pose.
#[derive(Clone, Debug)]
pub enum PoseReach {
    /// A configuration reaches the pose. It is free of collisions if the arm has a checker.
    Reachable(Solution),
    /// No configuration within the joint limits reaches the pose, whatever the obstacles.
    Unreachable,
    /// Neither a configuration nor a proof was found; with the closest pose found.
    Undecided(Solution),
}

/// Result of a look-up, with the row of the configuration.
enum Entry {
    Unreachable,
    Row(usize),
    Unknown,
}

impl ReachMap {
    /// Looks up the cell of a pose of the tool, metres.
    ///
    /// A pose outside of the grid is unreachable: the grid contains every position that the tool reaches.
    ///
    /// # Errors
    /// Returns an error for a pose that is not a rigid motion.
    pub fn query(&self, base_from_tool: &Placement<f64>) -> Result<CellReach, QueryError> {
        Ok(match self.entry(None, base_from_tool)? {
            Entry::Unreachable => CellReach::Unreachable,
            Entry::Unknown => CellReach::Unknown,
            Entry::Row(row) => {
                let mut configuration = vec![0.0; self.data.arm.joints.len()];
                self.decode(row, &mut configuration);
                CellReach::Reached { configuration }
            }
        })
    }

    /// Looks up the cells of several poses: `Some(true)` for a reached centre, `Some(false)` for a cell that is proven
    /// unreachable, `None` for an unknown one. Writes configurations into `q`, a row for each pose: NaN if there is none.
    ///
    /// # Errors
    /// Returns an error for a pose that is not a rigid motion, and for slices of the wrong length.
    pub fn query_into(
        &self,
        base_from_tools: &[Placement<f64>],
        q: &mut [f64],
        reached: &mut [Option<bool>],
    ) -> Result<(), QueryError> {
        let joints = self.data.arm.joints.len();
        let lengths = [
            ("q", q.len(), joints * base_from_tools.len()),
            ("reached", reached.len(), base_from_tools.len()),
        ];
        for (what, given, expected) in lengths {
            if given != expected {
                return Err(QueryError::Length {
                    what,
                    given,
                    expected,
                    joints,
                });
            }
        }
        let rows = q.chunks_mut(joints).zip(reached);
        for (index, (pose, (q, reached))) in base_from_tools.iter().zip(rows).enumerate() {
            q.fill(f64::NAN);
            *reached = match self.entry(Some(index), pose)? {
                Entry::Unreachable => Some(false),
                Entry::Unknown => None,
                Entry::Row(row) => {
                    self.decode(row, q);
                    Some(true)
                }
            };
        }
        Ok(())
    }

    /// Centre of the cell of a pose, metres; `None` for a position outside of the grid.
    ///
    /// The pose's position is at most half a position step away along each axis, and its orientation at most 1.1
    /// orientation steps. The orientation is the identity for a goal without orientation.
    #[must_use]
    pub fn cell_centre(&self, base_from_tool: &Placement<f64>) -> Option<Placement<f64>> {
        let (grid, bins) = (self.data.grid(), self.data.bins());
        let cube = grid.cube(grid.cube_at(base_from_tool.translation)?);
        let rotation = bins.centre(bins.bin_at(&base_from_tool.rotation));
        let position = cube.map(|interval| interval.centre);
        Some(Placement::new(rotation, position.into()))
    }

    /// Shares of the orientations at a position that are reached and that are proven unreachable, from 0 to 1, by the bins
    /// of its cube.
    #[must_use]
    pub fn orientation_shares(&self, position: Vector3<f64>) -> [f64; 2] {
        let data = &self.data;
        let block = match data.grid().cube_at(position).map(|cube| data.cubes[cube]) {
            None | Some(EXCLUDED) => return [0.0, 1.0],
            Some(ABSENT) => return [0.0; 2],
            Some(block) => block as usize,
        };
        let bins = data.bins().count();
        let cells = &data.cells[block * bins..(block + 1) * bins];
        let share = |kind: fn(u32) -> bool| {
            cells.iter().filter(|&&cell| kind(cell)).count() as f64 / bins as f64
        };
        [
            share(|cell| cell < UNKNOWN),
            share(|cell| cell == UNREACHABLE),
        ]
    }

    /// Decides whether the map's arm reaches a pose: by the map, then by exact inverse kinematics from the cell's
    /// configuration, then by a proof of at most `max_boxes` boxes as [`Arm::reachability`].
    ///
    /// # Errors
    /// Returns an error for a pose that is not a rigid motion, and for an arm that differs from the map's.
    pub fn decide(
        &self,
        arm: &Arm,
        base_from_tool: &Placement<f64>,
        max_boxes: usize,
    ) -> Result<PoseReach, ReachMapError> {
        self.check_arm(arm)?;
        Ok(self.decide_checked(arm, None, base_from_tool, max_boxes)?)
    }

    /// [`decide`](Self::decide) for an arm that was compared with the map's.
    pub(super) fn decide_checked(
        &self,
        arm: &Arm,
        query: Option<usize>,
        base_from_tool: &Placement<f64>,
        max_boxes: usize,
    ) -> Result<PoseReach, QueryError> {
        let mut start = arm.default_start().to_vec();
        match self.entry(query, base_from_tool)? {
            Entry::Unreachable => return Ok(PoseReach::Unreachable),
            Entry::Row(row) => self.decode(row, &mut start),
            Entry::Unknown => {}
        }
        let answer = arm.reachability(*base_from_tool, &start, max_boxes)?;
        Ok(match answer {
            Reachability::Reachable(solution) => PoseReach::Reachable(solution),
            Reachability::Unreachable { .. } => PoseReach::Unreachable,
            Reachability::Undecided { closest, .. } => PoseReach::Undecided(closest),
        })
    }

    fn entry(&self, query: Option<usize>, pose: &Placement<f64>) -> Result<Entry, QueryError> {
        if let Err(problem) = pose.check_rigid(0.9e-6) {
            return Err(QueryError::Target { query, problem });
        }
        let data = &self.data;
        let Some(cube) = data.grid().cube_at(pose.translation) else {
            return Ok(Entry::Unreachable);
        };
        let block = match data.cubes[cube] {
            EXCLUDED => return Ok(Entry::Unreachable),
            ABSENT => return Ok(Entry::Unknown),
            block => block as usize,
        };
        let bins = data.bins();
        let cell = block * bins.count() + bins.bin_at(&pose.rotation);
        Ok(match data.cells[cell] {
            UNREACHABLE => Entry::Unreachable,
            UNKNOWN => Entry::Unknown,
            row => Entry::Row(row as usize),
        })
    }

    fn decode(&self, row: usize, q: &mut [f64]) {
        let arm = &self.data.arm;
        let codes = &self.data.configurations[row * q.len()..(row + 1) * q.len()];
        let limits = arm.lower.iter().zip(&arm.upper);
        for ((value, code), (lower, upper)) in q.iter_mut().zip(codes).zip(limits) {
            *value = decode(*code, *lower, *upper);
        }
    }
}
