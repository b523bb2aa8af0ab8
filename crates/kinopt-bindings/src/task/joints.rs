//! Tasks of joints: posture and velocity.

use kinopt::Model;
use kinopt::model::{JointId, UnknownName};
use kinopt::task::{Posture, Residual, Smoothness};

use super::{BoxedTask, Visit};
use crate::error::ErrorKind;
use crate::value::{Arguments, ErrorOf, OrRaise, Value, joint_of};

/// Weights of joints.
enum JointWeights {
    Even,
    ByRange,
    Upright,
    Given(Vec<f64>),
}

/// Reads a posture of all joints from a configuration, or of some by name.
pub(super) fn posture<A: Arguments>(
    arguments: &A,
    model: &Model,
    visitor: impl Visit<A::Value>,
) -> Result<BoxedTask<A::Value>, ErrorOf<A>> {
    let reference = arguments.required("reference")?;
    let posture = match reference.is_map() {
        false => {
            let length = model.configuration_len();
            Posture::new(model, &reference.vector("reference", length)?)
        }
        true => {
            let keys = "a joint of the reference";
            let values = reference.numbers_by_name("reference", keys)?;
            let named = values
                .into_iter()
                .map(|(joint, value)| Ok((joint_of::<A::Value>(model, &joint)?, value)));
            Posture::of_joints(named.collect::<Result<Vec<_>, ErrorOf<A>>>()?)
        }
    };
    let words = ["by range", "upright"];
    let inputs = posture.inputs();
    visitor.visit(
        match weights(arguments, model, inputs.joint_ids(), &words)? {
            JointWeights::Even => posture,
            JointWeights::ByRange => posture.by_range(model),
            JointWeights::Upright => posture.upright(model),
            JointWeights::Given(weights) => posture.with_weights(weights),
        },
    )
}

/// Reads a smoothness of all joints.
pub(super) fn smoothness<A: Arguments>(
    arguments: &A,
    model: &Model,
    visitor: impl Visit<A::Value>,
) -> Result<BoxedTask<A::Value>, ErrorOf<A>> {
    let previous = arguments.required("previous")?;
    let previous = previous.vector("previous", model.configuration_len())?;
    let smoothness = Smoothness::new(model, &previous, arguments.number("time_step")?);
    let inputs = smoothness.inputs();
    visitor.visit(
        match weights(arguments, model, inputs.joint_ids(), &["by range"])? {
            JointWeights::Even => smoothness,
            JointWeights::ByRange | JointWeights::Upright => smoothness.by_range(model),
            JointWeights::Given(weights) => smoothness.with_weights(weights),
        },
    )
}

/// Reads weights of these joints: a word for all, a list, or some by name, the others 1.
fn weights<A: Arguments>(
    arguments: &A,
    model: &Model,
    joints: &[JointId],
    words: &[&str],
) -> Result<JointWeights, ErrorOf<A>> {
    let label = A::Value::label("joint_weights");
    let Some(value) = arguments.get("joint_weights")? else {
        return Ok(JointWeights::Even);
    };
    if let Some(word) = value.as_text() {
        return match word.as_str() {
            "by range" => Ok(JointWeights::ByRange),
            "upright" if words.contains(&"upright") => Ok(JointWeights::Upright),
            other => Err(UnknownName::new(
                "joint weights",
                other,
                words.iter().copied(),
            ))
            .or_raise::<A::Value>(),
        };
    }
    if !value.is_map() {
        return Ok(JointWeights::Given(value.vector(&label, joints.len())?));
    }
    let mut weights = vec![1.0; joints.len()];
    for (name, weight) in value.numbers_by_name(&label, "a joint of joint_weights")? {
        let joint = joint_of::<A::Value>(model, &name)?;
        let Some(index) = joints.iter().position(|known| *known == joint) else {
            return Err(A::Value::error(
                ErrorKind::InvalidValue,
                format!("{label} names {name}, which is no joint of the task"),
            ));
        };
        weights[index] = weight;
    }
    Ok(JointWeights::Given(weights))
}
