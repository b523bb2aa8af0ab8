//! Motion of one joint in control cycles, within limits of position, velocity, acceleration and jerk.
//!
//! All rates are per cycle: a step is `velocity * time_step`, its change `acceleration * time_step²`, and the change of
//! that `jerk * time_step³`. So q′ = q + d′, d′ = d + e′ and |e′ − e| ≤ K. The limits hold for the finite differences
//! of the commanded positions, which robot controllers check.
//!
//! A state is viable if the joint can come to rest from it within all limits. [`JointMotion::braking_change`] is the
//! policy with the earliest stop: it decelerates as much as possible and still releases the deceleration in time. A
//! cycle chooses among the changes after which this policy stops within the limits. The policy's own change is one of
//! them, so a viable state always has a viable successor.

use std::cmp::Ordering;

/// Limits of a joint: positions in radians or metres, rates per control cycle; infinite for none.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct CycleLimits {
    #[doc(hidden)]
    pub lower: f64,
    #[doc(hidden)]
    pub upper: f64,
    /// Largest step D.
    #[doc(hidden)]
    pub step: f64,
    /// Largest change E of a step.
    #[doc(hidden)]
    pub change: f64,
    /// Largest change K of a change.
    #[doc(hidden)]
    pub change_rate: f64,
}

/// Fraction of an acceleration or jerk limit reserved for rounding that accumulates over a stop.
const ROUNDING: f64 = 1e-9;

impl CycleLimits {
    /// Limits per cycle of a joint at `q`, from limits per second, second² and second³.
    ///
    /// They are reduced by the rounding of position differences. `unlimited_step` is the largest step of a joint
    /// without a velocity limit.
    #[doc(hidden)]
    pub fn new(
        [lower, upper]: [f64; 2],
        q: f64,
        time_step: f64,
        [velocity, acceleration, jerk]: [f64; 3],
        unlimited_step: f64,
    ) -> Self {
        let t = time_step;
        let size = |bound: f64| if bound.is_finite() { bound.abs() } else { 1.0 };
        let ulp = f64::EPSILON * size(lower).max(size(upper)).max(q.abs());
        let less = |limit: f64, rounding: f64| (limit * (1.0 - ROUNDING) - rounding).max(0.0);
        let step = match velocity.is_finite() {
            true => velocity * t,
            false => unlimited_step,
        };
        Self {
            lower,
            upper,
            step: (step - ulp).max(0.0),
            change: less(acceleration * t * t, 2.0 * ulp),
            change_rate: less(jerk * t * t * t, 4.0 * ulp),
        }
    }
}

/// State of a joint after a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct JointMotion {
    /// Position, radians or metres.
    #[doc(hidden)]
    pub q: f64,
    /// Last step d.
    #[doc(hidden)]
    pub step: f64,
    /// Last change e of the step.
    #[doc(hidden)]
    pub change: f64,
}

/// Extremes of a stop, relative to its start.
#[derive(Clone, Copy, Debug, Default)]
#[doc(hidden)]
pub struct Stop {
    #[doc(hidden)]
    pub lowest: f64,
    #[doc(hidden)]
    pub highest: f64,
    #[doc(hidden)]
    pub end: f64,
}

/// Largest number of iterations of a one-dimensional search.
const SEARCH_ITERATIONS: usize = 60;
/// Number of cycles after which a stop counts as endless; no robot's limits need as many.
const MAX_STOP_CYCLES: usize = 100_000;
/// Longest stop, in cycles, that is simulated exactly if an estimate suffices.
const MAX_SIMULATED_CYCLES: f64 = 24.0;

/// The integer part of a number of at least 0, below 2⁶³.
///
/// [`f64::floor`] is a call on processors that are not known to have SSE4.1, and takes a tenth of a stop.
fn integer_part(number: f64) -> f64 {
    number as i64 as f64
}

