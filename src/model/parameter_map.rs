//! The map from solver variables to configurations: q = S x + s₀, sparse.
//!
//! Locked joints, URDF `mimic` joints, coupled joints and "only this arm" are all this one map.
//! Every coordinate of q depends on at most one variable, so limits on q are limits on x and hard
//! bounds stay boxes.

use super::{JointId, Limits, Model, ModelError};
use crate::scalar::Scalar;

/// Where one coordinate of a configuration comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Held at a value.
    Constant(f64),
    /// `ratio · x[variable] + offset`.
    Variable {
        /// Which solver variable.
        variable: usize,
        /// Coordinate units per variable unit.
        ratio: f64,
        /// In the coordinate's unit.
        offset: f64,
    },
}

impl Source {
    /// The variable itself.
    pub(crate) const fn copy_of(variable: usize) -> Self {
        Self::Variable {
            variable,
            ratio: 1.0,
            offset: 0.0,
        }
    }

    /// The coordinate at x.
    pub(crate) fn at(&self, x: &[f64]) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Variable {
                variable,
                ratio,
                offset,
            } => ratio * x[variable] + offset,
        }
    }

    /// Which variable moves the coordinate, and its derivative by that variable.
    pub(crate) const fn slope(&self) -> Option<(usize, f64)> {
        match *self {
            Self::Constant(_) => None,
            Self::Variable {
                variable, ratio, ..
            } => Some((variable, ratio)),
        }
    }
}

