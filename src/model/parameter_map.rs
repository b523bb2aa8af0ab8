//! The sparse map from solver variables to configurations: q = S x + s₀.
//!
//! It expresses locked joints, URDF `mimic` joints, coupled joints and subsets of joints. Every coordinate of q depends
//! on at most one variable, so limits on q are bounds on x. Ball joints are the exception: their four coordinates
//! depend on three variables (see [`BallVariables`]).

use super::{BallVariables, Joint, Limits, Model, ModelError, ParameterMapBuilder, quaternion_at};
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Vector3};

/// The source of one coordinate of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Source {
    /// Locked at a value, radians or metres.
    Constant(f64),
    /// `ratio · x[variable] + offset`.
    Variable {
        /// Index of the solver variable.
        variable: usize,
        /// Coordinate units per variable unit.
        ratio: f64,
        /// Offset in the coordinate's unit.
        offset: f64,
    },
    /// A component of the unit quaternion of a ball joint, which depends on three variables.
    Rotation {
        /// Index of the first of the three variables.
        variable: usize,
    },
}

impl Source {
    /// A plain copy of a variable.
    pub(crate) const fn copy_of(variable: usize) -> Self {
        Self::of_variable(variable, 1.0, 0.0)
    }

    /// `ratio · x[variable] + offset`.
    pub(crate) const fn of_variable(variable: usize, ratio: f64, offset: f64) -> Self {
        Self::Variable {
            variable,
            ratio,
            offset,
        }
    }

    /// The coordinate at x; 0 for one of a ball joint.
    pub(crate) fn at(&self, x: &[f64]) -> f64 {
        match *self {
            Self::Rotation { .. } => 0.0,
            Self::Constant(value) => value,
            Self::Variable {
                variable,
                ratio,
                offset,
            } => ratio * x[variable] + offset,
        }
    }

    /// The only variable of the coordinate and the derivative by it; `None` for constants and ball joints.
    pub(crate) const fn slope(&self) -> Option<(usize, f64)> {
        match *self {
            Self::Constant(_) | Self::Rotation { .. } => None,
            Self::Variable {
                variable, ratio, ..
            } => Some((variable, ratio)),
        }
    }
}

/// A checked map from variables x to configurations q of one model.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "super::serialised::Map", into = "super::serialised::Map")
)]
pub struct ParameterMap {
    pub(super) sources: Vec<Source>,
    pub(super) limits: Vec<Limits>,
    /// For each variable, the coordinate that it is a copy of, or one of the quaternion that it moves.
    pub(super) leaders: Vec<usize>,
    pub(super) balls: Vec<BallVariables>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

impl ParameterMap {
    /// A variable for every coordinate, locked ones included, and three for a ball joint.
    ///
    /// x equals q, except for rotation vectors instead of quaternions. Use this map to evaluate a given configuration.
    /// To solve, use [`builder`](Self::builder), which makes locked coordinates constant.
    #[must_use]
    pub fn identity(model: &Model) -> Self {
        Self::with_variables(model, false)
    }

    /// A variable for every coordinate that its limits do not lock, and three for a ball joint.
    #[must_use]
    pub fn free(model: &Model) -> Self {
        Self::with_variables(model, true)
    }

    fn with_variables(model: &Model, within_limits: bool) -> Self {
        let mut map = Self::empty(model);
        let mut coordinate = 0;
        while coordinate < map.limits.len() {
            coordinate += match model.joint_of(coordinate) {
                ball if ball.kind.is_ball() => {
                    map.add_ball(coordinate, ball, within_limits);
                    4
                }
                _ if within_limits && map.limits[coordinate].is_locked() => 1,
                _ => {
                    let limits = map.limits[coordinate];
                    map.add_variable(coordinate, &limits);
                    1
                }
            };
        }
        map
    }

    /// A map without variables; each coordinate is constant at its lower limit.
    pub(super) fn empty(model: &Model) -> Self {
        let limits: Vec<Limits> = model.limits().collect();
        Self {
            sources: limits.iter().map(|l| Source::Constant(l.lower)).collect(),
            limits,
            leaders: Vec::new(),
            balls: Vec::new(),
            lower: Vec::new(),
            upper: Vec::new(),
        }
    }

