//! The solver of paths: its options, and what one solve does.

use super::bridge::bridge;
use super::cartesian_path::{CartesianPath, Course};
use super::deviation::{self, LedStep};
use super::error::PathError;
use super::fill::{self, Way, fill};
use super::graph::{Between, Chosen, fewest_reconfigurations};
use super::knots::Knots;
use super::layers::{Growth, Layer};
use super::shorten::{Shortening, step_length};
use super::solution::{MissReason, Missed, PathSolution, Reconfiguration};
use super::step_bounds::StepBounds;
use super::tools::Tools;
use crate::arm::Arm;
use crate::bad_option::{AT_LEAST_ONE, BadOption, POSITIVE};

/// Configurations that are known of a station at most, and bytes of all.
const SAMPLES: usize = 256;
const MEMORY: usize = 200_000_000;
/// Rounds of shortening.
const ROUNDS: usize = 12;
/// How often it is chosen again where steps turn out to be of two branches.
const CHOICES: usize = 8;
/// Longer paths are left as they were chosen, points.
const LONGEST_SHORTENED: usize = 200_000;
/// Places at which a path that may be entered anywhere is tried.
const ENTRIES: usize = 8;

/// Solves whole paths of an arm. Options are checked when it [solves](Self::solve).
#[derive(Clone, Debug)]
pub struct PathSolver<'a> {
    tools: Tools<'a>,
    weights: Option<Vec<f64>>,
    max_step: f64,
    times_count: bool,
    samples: usize,
    start: Option<Vec<f64>>,
    end: Option<Vec<f64>>,
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
        /// The configuration that the first point is to be reached in, radians or metres. It must stand there. Default: any.
        pub fn with_start(mut self, q: &[f64]) { self.start = Some(q.to_vec()) }
        /// The same of the last point. Default: any.
        pub fn with_end(mut self, q: &[f64]) { self.end = Some(q.to_vec()) }
        /// Other tools, 1 and so on for the [points that are for them](CartesianPath::with_tools): the
        /// [same arm with another](Arm::with_tool).
        pub fn with_tools(mut self, arms: impl IntoIterator<Item = &'a Arm>) {
            arms.into_iter().for_each(|arm| self.tools.add(arm));
        }
    }

    /// Finds joints for a whole path: fewest reconfigurations first, then the shortest.
    ///
    /// # Errors
    /// An option out of its range, a configuration to begin or end with that does not stand there, a tool that there is not. A point
    /// out of reach is none: see [`PathSolution::missed`].
    pub fn solve(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        self.check(path)?;
        match path.course {
            Course::Open => self.solve_open(path),
            Course::Cyclic => self.solve_cyclic(path),
            Course::AnyStart => self.solve_anywhere(path),
        }
    }

    fn solve_open(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        let knots = Knots::of(path, &self.tools);
        let bounds = self.bounds();
        let mut growth = Growth::new(&self.tools, &knots, &bounds, self.most(&knots));
        growth.start = self.start.as_deref();
        growth.end = self.end.as_deref();
        let layers = growth.layers()?;
        let weights = self.weights();
        let between = Between::default();
        let chosen = fewest_reconfigurations(&growth, &layers, &weights, between, &[]);
        let way = self.along(&growth, &layers, (chosen, between))?;
        self.tell(path, &knots, &way)
    }

    /// Round and round: for each of the first point's configurations the best way back to it.
    fn solve_cyclic(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
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
        growth.start = Some(&start);
        growth.end = Some(&end);
        let way = self.along(&growth, &layers, (chosen, between(turn)))?;
        self.tell(path, &knots, &way)
    }

    /// Round once from where that is best: a reconfiguration less, if the path is entered where one would be.
    fn solve_anywhere(&self, path: &CartesianPath) -> Result<PathSolution, PathError> {
        let mut best = self.solve_open(&path.entered_at(0))?;
        let breaks: Vec<usize> = best.reconfigurations.iter().map(|r| r.index).collect();
        for entry in breaks.into_iter().take(ENTRIES) {
            let entry = entry % path.points.len();
            let mut other = self.solve_open(&path.entered_at(entry))?;
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
        let mut way = fill(growth, layers, &chosen)?;
        // Stations are some way apart, and what is near at both may be of two branches: then it is chosen again without that step.
        let (mut apart, mut last) = (Vec::new(), fill::false_edges(growth, &chosen, &way));
        for _ in 0..CHOICES {
            if last.is_empty() {
                break;
            }
            apart.append(&mut last);
            chosen = fewest_reconfigurations(growth, layers, &weights, between, &apart);
            let other = fill(growth, layers, &chosen)?;
            last = fill::false_edges(growth, &chosen, &other);
            if other.rank() < way.rank() {
                way = other;
            }
        }
        bridge(growth, &mut way)?;
        let shortening = Shortening {
            growth,
            weights: &weights,
            rounds: ROUNDS,
        };
        // Its rounds take some 300 bytes a point.
        if growth.knots.len() <= LONGEST_SHORTENED {
            shortening.run(&mut way)?;
            // It has drawn the branches together.
            bridge(growth, &mut way)?;
        }
        fill::keep_ends(growth, &mut way);
        fill::rejoin(growth, &mut way);
        Ok(way)
    }

    /// What is true of a way.
    fn tell(
        &self,
        path: &CartesianPath,
        knots: &Knots,
        way: &Way,
    ) -> Result<PathSolution, PathError> {
        let n = self.tools.own().joint_count();
        let weights = self.weights();
        let count = path.points.len();
        let mut solution = PathSolution {
            joint_count: n,
            ..PathSolution::default()
        };
        let mut steps = Vec::new();
        for knot in 0..knots.len() {
            let q = way.row(knot, n);
            // The first comes again at a cyclic path's end.
            if knot < count {
                solution.q.extend_from_slice(q);
                if let Some(missed) = self.missed(knots, knot, way, knot)? {
                    solution.missed.push(missed);
                }
            }
            if let Some(from) = knot.checked_sub(1) {
                let row = knot % count;
                let before = way.row(from, n);
                let length = step_length(before, q, &weights);
                solution.length += length;
                if !way.joined[knot] {
                    let (joint, distance) = self.longest_move(before, q);
                    solution.reconfigurations.push(Reconfiguration {
                        index: row,
                        joint,
                        distance,
                        length,
                    });
                } else {
                    self.look_between(&mut solution, row, before, q)?;
                    if way.reached[from] && way.reached[knot] && knots.is_led_to(knot) {
                        steps.push(LedStep {
                            row,
                            points: [from, row],
                            q: [before, q],
                        });
                    }
                }
            }
        }
        solution.largest_deviation = deviation::largest(&self.tools, path, &steps)?;
        Ok(solution)
    }

    #[cfg(feature = "collision")]
    fn look_between(
        &self,
        solution: &mut PathSolution,
        index: usize,
        from: &[f64],
        to: &[f64],
    ) -> Result<(), PathError> {
        if let Some(by) = self.tools.own().in_the_way(from, to)? {
            let blocked = super::solution::Blocked { index, by };
            solution.blocked.push(blocked);
        }
        Ok(())
    }

    #[cfg(not(feature = "collision"))]
    #[expect(clippy::unused_self, reason = "nothing is in the way")]
    fn look_between(
        &self,
        _solution: &mut PathSolution,
        _index: usize,
        _from: &[f64],
        _to: &[f64],
    ) -> Result<(), PathError> {
        Ok(())
    }

    /// Why a point is missed, if it is.
    fn missed(
        &self,
        knots: &Knots,
        knot: usize,
        way: &Way,
        index: usize,
    ) -> Result<Option<Missed>, PathError> {
        let arm = self.tools.of(knots.tool(knot));
        let q = way.row(knot, arm.joint_count());
        #[cfg(feature = "collision")]
        let touching = arm.collisions(q)?.into_iter().next();
        #[cfg(not(feature = "collision"))]
        let touching = None;
        if way.reached[knot] && touching.is_none() {
            return Ok(None);
        }
        let target = &knots.targets[knot];
        let (position_error, orientation_error, reached) = arm.errors_at(target, q)?;
        let reason = match (arm.falls_short(target), touching) {
            (Some((distance, reach)), _) => MissReason::BeyondReach { distance, reach },
            (None, Some(by)) if reached => MissReason::Touches(by),
            _ => MissReason::NotFound,
        };
        Ok(Some(Missed {
            index,
            position_error,
            orientation_error,
            reason,
        }))
    }

    fn longest_move(&self, from: &[f64], to: &[f64]) -> (usize, f64) {
        let scales = self.tools.own().scales();
        let moves = from.iter().zip(to).zip(scales);
        let moves = moves.map(|((a, b), scale)| (a - b).abs() * scale);
        let longest = moves.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        longest.unwrap_or((0, 0.0))
    }

    fn weights(&self) -> Vec<f64> {
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

    fn check(&self, path: &CartesianPath) -> Result<(), PathError> {
        self.tools.check(&path.tools)?;
        BadOption::check("max_step", self.max_step, POSITIVE)?;
        BadOption::check("samples", self.samples as f64, AT_LEAST_ONE)?;
        let in_range = (4..=4096).contains(&self.samples);
        if !in_range {
            let allowed = "from 4 to 4096";
            let value = self.samples as f64;
            BadOption::check("samples", value, (|_| false, allowed))?;
        }
        let arm = self.tools.own();
        for (option, values) in [
            ("joint_weights", &self.weights),
            ("start", &self.start),
            ("end", &self.end),
        ] {
            let Some(values) = values else { continue };
            if values.len() != arm.joint_count() {
                return Err(PathError::JointCount {
                    option,
                    given: values.len(),
                    joints: arm.joints().map(str::to_owned).collect(),
                });
            }
        }
        for &weight in self.weights.iter().flatten() {
            BadOption::check("joint_weights", weight, POSITIVE)?;
        }
        if path.course != Course::Open && (self.end.is_some() || self.times_count) {
            return Err(PathError::Conflict(
                "a path that is gone round ends where it begins, and has no times to keep: neither an end nor kept times go with it",
            ));
        }
        if path.course == Course::AnyStart && self.start.is_some() {
            return Err(PathError::Conflict(
                "a path that may be entered anywhere has no start of its own",
            ));
        }
        if self.times_count && path.times.is_empty() {
            return Err(PathError::Conflict(
                "times are to be kept, but the path has none",
            ));
        }
        self.check_end("start", self.start.as_deref(), path, 0)?;
        self.check_end("end", self.end.as_deref(), path, path.points.len() - 1)
    }

    fn check_end(
        &self,
        which: &'static str,
        q: Option<&[f64]>,
        path: &CartesianPath,
        point: usize,
    ) -> Result<(), PathError> {
        let Some(q) = q else { return Ok(()) };
        let tool = path.tools.get(point).copied().unwrap_or(0);
        let arm = self.tools.of(tool);
        // Checks that it is finite.
        arm.base_from_tool(q)?;
        let (metres, radians, reached) = arm.errors_at(&path.points[point], q)?;
        let mut within = q.iter().zip(arm.limits());
        let within = within.all(|(q, limits)| limits.lower <= *q && *q <= limits.upper);
        #[cfg(feature = "collision")]
        let within = within && arm.collisions(q)?.is_empty();
        match reached && within {
            true => Ok(()),
            false => Err(PathError::End {
                which,
                metres,
                radians,
            }),
        }
    }
}
