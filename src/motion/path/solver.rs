//! Solver of Cartesian paths.

use super::bridge::bridge;
use super::cartesian_path::{CartesianPath, Traversal};
use super::error::PathError;
use super::graph::{Between, Chosen, fewest_reconfigurations, without_reconfiguration};
use super::knot_configurations::{self, KnotPath, fill};
use super::knots::Knots;
use super::layers::{Growth, Layer};
use super::shorten::{Shortening, length};
use super::solution::PathSolution;
use super::sparse_waypoints::{self, Redundancy};
use super::step_bounds::StepBounds;
use super::tools::Tools;
use super::tracked_path;
use super::winding::Turns;
use crate::arm::Arm;

/// Configurations per station: first pass, first pass of an arm with one redundant joint, last pass; and memory limit,
/// bytes.
const FEW_SAMPLES: usize = 64;
const FEW_OF_ONE: usize = 96;
const SAMPLES: usize = 256;
const MEMORY: usize = 200_000_000;
/// Maximum number of rounds of shortening.
const ROUNDS: usize = 12;
/// Maximum number of new selections after steps turn out to connect different branches.
const CHOICES: usize = 8;
/// Maximum number of times that colliding knots between stations become stations.
const LOOKS_BETWEEN: usize = 2;
/// Numbers of points inserted into a long reconfiguration, tried one after the other.
const POINTS_BETWEEN: [usize; 3] = [1, 3, 7];
/// Number of points above which a path is not shortened.
const LONGEST_SHORTENED: usize = 200_000;
/// Maximum number of entries tried for a path with any start.
const ENTRIES: usize = 8;

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
struct FoundWay {
    knots: Knots,
    way: KnotPath,
    /// Knots in collision, ascending.
    touching: Vec<usize>,
}

