//! Solver of Cartesian paths.

use super::bridge::bridge;
use super::cartesian_path::{CartesianPath, Traversal};
use super::error::PathError;
use super::graph::{EndIndices, Selection, fewest_reconfigurations, without_reconfiguration};
use super::knot_configurations::{self, KnotPath, fill};
use super::knots::Knots;
use super::layers::{Layer, LayerGenerator};
use super::path_report::PathReport;
use super::revolutions::Revolutions;
use super::shorten::{Shortening, length};
use super::sparse_waypoints::{self, Redundancy};
use super::step_bounds::StepBounds;
use super::tools::Tools;
use super::tracked_path;
use crate::arm::{Arm, JointPath};

/// Configurations per station: first pass, first pass of an arm with one redundant joint, last pass; and memory limit,
/// bytes.
const FIRST_PASS_SAMPLES: usize = 64;
const FIRST_PASS_SAMPLES_ONE_REDUNDANT: usize = 96;
const SAMPLES: usize = 256;
const MEMORY_LIMIT: usize = 200_000_000;
/// Maximum number of rounds of shortening.
const SHORTENING_ROUNDS: usize = 12;
/// Maximum number of new selections after steps turn out to connect different branches.
const MAX_RESELECTIONS: usize = 8;
/// Maximum number of times that colliding knots between stations become stations.
const MAX_COLLISION_PASSES: usize = 2;
/// Numbers of points inserted into a long reconfiguration, tried one after the other.
const INSERTED_POINTS: [usize; 3] = [1, 3, 7];
/// Number of points above which a path is not shortened.
const MAX_SHORTENED_KNOTS: usize = 200_000;
/// Maximum number of entries tried for a path with any start.
const MAX_ENTRIES: usize = 8;

/// Solver of Cartesian paths of an arm. [`solve`](Self::solve) checks the options.
#[derive(Clone, Debug)]
pub struct PathSolver<'a> {
    pub(super) tools: Tools<'a>,
    pub(super) weights: Option<Vec<f64>>,
    pub(super) max_step: f64,
    pub(super) times_count: bool,
    pub(super) samples: usize,
    pub(super) start: Option<Vec<f64>>,
    pub(super) end: Option<Vec<f64>>,
}

/// Joint path with its knots.
struct SolvedPath {
    knots: Knots,
    joint_path: KnotPath,
    /// Knots in collision, ascending.
    touching: Vec<usize>,
}

/// Number of knots in collision, of unreached knots, and of reconfigurations. Smaller is better.
fn rank(joint_path: &KnotPath, touching: &[usize]) -> (usize, (usize, usize)) {
    (touching.len(), joint_path.rank())
}

impl<'a> PathSolver<'a> {
    /// Creates a solver for an arm.
    ///
    /// The tolerances, goal bounds and collision avoidance of the arm apply. Its search, posture and joint step limits
    /// do not.
    #[must_use]
    pub fn new(arm: &'a Arm) -> Self {
        Self {
            tools: Tools::new(arm),
            weights: None,
            max_step: 0.2,
            times_count: false,
            samples: SAMPLES,
            start: None,
            end: None,
        }
    }

    /// Sets the weight of a radian or metre of each joint in lengths: one positive number per joint. Default 1 for
    /// all.
    #[must_use]
    pub fn with_joint_weights(mut self, weights: &[f64]) -> Self {
        self.weights = Some(weights.to_vec());
        self
    }

    /// Sets the largest joint displacement between two points on the same branch, radians; positive. Default 0.2.
    ///
    /// Prismatic joints are scaled by the [metres per radian](crate::arm::ArmBuilder::with_metres_per_radian).
    /// Longer displacements are allowed only for a long tool segment that can be followed in small parts, each at
    /// most half of this limit.
    #[must_use]
    pub fn with_max_step(mut self, radians: f64) -> Self {
        self.max_step = radians;
        self
    }

