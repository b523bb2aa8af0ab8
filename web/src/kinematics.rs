//! Forward kinematics and Jacobians.

use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::model::Model;
use crate::placement::columns;
use crate::view;

use kinopt::kinematics::ForwardKinematics as Kinematics;

/// Requested frames, by default all, and their compiled kinematics.
fn compiled(
    model: &Model,
    frames: Option<Vec<String>>,
) -> Result<(Vec<String>, Kinematics), Exception> {
    let model = &model.inner;
    let names = match frames {
        Some(names) => names,
        None => model
            .frames()
            .iter()
            .map(|frame| frame.name.clone())
            .collect(),
    };
    let ids = names.iter().map(|name| model.frame(name));
    let ids = ids.collect::<Result<Vec<_>, _>>().map_err(raise)?;
    let inner = Kinematics::of_frames(model, &ids).map_err(raise)?;
    Ok((names, inner))
}

/// Forward kinematics of frames of a model: compiled once.
#[wasm_bindgen]
pub struct ForwardKinematics {
    names: Vec<String>,
    inner: Kinematics,
    placed: Vec<f64>,
}

#[wasm_bindgen]
impl ForwardKinematics {
    /// Compiles these frames, or all.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, frames: Option<Vec<String>>) -> Result<Self, Exception> {
        let (names, inner) = compiled(model, frames)?;
        Ok(Self {
            inner,
            placed: Vec::with_capacity(16 * names.len()),
            names,
        })
    }

    /// Names of the frames, in the order of the placements.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Poses of the frames in the world: sixteen numbers for each, a matrix by columns. The result is a view, valid
    /// until the next call into the module.
    #[wasm_bindgen(unchecked_return_type = "Float64Array")]
    pub fn place(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<js_sys::Float64Array, Exception> {
        let placed = self.inner.place(q).map_err(raise)?;
        self.placed.clear();
        self.placed.extend(placed.iter().flat_map(columns));
        Ok(view::doubles(&self.placed))
    }
}

/// Jacobians of frames of a model: compiled once.
///
/// Six rows for each frame: the velocity of its origin (m/s), then its angular velocity (rad/s), in world axes. One
/// column for each degree of freedom, stored by columns.
#[wasm_bindgen]
pub struct Jacobian {
    names: Vec<String>,
    inner: kinopt::kinematics::Jacobian,
    matrix: Vec<f64>,
}

#[wasm_bindgen]
impl Jacobian {
    /// Compiles these frames, or all.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, frames: Option<Vec<String>>) -> Result<Self, Exception> {
        let (names, kinematics) = compiled(model, frames)?;
        Ok(Self {
            names,
            inner: kinopt::kinematics::Jacobian::new(kinematics),
            matrix: Vec::new(),
        })
    }

    /// Names of the frames, in the order of the rows.
    #[wasm_bindgen(getter, js_name = frameNames)]
    pub fn frame_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Number of columns.
    #[wasm_bindgen(getter)]
    pub fn columns(&self) -> usize {
        self.inner.columns()
    }

    /// Jacobian at a configuration, by columns, as a view: valid until the next call into the module.
    #[wasm_bindgen(unchecked_return_type = "Float64Array")]
    pub fn at(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<js_sys::Float64Array, Exception> {
        let matrix = self.inner.at(q).map_err(raise)?;
        self.matrix.clear();
        self.matrix.extend_from_slice(matrix.as_slice());
        Ok(view::doubles(&self.matrix))
    }
}

/// Pose of one frame at a configuration: a 4 x 4 matrix by columns. `ForwardKinematics` compiles once.
#[wasm_bindgen(js_name = framePlacement)]
pub fn frame_placement(
    model: &Model,
    frame: String,
    #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
) -> Result<Vec<f64>, Exception> {
    let (_, mut kinematics) = compiled(model, Some(vec![frame]))?;
    let placed = kinematics.place(q).map_err(raise)?;
    Ok(placed.iter().flat_map(columns).collect())
}

/// Jacobian of one frame: six rows, linear before angular, in world axes at its origin; by columns, one for each degree
/// of freedom. `Jacobian` compiles once.
#[wasm_bindgen(js_name = frameJacobian)]
pub fn frame_jacobian(
    model: &Model,
    frame: String,
    #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
) -> Result<Vec<f64>, Exception> {
    let (_, kinematics) = compiled(model, Some(vec![frame]))?;
    let mut jacobian = kinopt::kinematics::Jacobian::new(kinematics);
    Ok(jacobian.at(q).map_err(raise)?.as_slice().to_vec())
}
