//! Tasks of whole bodies: balance, velocities, joint couplings.

use kinopt::model::{Masses, PointMass, UnknownName};
use kinopt::task::{CentreOfMass, FrameVelocity, JointCoupling, Manipulability, SupportPolygon};

use super::{BoxedTask, TaskModel, Visit};
use crate::error::ErrorKind;
use crate::names::{AXES, named};
use crate::value::{Arguments, ErrorOf, OrRaise, Value, joint_of};

/// Converts the residual of a task of a kind.
pub(super) fn residual<A: Arguments>(
    arguments: &A,
    on: &TaskModel<'_, A::Value>,
    kind: &str,
    visitor: impl Visit<A::Value>,
) -> Result<BoxedTask<A::Value>, ErrorOf<A>> {
    let model = on.model;
    let frame = || arguments.frame(model, "frame");
    match kind {
        "center of mass" => {
            let task = centre_of_mass(arguments, on)?;
            visitor.visit(match arguments.optional_frame(model, "base")? {
                Some(base) => task.relative_to(base),
                None => task,
            })
        }
        "support polygon" => {
            let mut polygon = SupportPolygon::new(&masses(arguments, on)?)
                .with_margin(arguments.number_or("margin", 0.0)?);
            if let Some(points) = arguments.get("points")? {
                polygon = polygon.with_points(points.points("points")?);
            }
            if let Some(up) = arguments.optional_array::<3>("up")? {
                polygon = polygon.with_up(up);
            }
            for (name, on) in arguments.entries("on")? {
                let points = on.points(&format!("the points on {name}"))?;
                let frame = model.frame(&name).or_raise::<A::Value>()?;
                polygon = polygon.with_points_on(frame, points);
            }
            visitor.visit(polygon)
        }
        "frame velocity" => {
            let previous = arguments.placement("previous")?;
            let velocity = ["linear", "angular"].map(|name| arguments.optional_array::<3>(name));
            let [linear, angular] = velocity;
            let velocity = (linear?.unwrap_or_default(), angular?.unwrap_or_default());
            let step = arguments.number("time_step")?;
            visitor.visit(FrameVelocity::new(frame()?, previous, step, velocity))
        }
        "joint coupling" => {
            let coefficients = arguments.required("coefficients")?;
            let keys = "a joint of coefficients";
            let coefficients = coefficients.numbers_by_name("coefficients", keys)?;
            let joints = coefficients.into_iter().map(|(joint, coefficient)| {
                Ok((joint_of::<A::Value>(model, &joint)?, coefficient))
            });
            let joints = joints.collect::<Result<Vec<_>, ErrorOf<A>>>()?;
            let offset = arguments.number_or("offset", 0.0)?;
            visitor.visit(JointCoupling::new(model, joints, offset))
        }
        "manipulability" => {
            let (least, base) = (
                arguments.number("least")?,
                arguments.optional_frame(model, "base")?,
            );
            let task = Manipulability::new(model, base, frame()?, least);
            let rows = arguments.get("of")?.map(|rows| rows.name("of"));
            visitor.visit(match rows.transpose()?.as_deref() {
                None | Some("pose") => task,
                Some("position") => task.of_position(),
                Some("orientation") => task.of_orientation(),
                Some(other) => {
                    let names = ["pose", "position", "orientation"];
                    return Err(UnknownName::new("of", other, names)).or_raise::<A::Value>();
                }
            })
        }
        kind => {
            let kinds = super::KINDS.map(|(kind, _)| kind);
            Err(UnknownName::new("kind of task", kind, kinds)).or_raise::<A::Value>()
        }
    }
}

/// Reads a centre of mass; a target of two numbers leaves the height free.
fn centre_of_mass<A: Arguments>(
    arguments: &A,
    on: &TaskModel<'_, A::Value>,
) -> Result<CentreOfMass, ErrorOf<A>> {
    let invalid = |message: String| A::Value::error(ErrorKind::InvalidValue, message);
    let target = arguments.required("target")?.numbers("target")?;
    let free = arguments.get("free")?.map(|free| free.name("free"));
    let mut free = free.transpose()?.unwrap_or_default();
    let position = match target[..] {
        [x, y, z] => [x, y, z],
        [x, y] => {
            free.push('z');
            [x, y, 0.0]
        }
        _ => {
            let count = target.len();
            let message = format!("target has {count} numbers, expected 3, or 2 for any height");
            return Err(invalid(message));
        }
    };
    let mut task = CentreOfMass::new(&masses(arguments, on)?, position);
    for letter in free.chars() {
        let axis = named("axis", letter.encode_utf8(&mut [0; 4]), &AXES);
        let axis = axis.map_err(|_| invalid("free must be axes such as \"z\" or \"xy\"".into()))?;
        task = task.free_along(axis);
    }
    Ok(task)
}

/// Returns the masses of the task, else those of the body.
fn masses<A: Arguments>(arguments: &A, on: &TaskModel<'_, A::Value>) -> Result<Masses, ErrorOf<A>> {
    let Some(masses) = arguments.get("masses")? else {
        return (on.masses)();
    };
    let mut points = Vec::new();
    for (name, value) in masses.entries("masses")? {
        let (mass, at) = value.mass(&format!("the mass of {name}"))?;
        points.push(PointMass {
            at: at.into(),
            frame: on.model.frame(&name).or_raise::<A::Value>()?,
            mass,
        });
    }
    Masses::new(on.model, points).or_raise::<A::Value>()
}