/// Largest first decrement x of a sequence with a total of `total` that decreases by at most `rate` to zero.
///
/// It is the root of x + Σ max(x − k·rate, 0) = total. Zero for a total below zero.
fn first_decrement(total: f64, rate: f64) -> f64 {
    if total <= 0.0 {
        return 0.0;
    }
    if rate >= total {
        return total;
    }
    // Number of decrements after the first.
    let count = integer_part(0.5 * ((1.0 + 8.0 * total / rate).sqrt() - 1.0));
    (total + 0.5 * rate * count * (count + 1.0)) / (count + 1.0)
}

/// Sum of the decrements after the first: Σ max(first − k·rate, 0).
fn later_decrements(first: f64, rate: f64) -> f64 {
    if first <= rate {
        return 0.0;
    }
    let quotient = first / rate;
    let whole = integer_part(quotient);
    let count = if whole < quotient { whole } else { whole - 1.0 };
    count * first - 0.5 * rate * count * (count + 1.0)
}

/// Distance of a release: the sum of the steps that remain after each of the decrements from `first` to zero.
///
/// Step k is Σ max(first − j·rate, 0) over j > k, so the sum is Σ j·max(first − j·rate, 0).
fn release_distance(first: f64, rate: f64) -> f64 {
    if first <= rate {
        return 0.0;
    }
    let count = integer_part(first / rate);
    let pairs = 0.5 * count * (count + 1.0);
    pairs * (first - rate * (2.0 * count + 1.0) / 3.0)
}

impl JointMotion {
    #[doc(hidden)]
    pub fn at_rest(q: f64) -> Self {
        Self {
            q,
            step: 0.0,
            change: 0.0,
        }
    }

    #[doc(hidden)]
    pub fn is_at_rest(&self) -> bool {
        self.step == 0.0 && self.change == 0.0
    }

    /// The state after a cycle whose step changes by `change`.
    #[doc(hidden)]
    pub fn after(&self, change: f64) -> Self {
        let step = self.step + change;
        Self {
            q: self.q + step,
            step,
            change,
        }
    }

    /// The state clamped to the position limits, which it exceeds by rounding only.
    #[doc(hidden)]
    pub fn within(self, limits: &CycleLimits) -> Self {
        let q = self.q.max(limits.lower).min(limits.upper);
        let correction = q - self.q;
        Self {
            q,
            step: self.step + correction,
            change: self.change + correction,
        }
    }

    /// The change of the policy with the earliest stop.
    #[doc(hidden)]
    pub fn braking_change(&self, limits: &CycleLimits) -> f64 {
        let release = first_decrement(self.step.abs(), limits.change_rate);
        self.change_towards_release(release, limits)
    }

    /// The change within the limits that is nearest to the first decrement of a release.
    fn change_towards_release(&self, release: f64, limits: &CycleLimits) -> f64 {
        let CycleLimits {
            change: max_change,
            change_rate: rate,
            ..
        } = *limits;
        let target_change = -release.min(max_change).copysign(self.step);
        if rate.is_infinite() {
            return target_change;
        }
        target_change
            .max(self.change - rate)
            .min(self.change + rate)
            .clamp(-max_change, max_change)
    }

    /// The course of a stop by the braking policy.
    #[doc(hidden)]
    pub fn stop(&self, limits: &CycleLimits) -> Stop {
        let (change, rate) = (limits.change, limits.change_rate);
        let mut stop = Stop::default();
        if change.is_infinite() && rate.is_infinite() {
            return stop;
        }
        if rate.is_infinite() {
            stop.end = later_decrements(self.step.abs(), change).copysign(self.step);
            stop.lowest = stop.end.min(0.0);
            stop.highest = stop.end.max(0.0);
            return stop;
        }
        let mut state = Self { q: 0.0, ..*self };
        // Smaller steps are rounding.
        let negligible = 1e-12 * rate;
        for _ in 0..MAX_STOP_CYCLES {
            let release = first_decrement(state.step.abs(), rate);
            if release <= change && (state.change + release.copysign(state.step)).abs() <= rate {
                state.q += release_distance(release, rate).copysign(state.step);
                break;
            }
            let next = state.change_towards_release(release, limits);
            // Skip cycles at constant full deceleration.
            if next == state.change && next.abs() == change {
                let constant_part = state.step.abs() - later_decrements(change, rate);
                let count = (constant_part / change).floor() - 1.0;
                if count > 1.0 {
                    let distance = count * state.step + 0.5 * next * count * (count + 1.0);
                    state.q += distance;
                    state.step += count * next;
                }
            }
            state = state.after(next);
            stop.lowest = stop.lowest.min(state.q);
            stop.highest = stop.highest.max(state.q);
            if state.step.abs() <= negligible && state.change.abs() <= rate {
                break;
            }
        }
        stop.lowest = stop.lowest.min(state.q);
        stop.highest = stop.highest.max(state.q);
        stop.end = state.q;
        stop
    }

