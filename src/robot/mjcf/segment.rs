//! `fromto`: a shape given by its two ends.

use super::attributes::Attributes;
use super::orientation::{direction, turn_of_z_to};
use crate::robot::xml::{Fault, Read};
use crate::spatial::{Placement, Vector3};

/// Its middle, its z axis from the second end to the first, and how far that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) placement: Placement<f64>,
    pub(super) length: f64,
}

/// The segment of an element that has one.
pub(super) fn read(element: &Attributes<'_>) -> Read<Option<Segment>> {
    let attribute = "fromto";
    let Some([ax, ay, az, bx, by, bz]) = element.numbers::<6>(attribute)? else {
        return Ok(None);
    };
    let (from, to) = (Vector3::new(ax, ay, az), Vector3::new(bx, by, bz));
    // MuJoCo's shapes point from `to` to `from`.
    let along = from - to;
    let zero = || element.fault(Fault::ZeroLength { attribute });
    let rotation = turn_of_z_to(direction(along).ok_or_else(zero)?);
    Ok(Some(Segment {
        placement: Placement::new(rotation, (from + to) * 0.5),
        length: along.norm(),
    }))
}
