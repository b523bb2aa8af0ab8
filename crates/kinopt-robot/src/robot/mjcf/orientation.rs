//! Poses of elements, and the five notations of rotations in MJCF.

use super::attributes::Attributes;
use super::compiler::Compiler;
use crate::robot::xml::{ParseIssue, Read, rotation_of_wxyz};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::scalar::elementary::clean_sin_cos;
use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// Notations of a rotation that override a `quat` of a default class.
const ORIENTATION_ATTRIBUTES: [&str; 4] = ["axisangle", "xyaxes", "zaxis", "euler"];
/// Largest sine of the angle between z and a z axis at which the rotation axis is taken as x.
const PARALLEL_TOLERANCE: f64 = 1e-10;

/// Pose from `pos` and an orientation; identity by default.
pub(super) fn placement(element: &Attributes<'_>, compiler: &Compiler) -> Read<Placement<f64>> {
    let position = element.numbers::<3>("pos")?.unwrap_or_default();
    let rotation = rotation(element, compiler)?;
    Ok(Placement::new(rotation, Vector3::from(position)))
}

fn rotation(element: &Attributes<'_>, compiler: &Compiler) -> Read<Matrix3<f64>> {
    let mut notation = None;
    for layer in element.layers() {
        let mut given = ORIENTATION_ATTRIBUTES
            .into_iter()
            .filter(|notation| layer.text(notation).is_some());
        let first = given.next();
        if given.next().is_some() || first.is_some() && layer.text("quat").is_some() {
            return Err(layer.fault(ParseIssue::SeveralOrientations));
        }
        notation = notation.or(first);
    }
    let zero = |attribute| element.fault(ParseIssue::ZeroLength { attribute });
    let unit = |numbers: &[f64], attribute| {
        let [x, y, z] = [numbers[0], numbers[1], numbers[2]];
        direction(Vector3::new(x, y, z)).ok_or_else(|| zero(attribute))
    };
    Ok(match notation {
        None => match element.numbers::<4>("quat")? {
            None => Matrix3::identity(),
            Some(wxyz) => rotation_of_wxyz(wxyz).ok_or_else(|| zero("quat"))?,
        },
        Some("axisangle") => {
            let numbers = element.numbers::<4>("axisangle")?.unwrap_or_default();
            let angle = numbers[3] * compiler.angle;
            Matrix3::rotation(unit(&numbers, "axisangle")?, clean_sin_cos(angle))
        }
        Some("xyaxes") => {
            let numbers = element.numbers::<6>("xyaxes")?.unwrap_or_default();
            let x = unit(&numbers[..3], "xyaxes")?;
            let y = Vector3::new(numbers[3], numbers[4], numbers[5]);
            let y = direction(y - x * x.dot(y)).ok_or_else(|| zero("xyaxes"))?;
            Matrix3::from_columns(x, y, x.cross(y))
        }
        Some("zaxis") => {
            let numbers = element.numbers::<3>("zaxis")?.unwrap_or_default();
            rotation_of_z_to(unit(&numbers, "zaxis")?)
        }
        _ => {
            let angles = element.numbers::<3>("euler")?.unwrap_or_default();
            of_euler(angles.map(|angle| angle * compiler.angle), compiler)
        }
    })
}

fn of_euler(angles: [f64; 3], compiler: &Compiler) -> Matrix3<f64> {
    let rotations = angles.into_iter().zip(compiler.euler);
    rotations.fold(Matrix3::identity(), |rotation, (angle, (axis, fixed))| {
        let factor = Matrix3::rotation(Vector3::UNITS[axis], clean_sin_cos(angle));
        match fixed {
            true => factor * rotation,
            false => rotation * factor,
        }
    })
}

/// The smallest rotation from z to a unit vector; π about x for the opposite of z.
pub(super) fn rotation_of_z_to(to: Vector3<f64>) -> Matrix3<f64> {
    let perpendicular = Vector3::UNITS[2].cross(to);
    let sin = perpendicular.norm();
    let axis = match sin < PARALLEL_TOLERANCE {
        true => Vector3::UNITS[0],
        false => perpendicular * (1.0 / sin),
    };
    Quaternion::exp(axis * elementary::atan2(sin, to.z)).to_matrix()
}

/// Normalised vector; `None` if it is zero or not finite.
pub(super) fn direction(vector: Vector3<f64>) -> Option<Vector3<f64>> {
    let Vector3 { x, y, z } = vector;
    let largest = x.abs().max(y.abs()).max(z.abs());
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let scaled = Vector3::new(x / largest, y / largest, z / largest);
    Some(scaled * (1.0 / scaled.norm()))
}
