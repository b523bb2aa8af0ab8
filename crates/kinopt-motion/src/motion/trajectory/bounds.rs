//! Bounds of variables and of their displacements between samples, and a strictly feasible start.

use super::feasible_start::{LimitGroup, groups};
use super::length_limits::LengthLimit;
use kinopt_solver::problem::Problem;

/// Fractions of the displacement bounds and ranges, tried in this order, for a trajectory well within its bounds.
const INTERIOR_FRACTIONS: [f64; 6] = [0.5, 0.9, 0.99, 0.999, 0.999_99, 0.999_999_9];
/// Displacement of a start off its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inward {
    /// Fraction of the distance to a trajectory well within the bounds.
    fraction: f64,
    /// Clearance from the bounds, relative to range and displacement bound, above which a variable is not moved.
    max_clearance: f64,
}

impl Inward {
    /// Moves every variable: the start is only a rough guess.
    pub(super) const ALL_VARIABLES: Self = Self {
        fraction: 0.02,
        max_clearance: f64::INFINITY,
    };
    /// Moves only variables at their bounds, slightly: the start is good.
    pub(super) const ACTIVE_BOUNDS: Self = Self {
        fraction: 0.005,
        max_clearance: 0.0025,
    };
}

/// Bounds that are equal for all samples.
#[derive(Clone, Debug)]
pub(super) struct FrameBounds {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Largest displacement of each variable between samples; infinity for no limit.
    pub(super) max_step: Vec<f64>,
    /// For each variable, whether both bounds are equal.
    pub(super) is_constant: Vec<bool>,
    /// Bounds on several variables together.
    pub(super) lengths: Vec<LengthLimit>,
}

/// Displacement bounds between consecutive samples.
#[derive(Clone, Debug)]
pub(in crate::motion) struct DisplacementLimits {
    /// Bound of each variable; infinity for no limit.
    pub(in crate::motion) max_step: Vec<f64>,
    /// Bounds on several variables together.
    pub(super) lengths: Vec<LengthLimit>,
}

impl DisplacementLimits {
    /// Returns the name of the first joint with a bound on several variables together.
    pub(in crate::motion) fn first_length_limit(&self, problem: &Problem) -> Option<String> {
        let first = self.lengths.first()?.variables[0];
        Some(problem.names().joints[first].clone())
    }
}

/// Variable that cannot get from one fixed sample to the next within its velocity limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooFar {
    pub(super) variable: usize,
}

/// Lower and upper ends of a range at each sample.
type Band = [Vec<f64>; 2];

impl FrameBounds {
    /// Creates the bounds of a problem with displacement bounds.
    pub(super) fn new(problem: &Problem, moves: DisplacementLimits) -> Self {
        let (mut lower, mut upper) = (problem.lower().to_vec(), problem.upper().to_vec());
        let is_constant: Vec<bool> = lower
            .iter()
            .zip(&upper)
            .map(|(low, high)| low >= high)
            .collect();
        let map = problem.parameters();
        for ball in map.balls().iter().filter(|ball| ball.swing.is_some()) {
            // The swing ellipse is within that box.
            lower[ball.variable..ball.variable + 2].fill(f64::NEG_INFINITY);
            upper[ball.variable..ball.variable + 2].fill(f64::INFINITY);
        }
        let mut lengths = LengthLimit::for_balls(map);
        lengths.extend(moves.lengths);
        lengths.sort_by_key(|limit| limit.variables);
        Self {
            is_constant,
            lower,
            upper,
            max_step: moves.max_step,
            lengths,
        }
    }

    /// Returns the range of a variable at each sample from which all other samples can be reached.
    ///
    /// Displacement bounds and ranges are scaled by `fraction`. The range at fixed samples is their value.
    fn band(&self, x: &SampleVariables<'_>, variable: usize, fraction: f64) -> Option<Band> {
        let (low, high) = (self.lower[variable], self.upper[variable]);
        let middle = 0.5 * (low + high);
        let inset = |end: f64| match middle.is_finite() {
            true => middle + fraction * (end - middle),
            false => end,
        };
        let max_step = fraction * self.max_step[variable];
        let frames = x.frames();
        let (mut lower, mut upper) = (vec![inset(low); frames], vec![inset(high); frames]);
        for frame in (0..frames).filter(|&frame| x.fixed[frame]) {
            lower[frame] = x.value(frame, variable);
            upper[frame] = lower[frame];
        }
        let mut narrow = |frame: usize, from: usize| {
            lower[frame] = lower[frame].max(lower[from] - max_step);
            upper[frame] = upper[frame].min(upper[from] + max_step);
        };
        (1..frames).for_each(|frame| narrow(frame, frame - 1));
        (1..frames).rev().for_each(|frame| narrow(frame - 1, frame));
        // The neighbours of a fixed sample show whether it is unreachable.
        let is_feasible = |frame: usize| x.fixed[frame] || lower[frame] <= upper[frame];
        (0..frames).all(is_feasible).then_some([lower, upper])
    }