    /// Adds a variable that is a copy of a coordinate.
    pub(super) fn add_variable(&mut self, coordinate: usize, bounds: &Limits) {
        self.sources[coordinate] = Source::copy_of(self.leaders.len());
        self.leaders.push(coordinate);
        self.lower.push(bounds.lower);
        self.upper.push(bounds.upper);
    }

    /// Adds the three variables of a ball joint, with its limits or without.
    pub(super) fn add_ball(&mut self, coordinate: usize, joint: &Joint, within_limits: bool) {
        let limits = joint.ball.as_ref().filter(|_| within_limits);
        let variable = self.leaders.len();
        let ball = BallVariables::new(coordinate, variable, joint.axis, limits);
        self.sources[coordinate..coordinate + 4].fill(Source::Rotation { variable });
        for (k, bounds) in ball.bounds(limits).into_iter().enumerate() {
            self.leaders.push(coordinate + k);
            self.lower.push(bounds.lower);
            self.upper.push(bounds.upper);
        }
        self.balls.push(ball);
    }

    /// A builder that starts with every joint free.
    #[must_use]
    pub fn builder(model: &Model) -> ParameterMapBuilder<'_> {
        ParameterMapBuilder::new(model)
    }

    /// The smallest limit on each variable from limits on the coordinates of q, in variable units.
    ///
    /// A limit on a mimic joint is divided by its ratio. `limits` has one entry for each coordinate. Infinity for a
    /// variable of which no coordinate is a multiple.
    pub(crate) fn least_by_variable(&self, limits: &[f64]) -> Vec<f64> {
        let mut min_limits = vec![f64::INFINITY; self.variables()];
        for (source, limit) in self.sources.iter().zip(limits) {
            if let Some((variable, ratio)) = source.slope()
                && ratio != 0.0
            {
                min_limits[variable] = min_limits[variable].min(limit / ratio.abs());
            }
        }
        min_limits
    }

