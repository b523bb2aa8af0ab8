//! Mimic joints: joints whose value is a linear function of another joint's value.

use super::Robot;
#[cfg(feature = "xml")]
use crate::robot::RepairKind;
use kinopt_kinematics::model::{
    JointId, Limits, Model, ModelBuilder, ModelError, ParameterMap, Source,
};

/// Largest distance of a mimic joint from its range that counts as rounding of the file's numbers, radians or metres.
#[cfg(any(feature = "urdf", feature = "mjcf"))]
const MAX_ROUNDING: f64 = 1e-6;
/// Largest distance of a mimic joint from the value that its source joint gives, radians or metres.
const MAX_DEVIATION: f64 = 1e-9;

/// A mimic joint: its value is `ratio · master + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// The mimic joint.
    pub joint: JointId,
    /// The source joint, which may be a mimic joint itself.
    pub master: JointId,
    /// Factor, in units of the mimic joint per unit of the source joint.
    pub ratio: f64,
    /// Offset, in radians or metres.
    pub offset: f64,
}

/// The mimic joints of a robot, and the ranges that its files state for them.
///
/// The model's limits of a mimic joint contain every value that the source joint gives it. Mimic joints then do not
/// restrict their sources, unless [`restrict_sources`](Self::restrict_sources) is set.
#[derive(Clone, Debug, Default)]
pub(super) struct Mimics {
    pub(super) joints: Vec<Mimic>,
    /// The range of each mimic joint as the files state it, radians or metres.
    pub(super) ranges: Vec<Limits>,
    pub(super) restrict_sources: bool,
}

impl Mimics {
    /// Creates the mimic joints of a model that has the ranges of the files.
    pub(super) fn of(model: &Model, joints: Vec<Mimic>) -> Self {
        Self {
            ranges: ranges(model, &joints),
            joints,
            restrict_sources: false,
        }
    }

    /// The model whose mimic joints have the limits described at [`Mimics`], and its map.
    pub(super) fn applied(&self, model: Model) -> Result<(Model, ParameterMap), ModelError> {
        let with_file_ranges = self.with_ranges_of_files(&model);
        if self.joints.is_empty() || self.restrict_sources {
            let model = with_file_ranges.build()?;
            let map = super::coupled(&model, &self.joints).build()?;
            return Ok((model, map));
        }
        let mut without_limits = with_file_ranges;
        for mimic in &self.joints {
            without_limits.replace_limits(mimic.joint, Limits::UNBOUNDED);
        }
        let unlimited = without_limits.build()?;
        let map = super::coupled(&unlimited, &self.joints).build()?;
        let mut builder = ModelBuilder::from_model(&unlimited);
        for (mimic, range) in self.joints.iter().zip(&self.ranges) {
            let values = values_of(&unlimited, &map, mimic.joint).unwrap_or(*range);
            builder.replace_limits(mimic.joint, hull(range, &values));
        }
        let model = builder.build()?;
        let map = super::coupled(&model, &self.joints).build()?;
        Ok((model, map))
    }

    /// The model with the ranges that the files state for mimic joints.
    pub(super) fn with_ranges_of_files(&self, model: &Model) -> ModelBuilder {
        let mut builder = ModelBuilder::from_model(model);
        for (mimic, range) in self.joints.iter().zip(&self.ranges) {
            builder.replace_limits(mimic.joint, *range);
        }
        builder
    }
}

/// The limits of mimic joints in a model.
pub(super) fn ranges(model: &Model, mimics: &[Mimic]) -> Vec<Limits> {
    let joints = model.joints();
    let limits = |mimic: &Mimic| joints.get(mimic.joint.index()).map(|joint| joint.limits);
    mimics
        .iter()
        .map(|mimic| limits(mimic).unwrap_or(Limits::UNBOUNDED))
        .collect()
}

/// The values that a mimic joint takes while its source moves through its limits; `None` for a ball joint.
fn values_of(model: &Model, map: &ParameterMap, joint: JointId) -> Option<Limits> {
    match map.sources()[model.coordinate(joint)?] {
        Source::Constant(value) => Some(Limits::new(value, value)),
        Source::Rotation { .. } => None,
        Source::Variable {
            variable,
            ratio,
            offset,
        } => {
            let value = |bound: f64| match ratio == 0.0 {
                true => offset,
                false => ratio * bound + offset,
            };
            let ends = [map.lower(), map.upper()].map(|bounds| value(bounds[variable]));
            Some(Limits::new(ends[0].min(ends[1]), ends[0].max(ends[1])))
        }
    }
}

fn hull(a: &Limits, b: &Limits) -> Limits {
    Limits::new(a.lower.min(b.lower), a.upper.max(b.upper))
}

