//! Tasks of joints: posture and velocity.

use kinopt::model::{JointId, UnknownName};
use kinopt::task::{Posture, Smoothness};
use wasm_bindgen::prelude::*;

use super::{BoxedTask, Visit};
use crate::arguments::{self, NamedArguments};
use crate::model::Model;
use crate::raise;

/// Weights of joints.
enum JointWeights {
    Even,
    ByRange,
    Upright,
    Given(Vec<f64>),
}

pub(super) fn posture(
    options: &NamedArguments,
    model: &Model,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let inner_model = &model.inner;
    let reference = options.required("reference")?;
    // A list has a length; an object by joint has none.
    let posture = match arguments::is_list(&reference) {
        true => Posture::new(inner_model, &configuration(&reference, "reference", model)?),
        false => {
            let values = options.by_name("reference")?;
            let named = values.iter().map(|(joint, value)| {
                let joint = inner_model.joint(joint.as_str()).map_err(raise)?;
                Ok((joint, *value))
            });
            Posture::of_joints(named.collect::<Result<Vec<_>, JsError>>()?)
        }
    };
    let words = ["by range", "upright"];
    let joints = kinopt::task::Residual::joints(&posture);
    visitor.visit(match weights(options, model, &joints, &words)? {
        JointWeights::Even => posture,
        JointWeights::ByRange => posture.by_range(inner_model),
        JointWeights::Upright => posture.upright(inner_model),
        JointWeights::Given(weights) => posture.with_weights(weights),
    })
}

pub(super) fn smoothness(
    options: &NamedArguments,
    model: &Model,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let inner_model = &model.inner;
    let previous = configuration(&options.required("previous")?, "previous", model)?;
    let smoothness = Smoothness::new(inner_model, &previous, options.needed("timeStep")?);
    let joints = kinopt::task::Residual::joints(&smoothness);
    visitor.visit(match weights(options, model, &joints, &["by range"])? {
        JointWeights::Even => smoothness,
        JointWeights::ByRange | JointWeights::Upright => smoothness.by_range(inner_model),
        JointWeights::Given(weights) => smoothness.with_weights(weights),
    })
}

/// Reads a whole configuration.
fn configuration(value: &JsValue, what: &str, model: &Model) -> Result<Vec<f64>, JsError> {
    let numbers = arguments::numbers(value, what)?;
    let (count, expected) = (numbers.len(), model.inner.configuration_len());
    if count != expected {
        let message = format!("{what} has {count} numbers, expected {expected}");
        return Err(JsError::new(&message));
    }
    Ok(numbers)
}

/// Reads weights of these joints: a word for all, a list, or some by name, the others 1.
fn weights(
    options: &NamedArguments,
    model: &Model,
    joints: &[JointId],
    words: &[&str],
) -> Result<JointWeights, JsError> {
    let Some(value) = options.get("jointWeights") else {
        return Ok(JointWeights::Even);
    };
    if let Some(word) = value.as_string() {
        return match word.as_str() {
            "by range" => Ok(JointWeights::ByRange),
            "upright" if words.contains(&"upright") => Ok(JointWeights::Upright),
            other => {
                let unknown = UnknownName::new("joint weights", other, words.iter().copied());
                Err(raise(unknown))
            }
        };
    }
    if arguments::is_list(&value) {
        let weights = arguments::numbers(&value, "jointWeights")?;
        let (count, expected) = (weights.len(), joints.len());
        if count != expected {
            let message = format!("jointWeights has {count} numbers, expected {expected}");
            return Err(JsError::new(&message));
        }
        return Ok(JointWeights::Given(weights));
    }
    let mut weights = vec![1.0; joints.len()];
    for (name, weight) in options.by_name("jointWeights")? {
        let joint = model.inner.joint(name.as_str()).map_err(raise)?;
        let Some(index) = joints.iter().position(|known| *known == joint) else {
            let message = format!("jointWeights names {name}, which is no joint of the task");
            return Err(JsError::new(&message));
        };
        weights[index] = weight;
    }
    Ok(JointWeights::Given(weights))
}
