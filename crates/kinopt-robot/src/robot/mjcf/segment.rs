//! `fromto`: a shape given by its two end points.

use super::attributes::Attributes;
use super::orientation::{direction, rotation_of_z_to};
use crate::robot::xml::{ParseIssue, Read};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Pose at the midpoint with z from the second end to the first, and the distance of the ends in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromTo {
    pub(super) placement: Placement<f64>,
    pub(super) length: f64,
}

/// Reads the `fromto` attribute of an element.
pub(super) fn read(element: &Attributes<'_>) -> Read<Option<FromTo>> {
    let attribute = "fromto";
    let Some([ax, ay, az, bx, by, bz]) = element.numbers::<6>(attribute)? else {
        return Ok(None);
    };
    let (from, to) = (Vector3::new(ax, ay, az), Vector3::new(bx, by, bz));
    // As in MuJoCo, z points from `to` to `from`.
    let along = from - to;
    let zero = || element.fault(ParseIssue::ZeroLength { attribute });
    let rotation = rotation_of_z_to(direction(along).ok_or_else(zero)?);
    Ok(Some(FromTo {
        placement: Placement::new(rotation, (from + to) * 0.5),
        length: along.norm(),
    }))
}
