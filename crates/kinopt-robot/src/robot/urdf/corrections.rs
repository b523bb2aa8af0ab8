//! Corrected joint origins in the text of a URDF file.

use super::origin;
use super::version::Version;
use crate::robot::xml::{Element, Read, Reading, RobotFileError, is, parse};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement};

/// Returns the text of a URDF file with corrected `<origin>` elements of joints; all other text stays.
///
/// A correction is the placement of the corrected joint frame in the joint frame of the file, metres, by the joint's name.
/// Names that the file does not have are ignored.
///
/// # Errors
/// Returns an error for text that is no URDF.
pub fn with_origin_corrections(
    text: &str,
    file: &str,
    corrections: &[(String, Placement<f64>)],
) -> Result<String, RobotFileError> {
    let reading = Reading {
        file,
        text,
        lenient: false,
        repairs: Vec::new().into(),
    };
    let edits = edits(&reading, corrections)?;
    let mut corrected = text.to_owned();
    // From the end, so that earlier positions stay valid.
    for (range, origin) in edits.into_iter().rev() {
        corrected.replace_range(range, &origin);
    }
    Ok(corrected)
}

type Edit = (std::ops::Range<usize>, String);

/// Replacements in the order of the text.
fn edits(reading: &Reading<'_>, corrections: &[(String, Placement<f64>)]) -> Read<Vec<Edit>> {
    let xml = parse(reading.file, reading.text)?;
    let root = xml.root_element();
    let version = Version::of(&Element::new(reading, root, "<robot>".to_owned()));
    let mut edits = Vec::new();
    for node in root.children().filter(|node| is(*node, "joint")) {
        let element = Element::new(reading, node, "<joint>".to_owned());
        let name = element.named()?.name;
        let Some((_, correction)) = corrections.iter().find(|(joint, _)| *joint == name) else {
            continue;
        };
        let placement = origin::read(&element, version)? * *correction;
        let written = written(&placement);
        let edit = match element.child("origin")? {
            Some(origin) => (origin.node.range(), written),
            // Before the first child: a joint has a parent and a child.
            None => match node.first_element_child() {
                Some(first) => {
                    let at = first.range().start;
                    (at..at, written)
                }
                None => continue,
            },
        };
        edits.push(edit);
    }
    Ok(edits)
}

/// The element of a placement, with all digits.
fn written(placement: &Placement<f64>) -> String {
    let [x, y, z] = placement.translation.to_array();
    let [roll, pitch, yaw] = to_roll_pitch_yaw(&placement.rotation);
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

/// Roll, pitch and yaw in radians: the inverse of the reader's R = R_z(yaw) · R_y(pitch) · R_x(roll).
fn to_roll_pitch_yaw(rotation: &Matrix3<f64>) -> [f64; 3] {
    let Matrix3 { x, y, z } = rotation;
    let across = elementary::hypot(x.x, x.y);
    let pitch = elementary::atan2(-x.z, across);
    // At a pitch of 90° only the difference of roll and yaw is defined.
    match across > 1e-12 {
        true => [
            elementary::atan2(y.z, z.z),
            pitch,
            elementary::atan2(x.y, x.x),
        ],
        false => [elementary::atan2(-z.y, y.y), pitch, 0.0],
    }
}
