//! Tasks of whole bodies: balance, gaze, velocities, joint couplings.

use kinopt::model::{Masses, PointMass};
use kinopt::spatial::Vector3;
use kinopt::task::{
    Axis, CentreOfMass, FrameVelocity, Gaze, JointCoupling, Manipulability, SupportPolygon,
};
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use super::task::{AnyTask, Given, Visit};
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::masses::masses_of;
use crate::placement;

/// Reads the residual of a task of a kind.
pub(super) fn residual<V: Visit>(
    given: &Given<'_, '_>,
    kind: &str,
    visitor: V,
) -> PyResult<Box<dyn AnyTask>> {
    match kind {
        "center of mass" => {
            let target = given.numbers::<3>("target")?;
            let mut task = CentreOfMass::new(&masses(given)?, target);
            let free: String = given.get("free")?.extract()?;
            for axis in free.chars() {
                task = task.free_along(match axis {
                    'x' => Axis::X,
                    'y' => Axis::Y,
                    _ => Axis::Z,
                });
            }
            if let Some(base) = given.optional_frame("base")? {
                task = task.relative_to(base);
            }
            visitor.visit(task)
        }
        "support polygon" => {
            let margin = arrays::number(&given.get("margin")?, "margin")?;
            let polygon = SupportPolygon::new(&masses(given)?)
                .with_points(points(&given.get("points")?, "points")?)
                .with_up(given.numbers::<3>("up")?)
                .with_margin(margin);
            let mut polygon = polygon;
            for (frame, on) in named(&given.get("on")?)? {
                let id = given.model.frame(&frame).or_raise()?;
                let what = format!("the points on {frame}");
                polygon = polygon.with_points_on(id, points(&on, &what)?);
            }
            visitor.visit(polygon)
        }
        "gaze" => {
            let (frame, axis) = (given.frame("frame")?, given.numbers::<3>("axis")?);
            let half_angle = arrays::number(&given.get("half_angle")?, "half_angle")?;
            visitor.visit(match given.optional("direction")? {
                Some(_) => Gaze::along(frame, axis, given.numbers::<3>("direction")?, half_angle),
                None => Gaze::at(frame, axis, given.numbers::<3>("target")?, half_angle),
            })
        }
        "frame velocity" => {
            let previous = placement::placement(&given.get("previous")?, "previous")?;
            let time_step_s = arrays::number(&given.get("time_step_s")?, "time_step_s")?;
            let velocity = (
                given.numbers::<3>("linear")?,
                given.numbers::<3>("angular")?,
            );
            let frame = given.frame("frame")?;
            visitor.visit(FrameVelocity::new(frame, previous, time_step_s, velocity))
        }
        "joint coupling" => {
            let mut joints = Vec::new();
            for (joint, coefficient) in named(&given.get("coefficients")?)? {
                let what = format!("the coefficient of {joint}");
                let coefficient = arrays::number(&coefficient, &what)?;
                joints.push((given.model.joint(&joint).or_raise()?, coefficient));
            }
            let offset = arrays::number(&given.get("offset")?, "offset")?;
            visitor.visit(JointCoupling::new(given.model, joints, offset))
        }
        "manipulability" => {
            let (frame, base) = (given.frame("frame")?, given.optional_frame("base")?);
            let least = arrays::number(&given.get("least")?, "least")?;
            let task = Manipulability::new(given.model, base, frame, least);
            let of: String = given.get("of")?.extract()?;
            visitor.visit(match of.as_str() {
                "position" => task.of_position(),
                "orientation" => task.of_orientation(),
                _ => task,
            })
        }
        _ => Err(invalid(format!(
            "{} is no task of kinopt.tasks",
            given.task.repr()?
        ))),
    }
}

/// Returns the masses of the task, else those of the problem's robot or rig.
fn masses(given: &Given<'_, '_>) -> PyResult<Masses> {
    let Some(own) = given.optional("masses")? else {
        return masses_of(given.whole);
    };
    let mut points = Vec::new();
    for (frame, own) in named(&own)? {
        let (mass, at): (f64, Bound<'_, PyAny>) = own.extract()?;
        points.push(PointMass {
            at: arrays::array::<3>(&at, "where a mass is")?.into(),
            frame: given.model.frame(&frame).or_raise()?,
            mass,
        });
    }
    Masses::new(given.model, points).or_raise()
}

fn points(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Vector3<f64>>> {
    let rows = arrays::rows(value, what, 3)?;
    let points = rows.chunks_exact(3).map(|p| Vector3::new(p[0], p[1], p[2]));
    Ok(points.collect())
}

/// Returns the items of a dict by name.
fn named<'py>(value: &Bound<'py, PyAny>) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let items = value.cast::<PyMapping>()?.items()?;
    items.iter().map(|item| item.extract()).collect()
}
