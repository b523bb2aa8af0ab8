//! Tasks of whole bodies: balance, gaze, velocities, joint couplings.

use kinopt::model::{Masses, PointMass};
use kinopt::spatial::Vector3;
use kinopt::task::{
    Axis, CentreOfMass, FrameVelocity, Gaze, JointCoupling, Manipulability, SupportPolygon,
};
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use super::task::{AnyTask, ResidualVisitor, TaskArguments};
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::masses::masses_of;
use crate::placement;

/// Reads the residual of a task of a kind.
pub(super) fn residual<V: ResidualVisitor>(
    arguments: &TaskArguments<'_, '_>,
    kind: &str,
    visitor: V,
) -> PyResult<Box<dyn AnyTask>> {
    match kind {
        "center of mass" => {
            let target = arguments.numbers::<3>("target")?;
            let mut task = CentreOfMass::new(&masses(arguments)?, target);
            let free: String = arguments.get("free")?.extract()?;
            for axis in free.chars() {
                task = task.free_along(match axis {
                    'x' => Axis::X,
                    'y' => Axis::Y,
                    _ => Axis::Z,
                });
            }
            if let Some(base) = arguments.optional_frame("base")? {
                task = task.relative_to(base);
            }
            visitor.visit(task)
        }
        "support polygon" => {
            let margin = arrays::number(&arguments.get("margin")?, "margin")?;
            let polygon = SupportPolygon::new(&masses(arguments)?)
                .with_points(points(&arguments.get("points")?, "points")?)
                .with_up(arguments.numbers::<3>("up")?)
                .with_margin(margin);
            let mut polygon = polygon;
            for (frame, on) in named(&arguments.get("on")?)? {
                let id = arguments.model.frame(&frame).or_raise()?;
                let what = format!("the points on {frame}");
                polygon = polygon.with_points_on(id, points(&on, &what)?);
            }
            visitor.visit(polygon)
        }
        "gaze" => {
            let (frame, axis) = (arguments.frame("frame")?, arguments.numbers::<3>("axis")?);
            let half_angle = arrays::number(&arguments.get("half_angle")?, "half_angle")?;
            visitor.visit(match arguments.optional("direction")? {
                Some(_) => Gaze::along(
                    frame,
                    axis,
                    arguments.numbers::<3>("direction")?,
                    half_angle,
                ),
                None => Gaze::at(frame, axis, arguments.numbers::<3>("target")?, half_angle),
            })
        }
        "frame velocity" => {
            let previous = placement::placement(&arguments.get("previous")?, "previous")?;
            let time_step_s = arrays::number(&arguments.get("time_step_s")?, "time_step_s")?;
            let velocity = (
                arguments.numbers::<3>("linear")?,
                arguments.numbers::<3>("angular")?,
            );
            let frame = arguments.frame("frame")?;
            visitor.visit(FrameVelocity::new(frame, previous, time_step_s, velocity))
        }
        "joint coupling" => {
            let mut joints = Vec::new();
            for (joint, coefficient) in named(&arguments.get("coefficients")?)? {
                let what = format!("the coefficient of {joint}");
                let coefficient = arrays::number(&coefficient, &what)?;
                joints.push((arguments.model.joint(&joint).or_raise()?, coefficient));
            }
            let offset = arrays::number(&arguments.get("offset")?, "offset")?;
            visitor.visit(JointCoupling::new(arguments.model, joints, offset))
        }
        "manipulability" => {
            let (frame, base) = (arguments.frame("frame")?, arguments.optional_frame("base")?);
            let least = arrays::number(&arguments.get("least")?, "least")?;
            let task = Manipulability::new(arguments.model, base, frame, least);
            let part: String = arguments.get("of")?.extract()?;
            visitor.visit(match part.as_str() {
                "position" => task.of_position(),
                "orientation" => task.of_orientation(),
                _ => task,
            })
        }
        _ => Err(invalid(format!(
            "{} is no task of kinopt.tasks",
            arguments.task.repr()?
        ))),
    }
}

/// Returns the masses of the task, else those of the problem's robot or rig.
fn masses(arguments: &TaskArguments<'_, '_>) -> PyResult<Masses> {
    let Some(masses) = arguments.optional("masses")? else {
        return masses_of(arguments.python_model);
    };
    let mut points = Vec::new();
    for (frame, mass_and_position) in named(&masses)? {
        let (mass, at): (f64, Bound<'_, PyAny>) = mass_and_position.extract()?;
        points.push(PointMass {
            at: arrays::array::<3>(&at, "where a mass is")?.into(),
            frame: arguments.model.frame(&frame).or_raise()?,
            mass,
        });
    }
    Masses::new(arguments.model, points).or_raise()
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