    /// Sets whether a step that exceeds a joint's velocity limit, by the path's times, counts as a reconfiguration.
    /// Default false.
    #[must_use]
    pub fn with_times_kept(mut self, kept: bool) -> Self {
        self.times_count = kept;
        self
    }

    /// Sets the maximum number of configurations per station, from 4 to 4096; less for very long paths. Default
    /// 256.
    #[must_use]
    pub fn with_samples(mut self, max_samples: usize) -> Self {
        self.samples = max_samples;
        self
    }

    /// Sets the configuration at the first point, radians or metres. Its tool must be at that point. Default: any.
    ///
    /// The solver also compares the path that [`Arm::track`] finds from there, so the solution is never worse than
    /// that.
    #[must_use]
    pub fn with_start(mut self, q: &[f64]) -> Self {
        self.start = Some(q.to_vec());
        self
    }

    /// Sets the configuration at the last point, radians or metres. Its tool must be at that point. Default: any.
    #[must_use]
    pub fn with_end(mut self, q: &[f64]) -> Self {
        self.end = Some(q.to_vec());
        self
    }

    /// Adds tools, with indices from 1, for [points with tools](CartesianPath::with_tools).
    ///
    /// Each is the [same arm with another tool](Arm::with_tool).
    #[must_use]
    pub fn with_tools(mut self, arms: impl IntoIterator<Item = &'a Arm>) -> Self {
        arms.into_iter().for_each(|arm| self.tools.add(arm));
        self
    }

    /// Solves a path: fewest unreached points first, then fewest reconfigurations, then the shortest joint path.
    ///
    /// # Errors
    /// Returns an error if an option is out of its range, or if a tool does not exist. Returns an error if a given
    /// start or end configuration does not reach its point. An unreachable point is not an error: see
    /// [`PathReport::missed`].
    pub fn solve(&self, path: &CartesianPath) -> Result<JointPath<PathReport>, PathError> {
        self.check(path)?;
        match path.traversal {
            Traversal::Open | Traversal::Cyclic => self.solve_in_order(path),
            Traversal::AnyStart => self.solve_anywhere(path),
        }
    }

    /// Solves an open or a cyclic path.
    fn solve_in_order(&self, path: &CartesianPath) -> Result<JointPath<PathReport>, PathError> {
        let find = |path: &CartesianPath| match path.traversal {
            Traversal::Open | Traversal::AnyStart => self.find_open(path),
            Traversal::Cyclic => self.find_cyclic(path),
        };
        let mut best = find(path)?;
        let bounds = self.bounds();
        for count in INSERTED_POINTS {
            // Additional points can reveal branches that a long step misses.
            let generator = LayerGenerator::new(&self.tools, &best.knots, &bounds, 0);
            let long_steps = sparse_waypoints::long_reconfigurations(&generator, &best.joint_path);
            if long_steps.is_empty() {
                break;
            }
            let (finer, knot_indices) = path.with_points_between(&long_steps, count);
            let other = find(&finer)?;
            let mut joint_path = other.joint_path.through(&knot_indices, &bounds);
            sparse_waypoints::split_untraceable(
                &generator,
                &mut joint_path,
                Redundancy::Interpolated,
            )?;
            let touching = self.touching(&best.knots, &joint_path)?;
            if rank(&joint_path, &touching) < rank(&best.joint_path, &best.touching) {
                (best.joint_path, best.touching) = (joint_path, touching);
            }
        }
        self.record(path, &best.knots, &best.joint_path, &best.touching)
    }

    fn find_open(&self, path: &CartesianPath) -> Result<SolvedPath, PathError> {
        let mut knots = Knots::of(path, &self.tools);
        let mut joint_path = self.best_open(&knots)?;
        let mut touching = self.touching(&knots, &joint_path)?;
        for _ in 0..MAX_COLLISION_PASSES {
            if !knots.add_stations(&touching) {
                break;
            }
            let other = self.best_open(&knots)?;
            let other_touching = self.touching(&knots, &other)?;
            if rank(&other, &other_touching) < rank(&joint_path, &touching) {
                (joint_path, touching) = (other, other_touching);
            }
        }
        self.compare_with_track(SolvedPath {
            knots,
            joint_path,
            touching,
        })
    }