/// A checked map from variables x to configurations q of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterMap {
    sources: Vec<Source>,
    limits: Vec<Limits>,
    /// The coordinate that each variable is a plain copy of.
    leaders: Vec<usize>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl ParameterMap {
    /// Every coordinate its own variable, also one that its limits lock: x is q. It is the map for
    /// evaluating a configuration as given; solving wants [`builder`](Self::builder), which turns
    /// locked coordinates into constants.
    #[must_use]
    pub fn identity(model: &Model) -> Self {
        Self::of_own_variables(model, |_| true)
    }

    /// Every coordinate its own variable, except those whose limits leave one value.
    #[must_use]
    pub fn free(model: &Model) -> Self {
        Self::of_own_variables(model, |limits| !limits.is_locked())
    }

    fn of_own_variables(model: &Model, varies: impl Fn(&Limits) -> bool) -> Self {
        let limits: Vec<Limits> = model.limits().collect();
        let leaders: Vec<usize> = (0..limits.len()).filter(|&c| varies(&limits[c])).collect();
        let mut sources: Vec<Source> = limits.iter().map(|l| Source::Constant(l.lower)).collect();
        for (variable, &leader) in leaders.iter().enumerate() {
            sources[leader] = Source::copy_of(variable);
        }
        Self {
            lower: leaders.iter().map(|&c| limits[c].lower).collect(),
            upper: leaders.iter().map(|&c| limits[c].upper).collect(),
            sources,
            limits,
            leaders,
        }
    }

    /// Starts from every joint free.
    #[must_use]
    pub fn builder(model: &Model) -> ParameterMapBuilder<'_> {
        ParameterMapBuilder {
            model,
            limits: model.limits().collect(),
            roles: vec![None; model.degrees_of_freedom()],
            named: vec![[false; 2]; model.degrees_of_freedom()],
            problem: None,
        }
    }

    getters! {
        /// How many solver variables there are.
        pub fn variables(&self) -> usize = self.leaders.len();
        /// Where each coordinate of q comes from.
        pub fn sources(&self) -> &[Source] = &self.sources;
        /// For each variable the coordinate of q that it is a copy of.
        pub fn leaders(&self) -> &[usize] = &self.leaders;
        /// Lower bounds of the variables, those of followers included.
        pub fn lower(&self) -> &[f64] = &self.lower;
        /// Upper bounds of the variables, those of followers included.
        pub fn upper(&self) -> &[f64] = &self.upper;
    }

    /// Narrows one coordinate's limits, and with them the bounds of the variable it comes from.
    ///
    /// # Errors
    /// The interval that is left, if it is none.
    pub(crate) fn narrow(&mut self, coordinate: usize, limits: &Limits) -> Result<(), Limits> {
        let own = self.limits[coordinate].intersection(limits);
        if !limits.is_valid() || !own.is_valid() {
            return Err(if limits.is_valid() { own } else { *limits });
        }
        self.limits[coordinate] = own;
        match self.sources[coordinate] {
            Source::Constant(value) if own.contains(value) => Ok(()),
            Source::Constant(_) => Err(*limits),
            Source::Variable {
                variable,
                ratio,
                offset,
            } => {
                let bounds = Limits::new(self.lower[variable], self.upper[variable]);
                let left = bounds.intersection(&preimage(&own, ratio, offset));
                if !left.is_valid() {
                    return Err(left);
                }
                (self.lower[variable], self.upper[variable]) = (left.lower, left.upper);
                Ok(())
            }
        }
    }

    /// Writes q = S x + s₀. Shapes: `x` [`variables`](Self::variables), `q` the model's degrees of
    /// freedom.
    ///
    /// # Errors
    /// A slice of another length, or a variable that is not finite.
    pub fn expand(&self, x: &[f64], q: &mut [f64]) -> Result<(), ModelError> {
        self.check(x, q.len())?;
        self.scatter(x, q);
        Ok(())
    }

    /// As [`expand`](Self::expand), then clamps a follower that rounding took past its own limit.
    ///
    /// # Errors
    /// As [`expand`](Self::expand).
    pub fn expand_within_limits(&self, x: &[f64], q: &mut [f64]) -> Result<(), ModelError> {
        self.check(x, q.len())?;
        self.scatter_within_limits(x, q);
        Ok(())
    }

    /// Reads the variables out of a configuration and clamps them into their bounds; the values of
    /// locked and following coordinates are not looked at. Shapes: `q` the model's degrees of
    /// freedom, `x` [`variables`](Self::variables).
    ///
    /// # Errors
    /// A slice of another length, or a value to read that is NaN.
    pub fn reduce(&self, q: &[f64], x: &mut [f64]) -> Result<(), ModelError> {
        check_length(CONFIGURATION, q.len(), self.sources.len())?;
        check_length(VARIABLES, x.len(), self.variables())?;
        if let Some(&index) = self.leaders.iter().find(|&&leader| q[leader].is_nan()) {
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

    /// [`expand`](Self::expand) where lengths are known: a shorter `q` takes what it has room for, and
    /// what reads a variable that `x` lacks is NaN.
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
            };
        }
    }

    pub(crate) fn scatter_within_limits(&self, x: &[f64], q: &mut [f64]) {
        self.scatter(x, q);
        for (value, limits) in q.iter_mut().zip(&self.limits) {
            *value = limits.clamp(*value);
        }
    }

    /// [`reduce`](Self::reduce) where lengths are known; NaN stays NaN.
    pub(crate) fn gather(&self, q: &[f64], x: &mut [f64]) {
        let bounds = self.lower.iter().zip(&self.upper);
        for ((value, &leader), (&lower, &upper)) in x.iter_mut().zip(&self.leaders).zip(bounds) {
            let given = q.get(leader).copied().unwrap_or(f64::NAN);
            *value = Limits::new(lower, upper).clamp(given);
        }
    }
}

/// One number for each degree of freedom, all finite.
pub(crate) fn check_configuration(model: &Model, q: &[f64]) -> Result<(), ModelError> {
    check_length(CONFIGURATION, q.len(), model.degrees_of_freedom())?;
    check_numbers(CONFIGURATION, q)
}

const CONFIGURATION: &str = "a configuration of this model";
const VARIABLES: &str = "the variables of this map";

fn check_length(what: &'static str, given: usize, expected: usize) -> Result<(), ModelError> {
    match given == expected {
        true => Ok(()),
        false => Err(ModelError::Length {
            what,
            given,
            expected,
        }),
    }
}

fn check_numbers(what: &'static str, numbers: &[f64]) -> Result<(), ModelError> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(index) => Err(ModelError::BadNumber {
            what,
            index,
            value: numbers[index],
        }),
    }
}

