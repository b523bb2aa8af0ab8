//! Conversions of vectors, rotations and placements from and to the types of nalgebra and glam.
//!
//! Types that are rigid by construction convert by `From`. An affine map may scale, shear or mirror, so it converts by
//! `TryFrom` and returns an error if it is not rigid. A glam quaternion is assumed to be of unit length; a placement
//! built from any other fails [`Placement::check_rigid`].

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Mat3A, Quat, Vec3, Vec3A};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, UnitVector3};

use super::{Matrix3, Placement, Quaternion, RigidDefect, Vector3};

/// Largest deviation of a double-precision map from a rigid motion, per entry.
const DOUBLE_TOLERANCE: f64 = 1e-6;
/// Largest deviation of a single-precision map from a rigid motion, per entry, after products along a chain of bones.
const SINGLE_TOLERANCE: f64 = 1e-4;

/// The error for an affine map that is not a rigid motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the affine map is not a rigid motion: {0}")]
pub struct NotRigid(
    /// The defect.
    pub RigidDefect,
);

/// Implements `From` for each pair by an expression of the value.
macro_rules! convert {
    ($($(#[$doc:meta])* $from:ty => $to:ty: |$value:ident| $expression:expr;)*) => {
        $($(#[$doc])* impl From<$from> for $to {
            fn from($value: $from) -> Self {
                $expression
            }
        })*
    };
}

convert! {
    nalgebra::Vector3<f64> => Vector3<f64>: |v| Self::new(v.x, v.y, v.z);
    Vector3<f64> => nalgebra::Vector3<f64>: |v| Self::new(v.x, v.y, v.z);
    UnitVector3<f64> => Vector3<f64>: |v| v.into_inner().into();
    Point3<f64> => Vector3<f64>: |p| p.coords.into();
    Vector3<f64> => Point3<f64>: |p| Self::new(p.x, p.y, p.z);
    DVec3 => Vector3<f64>: |v| v.to_array().into();
    Vector3<f64> => DVec3: |v| v.to_array().into();
    Vec3 => Vector3<f64>: |v| v.as_dvec3().into();
    Vec3A => Vector3<f64>: |v| v.as_dvec3().into();

    nalgebra::Matrix3<f64> => Matrix3<f64>: |m| {
        let column = |j| Vector3::new(m[(0, j)], m[(1, j)], m[(2, j)]);
        Self::from_columns(column(0), column(1), column(2))
    };
    Matrix3<f64> => nalgebra::Matrix3<f64>: |m| Self::from_columns(&[m.x.into(), m.y.into(), m.z.into()]);
    Rotation3<f64> => Matrix3<f64>: |r| r.into_inner().into();
    UnitQuaternion<f64> => Matrix3<f64>: |q| q.to_rotation_matrix().into();
    DMat3 => Matrix3<f64>: |m| Self::from_columns(m.x_axis.into(), m.y_axis.into(), m.z_axis.into());
    Matrix3<f64> => DMat3: |m| Self::from_cols(m.x.into(), m.y.into(), m.z.into());
    DQuat => Matrix3<f64>: |q| Quaternion::from(q).to_matrix();
    Quat => Matrix3<f64>: |q| {
        // `q` is of unit length in single precision only.
        q.as_dquat().normalize().into()
    };
    Quaternion<f64> => Matrix3<f64>: |q| q.to_matrix();

    UnitQuaternion<f64> => Quaternion<f64>: |q| Self { w: q.w, v: Vector3::new(q.i, q.j, q.k) };
    DQuat => Quaternion<f64>: |q| Self { w: q.w, v: Vector3::new(q.x, q.y, q.z) };
    Quat => Quaternion<f64>: |q| q.as_dquat().into();
    Quaternion<f64> => DQuat: |q| Self::from_xyzw(q.v.x, q.v.y, q.v.z, q.w);

    /// A placement without rotation.
    Vector3<f64> => Placement<f64>: |v| Self::translation(v);
    Translation3<f64> => Placement<f64>: |t| Self::translation(t.vector.into());
    UnitQuaternion<f64> => Placement<f64>: |q| Self::new(q.into(), Vector3::zero());
}

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

/// Rounds to single precision.
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
        Self {
            matrix3: placement.rotation.into(),
            translation: placement.translation.into(),
        }
    }
}

/// Converts a map that is rigid within 1e-6 per entry.
///
/// Replaces the rotation by the nearest exact one if it is off by more than rounding.
impl TryFrom<DAffine3> for Placement<f64> {
    type Error = NotRigid;

    fn try_from(map: DAffine3) -> Result<Self, NotRigid> {
        rigid(map, DOUBLE_TOLERANCE)
    }
}

/// Converts a map that is rigid within 1e-4 per entry: the accuracy of single-precision products along bones.
///
/// Replaces the rotation by the nearest exact one.
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
            SINGLE_TOLERANCE,
        )
    }
}

fn rigid(map: DAffine3, tolerance: f64) -> Result<Placement<f64>, NotRigid> {
    let placement = Placement::new(map.matrix3.into(), map.translation.into());
    placement.check_rigid(tolerance).map_err(NotRigid)?;
    Ok(placement.made_rigid())
}
