//! Tasks of joints: posture and velocity.

use kinopt::model::{JointId, UnknownName};
use kinopt::task::{Posture, Smoothness};
use wasm_bindgen::prelude::*;

use super::{BoxedTask, Visit};
use crate::given::{self, Given};
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
    given: &Given,
    model: &Model,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let own = &model.inner;
    let reference = given.required("reference")?;
    // A list has a length; an object by joint has none.
    let posture = match given::is_list(&reference) {
        true => Posture::new(own, &configuration(&reference, "reference", model)?),
        false => {
            let values = given.by_name("reference")?;
            let named = values.iter().map(|(joint, value)| {
                let joint = own.joint(joint.as_str()).map_err(raise)?;
                Ok((joint, *value))
            });
            Posture::of_joints(named.collect::<Result<Vec<_>, JsError>>()?)
        }
    };
    let words = ["by range", "upright"];
    let joints = kinopt::task::Residual::joints(&posture);
    visitor.visit(match weights(given, model, &joints, &words)? {
        JointWeights::Even => posture,
        JointWeights::ByRange => posture.by_range(own),
        JointWeights::Upright => posture.upright(own),
        JointWeights::Given(weights) => posture.with_weights(weights),
    })
}

pub(super) fn smoothness(
    given: &Given,
    model: &Model,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let own = &model.inner;
    let previous = configuration(&given.required("previous")?, "previous", model)?;
    let smoothness = Smoothness::new(own, &previous, given.needed("timeStep")?);
    let joints = kinopt::task::Residual::joints(&smoothness);
    visitor.visit(match weights(given, model, &joints, &["by range"])? {
        JointWeights::Even => smoothness,
        JointWeights::ByRange | JointWeights::Upright => smoothness.by_range(own),
        JointWeights::Given(weights) => smoothness.with_weights(weights),
    })
}

/// Reads a whole configuration.
fn configuration(value: &JsValue, what: &str, model: &Model) -> Result<Vec<f64>, JsError> {
    let numbers = given::numbers(value, what)?;
    let (count, asked) = (numbers.len(), model.inner.configuration_len());
    if count != asked {
        let message = format!("{what} has {count} numbers, expected {asked}");
        return Err(JsError::new(&message));
    }
    Ok(numbers)
}

/// Reads weights of these joints: a word for all, a list, or some by name, the others 1.
fn weights(
    given: &Given,
    model: &Model,
    joints: &[JointId],
    words: &[&str],
) -> Result<JointWeights, JsError> {
    let Some(value) = given.get("jointWeights") else {
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
    if given::is_list(&value) {
        let weights = given::numbers(&value, "jointWeights")?;
        let (count, asked) = (weights.len(), joints.len());
        if count != asked {
            let message = format!("jointWeights has {count} numbers, expected {asked}");
            return Err(JsError::new(&message));
        }
        return Ok(JointWeights::Given(weights));
    }
    let mut weights = vec![1.0; joints.len()];
    for (name, weight) in given.by_name("jointWeights")? {
        let joint = model.inner.joint(name.as_str()).map_err(raise)?;
        let Some(at) = joints.iter().position(|own| *own == joint) else {
            let message = format!("jointWeights names {name}, which is no joint of the task");
            return Err(JsError::new(&message));
        };
        weights[at] = weight;
    }
    Ok(JointWeights::Given(weights))
}
