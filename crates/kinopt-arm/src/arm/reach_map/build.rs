//! Construction of reach maps, cube by cube.

use super::super::PoseOutcome;
use super::super::Search;
use super::super::arm::Arm;
use super::super::batch::outcomes_of_attempts;
use super::super::construction::with_options;
use super::super::options::Options;
use super::super::reachability::CellSearch;
use super::ReachMap;
use super::configuration_codes::encode;
use super::cube_grid::CubeGrid;
use super::data::{ABSENT, EXCLUDED, ReachMapData, UNKNOWN, UNREACHABLE};
use super::error::ReachMapError;
use super::fingerprint::ArmFingerprint;
use super::orientation_bins::OrientationBins;
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Default edge of a cube, as a fraction of the radius of the ball of all positions.
const STEP_OF_RADIUS: f64 = 0.1;
/// Boxes of the proof for a cube of positions.
const CUBE_BOXES: usize = 64;
/// Default largest number of boxes of the proof for a cell.
const CELL_BOXES: usize = 2;
/// Largest number of cells of a grid.
const MAX_CELLS: f64 = 2_147_483_648.0;

/// Builder of a [`ReachMap`]: resolution, and the work for each cell.
#[derive(Clone, Debug)]
pub struct ReachMapBuilder<'a> {
    arm: &'a Arm,
    position_step: Option<f64>,
    orientation_step: f64,
    attempts: u32,
    max_boxes: usize,
    part: (usize, usize),
}

/// Search for the cells of one map.
struct MapSearch {
    /// The arm with the options of the search.
    arm: Arm,
    start: Vec<f64>,
    proofs: CellSearch,
    grid: CubeGrid,
    bins: OrientationBins,
    attempts: u32,
    max_boxes: usize,
}

/// Cells of one cube, with rows of configurations that count from 0; `None` for a cube that the tool never enters.
type CubeCells = Option<(Vec<u32>, Vec<u16>)>;

impl<'a> ReachMapBuilder<'a> {
    pub(super) fn new(arm: &'a Arm) -> Self {
        Self {
            arm,
            position_step: None,
            orientation_step: std::f64::consts::FRAC_PI_4,
            attempts: 8,
            max_boxes: CELL_BOXES,
            part: (0, 1),
        }
    }

    /// Edge of a cube of positions, metres. The default is a tenth of the radius of the ball that contains all positions.
    #[must_use]
    pub fn with_position_step(mut self, metres: f64) -> Self {
        self.position_step = Some(metres);
        self
    }

    /// Largest width of a bin along each of its three angles, radians. The default is π/4.
    ///
    /// A map has 24·n³ bins of orientations, with n = π/2 divided by the step, rounded up.
    #[must_use]
    pub fn with_orientation_step(mut self, radians: f64) -> Self {
        self.orientation_step = radians;
        self
    }

    /// Largest number of attempts of exact inverse kinematics at the centre of a cell. The default is 8.
    #[must_use]
    pub fn with_attempts(mut self, attempts: u32) -> Self {
        self.attempts = attempts;
        self
    }

    /// Largest number of boxes of joint values in the proof for a cell. The default is 2.
    ///
    /// The proof follows the search for a solution. 0 proves nothing about cells, only about whole cubes.
    #[must_use]
    pub fn with_max_boxes(mut self, max_boxes: usize) -> Self {
        self.max_boxes = max_boxes;
        self
    }

    /// Builds part `part` of `parts` only, for several machines; [`ReachMap::merged`] joins the parts.
    #[must_use]
    pub fn with_part(mut self, part: usize, parts: usize) -> Self {
        self.part = (part, parts);
        self
    }

    /// Builds the map.
    ///
    /// # Errors
    /// Returns an error for an arm or a goal without proofs, for options out of range, and for more than 2³¹ cells.
    pub fn build(&self) -> Result<ReachMap, ReachMapError> {
        self.build_cubes(|search, cubes| cubes.iter().map(|&cube| search.solve(cube)).collect())
    }

    /// Builds the map over the threads of the current rayon pool, bitwise equal to that of [`build`](Self::build).
    ///
    /// # Errors
    /// Returns the errors of [`build`](Self::build).
    #[cfg(feature = "rayon")]
    pub fn build_parallel(&self) -> Result<ReachMap, ReachMapError> {
        use rayon::prelude::*;
        self.build_cubes(|search, cubes| {
            (cubes.par_iter().map(|&cube| search.solve(cube))).collect()
        })
    }