    /// Returns the knots in collision, ascending.
    fn touching(&self, knots: &Knots, joint_path: &KnotPath) -> Result<Vec<usize>, PathError> {
        let (bounds, n) = (self.bounds(), self.tools.primary().joint_count());
        let generator = LayerGenerator::new(&self.tools, knots, &bounds, 0);
        let mut free = Vec::new();
        let mut touching = Vec::new();
        for knot in 0..knots.len() {
            generator.mark_free(knot, joint_path.row(knot, n), true, &mut free)?;
            if free.contains(&false) {
                touching.push(knot);
            }
        }
        Ok(touching)
    }

    /// Returns the best joint path from the first knot to the last.
    ///
    /// Whole revolutions of joints are ignored first. If that result is not perfect, the search is repeated with them.
    fn best_open(&self, knots: &Knots) -> Result<KnotPath, PathError> {
        let arm = self.tools.primary();
        let with_revolutions = |revolutions| self.best_with_revolutions(knots, revolutions);
        let ignored = Revolutions::ignored(arm);
        if !ignored.any_ignored() {
            return with_revolutions(&ignored);
        }
        let joint_path = with_revolutions(&ignored)?;
        if joint_path.rank() == (0, 0) {
            return Ok(joint_path);
        }
        let other = with_revolutions(&Revolutions::counted(arm.joint_count()))?;
        Ok(if other.rank() < joint_path.rank() {
            other
        } else {
            joint_path
        })
    }

    fn best_with_revolutions(
        &self,
        knots: &Knots,
        revolutions: &Revolutions,
    ) -> Result<KnotPath, PathError> {
        let bounds = self.bounds();
        let weights = self.weights();
        let all_samples = self.max_samples(knots);
        // A self-motion has arbitrarily many configurations. Few suffice for most paths, and all are used if few lead
        // to a reconfiguration.
        let redundant_joints = self.tools.primary().spare_joints();
        let first_pass = match redundant_joints {
            0 => all_samples,
            1 => FIRST_PASS_SAMPLES_ONE_REDUNDANT.min(all_samples),
            _ => FIRST_PASS_SAMPLES.min(all_samples),
        };
        let mut best: Option<KnotPath> = None;
        for max_count in [first_pass, all_samples] {
            let mut generator = LayerGenerator::new(&self.tools, knots, &bounds, max_count);
            generator.start = self.start.as_deref();
            generator.end = self.end.as_deref();
            generator.revolutions = revolutions.clone();
            if redundant_joints < 2 {
                // The same number as in the last pass.
                generator.search_threshold = all_samples / 2;
            }
            let layers = generator.layers()?;
            // If no layer is full, a pass with more configurations would give the same result.
            let is_complete = redundant_joints < 2 && !layers.iter().any(|layer| layer.full);
            let last = max_count == all_samples || is_complete;
            let end_indices = EndIndices::default();
            let selection = match last {
                true => fewest_reconfigurations(&generator, &layers, &weights, end_indices, &[]),
                false => {
                    match without_reconfiguration(&generator, &layers, &weights, end_indices, &[]) {
                        Some(selection) => selection,
                        None => continue,
                    }
                }
            };
            let joint_path = self.along(&generator, &layers, (selection, end_indices))?;
            if best
                .as_ref()
                .is_none_or(|best| joint_path.rank() < best.rank())
            {
                best = Some(joint_path);
            }
            if last || best.as_ref().is_some_and(|best| best.rank() == (0, 0)) {
                break;
            }
        }
        best.ok_or(PathError::Empty)
    }

