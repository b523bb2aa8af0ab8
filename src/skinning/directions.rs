//! Normals and tangents under a blended matrix.

use glam::{Mat3A, Vec3, Vec3A, Vec4};

/// M⁻ᵀ n / ‖M⁻ᵀ n‖; zero where it has no direction. The cofactors of M are its inverse transpose
/// times its determinant, so only the determinant's sign is needed and a singular M is no special
/// case.
pub(super) fn turned_normal(matrix: &Mat3A, normal: Vec3) -> Vec3 {
    let largest = normal.abs().max_element();
    if largest == 0.0 {
        return Vec3::ZERO;
    }
    // Scaled, because the square of a short normal would underflow.
    let n = Vec3A::from(normal / largest);
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let cofactors = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let turned = Vec3::from((cofactors * n).normalize_or_zero());
    if x.dot(cofactors.x_axis) < 0.0 {
        -turned
    } else {
        turned
    }
}

/// A tangent lies in the surface, so the matrix itself moves it: M t / ‖M t‖. The bitangent w n × t
/// changes its sign against the normal's where M mirrors.
pub(super) fn turned_tangent(matrix: &Mat3A, tangent: Vec4) -> Vec4 {
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
    let turned = *matrix * Vec3A::from(direction / largest);
    Vec3::from(turned.normalize_or_zero()).extend(sign)
}