    /// Projects a trajectory into its bounds and moves it off them. Fixed samples stay.
    ///
    /// # Errors
    /// Returns an error if a variable cannot get from one fixed sample to the next.
    pub(super) fn move_inside(
        &self,
        x: &mut SampleVariables<'_>,
        inward: Inward,
    ) -> Result<(), TooFar> {
        let frames = x.frames();
        for variable in (0..self.max_step.len()).filter(|&variable| self.is_bounded(variable)) {
            let jumps = |frame: usize| {
                let both = x.fixed[frame - 1] && x.fixed[frame];
                let displacement = x.value(frame, variable) - x.value(frame - 1, variable);
                both && displacement.abs() > self.max_step[variable]
            };
            if (1..frames).any(jumps) {
                return Err(TooFar { variable });
            }
            let middle = INTERIOR_FRACTIONS.iter().find_map(|&fraction| {
                let [lower, upper] = self.band(x, variable, fraction)?;
                let between = lower
                    .iter()
                    .zip(&upper)
                    .map(|(low, high)| match (*low, *high) {
                        (f64::NEG_INFINITY, f64::INFINITY) => 0.0,
                        (f64::NEG_INFINITY, high) => high - 1.0,
                        (low, f64::INFINITY) => low + 1.0,
                        (low, high) => 0.5 * (low + high),
                    });
                Some(between.collect::<Vec<f64>>())
            });
            let middle = middle.ok_or(TooFar { variable })?;
            let [lower, upper] = self.band(x, variable, 1.0).ok_or(TooFar { variable })?;
            let unbounded = !(self.lower[variable].is_finite() || self.upper[variable].is_finite());
            for frame in 0..frames {
                if x.fixed[frame] {
                    continue;
                }
                let mut value = x.value(frame, variable).clamp(lower[frame], upper[frame]);
                if frame > 0 {
                    let max_step = self.max_step[variable];
                    let before = x.value(frame - 1, variable);
                    value = value.clamp(before - max_step, before + max_step);
                }
                x.set(frame, variable, value);
            }
            if self.clearance(x, variable) > inward.max_clearance {
                continue;
            }
            let free: Vec<usize> = (0..frames).filter(|&frame| !x.fixed[frame]).collect();
            // A variable with a single allowed value leaves its displacement bounds by staying constant.
            let constant_value = free.first().map_or(0.0, |&frame| x.value(frame, variable));
            let anchored = x.fixed.contains(&true);
            for frame in free {
                let inside = match unbounded && !anchored {
                    true => constant_value,
                    false => middle[frame],
                };
                let value = x.value(frame, variable);
                x.set(frame, variable, value + inward.fraction * (inside - value));
            }
        }
        for limits in groups(&self.lengths) {
            LimitGroup::new(self, limits).move_inside(x, 1.0 - inward.fraction)?;
        }
        Ok(())
    }

    /// Returns the smallest clearance of a trajectory from a variable's bounds, relative to its range and displacement
    /// bound.
    fn clearance(&self, x: &SampleVariables<'_>, variable: usize) -> f64 {
        let (low, high) = (self.lower[variable], self.upper[variable]);
        let range = Some(high - low)
            .filter(|range| range.is_finite())
            .unwrap_or(1.0);
        let max_step = self.max_step[variable];
        let mut clearance = f64::INFINITY;
        for frame in (0..x.frames()).filter(|&frame| !x.fixed[frame]) {
            let value = x.value(frame, variable);
            clearance = clearance
                .min((value - low) / range)
                .min((high - value) / range);
            for neighbour in [frame.wrapping_sub(1), frame + 1] {
                if neighbour < x.frames() && max_step.is_finite() {
                    clearance = clearance
                        .min((max_step - (value - x.value(neighbour, variable)).abs()) / max_step);
                }
            }
        }
        clearance
    }

    fn is_bounded(&self, variable: usize) -> bool {
        let ends = [self.lower[variable], self.upper[variable]];
        !self.is_constant[variable]
            && (ends.iter().any(|end| end.is_finite()) || self.has_step_limit(variable))
    }

    pub(super) fn has_step_limit(&self, variable: usize) -> bool {
        self.max_step[variable].is_finite()
    }
}

/// Variables of consecutive samples, with flags of fixed samples.
#[derive(Debug)]
pub(super) struct SampleVariables<'a> {
    pub(super) x: &'a mut [f64],
    pub(super) fixed: &'a [bool],
}

impl SampleVariables<'_> {
    pub(super) fn frames(&self) -> usize {
        self.fixed.len()
    }

    fn stride(&self) -> usize {
        self.x.len() / self.fixed.len()
    }

    pub(super) fn frame(&self, frame: usize) -> &[f64] {
        let n = self.stride();
        &self.x[frame * n..(frame + 1) * n]
    }

    pub(super) fn frame_mut(&mut self, frame: usize) -> &mut [f64] {
        let n = self.stride();
        &mut self.x[frame * n..(frame + 1) * n]
    }

    pub(super) fn set_variables(&mut self, frame: usize, variables: [usize; 3], values: [f64; 3]) {
        for (variable, value) in variables.into_iter().zip(values) {
            self.set(frame, variable, value);
        }
    }

    fn value(&self, frame: usize, variable: usize) -> f64 {
        self.x[frame * self.stride() + variable]
    }

    fn set(&mut self, frame: usize, variable: usize, value: f64) {
        let index = frame * self.stride() + variable;
        self.x[index] = value;
    }
}

/// Returns the longest displacement that respects a velocity limit in floating-point arithmetic.
///
/// Neither |b − a|, nor its quotient by the time step, nor its product with the sample rate exceeds the limit. `size`
/// bounds the absolute values.
pub(super) fn max_displacement(speed: f64, time_step_s: f64, size: f64) -> f64 {
    let limit = speed * time_step_s * (1.0 - 8.0 * f64::EPSILON);
    let rounding = 2.0 * f64::EPSILON * size;
    (limit - rounding).max(0.0)
}
