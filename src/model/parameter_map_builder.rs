//! Builder of parameter maps: locked, mimic and free joints.

use super::parameter_map::{ParameterMap, Source, check_configuration, preimage};
use super::{JointId, Limits, Model, ModelError, quaternion_at};
use crate::spatial::Quaternion;

/// Largest violation of its limits at which a joint may be locked, radians or metres.
const MAX_EXCESS: f64 = 1e-3;

/// Assigns roles to joints. A joint that is both locked and coupled has the role that was set last.
#[derive(Clone, Debug)]
pub struct ParameterMapBuilder<'m> {
    model: &'m Model,
    limits: Vec<Limits>,
    /// Role of each coordinate; `None` is free. In a role, a variable is the index of the source coordinate.
    roles: Vec<Option<Source>>,
    /// For each coordinate, whether it was locked and coupled by name: setting a role twice is an error.
    set_roles: Vec<[bool; 2]>,
    problem: Option<ModelError>,
}

impl<'m> ParameterMapBuilder<'m> {
    /// A builder with every joint free.
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            limits: model.limits().collect(),
            roles: vec![None; model.configuration_len()],
            set_roles: vec![[false; 2]; model.configuration_len()],
            problem: None,
        }
    }

    /// The model of the map.
    #[must_use]
    pub(crate) fn model(&self) -> &'m Model {
        self.model
    }

    /// Locks a joint at `value`, radians or metres.
    ///
    /// A value up to 1e-3 outside the limits, as sensors report it, is clamped to them.
    #[must_use]
    pub fn with_locked(mut self, joint: JointId, value: f64) -> Self {
        if let Some(coordinate) = self.single_coordinate(joint, "locked") {
            let value = clamped_within_excess(&self.limits[coordinate], value);
            self.set(coordinate, Source::Constant(value));
        }
        self
    }

    /// Locks a ball joint at a rotation: a quaternion w, x, y, z of any length except zero. Ignores limits.
    #[must_use]
    pub fn with_locked_ball(mut self, joint: JointId, rotation: [f64; 4]) -> Self {
        let Some(first) = self.moving_coordinate(joint, "locked") else {
            return self;
        };
        let ball = self.model.joint_of(first);
        match quaternion_at(&rotation) {
            Some(unit) if ball.kind.is_ball() => {
                for (k, part) in unit_parts(unit).into_iter().enumerate() {
                    self.set(first + k, Source::Constant(part));
                }
            }
            rotation => {
                let joint = ball.name.clone();
                self.problem.get_or_insert(match rotation {
                    None => ModelError::NoRotation { joint },
                    Some(_) => ModelError::NoBallJoint { joint },
                });
            }
        }
        self
    }

    /// Makes `joint` a mimic joint of `source`: its value is `ratio · source + offset`.
    #[must_use]
    pub fn with_coupled(
        mut self,
        joint: JointId,
        source: JointId,
        ratio: f64,
        offset: f64,
    ) -> Self {
        if let (Some(coordinate), Some(source)) = (
            self.single_coordinate(joint, "coupled"),
            self.single_coordinate(source, "followed"),
        ) {
            self.set(coordinate, Source::of_variable(source, ratio, offset));
        }
        self
    }

    /// Intersects the limits of a joint with `limits`, radians or metres.
    #[must_use]
    pub fn with_narrowed(mut self, joint: JointId, limits: Limits) -> Self {
        if let Some(coordinate) = self.single_coordinate(joint, "narrowed") {
            let narrowed = &mut self.limits[coordinate];
            *narrowed = narrowed.intersection(&limits);
        }
        self
    }

    /// Frees only the given joints. Locks every other free joint at its value in `q`.
    ///
    /// `q` has the model's [`configuration_len`](Model::configuration_len). [`build`](Self::build) returns an error for
    /// a wrong length or a number that is not finite. Values outside the limits follow the rule of
    /// [`with_locked`](Self::with_locked).
    #[must_use]
    pub fn with_only(mut self, joints: &[JointId], q: &[f64]) -> Self {
        let mut is_freed = vec![false; self.roles.len()];
        for &joint in joints {
            if let Some(first) = self.moving_coordinate(joint, "freed") {
                let count = self.model.joint_of(first).kind.coordinates();
                is_freed[first..first + count].fill(true);
            }
        }
        self = self.checked(q);
        let limits = &self.limits;
        for (coordinate, role) in self.roles.iter_mut().enumerate() {
            if role.is_none() && !is_freed[coordinate] {
                let value = q.get(coordinate).copied().unwrap_or(f64::NAN);
                let value = clamped_within_excess(&limits[coordinate], value);
                *role = Some(Source::Constant(value));
            }
        }
        for (_, first) in self.model.balls().filter(|&(_, first)| !is_freed[first]) {
            match q.get(first..).and_then(quaternion_at) {
                Some(unit) => {
                    for (role, part) in self.roles[first..first + 4]
                        .iter_mut()
                        .zip(unit_parts(unit))
                    {
                        *role = Some(Source::Constant(part));
                    }
                }
                None => {
                    let joint = self.model.joint_of(first).name.clone();
                    self.problem.get_or_insert(ModelError::NoRotation { joint });
                }
            }
        }
        self
    }

    /// Checks the roles and numbers the variables in configuration order.
    ///
    /// # Errors
    /// Returns an error with the name of the first joint that:
    /// - is fixed but was given a role;
    /// - is locked or coupled twice;
    /// - is locked outside its limits;
    /// - is its own source through mimic joints;
    /// - has a number that is not finite;
    /// - has no value within the limits of its mimic joints.
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
        let mut map = ParameterMap::empty(model);
        let mut variable_of = vec![None; roles.len()];
        let mut ball_until = 0;
        for (c, role) in roles.iter_mut().enumerate() {
            let joint = model.joint_of(c);
            if role.is_none() && !joint.kind.is_ball() && limits[c].is_locked() {
                *role = Some(Source::Constant(limits[c].lower));
            }
            match role {
                Some(source) => check(source, &limits[c], ["the ratio", "the offset"], || name(c))?,
                None if !joint.kind.is_ball() => {
                    variable_of[c] = Some(map.variables());
                    map.add_variable(c, &limits[c]);
                }
                None if c >= ball_until => {
                    map.add_ball(c, joint, true);
                    ball_until = c + 4;
                }
                None => {}
            }
        }

        // Products along a chain of mimic joints may overflow although every factor is finite.
        let chain_numbers = [
            "the ratio to its source joint",
            "the offset to its source joint",
        ];
        let ends = map.lower.iter().zip(&map.upper);
        let mut bounds: Vec<Limits> = ends.map(|(&l, &u)| Limits::new(l, u)).collect();
        for c in 0..roles.len() {
            if matches!(map.sources[c], Source::Rotation { .. }) {
                continue;
            }
            let source = resolve(c, &roles, &variable_of)
                .ok_or_else(|| ModelError::CouplingCycle { joint: name(c) })?;
            check(&source, &limits[c], chain_numbers, || name(c))?;
            if let Source::Variable {
                variable,
                ratio,
                offset,
            } = source
                && roles[c].is_some()
            {
                let allowed = preimage(&limits[c], ratio, offset);
                bounds[variable] = restricted(&bounds[variable], &allowed, offset / ratio);
            }
            map.sources[c] = source;
        }
        for (bound, &leader) in bounds.iter().zip(&map.leaders) {
            if !bound.is_valid() {
                return Err(ModelError::EmptyRange {
                    joint: name(leader),
                });
            }
        }
        map.limits = limits;
        map.lower = bounds.iter().map(|b| b.lower).collect();
        map.upper = bounds.iter().map(|b| b.upper).collect();
        Ok(map)
    }

    /// Records an invalid configuration, for which [`build`](Self::build) returns an error.
    pub(crate) fn checked(mut self, q: &[f64]) -> Self {
        if let Err(problem) = check_configuration(self.model, q) {
            self.problem.get_or_insert(problem);
        }
        self
    }

    /// Sets a role by name. Records an error for a role that is set twice.
    fn set(&mut self, coordinate: usize, source: Source) {
        let model = self.model;
        let (kind, role) = match source {
            Source::Variable { .. } => (1, "coupled"),
            Source::Constant(_) | Source::Rotation { .. } => (0, "locked"),
        };
        let is_set = &mut self.set_roles[coordinate][kind];
        if *is_set && self.problem.is_none() {
            let joint = &model.joints()[model.moving_joints()[coordinate].index()];
            let joint = joint.name.clone();
            self.problem = Some(ModelError::RoleTwice { joint, role });
        }
        *is_set = true;
        self.roles[coordinate] = Some(source);
    }

    /// The coordinate of a joint that has only one; records an error for every other joint.
    fn single_coordinate(&mut self, joint: JointId, role: &'static str) -> Option<usize> {
        let coordinate = self.moving_coordinate(joint, role)?;
        let model_joint = self.model.joint_of(coordinate);
        if model_joint.kind.coordinates() == 1 {
            return Some(coordinate);
        }
        let joint = model_joint.name.clone();
        self.problem
            .get_or_insert(ModelError::BallJoint { joint, role });
        None
    }

    fn moving_coordinate(&mut self, joint: JointId, role: &'static str) -> Option<usize> {
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

/// The value clamped to the limits if it is at most [`MAX_EXCESS`] outside them, otherwise the value itself.
fn clamped_within_excess(limits: &Limits, value: f64) -> f64 {
    let clamped = limits.clamp(value);
    match (clamped - value).abs() <= MAX_EXCESS {
        true => clamped,
        false => value,
    }
}

/// The intersection of the bounds with the allowed values.
///
/// A bound that changes only by rounding stays; `shift` is the offset in the bounds' unit.
fn restricted(bounds: &Limits, allowed: &Limits, shift: f64) -> Limits {
    let end = |bound: f64, restricted: f64| {
        let rounding = 8.0 * f64::EPSILON * (bound.abs() + shift.abs());
        let is_rounding = rounding.is_finite() && (bound - restricted).abs() <= rounding;
        if is_rounding { bound } else { restricted }
    };
    let Limits { lower, upper } = bounds.intersection(allowed);
    Limits::new(end(bounds.lower, lower), end(bounds.upper, upper))
}

fn unit_parts(Quaternion { w, v }: Quaternion<f64>) -> [f64; 4] {
    [w, v.x, v.y, v.z]
}

/// Checks that a source's numbers are finite and that a constant is within the limits.
///
/// `ratio_name` and `offset_name` name the numbers in errors.
fn check(
    source: &Source,
    limits: &Limits,
    [ratio_name, offset_name]: [&'static str; 2],
    name: impl FnOnce() -> String,
) -> Result<(), ModelError> {
    let numbers = match *source {
        Source::Rotation { .. } => return Ok(()),
        Source::Constant(value) => [("the locked value", value); 2],
        Source::Variable { ratio, offset, .. } => [(ratio_name, ratio), (offset_name, offset)],
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

/// The source of a coordinate through its chain of mimic joints; `None` for a cycle.
fn resolve(
    coordinate: usize,
    roles: &[Option<Source>],
    variable_of: &[Option<usize>],
) -> Option<Source> {
    let (mut total_ratio, mut total_offset, mut current) = (1.0, 0.0, coordinate);
    for _ in 0..=roles.len() {
        match roles[current] {
            None => {
                return variable_of[current]
                    .map(|x| Source::of_variable(x, total_ratio, total_offset));
            }
            Some(Source::Rotation { .. }) => return None,
            Some(Source::Constant(value)) => {
                return Some(Source::Constant(total_ratio * value + total_offset));
            }
            Some(Source::Variable {
                variable: source,
                ratio,
                offset,
            }) => {
                // total·(ratio m + offset) + shift
                total_offset += total_ratio * offset;
                total_ratio *= ratio;
                current = source;
            }
        }
    }
    None
}