    /// The step after the change is reduced to zero as fast as the jerk limit allows.
    #[doc(hidden)]
    pub fn coasting_step(&self, limits: &CycleLimits) -> f64 {
        let later = later_decrements(self.change.abs(), limits.change_rate);
        self.step + later.copysign(self.change)
    }

    /// The smallest and the largest change of the next cycle after which the joint still stops within its limits.
    #[doc(hidden)]
    pub fn viable_changes(&self, limits: &CycleLimits) -> (f64, f64) {
        let braking = self.braking_change(limits);
        let mut lower = (-limits.change).max(self.change - limits.change_rate);
        let mut upper = limits.change.min(self.change + limits.change_rate);
        // Velocity limits include the speed gained until the acceleration is released.
        let rate = limits.change_rate;
        let up = limits.step - self.step;
        let down = limits.step + self.step;
        upper = upper.min(if up < 0.0 {
            up
        } else {
            first_decrement(up, rate)
        });
        lower = lower.max(if down < 0.0 {
            -down
        } else {
            -first_decrement(down, rate)
        });
        // A bound on the wrong side of braking is rounding, or a joint beyond its velocity limit, which brakes.
        upper = upper.max(braking);
        lower = lower.min(braking);
        upper = self.highest_change(braking, upper, limits);
        let mirrored = Self {
            q: -self.q,
            step: -self.step,
            change: -self.change,
        };
        let opposite = CycleLimits {
            lower: -limits.upper,
            upper: -limits.lower,
            ..*limits
        };
        lower = -mirrored.highest_change(-braking, -lower, &opposite);
        (lower, upper)
    }

    /// The largest change up to `max_change` after which the joint stops before its upper limit; `braking` is known to
    /// be one.
    fn highest_change(&self, braking: f64, max_change: f64, limits: &CycleLimits) -> f64 {
        let distance_to_limit = limits.upper - self.q;
        if distance_to_limit.is_infinite() {
            return max_change;
        }
        if limits.change_rate.is_infinite() {
            // In closed form: the first step and all later ones of a stop.
            let step = match limits.change.is_infinite() {
                true => distance_to_limit,
                false => first_decrement(distance_to_limit, limits.change),
            };
            return max_change.min(step - self.step).max(braking);
        }
        // Far from the limit no stop needs simulation.
        let CycleLimits {
            change: deceleration,
            change_rate: rate,
            ..
        } = *limits;
        let speed_gain = max_change.max(0.0);
        let fastest = (self.step + speed_gain + later_decrements(speed_gain, rate)).max(0.0);
        let cycles = match deceleration.is_infinite() {
            true => 2.0 * (fastest / rate).sqrt() + 3.0,
            false => {
                let ramps = 2.0 * deceleration.min(fastest) / rate;
                fastest / deceleration + ramps + speed_gain / rate + 3.0
            }
        };
        if fastest * cycles < distance_to_limit {
            return max_change;
        }
        let excess = |change: f64| {
            let next = self.after(change);
            self.step + change + next.stop(limits).highest - distance_to_limit
        };
        if excess(max_change) <= 0.0 {
            return max_change;
        }
        let (mut feasible, mut infeasible) = (braking, max_change);
        for _ in 0..SEARCH_ITERATIONS {
            let middle = 0.5 * (feasible + infeasible);
            if middle <= feasible || middle >= infeasible {
                break;
            }
            match excess(middle) <= 0.0 {
                true => feasible = middle,
                false => infeasible = middle,
            }
            if infeasible - feasible <= 1e-9 * limits.change_rate {
                break;
            }
        }
        feasible
    }
}