    /// Solves a cyclic path: for each of the first point's configurations, finds the best path back to it.
    fn find_cyclic(&self, path: &CartesianPath) -> Result<SolvedPath, PathError> {
        let knots = Knots::of(path, &self.tools);
        let bounds = self.bounds();
        let mut generator =
            LayerGenerator::new(&self.tools, &knots, &bounds, self.max_samples(&knots));
        generator.start = self.start.as_deref();
        let mut layers = generator.layers()?;
        let weights = self.weights();
        let pairs = generator.close(&mut layers);
        let end_indices = |(first, last)| EndIndices {
            first: Some(first),
            last: Some(last),
        };
        let mut best: Option<(Selection, (usize, usize))> = None;
        for &pair in &pairs {
            let end_indices = end_indices(pair);
            let selection =
                fewest_reconfigurations(&generator, &layers, &weights, end_indices, &[]);
            let better = best.as_ref().is_none_or(|(known, _)| {
                let (a, b) = (selection.cost, known.cost);
                a.0 < b.0 || a.0 == b.0 && a.1 < b.1
            });
            if better {
                best = Some((selection, pair));
            }
        }
        let Some((selection, pair)) = best else {
            return Err(PathError::Empty);
        };
        let (start, end) = generator.closing_ends(&layers, pair.0, pair.1)?;
        if generator.start.is_none() {
            generator.cycle_displacement = Some(
                end.iter()
                    .zip(&start)
                    .map(|(end, start)| end - start)
                    .collect(),
            );
        }
        generator.start = Some(&start);
        generator.end = Some(&end);
        let joint_path = self.along(&generator, &layers, (selection, end_indices(pair)))?;
        let touching = self.touching(&knots, &joint_path)?;
        self.compare_with_track(SolvedPath {
            knots,
            joint_path,
            touching,
        })
    }

    /// Returns the better of a joint path and the one that [`Arm::track`] finds from the given start.
    fn compare_with_track(&self, mut result: SolvedPath) -> Result<SolvedPath, PathError> {
        let Some(start) = &self.start else {
            return Ok(result);
        };
        // For a long path without errors, only the length could improve, by little.
        let is_best = rank(&result.joint_path, &result.touching) == (0, (0, 0));
        if is_best && result.knots.len() > MAX_SHORTENED_KNOTS {
            return Ok(result);
        }
        let bounds = self.bounds();
        let mut generator = LayerGenerator::new(&self.tools, &result.knots, &bounds, 0);
        let (mut joint_path, end) = tracked_path::track(&generator, start, self.end.as_deref())?;
        generator.start = Some(start);
        generator.end = end.as_deref();
        self.refine(&generator, &mut joint_path)?;
        let touching = self.touching(&result.knots, &joint_path)?;
        let weights = self.weights();
        let [known, other] =
            [&result.joint_path, &joint_path].map(|joint_path| length(&joint_path.q, &weights));
        let ranks = [
            (&result.joint_path, &result.touching),
            (&joint_path, &touching),
        ];
        let [known_rank, other_rank] =
            ranks.map(|(joint_path, touching)| rank(joint_path, touching));
        if other_rank < known_rank || other_rank == known_rank && other < known {
            (result.joint_path, result.touching) = (joint_path, touching);
        }
        Ok(result)
    }

    /// Solves a closed path from its best entry. An entry at a reconfiguration saves that reconfiguration.
    fn solve_anywhere(&self, path: &CartesianPath) -> Result<JointPath<PathReport>, PathError> {
        let mut best = self.solve_in_order(&path.entered_at(0))?;
        let breaks: Vec<usize> = best.jumps.iter().map(|r| r.index).collect();
        for entry in breaks.into_iter().take(MAX_ENTRIES) {
            let entry = entry % path.points.len();
            let mut other = self.solve_in_order(&path.entered_at(entry))?;
            other.report.entry = entry;
            let rank = |path: &JointPath<PathReport>| (path.report.missed.len(), path.jumps.len());
            let (a, b) = (rank(&other), rank(&best));
            if a < b || a == b && other.report.length < best.report.length {
                best = other;
            }
        }
        Ok(best)
    }

