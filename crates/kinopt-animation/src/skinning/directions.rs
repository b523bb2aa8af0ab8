//! Normals and tangents under a blended matrix.

use glam::{Mat3A, Vec3, Vec3A, Vec4};

/// Normal M⁻ᵀ n / ‖M⁻ᵀ n‖, or zero without a direction. The cofactor matrix of M is det(M) M⁻ᵀ, so only the sign of the
/// determinant is needed, also for a singular M.
pub(super) fn transformed_normal(matrix: &Mat3A, normal: Vec3) -> Vec3 {
    let largest = normal.abs().max_element();
    if largest == 0.0 {
        return Vec3::ZERO;
    }
    // Scaled, because the square of a short normal would underflow.
    let n = Vec3A::from(normal / largest);
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let cofactors = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let transformed = Vec3::from((cofactors * n).normalize_or_zero());
    if x.dot(cofactors.x_axis) < 0.0 {
        -transformed
    } else {
        transformed
    }
}

/// Tangent M t / ‖M t‖. A tangent lies in the surface, so M itself transforms it. The sign w of the bitangent w n × t
/// changes if M mirrors.
pub(super) fn transformed_tangent(matrix: &Mat3A, tangent: Vec4) -> Vec4 {
    let direction = tangent.truncate();
    let largest = direction.abs().max_element();
    let sign = if matrix.determinant() < 0.0 {
        -tangent.w
    } else {
        tangent.w
    };
    if largest == 0.0 {
        return Vec4::new(0.0, 0.0, 0.0, sign);
    }
    let transformed = *matrix * Vec3A::from(direction / largest);
    Vec3::from(transformed.normalize_or_zero()).extend(sign)
}
