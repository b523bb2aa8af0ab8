//! Serialised form of models and parameter maps; deserialisation builds and checks them again.

use super::parameter_map::Source;
use super::{
    BallVariables, Frame, Joint, JointId, LengthUnit, Limits, Loop, Model, ModelError, ParameterMap,
};

/// Largest difference between a built and a written axis that counts as rounding.
const ROUNDING: f64 = 1e-14;

#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct ModelDocument {
    name: String,
    length_unit: LengthUnit,
    joints: Vec<Joint>,
    frames: Vec<Frame>,
    #[serde(default)]
    loops: Vec<Loop>,
    configuration_order: Vec<JointId>,
    /// The first prismatic joint of each free joint.
    #[serde(default)]
    free_joints: Vec<JointId>,
}

impl From<Model> for ModelDocument {
    fn from(model: Model) -> Self {
        Self {
            configuration_order: model.configuration_order(),
            name: model.name,
            length_unit: model.length_unit,
            joints: model.joints,
            frames: model.frames,
            loops: model.loops,
            free_joints: model.free,
        }
    }
}

impl TryFrom<ModelDocument> for Model {
    type Error = ModelError;

    fn try_from(parts: ModelDocument) -> Result<Self, ModelError> {
        let mut builder = Self::builder(parts.name);
        builder.length_unit(parts.length_unit);
        let axes: Vec<_> = parts.joints.iter().map(|joint| joint.axis).collect();
        for joint in parts.joints {
            builder.joint(joint);
        }
        for frame in parts.frames {
            builder.frame(frame.name, frame.joint, frame.joint_from_frame);
        }
        for closed in parts.loops {
            builder.close(closed);
        }
        builder.configuration_order(parts.configuration_order);
        builder.free_joints(parts.free_joints);
        let mut model = builder.build()?;
        // Keep the written axis: normalising a unit axis again may change its bits.
        for (joint, written) in model.joints.iter_mut().zip(axes) {
            if (joint.axis - written).norm() <= ROUNDING {
                joint.axis = written;
            }
        }
        Ok(model)
    }
}

/// The serialised form of a parameter map. Bounds are `Limits` because those serialise infinity.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Map {
    sources: Vec<Source>,
    limits: Vec<Limits>,
    leaders: Vec<usize>,
    bounds: Vec<Limits>,
    #[serde(default)]
    balls: Vec<BallVariables>,
}

/// A contradiction in a deserialised parameter map.
#[derive(Debug, thiserror::Error)]
#[error("invalid parameter map: {0}")]
pub(super) struct NoMap(&'static str);

impl From<ParameterMap> for Map {
    fn from(map: ParameterMap) -> Self {
        let bounds = map.lower.iter().zip(&map.upper);
        Self {
            bounds: bounds.map(|(&l, &u)| Limits::new(l, u)).collect(),
            sources: map.sources,
            limits: map.limits,
            leaders: map.leaders,
            balls: map.balls,
        }
    }
}

impl TryFrom<Map> for ParameterMap {
    type Error = NoMap;

    fn try_from(map: Map) -> Result<Self, NoMap> {
        let Map {
            sources,
            limits,
            leaders,
            bounds,
            balls,
        } = map;
        let is_valid_source = |source: &Source| match *source {
            Source::Constant(value) => value.is_finite(),
            Source::Variable {
                variable,
                ratio,
                offset,
            } => variable < leaders.len() && ratio.is_finite() && offset.is_finite(),
            Source::Rotation { variable } => balls.iter().any(|ball| ball.variable == variable),
        };
        let moves_ball = |k: usize, c: usize| {
            let mut balls = balls.iter();
            balls.any(|ball| k.checked_sub(ball.variable) == c.checked_sub(ball.coordinate))
        };
        let is_leader = |(k, &c): (usize, &usize)| match sources.get(c) {
            Some(Source::Rotation { .. }) => moves_ball(k, c),
            source => source == Some(&Source::copy_of(k)),
        };
        let is_complete_ball = |ball: &BallVariables| {
            let quaternion = sources.get(ball.coordinate..ball.coordinate.saturating_add(4));
            let rotation = Source::Rotation {
                variable: ball.variable,
            };
            ball.of(&leaders).is_some()
                && quaternion.is_some_and(|four| four.iter().all(|source| *source == rotation))
        };
        for (is_valid, what) in [
            (
                limits.len() == sources.len(),
                "the number of limits differs from the number of coordinates",
            ),
            (
                bounds.len() == leaders.len(),
                "the number of bounds differs from the number of variables",
            ),
            (
                limits.iter().chain(&bounds).all(Limits::is_valid),
                "limits or bounds are not an interval",
            ),
            (
                sources.iter().all(is_valid_source),
                "`sources` are not finite or have no variable",
            ),
            (
                balls.iter().all(is_complete_ball),
                "`balls` need four coordinates and three variables each",
            ),
            (
                leaders.iter().enumerate().all(is_leader),
                "variables without a coordinate",
            ),
        ] {
            if !is_valid {
                return Err(NoMap(what));
            }
        }
        Ok(Self {
            lower: bounds.iter().map(|bound| bound.lower).collect(),
            upper: bounds.iter().map(|bound| bound.upper).collect(),
            sources,
            limits,
            leaders,
            balls,
        })
    }
}
