//! Where a bone stands in its parent.

use glam::{Affine3A, Mat3A, Quat, Vec3A, Vec4, Vec4Swizzles};

/// Cosine between axes up to which a matrix counts as without shear: single precision and a chain of
/// products stay below it.
const SQUARE: f32 = 1e-4;

/// A bone's place in its parent: scaled, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalTransform {
    /// In the model's own unit.
    pub translation: Vec3A,
    /// Of unit length.
    pub rotation: Quat,
    /// Along the bone's own axes.
    pub scale: Vec3A,
}

impl LocalTransform {
    /// Where the parent is.
    pub const IDENTITY: Self = Self {
        translation: Vec3A::ZERO,
        rotation: Quat::IDENTITY,
        scale: Vec3A::ONE,
    };

    /// The same as a matrix.
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

    /// The scale, rotation and translation that a matrix is; a mirror scales x by a negative number.
    /// `None` for one that shears, flattens space or is not finite.
    #[must_use]
    pub fn of_affine(matrix: &Affine3A) -> Option<Self> {
        let Mat3A {
            x_axis: x,
            y_axis: y,
            z_axis: z,
        } = matrix.matrix3;
        let side = x.cross(y).dot(z).signum();
        let lengths = Vec3A::new(side * x.length(), y.length(), z.length());
        let axes = [x / lengths.x, y / lengths.y, z / lengths.z];
        let [x, y, z] = axes;
        let square = [x.dot(y), y.dot(z), z.dot(x)];
        // Comparisons that NaN fails: a length of zero gives it.
        let square = square.into_iter().all(|cosine| cosine.abs() <= SQUARE);
        let rotation = Quat::from_mat3a(&Mat3A::from_cols(x, y, z)).normalize();
        let local = Self {
            translation: matrix.translation,
            rotation,
            scale: lengths,
        };
        (square && local.is_valid()).then_some(local)
    }

    /// Whether all its numbers are finite and the rotation is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        // No length of what is not finite is 1.
        self.translation.is_finite() && self.scale.is_finite() && self.rotation.is_normalized()
    }
}

/// The columns of a unit quaternion's rotation matrix. Six products of vectors instead of the
/// entries one by one: half the instructions of `Mat3A::from_quat`.
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