    /// Number of solver variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.leaders.len()
    }

    /// Source of each coordinate of q.
    #[must_use]
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// For each variable, the coordinate of q that it is a copy of.
    #[must_use]
    pub fn leaders(&self) -> &[usize] {
        &self.leaders
    }

    /// Lower bounds of the variables, limits of mimic joints included.
    #[must_use]
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// Upper bounds of the variables, limits of mimic joints included.
    #[must_use]
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The ball joints with variables.
    #[must_use]
    pub(crate) fn balls(&self) -> &[BallVariables] {
        &self.balls
    }

    /// The indices of the variables that move a coordinate.
    pub(crate) fn variables_of(&self, coordinate: usize) -> std::ops::Range<usize> {
        match self.sources[coordinate] {
            Source::Constant(_) => 0..0,
            Source::Variable { variable, .. } => variable..variable + 1,
            Source::Rotation { variable } => variable..variable + 3,
        }
    }

    /// The variables that move a coordinate, with its derivatives by them at x.
    pub(crate) fn slopes(
        &self,
        coordinate: usize,
        x: &[f64],
    ) -> impl Iterator<Item = (usize, f64)> + use<> {
        let slopes = match self.sources[coordinate] {
            Source::Constant(_) => [0.0; 3],
            Source::Variable { ratio, .. } => [ratio, 0.0, 0.0],
            Source::Rotation { variable } => {
                let ball = self.balls.iter().find(|ball| ball.variable == variable);
                let slopes =
                    ball.and_then(|ball| Some((ball.coordinate, ball.slopes(ball.of(x)?))));
                slopes.map_or([0.0; 3], |(first, slopes)| slopes[coordinate - first])
            }
        };
        self.variables_of(coordinate).zip(slopes)
    }

    /// Intersects one coordinate's limits with `limits` and updates the bounds of its variable.
    ///
    /// # Errors
    /// Returns the invalid interval if no value is left.
    pub(crate) fn narrow(&mut self, coordinate: usize, limits: &Limits) -> Result<(), Limits> {
        let narrowed = self.limits[coordinate].intersection(limits);
        if !limits.is_valid() || !narrowed.is_valid() {
            return Err(if limits.is_valid() { narrowed } else { *limits });
        }
        self.limits[coordinate] = narrowed;
        match self.sources[coordinate] {
            Source::Constant(value) if narrowed.contains(value) => Ok(()),
            Source::Constant(_) | Source::Rotation { .. } => Err(*limits),
            Source::Variable {
                variable,
                ratio,
                offset,
            } => {
                let bounds = Limits::new(self.lower[variable], self.upper[variable]);
                let remaining = bounds.intersection(&preimage(&narrowed, ratio, offset));
                if !remaining.is_valid() {
                    return Err(remaining);
                }
                (self.lower[variable], self.upper[variable]) = (remaining.lower, remaining.upper);
                Ok(())
            }
        }
    }

    /// Writes q = S x + s₀.
    ///
    /// Lengths: `x` [`variables`](Self::variables), `q` the model's [`configuration_len`](Model::configuration_len).
    ///
    /// # Errors
    /// Returns an error for a slice of wrong length or a variable that is not finite.
    pub fn expand(&self, x: &[f64], q: &mut [f64]) -> Result<(), ModelError> {
        self.check(x, q.len())?;
        self.scatter(x, q);
        Ok(())
    }

    /// Does the same as [`expand`](Self::expand), then clamps mimic joints that rounding moved past their limits.
    ///
    /// # Errors
    /// Returns the errors of [`expand`](Self::expand).
    pub fn expand_within_limits(&self, x: &[f64], q: &mut [f64]) -> Result<(), ModelError> {
        self.check(x, q.len())?;
        self.scatter_within_limits(x, q);
        Ok(())
    }

    /// Reads the variables from a configuration and clamps them to their bounds.
    ///
    /// Ignores the values of locked and mimic coordinates. Lengths: `q` the model's
    /// [`configuration_len`](Model::configuration_len), `x` [`variables`](Self::variables).
    ///
    /// # Errors
    /// Returns an error for a slice of wrong length or for a NaN in a coordinate that it reads.
    pub fn reduce(&self, q: &[f64], x: &mut [f64]) -> Result<(), ModelError> {
        check_length(CONFIGURATION, q.len(), self.sources.len())?;
        check_length(VARIABLES, x.len(), self.variables())?;
        let read = self.leaders.iter().copied();
        let balls = self.balls.iter().map(|ball| ball.coordinate + 3);
        if let Some(index) = read.chain(balls).find(|&leader| q[leader].is_nan()) {
            let (what, value) = (CONFIGURATION, q[index]);
            return Err(ModelError::BadNumber { what, index, value });
        }
        self.gather(q, x);
        Ok(())
    }

    fn check(&self, x: &[f64], coordinates: usize) -> Result<(), ModelError> {
        check_length(VARIABLES, x.len(), self.variables())?;
        check_length(CONFIGURATION, coordinates, self.sources.len())?;
        check_numbers(VARIABLES, x)
    }

    /// [`expand`](Self::expand) without checks.
    ///
    /// A shorter `q` gets a prefix. Coordinates whose variable is missing in `x` become NaN.
    #[inline]
    pub(crate) fn scatter<S: Scalar>(&self, x: &[S], q: &mut [S]) {
        for (value, source) in q.iter_mut().zip(&self.sources) {
            *value = match *source {
                Source::Constant(constant) => S::constant(constant),
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => match x.get(variable) {
                    Some(&value) => value * S::constant(ratio) + S::constant(offset),
                    None => S::constant(f64::NAN),
                },
                Source::Rotation { .. } => S::constant(f64::NAN),
            };
        }
        for ball in &self.balls {
            let quaternion = q.get_mut(ball.coordinate..ball.coordinate + 4);
            if let (Some(x), Some(quaternion)) = (ball.of(x), quaternion) {
                let Quaternion { w, v } = ball.chart.rotation(x);
                quaternion.copy_from_slice(&[w, v.x, v.y, v.z]);
            }
        }
    }

    pub(crate) fn scatter_within_limits(&self, x: &[f64], q: &mut [f64]) {
        self.scatter(x, q);
        for (value, limits) in q.iter_mut().zip(&self.limits) {
            *value = limits.clamp(*value);
        }
    }

    /// [`reduce`](Self::reduce) without checks; NaN stays NaN.
    pub(crate) fn gather(&self, q: &[f64], x: &mut [f64]) {
        let bounds = self.lower.iter().zip(&self.upper);
        for ((value, &leader), (&lower, &upper)) in x.iter_mut().zip(&self.leaders).zip(bounds) {
            let given = q.get(leader).copied().unwrap_or(f64::NAN);
            *value = Limits::new(lower, upper).clamp(given);
        }
        for ball in &self.balls {
            let x = x.get_mut(ball.variable..ball.variable + 3);
            if let (Some(x), Some(q)) = (x, q.get(ball.coordinate..)) {
                let rotation = quaternion_at(q).map(|rotation| ball.chart.variables(rotation));
                x.copy_from_slice(&rotation.unwrap_or([f64::NAN; 3]));
                for (value, k) in x.iter_mut().zip(ball.variable..) {
                    *value = Limits::new(self.lower[k], self.upper[k]).clamp(*value);
                }
            }
        }
    }

    /// The x of a configuration, for an identity map and any scalar; quaternions need not be of unit length.
    pub(crate) fn gather_all<S: Scalar>(&self, q: &[S], x: &mut [S]) {
        for (value, &leader) in x.iter_mut().zip(&self.leaders) {
            *value = q[leader];
        }
        for ball in &self.balls {
            let first = ball.coordinate;
            let (w, v) = (
                q[first],
                Vector3::new(q[first + 1], q[first + 2], q[first + 3]),
            );
            let length = (w * w + v.norm_squared()).sqrt();
            let unit = Quaternion {
                w: w / length,
                v: Vector3::new(v.x / length, v.y / length, v.z / length),
            };
            x[ball.variable..ball.variable + 3].copy_from_slice(&ball.chart.variables(unit));
        }
    }
}

