//! The solver of paths: its options, and what one solve does.

use super::bridge::bridge;
use super::cartesian_path::{CartesianPath, Traversal};
use super::error::PathError;
use super::graph::{Between, Chosen, fewest_reconfigurations, without_reconfiguration};
use super::knot_configurations::{self, Way, fill};
use super::knots::Knots;
use super::layers::{Growth, Layer};
use super::long_steps::{self, Spare};
use super::shorten::{Shortening, length};
use super::solution::PathSolution;
use super::step_bounds::StepBounds;
use super::tools::Tools;
use super::tracked_path;
use super::turns::Turns;
use crate::arm::Arm;

/// Configurations that are known of a station at most, at first and at last, and bytes of all.
const FEW_SAMPLES: usize = 64;
/// The first of an arm with one joint to spare.
const FEW_OF_ONE: usize = 96;
const SAMPLES: usize = 256;
const MEMORY: usize = 200_000_000;
/// Rounds of shortening.
const ROUNDS: usize = 12;
/// How often it is chosen again where steps turn out to be of two branches.
const CHOICES: usize = 8;
/// How often knots between stations that turn out to touch something become stations themselves.
const LOOKS_BETWEEN: usize = 2;
/// Points that are put into a long step in which a branch is left, one time after the other.
const POINTS_BETWEEN: [usize; 3] = [1, 3, 7];
/// Longer paths are left as they were chosen, points.
const LONGEST_SHORTENED: usize = 200_000;
/// Places at which a path that may be entered anywhere is tried.
const ENTRIES: usize = 8;

/// Solves whole paths of an arm. Options are checked when it [solves](Self::solve).
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

/// A way that was found.
struct FoundWay {
    knots: Knots,
    way: Way,
    /// Which knots of it touch something, rising.
    touching: Vec<usize>,
}

/// How much of a way touches something, is missed, and how many branches it leaves: the less the better.
fn rank(way: &Way, touching: &[usize]) -> (usize, (usize, usize)) {
    (touching.len(), way.rank())
}

