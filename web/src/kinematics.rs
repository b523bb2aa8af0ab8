//! Where frames stand.

use wasm_bindgen::prelude::*;

use crate::model::Model;
use crate::placement::columns;
use crate::raise;
use crate::view;

/// Places frames of one model: built once, asked as often as wanted.
#[wasm_bindgen]
pub struct ForwardKinematics {
    names: Vec<String>,
    inner: kinopt::kinematics::ForwardKinematics,
    placed: Vec<f64>,
}

#[wasm_bindgen]
impl ForwardKinematics {
    /// Of these frames, or of all.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, frames: Option<Vec<String>>) -> Result<Self, JsError> {
        let model = &model.inner;
        let names = match frames {
            Some(names) => names,
            None => model.frames().iter().map(|own| own.name.clone()).collect(),
        };
        let ids = names.iter().map(|name| model.frame(name));
        let ids = ids.collect::<Result<Vec<_>, _>>().map_err(raise)?;
        let inner = kinopt::kinematics::ForwardKinematics::of_frames(model, &ids);
        Ok(Self {
            inner: inner.map_err(raise)?,
            placed: Vec::with_capacity(16 * names.len()),
            names,
        })
    }

    /// The frames, in the order of the placements.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Where they stand in the world: sixteen numbers a frame, a matrix by columns, where they lie: valid until the next
    /// call into the module.
    #[wasm_bindgen(unchecked_return_type = "Float64Array")]
    pub fn place(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<js_sys::Float64Array, JsError> {
        let placed = self.inner.place(q).map_err(raise)?;
        self.placed.clear();
        self.placed.extend(placed.iter().flat_map(columns));
        Ok(view::doubles(&self.placed))
    }
}