    fn build_cubes(
        &self,
        run: impl FnOnce(&MapSearch, &[usize]) -> Result<Vec<CubeCells>, ReachMapError>,
    ) -> Result<ReachMap, ReachMapError> {
        let search = self.search()?;
        let (part, parts) = self.part;
        if part >= parts {
            return Err(ReachMapError::Part { part, parts });
        }
        let count = search.grid.cubes();
        let of_part: Vec<usize> = (part..count).step_by(parts).collect();
        let found = run(&search, &of_part)?;
        let mut data = ReachMapData {
            arm: ArmFingerprint::of(self.arm)?,
            centre: search.grid.centre.to_array(),
            position_step: search.grid.step,
            cubes_per_axis: search.grid.per_axis as u32,
            bins_per_face: search.bins.per_face as u32,
            cubes: vec![ABSENT; count],
            ..ReachMapData::default()
        };
        for (cube, cells) in of_part.into_iter().zip(found) {
            data.cubes[cube] = match cells {
                None => EXCLUDED,
                Some((rows, codes)) => data.add_block(&rows, &codes),
            };
        }
        Ok(ReachMap { data })
    }

    fn search(&self) -> Result<MapSearch, ReachMapError> {
        let proofs = self.arm.cell_search().ok_or(ReachMapError::NoProofs)?;
        let (centre, radius) = proofs.ball();
        let step = self.position_step.unwrap_or(STEP_OF_RADIUS * radius);
        BadOption::check("position_step", step, POSITIVE)?;
        BadOption::check("orientation_step", self.orientation_step, POSITIVE)?;
        BadOption::check("attempts", f64::from(self.attempts), POSITIVE)?;
        let bins = match self.arm.goal().has_orientation() {
            true => OrientationBins::new(self.orientation_step),
            false => Some(OrientationBins { per_face: 0 }),
        };
        let cubed = |count: f64| count * count * count;
        let cells = cubed(2.0 * radius / step + 1.0)
            * match bins {
                Some(bins) => bins.count() as f64,
                None => 24.0 * cubed(1.0 + 1.6 / self.orientation_step),
            };
        let grid = CubeGrid::around(centre, radius, step);
        let (Some(grid), Some(bins), true) = (grid, bins, cells <= MAX_CELLS) else {
            let allowed = MAX_CELLS;
            return Err(ReachMapError::TooManyCells { cells, allowed });
        };
        let options = Options {
            search: Search::First,
            max_move: None,
            posture: None,
            time_limit: None,
            ..self.arm.options.clone()
        };
        Ok(MapSearch {
            arm: with_options(self.arm, options)?,
            start: self.arm.default_start().to_vec(),
            proofs,
            grid,
            bins,
            attempts: self.attempts,
            max_boxes: self.max_boxes,
        })
    }
}

impl ReachMapData {
    /// Appends the cells of a cube, with rows that count from 0, and returns the number of their block.
    pub(super) fn add_block(&mut self, rows: &[u32], codes: &[u16]) -> u32 {
        let block = self.cells.len() / rows.len();
        let first_row = (self.configurations.len() / self.arm.joints.len()) as u32;
        let cells = rows.iter().map(|&row| match row {
            UNREACHABLE | UNKNOWN => row,
            row => first_row + row,
        });
        self.cells.extend(cells);
        self.configurations.extend_from_slice(codes);
        block as u32
    }
}

impl MapSearch {
    fn solve(&self, cube: usize) -> Result<CubeCells, ReachMapError> {
        let position = self.grid.cube(cube);
        if self.proofs.excludes_cube(&position, CUBE_BOXES) {
            return Ok(None);
        }
        let centre = Vector3::from(position.map(|interval| interval.centre));
        let targets: Vec<Placement<f64>> = (0..self.bins.count())
            .map(|bin| Placement::new(self.bins.centre(bin), centre))
            .collect();
        let joints = self.start.len();
        let mut q = vec![0.0; joints * targets.len()];
        let mut outcomes = vec![PoseOutcome::default(); targets.len()];
        outcomes_of_attempts(
            &self.arm,
            &targets,
            &self.start.repeat(targets.len()),
            self.attempts,
            &mut q,
            &mut outcomes,
        )?;
        let mut rows = vec![UNKNOWN; targets.len()];
        let mut codes = Vec::new();
        let found = outcomes.iter().zip(q.chunks(joints)).enumerate();
        for (bin, (outcome, q)) in found {
            if outcome.reached {
                rows[bin] = (codes.len() / joints) as u32;
                let limits = q.iter().zip(self.arm.limits());
                codes.extend(
                    limits.map(|(&value, limits)| encode(value, limits.lower, limits.upper)),
                );
                continue;
            }
            let orientations = self.bins.bin(bin);
            if (self.proofs).excludes_cell(&position, &orientations, self.max_boxes) {
                rows[bin] = UNREACHABLE;
            }
        }
        Ok(Some((rows, codes)))
    }
}