/// Gives joints their roles. A joint may be locked once and coupled once, of which the last counts.
#[derive(Clone, Debug)]
pub struct ParameterMapBuilder<'m> {
    model: &'m Model,
    limits: Vec<Limits>,
    /// Of each coordinate; `None` is free, and a variable is the coordinate that it follows.
    roles: Vec<Option<Source>>,
    /// Which joints were locked and coupled by name: twice is a slip that nobody would find.
    named: Vec<[bool; 2]>,
    problem: Option<ModelError>,
}

impl ParameterMapBuilder<'_> {
    /// Holds a joint at `value` (radians or metres).
    #[must_use]
    pub fn lock(mut self, joint: JointId, value: f64) -> Self {
        if let Some(coordinate) = self.moving(joint, "locked") {
            self.set(coordinate, Source::Constant(value));
        }
        self
    }

    /// Lets a joint follow another: its value is `ratio · master + offset`.
    #[must_use]
    pub fn couple(mut self, joint: JointId, master: JointId, ratio: f64, offset: f64) -> Self {
        if let (Some(coordinate), Some(master)) = (
            self.moving(joint, "coupled"),
            self.moving(master, "followed"),
        ) {
            let role = Source::Variable {
                variable: master,
                ratio,
                offset,
            };
            self.set(coordinate, role);
        }
        self
    }

    /// Leaves a joint only the values that `limits` (radians or metres) allow too.
    #[must_use]
    pub fn narrow(mut self, joint: JointId, limits: Limits) -> Self {
        if let Some(coordinate) = self.moving(joint, "narrowed") {
            let own = &mut self.limits[coordinate];
            *own = own.intersection(&limits);
        }
        self
    }

    /// Frees only the given joints: every other joint that was free is locked at its value in `q`
    /// (shape: degrees of freedom; [`build`](Self::build) refuses another length and what is not finite),
    /// clamped into its limits.
    #[must_use]
    pub fn only(mut self, joints: &[JointId], q: &[f64]) -> Self {
        let mut keep = vec![false; self.roles.len()];
        for &joint in joints {
            if let Some(coordinate) = self.moving(joint, "freed") {
                keep[coordinate] = true;
            }
        }
        self = self.checked(q);
        let limits = &self.limits;
        for (coordinate, role) in self.roles.iter_mut().enumerate() {
            if role.is_none() && !keep[coordinate] {
                let value = q.get(coordinate).copied().unwrap_or(f64::NAN);
                *role = Some(Source::Constant(limits[coordinate].clamp(value)));
            }
        }
        self
    }

    /// Checks the roles and numbers the variables in configuration order.
    ///
    /// # Errors
    /// The first joint, by name, that is fixed but was given a role, is locked or coupled twice, is
    /// locked outside its limits, follows itself, has a number that is not finite, or whose followers leave it no value.
    pub fn build(self) -> Result<ParameterMap, ModelError> {
        if let Some(problem) = self.problem {
            return Err(problem);
        }
        let (model, limits) = (self.model, self.limits);
        let name = |c: usize| {
            model.joints()[model.moving_joints()[c].index()]
                .name
                .clone()
        };

        let mut roles = self.roles;
        let mut leaders = Vec::new();
        let mut variable_of = vec![usize::MAX; roles.len()];
        for (c, role) in roles.iter_mut().enumerate() {
            if role.is_none() && limits[c].is_locked() {
                *role = Some(Source::Constant(limits[c].lower));
            }
            match role {
                Some(source) => check(source, &limits[c], ["the ratio", "the offset"], || name(c))?,
                None => {
                    variable_of[c] = leaders.len();
                    leaders.push(c);
                }
            }
        }

        // Products along a chain of masters may overflow though every factor is finite.
        let through = [
            "the ratio through its masters",
            "the offset through its masters",
        ];
        let mut sources = Vec::with_capacity(roles.len());
        let mut bounds: Vec<Limits> = leaders.iter().map(|&c| limits[c]).collect();
        for c in 0..roles.len() {
            let source = resolve(c, &roles, &variable_of)
                .ok_or_else(|| ModelError::CouplingCycle { joint: name(c) })?;
            check(&source, &limits[c], through, || name(c))?;
            if let Source::Variable {
                variable,
                ratio,
                offset,
            } = source
                && roles[c].is_some()
            {
                let allowed = preimage(&limits[c], ratio, offset);
                bounds[variable] = bounds[variable].intersection(&allowed);
            }
            sources.push(source);
        }
        for (bound, &leader) in bounds.iter().zip(&leaders) {
            if !bound.is_valid() {
                return Err(ModelError::EmptyRange {
                    joint: name(leader),
                });
            }
        }
        Ok(ParameterMap {
            sources,
            limits,
            leaders,
            lower: bounds.iter().map(|b| b.lower).collect(),
            upper: bounds.iter().map(|b| b.upper).collect(),
        })
    }

    /// Notes a configuration that is not one of the model's, for [`build`](Self::build) to refuse.
    pub(crate) fn checked(mut self, q: &[f64]) -> Self {
        if let Err(problem) = check_configuration(self.model, q) {
            self.problem.get_or_insert(problem);
        }
        self
    }

    /// Gives a role by name, which happens once for each.
    fn set(&mut self, coordinate: usize, new: Source) {
        let model = self.model;
        let (kind, role) = match new {
            Source::Variable { .. } => (1, "coupled"),
            Source::Constant(_) => (0, "locked"),
        };
        let named = &mut self.named[coordinate][kind];
        if *named && self.problem.is_none() {
            let joint = &model.joints()[model.moving_joints()[coordinate].index()];
            let joint = joint.name.clone();
            self.problem = Some(ModelError::RoleTwice { joint, role });
        }
        *named = true;
        self.roles[coordinate] = Some(new);
    }

    fn moving(&mut self, joint: JointId, role: &'static str) -> Option<usize> {
        let coordinate = self.model.coordinate(joint);
        if coordinate.is_none() && self.problem.is_none() {
            self.problem = Some(match self.model.joints().get(joint.index()) {
                Some(fixed) => ModelError::FixedJoint {
                    joint: fixed.name.clone(),
                    role,
                },
                None => ModelError::ForeignId {
                    kind: "parameter map of",
                    name: self.model.name().to_owned(),
                },
            });
        }
        coordinate
    }
}