impl Robot {
    /// Restricts source joints by the limits of their mimic joints. A source joint keeps only the values at which all
    /// its mimic joints are within their own limits.
    ///
    /// By default a source joint keeps its own limits. The limits of a mimic joint then contain all values that the
    /// source gives it.
    ///
    /// ```
    /// # use kinopt::robot::Robot;
    /// let text = r#"<robot name="gripper"><link name="palm"/><link name="left"/><link name="right"/>
    ///   <joint name="drive" type="revolute"><parent link="palm"/><child link="left"/><limit lower="0" upper="0.8"/></joint>
    ///   <joint name="other" type="revolute"><parent link="palm"/><child link="right"/><limit lower="0" upper="0.5"/>
    ///     <mimic joint="drive"/></joint></robot>"#;
    /// let robot = Robot::parse(text, "gripper.urdf")?;
    /// assert_eq!(robot.map().upper(), [0.8]);
    /// assert_eq!(robot.with_mimic_limits()?.map().upper(), [0.5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The first source joint that keeps no value.
    pub fn with_mimic_limits(mut self) -> Result<Self, ModelError> {
        self.mimics.restrict_sources = true;
        let (model, map) = self.mimics.applied(self.model)?;
        #[cfg(feature = "xml")]
        self.repairs
            .retain(|repair| !matches!(repair.mended, RepairKind::MimicBeyondRange { .. }));
        Ok(Self { model, map, ..self })
    }

    /// The configuration closest to all zeros within the limits, with mimic joints at the values that their source
    /// joints give them.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        self.with_mimics_applied(self.model.neutral())
    }

    /// A configuration sampled as by [`Model::random_configuration`]. Mimic joints have the values that their source
    /// joints give them.
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        self.with_mimics_applied(self.model.random_configuration(seed))
    }

    /// Reports whether a configuration is valid: all joints are within their limits, and every mimic joint has the
    /// value of its source joint up to 1e-9 rad or m. False for a configuration of another length.
    #[must_use]
    pub fn is_within_limits(&self, q: &[f64]) -> bool {
        self.model.is_within_limits(q) && self.satisfies_mimics(q)
    }

    /// Sets the mimic joints of a configuration to the values that their source joints give them, clamped to their
    /// limits. The length is the model's [`configuration_len`](Model::configuration_len), in radians and metres.
    ///
    /// # Errors
    /// A configuration of another length.
    pub fn apply_mimics(&self, q: &[f64]) -> Result<Vec<f64>, ModelError> {
        ModelError::check_numbers(
            "a configuration of this model",
            q,
            self.model.configuration_len(),
        )?;
        Ok(self.with_mimics_applied(q.to_vec()))
    }

    fn with_mimics_applied(&self, mut q: Vec<f64>) -> Vec<f64> {
        for (coordinate, value) in self.mimic_values(&q) {
            q[coordinate] = value;
        }
        q
    }

    fn satisfies_mimics(&self, q: &[f64]) -> bool {
        let mut values = self.mimic_values(q).into_iter();
        values.all(|(coordinate, value)| (q[coordinate] - value).abs() <= MAX_DEVIATION)
    }

    /// Each mimic joint's coordinate and the value that its source joint gives it.
    fn mimic_values(&self, q: &[f64]) -> Vec<(usize, f64)> {
        let model = &self.model;
        let value = |mimic: &Mimic| {
            let coordinate = model.coordinate(mimic.joint)?;
            let limits = model.joint_of(coordinate).limits;
            match self.map.sources()[coordinate] {
                Source::Constant(value) => Some((coordinate, value)),
                Source::Rotation { .. } => None,
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => {
                    let value = ratio * q[self.map.leaders()[variable]] + offset;
                    Some((coordinate, limits.clamp(value)))
                }
            }
        };
        self.mimics.joints.iter().filter_map(value).collect()
    }

    /// The mimic joints that their source joints move out of the range that the file states. Each comes with the repair
    /// that names the source joint at the end of the chain and the values of the mimic joint.
    #[cfg(any(feature = "urdf", feature = "mjcf"))]
    pub(super) fn mimics_beyond_range(&self) -> Vec<(JointId, RepairKind)> {
        let out_of_range = |(mimic, range): (&Mimic, &Limits)| {
            let values = values_of(&self.model, &self.map, mimic.joint)?;
            if values.lower >= range.lower - MAX_ROUNDING
                && values.upper <= range.upper + MAX_ROUNDING
            {
                return None;
            }
            let joints = self.model.joints();
            let source_of = |joint| {
                let mut mimics = self.mimics.joints.iter();
                mimics
                    .find(|other| other.joint == joint)
                    .map(|other| other.master)
            };
            let source =
                std::iter::successors(Some(mimic.master), |joint| source_of(*joint)).last()?;
            let mended = RepairKind::MimicBeyondRange {
                joint: joints[mimic.joint.index()].name.clone(),
                source: joints[source.index()].name.clone(),
                range: *range,
                values,
            };
            Some((mimic.joint, mended))
        };
        let all = self.mimics.joints.iter().zip(&self.mimics.ranges);
        all.filter_map(out_of_range).collect()
    }
}
