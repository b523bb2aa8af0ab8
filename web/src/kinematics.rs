//! Where frames stand, and how they move.

use wasm_bindgen::prelude::*;

use crate::model::Model;
use crate::placement::columns;
use crate::raise;
use crate::view;

use kinopt::kinematics::ForwardKinematics as Kinematics;

/// The frames that are asked for, all without names, and their compiled kinematics.
fn compiled(
    model: &Model,
    frames: Option<Vec<String>>,
) -> Result<(Vec<String>, Kinematics), JsError> {
    let model = &model.inner;
    let names = match frames {
        Some(names) => names,
        None => model.frames().iter().map(|own| own.name.clone()).collect(),
    };
    let ids = names.iter().map(|name| model.frame(name));
    let ids = ids.collect::<Result<Vec<_>, _>>().map_err(raise)?;
    let inner = Kinematics::of_frames(model, &ids).map_err(raise)?;
    Ok((names, inner))
}

/// Places frames of one model: built once, asked as often as wanted.
#[wasm_bindgen]
pub struct ForwardKinematics {
    names: Vec<String>,
    inner: Kinematics,
    placed: Vec<f64>,
}

#[wasm_bindgen]
impl ForwardKinematics {
    /// Of these frames, or of all.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, frames: Option<Vec<String>>) -> Result<Self, JsError> {
        let (names, inner) = compiled(model, frames)?;
        Ok(Self {
            inner,
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

/// The Jacobians of frames of one model: built once, asked as often as wanted.
///
/// Six rows a frame: the velocity of its origin (m/s), then its angular velocity (rad/s), in world axes; a column a degree
/// of freedom, one after another.
#[wasm_bindgen]
pub struct Jacobian {
    names: Vec<String>,
    inner: kinopt::kinematics::Jacobian,
    matrix: Vec<f64>,
}

#[wasm_bindgen]
impl Jacobian {
    /// Of these frames, or of all.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, frames: Option<Vec<String>>) -> Result<Self, JsError> {
        let (names, kinematics) = compiled(model, frames)?;
        Ok(Self {
            names,
            inner: kinopt::kinematics::Jacobian::new(kinematics),
            matrix: Vec::new(),
        })
    }

    /// The frames, in the order of the rows.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// How many columns it has.
    #[wasm_bindgen(getter)]
    pub fn columns(&self) -> usize {
        self.inner.columns()
    }

    /// It at a configuration, by columns, where it lies: valid until the next call into the module.
    #[wasm_bindgen(unchecked_return_type = "Float64Array")]
    pub fn at(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<js_sys::Float64Array, JsError> {
        let matrix = self.inner.at(q).map_err(raise)?;
        self.matrix.clear();
        self.matrix.extend_from_slice(matrix.as_slice());
        Ok(view::doubles(&self.matrix))
    }
}

/// Where one frame stands at a configuration: a 4 x 4 matrix by columns. `ForwardKinematics` does the same without compiling
/// each time.
#[wasm_bindgen(js_name = framePlacement)]
pub fn frame_placement(
    model: &Model,
    frame: String,
    #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
) -> Result<Vec<f64>, JsError> {
    let (_, mut kinematics) = compiled(model, Some(vec![frame]))?;
    let placed = kinematics.place(q).map_err(raise)?;
    Ok(placed.iter().flat_map(columns).collect())
}

/// The Jacobian of one frame: six rows, linear before angular, in world axes at its origin; by columns, one a degree of
/// freedom. `Jacobian` does the same without compiling each time.
#[wasm_bindgen(js_name = frameJacobian)]
pub fn frame_jacobian(
    model: &Model,
    frame: String,
    #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
) -> Result<Vec<f64>, JsError> {
    let (_, kinematics) = compiled(model, Some(vec![frame]))?;
    let mut jacobian = kinopt::kinematics::Jacobian::new(kinematics);
    Ok(jacobian.at(q).map_err(raise)?.as_slice().to_vec())
}