/// Whether a source's numbers, of these names, are finite and a constant is within the limits.
fn check(
    source: &Source,
    limits: &Limits,
    [ratio_is, offset_is]: [&'static str; 2],
    name: impl FnOnce() -> String,
) -> Result<(), ModelError> {
    let numbers = match *source {
        Source::Constant(value) => [("the locked value", value); 2],
        Source::Variable { ratio, offset, .. } => [(ratio_is, ratio), (offset_is, offset)],
    };
    if let Some(&(what, value)) = numbers.iter().find(|(_, number)| !number.is_finite()) {
        let joint = name();
        return Err(ModelError::NotFinite { joint, what, value });
    }
    match *source {
        Source::Constant(value) if !limits.contains(value) => {
            Err(ModelError::LockedOutsideLimits {
                joint: name(),
                value,
                lower: limits.lower,
                upper: limits.upper,
            })
        }
        _ => Ok(()),
    }
}

/// Follows masters to their end; `None` when they run in a ring.
fn resolve(coordinate: usize, roles: &[Option<Source>], variable_of: &[usize]) -> Option<Source> {
    let (mut total, mut shift, mut at) = (1.0, 0.0, coordinate);
    for _ in 0..=roles.len() {
        match roles[at] {
            None => {
                return Some(Source::Variable {
                    variable: variable_of[at],
                    ratio: total,
                    offset: shift,
                });
            }
            Some(Source::Constant(value)) => return Some(Source::Constant(total * value + shift)),
            Some(Source::Variable {
                variable: master,
                ratio,
                offset,
            }) => {
                // total·(ratio m + offset) + shift
                shift += total * offset;
                total *= ratio;
                at = master;
            }
        }
    }
    None
}

/// The x for which `ratio · x + offset` is within the limits.
fn preimage(limits: &Limits, ratio: f64, offset: f64) -> Limits {
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
