//! Hinges and held parts of skeletons.

use kinopt::ik::hold_postures;
use kinopt::motion::posing::guess_hinges;
use kinopt::skeleton::Hinge;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::object;
use crate::skeleton::Skeleton;
use crate::value::Value;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Joint of a bone about one axis. */
export interface Hinge {
    /** Axis in the axes of the bone. */
    axis: readonly [number, number, number];
    /** Lower and upper bound from rest, radians. */
    range: readonly [number, number];
    /** Of a guessed hinge: angle between the two segments of the limb at rest, radians. */
    restBend?: number;
    /** Of a guessed hinge: reason for the axis. */
    source?: string;
}

/** Hinges by bone. */
export type Hinges = Record<string, Hinge>;
"#;

#[wasm_bindgen]
extern "C" {
    /// Hinges as an object.
    #[wasm_bindgen(typescript_type = "Hinges")]
    pub type Hinges;
    /// Posture tasks as objects.
    #[wasm_bindgen(typescript_type = "Task[]")]
    pub type PostureTasks;
}

fn hinge_object(hinge: &Hinge) -> js_sys::Object {
    let limits = [hinge.limits.lower, hinge.limits.upper];
    let numbers = |values: &[f64]| {
        values
            .iter()
            .map(|v| JsValue::from(*v))
            .collect::<js_sys::Array>()
    };
    object::of([
        ("axis", numbers(&hinge.axis.to_array()).into()),
        ("range", numbers(&limits).into()),
    ])
}

#[wasm_bindgen]
impl Skeleton {
    /// Hinges by bone.
    #[wasm_bindgen(getter)]
    pub fn hinges(&self) -> Hinges {
        let by_bone = object::of([]);
        for (bone, hinge) in self.inner.hinges() {
            object::add(&by_bone, [(bone.as_str(), hinge_object(&hinge).into())]);
        }
        JsValue::from(by_bone).unchecked_into()
    }

    /// The skeleton with other hinges; `{}` for none. The bend of a hinged bone is the angle about its axis, and both
    /// twists are locked.
    #[wasm_bindgen(js_name = withHinges)]
    pub fn with_hinges(&self, hinges: Hinges) -> Result<Self, Exception> {
        let entries = js_sys::Object::entries(hinges.unchecked_ref());
        let entries = entries.iter().map(|entry| {
            let pair = js_sys::Array::from(&entry);
            (
                pair.get(0).as_string().unwrap_or_default(),
                Value(pair.get(1)),
            )
        });
        let hinges = kinopt_bindings::hinges::hinges(entries.collect())?;
        Ok(self.inner.with_hinges(&hinges).map_err(raise)?.into())
    }

    /// Posture tasks for a drag of the tips of `dragged`: all bones stay near the angles `q`, radians, and the spine with
    /// five times the weight of the limbs.
    #[wasm_bindgen(js_name = holdPostures)]
    pub fn hold_postures(
        &self,
        dragged: Vec<String>,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<PostureTasks, Exception> {
        let holds = self.inner.holds(&self.bones_named(&dragged)?);
        let names = self.inner.model().joints();
        let tasks = hold_postures(&holds, &self.inner, q).map_err(raise)?;
        let tasks = tasks.iter().map(|task| {
            let reference = object::of([]);
            for (joint, value) in task.residual.values() {
                object::add(
                    &reference,
                    [(names[joint.index()].name.as_str(), value.into())],
                );
            }
            JsValue::from(object::of([
                ("kind", "posture".into()),
                ("name", task.name.as_deref().into()),
                ("scale", task.factor.into()),
                ("reference", reference.into()),
            ]))
        });
        Ok(JsValue::from(tasks.collect::<js_sys::Array>()).unchecked_into())
    }
}

#[wasm_bindgen]
impl Skeleton {
    /// Guessed hinges of knees and elbows by bone, with the reason for each axis. `withHinges` applies them.
    #[wasm_bindgen(js_name = guessHinges)]
    pub fn guess_hinges(&self) -> Hinges {
        let by_bone = object::of([]);
        for guess in guess_hinges(&self.inner) {
            let hinge = hinge_object(&guess.hinge);
            let (bend, source) = (guess.rest_bend.into(), guess.source.to_string().into());
            object::add(&hinge, [("restBend", bend), ("source", source)]);
            object::add(&by_bone, [(guess.bone.as_str(), hinge.into())]);
        }
        JsValue::from(by_bone).unchecked_into()
    }
}