impl<'a> PathSolver<'a> {
    /// A solver for an arm: its tolerances, its goal (free axes, intervals), what it keeps clear of. Its search, its posture and
    /// its bounds of moves do not count.
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
        /// What a radian or metre of each joint weighs in lengths, one positive number a joint. Default 1 for all.
        pub fn with_joint_weights(mut self, weights: &[f64]) { self.weights = Some(weights.to_vec()) }
        /// The furthest that a joint may move from one point to the next on the same branch, radians (a slide by the
        /// [metres that weigh as much](crate::arm::ArmBuilder::with_metres_per_radian)); positive. Further only where the tool itself goes
        /// far, and small parts of its way, of which none is longer than half of that, lead there. Default 0.2.
        pub fn with_max_step(mut self, radians: f64) { self.max_step = radians }
        /// Whether a step in which a joint would have to move faster than its velocity limit, by the path's times, is a
        /// reconfiguration too. Default false.
        pub fn with_times_kept(mut self, kept: bool) { self.times_count = kept }
        /// How many configurations are known of a place at most, from 4 to 4096; fewer where the path is very long. Default 256.
        pub fn with_samples(mut self, most: usize) { self.samples = most }
        /// The configuration at the first point, radians or metres; its tool must be at that point. The path that [`Arm::track`] finds
        /// from there is among those that are compared, so the solution is never worse. Default: any.
        pub fn with_start(mut self, q: &[f64]) { self.start = Some(q.to_vec()) }
        /// The same of the last point. Default: any.
        pub fn with_end(mut self, q: &[f64]) { self.end = Some(q.to_vec()) }
        /// Other tools, 1 and so on for the [points that are for them](CartesianPath::with_tools): the
        /// [same arm with another](Arm::with_tool).
        pub fn with_tools(mut self, arms: impl IntoIterator<Item = &'a Arm>) {
            arms.into_iter().for_each(|arm| self.tools.add(arm));
        }
    }

    /// Finds joints for a whole path: fewest missed points first, then fewest reconfigurations, then the shortest.
    ///
    /// # Errors
    /// An option out of its range, a configuration to begin or end with that does not stand there, a tool that there is not. A point
    /// out of reach is none: see [`PathSolution::missed`].
    pub fn solve(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        self.check(path)?;
        match path.traversal {
            Traversal::Open | Traversal::Cyclic => self.solve_in_order(path),
            Traversal::AnyStart => self.solve_anywhere(path),
        }
    }

    /// From the first point to the last, and back to the first where that is asked for.
    fn solve_in_order(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        let found = |path: &CartesianPath| match path.traversal {
            Traversal::Open | Traversal::AnyStart => self.find_open(path),
            Traversal::Cyclic => self.find_cyclic(path),
        };
        let mut best = found(path)?;
        let bounds = self.bounds();
        for count in POINTS_BETWEEN {
            // More points on the tool's way show branches that a long step has not found.
            let growth = Growth::new(&self.tools, &best.knots, &bounds, 0);
            let left = long_steps::left(&growth, &best.way);
            if left.is_empty() {
                break;
            }
            let (finer, own) = path.with_points_between(&left, count);
            let other = found(&finer)?;
            let mut way = other.way.through(&own, &bounds);
            long_steps::leave_unled(&growth, &mut way, Spare::GoesAlong)?;
            let touching = self.touching(&best.knots, &way)?;
            if rank(&way, &touching) < rank(&best.way, &best.touching) {
                (best.way, best.touching) = (way, touching);
            }
        }
        self.tell(path, &best.knots, &best.way, &best.touching)
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

    /// Which knots of a way touch something, rising.
    fn touching(&self, knots: &Knots, way: &Way) -> Result<Vec<usize>, PathError> {
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

    /// The best way from the first of the knots to the last: where branches without their whole turns lead to one with turns that leaves
    /// none, that; else what is best with them as well.
    fn best_open(&self, knots: &Knots) -> Result<Way, PathError> {
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

    fn best_by_turns(&self, knots: &Knots, turns: &Turns) -> Result<Way, PathError> {
        let bounds = self.bounds();
        let weights = self.weights();
        let all = self.most(knots);
        // Of a self-motion there may be as many as asked: few are enough for most paths, and all are looked at where a way through few
        // leaves a branch.
        let spare = self.tools.own().spare_joints();
        let few = match spare {
            0 => all,
            1 => FEW_OF_ONE.min(all),
            _ => FEW_SAMPLES.min(all),
        };
        let mut best: Option<Way> = None;
        for most in [few, all] {
            let mut growth = Growth::new(&self.tools, knots, &bounds, most);
            growth.start = self.start.as_deref();
            growth.end = self.end.as_deref();
            growth.turns = turns.clone();
            if spare < 2 {
                // As many as with all.
                growth.looked_for = all / 2;
            }
            let layers = growth.layers()?;
            // Where there was room for all, more would be the same.
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

    /// Round and round: for each of the first point's configurations the best way back to it.
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

    /// The better of a path that was found and the one that [`Arm::track`] finds from the start that is given.
    fn compare_with_track(&self, mut found: FoundWay) -> Result<FoundWay, PathError> {
        let Some(start) = &self.start else {
            return Ok(found);
        };
        // Of a long path whose points are all reached without a reconfiguration the length would not change much.
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

    /// Round once from where that is best: a reconfiguration less, if the path is entered where one would be.
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

    /// From what was chosen at the stations to a short way through all knots.
    fn along(
        &self,
        growth: &Growth<'_>,
        layers: &[Layer],
        (mut chosen, between): (Chosen, Between),
    ) -> Result<Way, PathError> {
        let weights = self.weights();
        let fill = |chosen: &Chosen| match growth.turns.are_left_out() {
            false => fill(growth, layers, chosen),
            true => {
                let (layers, chosen) = growth.with_turns(layers, chosen);
                fill(growth, &layers, &chosen)
            }
        };
        let mut way = fill(&chosen)?;
        // Stations are some way apart, and what is near at both may be of two branches: then it is chosen again without that step.
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

    /// Bridges, joins and shortens what steps it can. Neither a point that is reached nor a step that is joined is lost, but for long steps
    /// that the tool's way does not lead along.
    fn refine(&self, growth: &Growth<'_>, way: &mut Way) -> Result<(), PathError> {
        let weights = self.weights();
        bridge(growth, way)?;
        long_steps::join_led(growth, way)?;
        // Of a ring what is between its ends first: all of it at once may drift far for little, and takes short steps then.
        let rings = [None, growth.ring.as_deref()];
        let rings = &rings[..1 + usize::from(growth.ring.is_some())];
        // Its rounds take some 300 bytes a point.
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
            // It has drawn the branches together, and may have moved a long step off the tool's way.
            // A bridge, whose steps are short, comes first.
            long_steps::leave_unled(growth, way, Spare::Left)?;
            bridge(growth, way)?;
            long_steps::join_led(growth, way)?;
        }
        knot_configurations::rejoin(growth, way);
        long_steps::leave_unled(growth, way, Spare::GoesAlong)
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

    /// Configurations of a station for which there is room.
    fn most(&self, knots: &Knots) -> usize {
        let each = 4 * self.tools.own().joint_count() + 2;
        let room = MEMORY / (each * knots.stations.len().max(1));
        self.samples.min(room.max(8))
    }
}