    /// Expands the selection at the stations to a short joint path through all knots.
    fn along(
        &self,
        generator: &LayerGenerator<'_>,
        layers: &[Layer],
        (mut selection, end_indices): (Selection, EndIndices),
    ) -> Result<KnotPath, PathError> {
        let weights = self.weights();
        let fill = |selection: &Selection| match generator.revolutions.any_ignored() {
            false => fill(generator, layers, selection),
            true => {
                let (layers, selection) = generator.with_revolutions(layers, selection);
                fill(generator, &layers, &selection)
            }
        };
        let mut joint_path = fill(&selection)?;
        // Near configurations of two stations may be on different branches. The selection is then repeated without that
        // step.
        let (mut excluded_edges, mut last) = (
            Vec::new(),
            knot_configurations::false_edges(generator, &selection, &joint_path),
        );
        for _ in 0..MAX_RESELECTIONS {
            if last.is_empty() {
                break;
            }
            excluded_edges.append(&mut last);
            selection =
                fewest_reconfigurations(generator, layers, &weights, end_indices, &excluded_edges);
            let other = fill(&selection)?;
            last = knot_configurations::false_edges(generator, &selection, &other);
            if other.rank() < joint_path.rank() {
                joint_path = other;
            }
        }
        self.refine(generator, &mut joint_path)?;
        Ok(joint_path)
    }

    /// Bridges, joins and shortens the steps of a joint path.
    ///
    /// Reached points and joined steps are preserved, except for long steps that cannot be followed in parts.
    fn refine(
        &self,
        generator: &LayerGenerator<'_>,
        joint_path: &mut KnotPath,
    ) -> Result<(), PathError> {
        let weights = self.weights();
        bridge(generator, joint_path)?;
        sparse_waypoints::join_traceable(generator, joint_path)?;
        // A cyclic path is first shortened between fixed ends. With free ends it could drift far for little gain, which
        // shortens its steps.
        let cycle_displacements = [None, generator.cycle_displacement.as_deref()];
        let cycle_displacements =
            &cycle_displacements[..1 + usize::from(generator.cycle_displacement.is_some())];
        // The rounds need about 300 bytes per point.
        for cycle_displacement in cycle_displacements
            .iter()
            .filter(|_| generator.knots.len() <= MAX_SHORTENED_KNOTS)
        {
            let shortening = Shortening {
                generator,
                weights: &weights,
                rounds: SHORTENING_ROUNDS,
                cycle_displacement: *cycle_displacement,
            };
            shortening.run(joint_path)?;
            // Shortening may have moved a long step off the tool's segment. Bridges have short steps and come first.
            sparse_waypoints::split_untraceable(generator, joint_path, Redundancy::Fixed)?;
            bridge(generator, joint_path)?;
            sparse_waypoints::join_traceable(generator, joint_path)?;
        }
        knot_configurations::rejoin(generator, joint_path);
        sparse_waypoints::split_untraceable(generator, joint_path, Redundancy::Interpolated)
    }

    pub(super) fn weights(&self) -> Vec<f64> {
        let ones = || vec![1.0; self.tools.primary().joint_count()];
        self.weights.clone().unwrap_or_else(ones)
    }

    fn bounds(&self) -> StepBounds {
        let arm = self.tools.primary();
        let speeds = match self.times_count {
            true => arm.velocity_limits().to_vec(),
            false => Vec::new(),
        };
        StepBounds::new(arm, self.max_step, speeds)
    }

    /// Returns the number of configurations per station that fits into memory.
    fn max_samples(&self, knots: &Knots) -> usize {
        let bytes_per_configuration = 4 * self.tools.primary().joint_count() + 2;
        let max_per_station =
            MEMORY_LIMIT / (bytes_per_configuration * knots.stations.len().max(1));
        self.samples.min(max_per_station.max(8))
    }
}
