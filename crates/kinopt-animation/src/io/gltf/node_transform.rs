//! NodeRest transform of a node: translation, rotation and scale, or a matrix that is decomposed.

use glam::{DAffine3, DMat3, DVec3, Quat, Vec3A};
use gltf_json::Node;

use crate::animation::{Decomposition, LocalTransform};

/// Largest off-diagonal entry of a matrix's stretch, relative to its largest entry. Files with five digits pass.
const MAX_SHEAR: f64 = 1e-4;

/// NodeRest transform of a node, and the repair that was needed.
pub(super) struct NodeRest {
    pub(super) rest: LocalTransform,
    pub(super) repair: Option<String>,
}

/// The local transform of a node, or the faulty key and its problem.
pub(super) fn local(node: &Node) -> Result<NodeRest, (&'static str, String)> {
    let (rest, row_repair) = match &node.matrix {
        Some(matrix) => decomposed(matrix).map_err(|problem| ("matrix", problem))?,
        None => {
            let [x, y, z, w] = node.rotation.unwrap_or_default().0;
            let rest = LocalTransform {
                translation: Vec3A::from(node.translation.unwrap_or([0.0; 3])),
                rotation: Quat::from_xyzw(x, y, z, w),
                scale: Vec3A::from(node.scale.unwrap_or([1.0; 3])),
            };
            (rest, None)
        }
    };
    let not_finite = |key| Err((key, "is not finite in single precision".into()));
    if !rest.translation.is_finite() {
        return not_finite("translation");
    }
    if !rest.scale.is_finite() {
        return not_finite("scale");
    }
    if !rest.rotation.is_finite() {
        return not_finite("rotation");
    }
    if rest.rotation.is_normalized() {
        return Ok(NodeRest {
            rest,
            repair: row_repair,
        });
    }
    // In double precision the square of a tiny single-precision number does not underflow to 0.
    let rotation = rest.rotation.as_dquat();
    let length = rotation.length();
    if length == 0.0 {
        let problem = "the quaternion is zero; a rotation needs a non-zero quaternion";
        return Err(("rotation", problem.into()));
    }
    let rotation = (rotation / length).as_quat();
    let repair = Some(format!("quaternion of length {length}: normalised"));
    let rest = LocalTransform { rotation, ..rest };
    Ok(NodeRest { rest, repair })
}

/// Decomposes a matrix in column order into translation, rotation and scale.
fn decomposed(matrix: &[f32; 16]) -> Result<(LocalTransform, Option<String>), String> {
    let (affine, repair) = affine(matrix)?;
    let parts = Decomposition::new(&affine).map_err(|error| error.to_string())?;
    let stretch = parts.stretch;
    let scale = DVec3::new(stretch.x_axis.x, stretch.y_axis.y, stretch.z_axis.z);
    let off_diagonal = stretch - DMat3::from_diagonal(scale);
    let entries = |m: DMat3| m.to_cols_array().into_iter().map(f64::abs);
    let largest_entry = |m: DMat3| entries(m).fold(0.0, f64::max);
    if largest_entry(off_diagonal) > MAX_SHEAR * largest_entry(stretch) {
        return Err("shears; only translation, rotation and scale are allowed".into());
    }
    let rest = LocalTransform {
        translation: parts.translation.as_vec3a(),
        rotation: parts.rotation.as_quat().normalize(),
        scale: scale.as_vec3a(),
    };
    Ok((rest, repair))
}

/// Largest deviation of an entry of a matrix's last row from 0 0 0 1: rounding of writers.
const LAST_ROW_TOLERANCE: f32 = 1e-4;

/// A matrix in column order whose last row is 0 0 0 1, and the repair of a last row that deviates by rounding.
pub(super) fn affine(matrix: &[f32; 16]) -> Result<(DAffine3, Option<String>), String> {
    let row = [matrix[3], matrix[7], matrix[11], matrix[15]];
    let exact = [0.0, 0.0, 0.0, 1.0];
    let is_near = |(a, b): (f32, f32)| (a - b).abs() <= LAST_ROW_TOLERANCE;
    if !row.into_iter().zip(exact).all(is_near) {
        return Err(format!("the last row is {row:?}, not 0 0 0 1"));
    }
    let repair = (row != exact).then(|| format!("the last row {row:?} is read as 0 0 0 1"));
    let column = |first: usize| {
        let [x, y, z] = [0, 1, 2].map(|row| matrix[first + row].into());
        DVec3::new(x, y, z)
    };
    let affine = DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(4), column(8)),
        translation: column(12),
    };
    match affine.is_finite() {
        true => Ok((affine, repair)),
        false => Err("has an entry that is not finite in single precision".into()),
    }
}
