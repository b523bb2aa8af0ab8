//! `<origin>`: poses, with rotations as roll-pitch-yaw angles or quaternions.

use super::version::Version;
use crate::robot::xml::{Element, ParseIssue, Read, rotation_of_wxyz};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Pose from the child `<origin>` of an element; the identity without one.
pub(super) fn read(element: &Element<'_>, version: Version) -> Read<Placement<f64>> {
    let Some(origin) = element.child("origin")? else {
        return Ok(Placement::identity());
    };
    let xyz = origin.numbers::<3>("xyz")?.unwrap_or_default();
    let rpy = origin.numbers::<3>("rpy")?;
    let quaternion = origin.numbers::<4>("quat_xyzw")?;
    let bad = |problem| Err(origin.fault(ParseIssue::BadQuaternion { problem }));
    let rotation = match (rpy, quaternion) {
        (rpy, None) => Matrix3::from_roll_pitch_yaw(rpy.unwrap_or_default()),
        _ if version < Version(1, 1) => return bad("needs <robot version=\"1.1\">"),
        (Some(_), Some(_)) => return bad("and `rpy` are both given"),
        // URDF orders quaternions as x, y, z, w.
        (None, Some([x, y, z, w])) => match rotation_of_wxyz([w, x, y, z]) {
            Some(rotation) => rotation,
            None => return bad("is zero and no rotation"),
        },
    };
    Ok(Placement::new(rotation, Vector3::from(xyz)))
}