/// The sign of a number that is not NaN.
fn ordering_to_zero(number: f64) -> Ordering {
    number.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// Predicted motion of a joint's goal, per control cycle.
#[derive(Clone, Copy, Debug, Default)]
#[doc(hidden)]
pub struct GoalMotion {
    #[doc(hidden)]
    pub step: f64,
    #[doc(hidden)]
    pub change: f64,
}

/// Smallest fraction of an acceleration limit that remains for meeting an accelerating goal.
const MIN_AUTHORITY: f64 = 0.25;

impl JointMotion {
    /// The position of the goal at which the joint, braking from now on, would match its motion.
    ///
    /// It is a position of the goal now. For a goal at rest it is the position at which the joint comes to rest.
    pub(crate) fn meeting(&self, goal: GoalMotion, limits: &CycleLimits) -> f64 {
        if limits.change.is_infinite() && limits.change_rate.is_infinite() {
            return self.q;
        }
        let relative = Self {
            q: 0.0,
            step: self.step - goal.step,
            change: self.change - goal.change,
        };
        let added_deceleration = goal.change.copysign(goal.change * relative.step);
        let limits = CycleLimits {
            change: (limits.change + added_deceleration).max(MIN_AUTHORITY * limits.change),
            ..*limits
        };
        if limits.change_rate.is_infinite() {
            let stop_distance = later_decrements(relative.step.abs(), limits.change);
            return self.q + stop_distance.copysign(relative.step);
        }
        self.q + relative.stop_offset(&limits)
    }

    /// Offset of the end of a stop: exact for short stops, otherwise from the continuous motion a cycle earlier.
    fn stop_offset(&self, limits: &CycleLimits) -> f64 {
        let (max_change, rate) = (limits.change, limits.change_rate);
        let peak = self.step.abs() + 0.5 * self.change * self.change / rate;
        let cycles = self.change.abs() / rate
            + match max_change * max_change > peak * rate {
                true => 2.0 * (peak / rate).sqrt(),
                false => 2.0 * max_change / rate,
            };
        if cycles <= MAX_SIMULATED_CYCLES {
            return self.stop(limits).end;
        }
        let (v, a) = (self.step - 0.5 * self.change, self.change);
        // Velocity after release of the acceleration.
        let released_speed = v + 0.5 * a * a.abs() / rate;
        let sign = 1.0_f64.copysign(released_speed);
        let (v, a) = (v * sign, a * sign);
        let braking = |v: f64| match v * rate <= max_change * max_change {
            true => v * (v / rate).sqrt(),
            false => 0.5 * v * (v / max_change + max_change / rate),
        };
        let distance = if a >= 0.0 {
            v * a / rate + a * a * a / (3.0 * rate * rate) + braking(released_speed * sign)
        } else {
            // The stop began earlier, without acceleration.
            let initial_speed = v + 0.5 * a * a / rate;
            let time = -a / rate;
            braking(initial_speed) - (initial_speed * time - rate * time * time * time / 6.0)
        };
        sign * distance - self.step
    }

    /// The change within `range` after which the joint meets its goal nearest to `position`.
    ///
    /// Also returns how `position` compares with what the range allows: `Less` below, `Greater` above, `Equal` if it is
    /// met.
    #[doc(hidden)]
    pub fn change_to_meet(
        &self,
        position: f64,
        range: (f64, f64),
        goal: GoalMotion,
        limits: &CycleLimits,
    ) -> (f64, Ordering) {
        let (mut low, mut high) = range;
        let excess = |change: f64| self.after(change).meeting(goal, limits) - position;
        // Straight to the goal, if that needs no braking.
        let straight = (position - self.q) - self.step;
        if straight >= low && straight <= high && excess(straight).abs() <= 1e-12 {
            return (straight, Ordering::Equal);
        }
        let (mut below, mut above) = (excess(low), excess(high));
        if below >= 0.0 {
            return (low, ordering_to_zero(-below));
        }
        if above <= 0.0 {
            return (high, ordering_to_zero(-above));
        }
        // Regula falsi; the weight of an end that stays twice is halved (Illinois).
        let mut last = 0.0;
        for _ in 0..SEARCH_ITERATIONS {
            let middle = (low * above - high * below) / (above - below);
            let value = excess(middle);
            if value.abs() <= 1e-11 || high - low <= 1e-12 * (low.abs() + high.abs()) {
                return (middle, Ordering::Equal);
            }
            if value < 0.0 {
                (low, below) = (middle, value);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                (high, above) = (middle, value);
                below *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = value;
        }
        (0.5 * (low + high), Ordering::Equal)
    }
}

#[cfg(test)]
mod tests {
    use super::{CycleLimits, JointMotion, first_decrement, later_decrements};

    fn limits(change: f64, change_rate: f64) -> CycleLimits {
        CycleLimits {
            lower: -2.0,
            upper: 3.0,
            step: 1e-2,
            change,
            change_rate,
        }
    }

    #[test]
    fn decrements_add_up_to_the_total() {
        for (total, rate) in [
            (0.3, 1.0),
            (1.0, 1.0),
            (2.7, 1.0),
            (40.0, 0.3),
            (5.0, f64::INFINITY),
        ] {
            let first = first_decrement(total, rate);
            let sum = first + later_decrements(first, rate);
            assert!((sum - total).abs() < 1e-12 * total, "{total} {rate}: {sum}");
        }
    }

    /// Random viable changes never lead to a state without a viable change, nor beyond a limit.
    #[test]
    fn viable_changes_lead_to_viable_states() {
        let mut state = 7;
        let mut unit = || {
            state = kinopt_kinematics::random::mix(state);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for limits in [
            limits(1e-4, 1e-5),
            limits(1e-4, f64::INFINITY),
            limits(f64::INFINITY, 1e-5),
            limits(1e-3, 2e-3),
        ] {
            for _ in 0..20 {
                let mut joint = JointMotion::at_rest(-2.0 + 5.0 * unit());
                let mut preferred = unit();
                for cycle in 0..3000 {
                    if cycle % 100 == 0 {
                        preferred = if unit() < 0.5 { 0.0 } else { 1.0 };
                    }
                    let (low, high) = joint.viable_changes(&limits);
                    assert!(low <= high, "{joint:?} {limits:?}");
                    let share = if unit() < 0.8 { preferred } else { unit() };
                    let next = joint.after(low + share * (high - low));
                    let rounding = 1e-12;
                    assert!(
                        next.q >= limits.lower - rounding && next.q <= limits.upper + rounding,
                        "{next:?}"
                    );
                    assert!(next.step.abs() <= limits.step + rounding, "{next:?}");
                    assert!(next.change.abs() <= limits.change + rounding, "{next:?}");
                    assert!(
                        (next.change - joint.change).abs() <= limits.change_rate + rounding,
                        "{joint:?} {next:?}"
                    );
                    joint = next;
                }
            }
        }
    }

    /// The estimate of a long stop agrees with the exact one to 1 %.
    #[test]
    fn long_stops_are_estimated_well() {
        let limits = limits(1e-4, 1e-6);
        for step in [2e-3, 5e-3, 9e-3] {
            for change in [-9e-5, -3e-5, 0.0, 4e-5] {
                let joint = JointMotion {
                    q: 0.0,
                    step,
                    change,
                };
                let (exact, estimate) = (joint.stop(&limits).end, joint.stop_offset(&limits));
                assert!(
                    (exact - estimate).abs() < 0.01 * exact.abs() + 2e-3,
                    "{step} {change}: {exact} {estimate}"
                );
            }
        }
    }
}
