//! Nearest points on cylinders and boxes.

use kinopt_kinematics::spatial::Vector3;

/// Signed distance from a point to a surface, metres, negative inside, and the closest point on the surface.
pub(crate) type Nearest = (f64, Vector3<f64>);

/// Nearest point on a cylinder along z, from its radius and half its length.
pub(crate) fn nearest_on_cylinder(p: Vector3<f64>, radius: f64, half: f64) -> Nearest {
    let across = (p.x * p.x + p.y * p.y).sqrt();
    let (x, y) = match across > 0.0 {
        true => (p.x / across, p.y / across),
        false => (1.0, 0.0),
    };
    let at = |r: f64, z: f64| Vector3::new(x * r, y * r, z);
    let (side, end) = (across - radius, p.z.abs() - half);
    match (side > 0.0, end > 0.0) {
        (true, true) => {
            let rim = at(radius, half.copysign(p.z));
            ((p - rim).norm(), rim)
        }
        (true, false) => (side, at(radius, p.z)),
        (false, true) => (end, at(across, half.copysign(p.z))),
        _ if side >= end => (side, at(radius, p.z)),
        _ => (end, at(across, half.copysign(p.z))),
    }
}

/// Nearest point on a box, from half its lengths.
pub(crate) fn nearest_on_cuboid(p: Vector3<f64>, half: Vector3<f64>) -> Nearest {
    let excess = [p.x.abs() - half.x, p.y.abs() - half.y, p.z.abs() - half.z];
    let (position, half) = (p.to_array(), half.to_array());
    let mut nearest = position;
    if excess.iter().any(|&b| b > 0.0) {
        for i in 0..3 {
            nearest[i] = position[i].clamp(-half[i], half[i]);
        }
        let nearest = Vector3::from(nearest);
        return ((p - nearest).norm(), nearest);
    }
    let mut side = 0;
    for i in 1..3 {
        if excess[i] > excess[side] {
            side = i;
        }
    }
    nearest[side] = half[side].copysign(position[side]);
    (excess[side], nearest.into())
}