/// Number of knots in collision, of unreached knots, and of reconfigurations. Smaller is better.
fn rank(way: &KnotPath, touching: &[usize]) -> (usize, (usize, usize)) {
    (touching.len(), way.rank())
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

    setters! {
        /// Sets the weight of a radian or metre of each joint in lengths: one positive number per joint. Default 1 for
        /// all.
        pub fn with_joint_weights(mut self, weights: &[f64]) { self.weights = Some(weights.to_vec()) }
        /// Sets the largest joint displacement between two points on the same branch, radians; positive. Default 0.2.
        ///
        /// Prismatic joints are scaled by the [metres per radian](crate::arm::ArmBuilder::with_metres_per_radian).
        /// Longer displacements are allowed only for a long tool segment that can be followed in small parts, each at
        /// most half of this limit.
        pub fn with_max_step(mut self, radians: f64) { self.max_step = radians }
        /// Sets whether a step that exceeds a joint's velocity limit, by the path's times, counts as a reconfiguration.
        /// Default false.
        pub fn with_times_kept(mut self, kept: bool) { self.times_count = kept }
        /// Sets the maximum number of configurations per station, from 4 to 4096; less for very long paths. Default
        /// 256.
        pub fn with_samples(mut self, most: usize) { self.samples = most }
        /// Sets the configuration at the first point, radians or metres. Its tool must be at that point. Default: any.
        ///
        /// The solver also compares the path that [`Arm::track`] finds from there, so the solution is never worse than
        /// that.
        pub fn with_start(mut self, q: &[f64]) { self.start = Some(q.to_vec()) }
        /// Sets the configuration at the last point, radians or metres. Its tool must be at that point. Default: any.
        pub fn with_end(mut self, q: &[f64]) { self.end = Some(q.to_vec()) }
        /// Adds tools, with indices from 1, for [points with tools](CartesianPath::with_tools).
        ///
        /// Each is the [same arm with another tool](Arm::with_tool).
        pub fn with_tools(mut self, arms: impl IntoIterator<Item = &'a Arm>) {
            arms.into_iter().for_each(|arm| self.tools.add(arm));
        }
    }

    /// Solves a path: fewest unreached points first, then fewest reconfigurations, then the shortest joint path.
    ///
    /// # Errors
    /// Returns an error if an option is out of its range, or if a tool does not exist. Returns an error if a given
    /// start or end configuration does not reach its point. An unreachable point is not an error: see
    /// [`PathSolution::missed`].
    pub fn solve(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        self.check(path)?;
        match path.traversal {
            Traversal::Open | Traversal::Cyclic => self.solve_in_order(path),
            Traversal::AnyStart => self.solve_anywhere(path),
        }
    }

    /// Solves an open or a cyclic path.
    fn solve_in_order(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        let found = |path: &CartesianPath| match path.traversal {
            Traversal::Open | Traversal::AnyStart => self.find_open(path),
            Traversal::Cyclic => self.find_cyclic(path),
        };
        let mut best = found(path)?;
        let bounds = self.bounds();
        for count in POINTS_BETWEEN {
            // Additional points can reveal branches that a long step misses.
            let growth = Growth::new(&self.tools, &best.knots, &bounds, 0);
            let left = sparse_waypoints::left(&growth, &best.way);
            if left.is_empty() {
                break;
            }
            let (finer, own) = path.with_points_between(&left, count);
            let other = found(&finer)?;
            let mut way = other.way.through(&own, &bounds);
            sparse_waypoints::split_untraceable(&growth, &mut way, Redundancy::GoesAlong)?;
            let touching = self.touching(&best.knots, &way)?;
            if rank(&way, &touching) < rank(&best.way, &best.touching) {
                (best.way, best.touching) = (way, touching);
            }
        }
        self.record(path, &best.knots, &best.way, &best.touching)
    }

    fn find_open(&self, path: &CartesianPath) -> Result<FoundWay, PathError> {
        let mut knots = Knots::of(path, &self.tools);
        let mut way = self.best_open(&knots)?;
        let mut touching = self.touching(&knots, &way)?;
        for _ in 0..LOOKS_BETWEEN {
            if !knots.add_stations(&touching) {
                break;
            }
            let other = self.best_open(&knots)?;
            let others = self.touching(&knots, &other)?;
            if rank(&other, &others) < rank(&way, &touching) {
                (way, touching) = (other, others);
            }
        }
        self.compare_with_track(FoundWay {
            knots,
            way,
            touching,
        })
    }

    /// Returns the knots in collision, ascending.
    fn touching(&self, knots: &Knots, way: &KnotPath) -> Result<Vec<usize>, PathError> {
        let (bounds, n) = (self.bounds(), self.tools.own().joint_count());
        let growth = Growth::new(&self.tools, knots, &bounds, 0);
        let mut free = Vec::new();
        let mut touching = Vec::new();
        for knot in 0..knots.len() {
            growth.note_free(knot, way.row(knot, n), true, &mut free)?;
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
        let arm = self.tools.own();
        let with_turns = |turns| self.best_by_turns(knots, turns);
        let left_out = Turns::left_out(arm);
        if !left_out.are_left_out() {
            return with_turns(&left_out);
        }
        let way = with_turns(&left_out)?;
        if way.rank() == (0, 0) {
            return Ok(way);
        }
        let other = with_turns(&Turns::kept(arm.joint_count()))?;
        Ok(if other.rank() < way.rank() {
            other
        } else {
            way
        })
    }

    fn best_by_turns(&self, knots: &Knots, turns: &Turns) -> Result<KnotPath, PathError> {
        let bounds = self.bounds();
        let weights = self.weights();
        let all = self.most(knots);
        // A self-motion has arbitrarily many configurations. Few suffice for most paths, and all are used if few lead
        // to a reconfiguration.
        let spare = self.tools.own().spare_joints();
        let few = match spare {
            0 => all,
            1 => FEW_OF_ONE.min(all),
            _ => FEW_SAMPLES.min(all),
        };
        let mut best: Option<KnotPath> = None;
        for most in [few, all] {
            let mut growth = Growth::new(&self.tools, knots, &bounds, most);
            growth.start = self.start.as_deref();
            growth.end = self.end.as_deref();
            growth.turns = turns.clone();
            if spare < 2 {
                // The same number as in the last pass.
                growth.looked_for = all / 2;
            }
            let layers = growth.layers()?;
            // If no layer is full, a pass with more configurations would give the same result.
            let is_all = spare < 2 && !layers.iter().any(|layer| layer.full);
            let last = most == all || is_all;
            let between = Between::default();
            let chosen = match last {
                true => fewest_reconfigurations(&growth, &layers, &weights, between, &[]),
                false => match without_reconfiguration(&growth, &layers, &weights, between, &[]) {
                    Some(chosen) => chosen,
                    None => continue,
                },
            };
            let way = self.along(&growth, &layers, (chosen, between))?;
            if best.as_ref().is_none_or(|best| way.rank() < best.rank()) {
                best = Some(way);
            }
            if last || best.as_ref().is_some_and(|best| best.rank() == (0, 0)) {
                break;
            }
        }
        best.ok_or(PathError::Empty)
    }

    /// Solves a cyclic path: for each of the first point's configurations, finds the best path back to it.
    fn find_cyclic(&self, path: &CartesianPath) -> Result<FoundWay, PathError> {
        let knots = Knots::of(path, &self.tools);
        let bounds = self.bounds();
        let mut growth = Growth::new(&self.tools, &knots, &bounds, self.most(&knots));
        growth.start = self.start.as_deref();
        let mut layers = growth.layers()?;
        let weights = self.weights();
        let turns = growth.close(&mut layers);
        let between = |(first, last)| Between {
            first: Some(first),
            last: Some(last),
        };
        let mut best: Option<(Chosen, (usize, usize))> = None;
        for &turn in &turns {
            let between = between(turn);
            let chosen = fewest_reconfigurations(&growth, &layers, &weights, between, &[]);
            let better = best.as_ref().is_none_or(|(known, _)| {
                let (a, b) = (chosen.cost, known.cost);
                a.0 < b.0 || a.0 == b.0 && a.1 < b.1
            });
            if better {
                best = Some((chosen, turn));
            }
        }
        let Some((chosen, turn)) = best else {
            return Err(PathError::Empty);
        };
        let (start, end) = growth.closing_ends(&layers, turn.0, turn.1)?;
        if growth.start.is_none() {
            growth.ring = Some(
                end.iter()
                    .zip(&start)
                    .map(|(end, start)| end - start)
                    .collect(),
            );
        }
        growth.start = Some(&start);
        growth.end = Some(&end);
        let way = self.along(&growth, &layers, (chosen, between(turn)))?;
        let touching = self.touching(&knots, &way)?;
        self.compare_with_track(FoundWay {
            knots,
            way,
            touching,
        })
    }

    /// Returns the better of a joint path and the one that [`Arm::track`] finds from the given start.
    fn compare_with_track(&self, mut found: FoundWay) -> Result<FoundWay, PathError> {
        let Some(start) = &self.start else {
            return Ok(found);
        };
        // For a long path without errors, only the length could improve, by little.
        let is_best = rank(&found.way, &found.touching) == (0, (0, 0));
        if is_best && found.knots.len() > LONGEST_SHORTENED {
            return Ok(found);
        }
        let bounds = self.bounds();
        let mut growth = Growth::new(&self.tools, &found.knots, &bounds, 0);
        let (mut way, end) = tracked_path::track(&growth, start, self.end.as_deref())?;
        growth.start = Some(start);
        growth.end = end.as_deref();
        self.refine(&growth, &mut way)?;
        let touching = self.touching(&found.knots, &way)?;
        let weights = self.weights();
        let [known, other] = [&found.way, &way].map(|way| length(&way.q, &weights));
        let ranks = [(&found.way, &found.touching), (&way, &touching)];
        let [known_rank, other_rank] = ranks.map(|(way, touching)| rank(way, touching));
        if other_rank < known_rank || other_rank == known_rank && other < known {
            (found.way, found.touching) = (way, touching);
        }
        Ok(found)
    }

    /// Solves a closed path from its best entry. An entry at a reconfiguration saves that reconfiguration.
    fn solve_anywhere(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        let mut best = self.solve_in_order(&path.entered_at(0))?;
        let breaks: Vec<usize> = best.reconfigurations.iter().map(|r| r.index).collect();
        for entry in breaks.into_iter().take(ENTRIES) {
            let entry = entry % path.points.len();
            let mut other = self.solve_in_order(&path.entered_at(entry))?;
            other.entry = entry;
            let rank =
                |solution: &PathSolution| (solution.missed.len(), solution.reconfigurations.len());
            let (a, b) = (rank(&other), rank(&best));
            if a < b || a == b && other.length < best.length {
                best = other;
            }
        }
        Ok(best)
    }

    /// Expands the selection at the stations to a short joint path through all knots.
    fn along(
        &self,
        growth: &Growth<'_>,
        layers: &[Layer],
        (mut chosen, between): (Chosen, Between),
    ) -> Result<KnotPath, PathError> {
        let weights = self.weights();
        let fill = |chosen: &Chosen| match growth.turns.are_left_out() {
            false => fill(growth, layers, chosen),
            true => {
                let (layers, chosen) = growth.with_turns(layers, chosen);
                fill(growth, &layers, &chosen)
            }
        };
        let mut way = fill(&chosen)?;
        // Near configurations of two stations may be on different branches. The selection is then repeated without that
        // step.
        let (mut apart, mut last) = (
            Vec::new(),
            knot_configurations::false_edges(growth, &chosen, &way),
        );
        for _ in 0..CHOICES {
            if last.is_empty() {
                break;
            }
            apart.append(&mut last);
            chosen = fewest_reconfigurations(growth, layers, &weights, between, &apart);
            let other = fill(&chosen)?;
            last = knot_configurations::false_edges(growth, &chosen, &other);
            if other.rank() < way.rank() {
                way = other;
            }
        }
        self.refine(growth, &mut way)?;
        Ok(way)
    }

    /// Bridges, joins and shortens the steps of a joint path.
    ///
    /// Reached points and joined steps are preserved, except for long steps that cannot be followed in parts.
    fn refine(&self, growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
        let weights = self.weights();
        bridge(growth, way)?;
        sparse_waypoints::join_led(growth, way)?;
        // A cyclic path is first shortened between fixed ends. With free ends it could drift far for little gain, which
        // shortens its steps.
        let rings = [None, growth.ring.as_deref()];
        let rings = &rings[..1 + usize::from(growth.ring.is_some())];
        // The rounds need about 300 bytes per point.
        for ring in rings
            .iter()
            .filter(|_| growth.knots.len() <= LONGEST_SHORTENED)
        {
            let shortening = Shortening {
                growth,
                weights: &weights,
                rounds: ROUNDS,
                ring: *ring,
            };
            shortening.run(way)?;
            // Shortening may have moved a long step off the tool's segment. Bridges have short steps and come first.
            sparse_waypoints::split_untraceable(growth, way, Redundancy::Left)?;
            bridge(growth, way)?;
            sparse_waypoints::join_led(growth, way)?;
        }
        knot_configurations::rejoin(growth, way);
        sparse_waypoints::split_untraceable(growth, way, Redundancy::GoesAlong)
    }

    pub(super) fn weights(&self) -> Vec<f64> {
        let ones = || vec![1.0; self.tools.own().joint_count()];
        self.weights.clone().unwrap_or_else(ones)
    }

    fn bounds(&self) -> StepBounds {
        let arm = self.tools.own();
        let speeds = match self.times_count {
            true => arm.velocity_limits().to_vec(),
            false => Vec::new(),
        };
        StepBounds::new(arm, self.max_step, speeds)
    }

    /// Returns the number of configurations per station that fits into memory.
    fn most(&self, knots: &Knots) -> usize {
        let each = 4 * self.tools.own().joint_count() + 2;
        let room = MEMORY / (each * knots.stations.len().max(1));
        self.samples.min(room.max(8))
    }
}
