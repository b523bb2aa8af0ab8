//! Local transforms of bones.

use glam::{Affine3A, Mat3A, Quat, Vec3A, Vec4, Vec4Swizzles};

/// Largest cosine between axes at which a matrix counts as free of shear. Rounding in single precision over a chain of
/// products stays below it.
const MAX_AXIS_COSINE: f32 = 1e-4;

/// Transform of a bone in its parent: scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalTransform {
    /// In the model's unit.
    pub translation: Vec3A,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Along the bone's own axes.
    pub scale: Vec3A,
}

impl LocalTransform {
    /// The identity: the bone coincides with its parent.
    pub const IDENTITY: Self = Self {
        translation: Vec3A::ZERO,
        rotation: Quat::IDENTITY,
        scale: Vec3A::ONE,
    };

    /// The transform as a matrix.
    #[inline]
    #[must_use]
    pub fn to_affine(&self) -> Affine3A {
        let [x, y, z] = rotation_axes(self.rotation);
        let [sx, sy, sz] = self.scale.to_array();
        Affine3A {
            matrix3: Mat3A::from_cols(x * sx, y * sy, z * sz),
            translation: self.translation,
        }
    }

    /// Decomposes a matrix into scale, rotation and translation; a mirror has a negative x scale. `None` if the matrix
    /// shears, is singular or not finite.
    #[must_use]
    pub fn of_affine(matrix: &Affine3A) -> Option<Self> {
        let Mat3A {
            x_axis: x,
            y_axis: y,
            z_axis: z,
        } = matrix.matrix3;
        let handedness = x.cross(y).dot(z).signum();
        let lengths = Vec3A::new(handedness * x.length(), y.length(), z.length());
        let axes = [x / lengths.x, y / lengths.y, z / lengths.z];
        let [x, y, z] = axes;
        let cosines = [x.dot(y), y.dot(z), z.dot(x)];
        // These comparisons fail for NaN, which results from a zero length.
        let is_orthogonal = cosines
            .into_iter()
            .all(|cosine| cosine.abs() <= MAX_AXIS_COSINE);
        let rotation = Quat::from_mat3a(&Mat3A::from_cols(x, y, z)).normalize();
        let local = Self {
            translation: matrix.translation,
            rotation,
            scale: lengths,
        };
        (is_orthogonal && local.is_valid()).then_some(local)
    }

    /// Returns true if all numbers are finite and the rotation is a unit quaternion.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        // A rotation that is not finite does not have unit length.
        self.translation.is_finite() && self.scale.is_finite() && self.rotation.is_normalized()
    }
}

/// Columns of a unit quaternion's rotation matrix. Six vector products take half the instructions of
/// `Mat3A::from_quat`.
#[inline(always)]
fn rotation_axes(rotation: Quat) -> [Vec3A; 3] {
    let q = Vec4::from(rotation);
    let twice = q + q;
    let a = Vec3A::from_vec4(q.yxww()) * Vec3A::new(-1.0, 1.0, -1.0);
    let b = Vec3A::from_vec4(q.zwxx()) * Vec3A::new(-1.0, 1.0, 1.0);
    let c = Vec3A::from_vec4(q.wzyy()) * Vec3A::new(-1.0, -1.0, 1.0);
    let [x2, y2, z2] = [twice.xxxx(), twice.yyyy(), twice.zzzz()].map(Vec3A::from_vec4);
    [
        Vec3A::X + y2 * a + z2 * b,
        Vec3A::Y - x2 * a + z2 * c,
        Vec3A::Z - x2 * b - y2 * c,
    ]
}