/// Checks that `q` has one finite number for each coordinate.
pub(crate) fn check_configuration(model: &Model, q: &[f64]) -> Result<(), ModelError> {
    ModelError::check_numbers(CONFIGURATION, q, model.configuration_len())
}

impl ModelError {
    /// Checks that there are `expected` numbers, all finite.
    pub(crate) fn check_numbers(
        what: &'static str,
        given: &[f64],
        expected: usize,
    ) -> Result<(), Self> {
        check_length(what, given.len(), expected)?;
        check_numbers(what, given)
    }
}

const CONFIGURATION: &str = "a configuration of this model";
const VARIABLES: &str = "the variables of this map";

pub(super) fn check_length(
    what: &'static str,
    given: usize,
    expected: usize,
) -> Result<(), ModelError> {
    match given == expected {
        true => Ok(()),
        false => Err(ModelError::Length {
            what,
            given,
            expected,
        }),
    }
}

pub(super) fn check_numbers(what: &'static str, numbers: &[f64]) -> Result<(), ModelError> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ModelError::BadNumber {
            what,
            index,
            value: numbers[index],
        }),
    }
}

/// The interval of x for which `ratio · x + offset` is within the limits.
pub(super) fn preimage(limits: &Limits, ratio: f64, offset: f64) -> Limits {
    if ratio == 0.0 {
        return if limits.contains(offset) {
            Limits::UNBOUNDED
        } else {
            Limits::new(f64::INFINITY, f64::NEG_INFINITY)
        };
    }
    let (a, b) = (
        (limits.lower - offset) / ratio,
        (limits.upper - offset) / ratio,
    );
    Limits::new(a.min(b), a.max(b))
}
