//! Placements from and to nalgebra's isometries and glam's affine maps.
//!
//! What is rigid by its type converts by `From`. An affine map may scale, shear or mirror, so it
//! becomes a placement by `TryFrom`: nothing of it is dropped unsaid.

use glam::{Affine3A, DAffine3, DMat3, Mat3A, Vec3A};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion};

use super::{Matrix3, Placement, Vector3};

/// How far a map in double precision may be from a rigid motion, entry by entry.
const DOUBLE: f64 = 1e-6;
/// The same in single precision, after products along a chain of bones.
const SINGLE: f64 = 1e-4;

/// An affine map that is no rigid motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the affine map is not a rigid motion: {0}")]
pub struct NotRigid(
    /// What is wrong, in words.
    pub &'static str,
);

impl From<&Isometry3<f64>> for Placement<f64> {
    fn from(isometry: &Isometry3<f64>) -> Self {
        let rotation = isometry.rotation.to_rotation_matrix().into_inner();
        Self::new(rotation.into(), isometry.translation.vector.into())
    }
}

impl From<Isometry3<f64>> for Placement<f64> {
    fn from(isometry: Isometry3<f64>) -> Self {
        Self::from(&isometry)
    }
}

impl From<&Placement<f64>> for Placement<f64> {
    fn from(placement: &Placement<f64>) -> Self {
        *placement
    }
}

impl From<&Placement<f64>> for Isometry3<f64> {
    fn from(placement: &Placement<f64>) -> Self {
        let rotation = Rotation3::from_matrix_unchecked(placement.rotation.into());
        Self::from_parts(
            Translation3::from(nalgebra::Vector3::from(placement.translation)),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }
}

impl From<Placement<f64>> for Isometry3<f64> {
    fn from(placement: Placement<f64>) -> Self {
        Self::from(&placement)
    }
}

/// Rounded to single precision.
impl From<Placement<f64>> for Affine3A {
    fn from(placement: Placement<f64>) -> Self {
        let Placement {
            rotation,
            translation,
        } = placement;
        let column = |v: Vector3<f64>| Vec3A::new(v.x as f32, v.y as f32, v.z as f32);
        Self {
            matrix3: Mat3A::from_cols(column(rotation.x), column(rotation.y), column(rotation.z)),
            translation: column(translation),
        }
    }
}

impl From<Placement<f64>> for DAffine3 {
    fn from(placement: Placement<f64>) -> Self {
        let Matrix3 { x, y, z } = placement.rotation;
        let [x, y, z] = [x, y, z].map(|column| column.to_array().into());
        Self {
            matrix3: DMat3::from_cols(x, y, z),
            translation: placement.translation.to_array().into(),
        }
    }
}

/// A map that is rigid within 1e-6; its rotation is replaced by the one next to it where it is off by
/// more than rounding.
impl TryFrom<DAffine3> for Placement<f64> {
    type Error = NotRigid;

    fn try_from(map: DAffine3) -> Result<Self, NotRigid> {
        rigid(map, DOUBLE)
    }
}

/// A map that is rigid within 1e-4, as single precision and products of bones leave it; its rotation
/// is replaced by the one next to it.
impl TryFrom<Affine3A> for Placement<f64> {
    type Error = NotRigid;

    fn try_from(map: Affine3A) -> Result<Self, NotRigid> {
        let matrix3 = glam::Mat3::from(map.matrix3).as_dmat3();
        let translation = map.translation.as_dvec3();
        rigid(
            DAffine3 {
                matrix3,
                translation,
            },
            SINGLE,
        )
    }
}

fn rigid(map: DAffine3, within: f64) -> Result<Placement<f64>, NotRigid> {
    let DMat3 {
        x_axis,
        y_axis,
        z_axis,
    } = map.matrix3;
    let [x, y, z, origin] =
        [x_axis, y_axis, z_axis, map.translation].map(|v| Vector3::from(v.to_array()));
    let placement = Placement::new(Matrix3::from_columns(x, y, z), origin);
    placement.check_rigid(within).map_err(NotRigid)?;
    Ok(placement.made_rigid())
}
