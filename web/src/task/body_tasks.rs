//! Tasks of whole bodies: balance, velocities, joint couplings.

use kinopt::model::{Masses, PointMass, UnknownName};
use kinopt::spatial::Vector3;
use kinopt::task::{
    Axis, CentreOfMass, FrameVelocity, JointCoupling, Manipulability, SupportPolygon,
};
use wasm_bindgen::prelude::*;

use super::residual::{base, frame, placed};
use super::{BoxedTask, Visit};
use crate::arguments::{self, NamedArguments};
use crate::model::Model;
use crate::raise;

/// Reads the residual of a task of a kind.
pub(super) fn read(
    options: &NamedArguments,
    model: &Model,
    kind: &str,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    match kind {
        "centerOfMass" => {
            let target = options.numbers("target")?.unwrap_or_default();
            let mut free = options.text("free")?.unwrap_or_default();
            let position = match target[..] {
                [x, y, z] => [x, y, z],
                [x, y] => {
                    free.push('z');
                    [x, y, 0.0]
                }
                _ => {
                    let count = target.len();
                    let message =
                        format!("target has {count} numbers, expected 3, or 2 for any height");
                    return Err(JsError::new(&message));
                }
            };
            let mut task = CentreOfMass::new(&masses(options, model)?, position);
            for axis in free.chars() {
                task = task.free_along(match axis {
                    'x' => Axis::X,
                    'y' => Axis::Y,
                    'z' => Axis::Z,
                    _ => return Err(JsError::new("free must be axes such as \"z\" or \"xy\"")),
                });
            }
            visitor.visit(match base(options, model)? {
                Some(base) => task.relative_to(base),
                None => task,
            })
        }
        "supportPolygon" => {
            let mut polygon = SupportPolygon::new(&masses(options, model)?)
                .with_points(points(options.get("points").as_ref(), "points")?)
                .with_margin(options.number("margin")?.unwrap_or(0.0));
            if options.get("up").is_some() {
                polygon = polygon.with_up(options.vector::<3>("up")?);
            }
            for (name, on) in arguments::entries(options.get("on").as_ref(), "on")? {
                let points_on_frame = points(Some(&on), &format!("the points on {name}"))?;
                polygon = polygon.with_points_on(frame(model, &name)?, points_on_frame);
            }
            visitor.visit(polygon)
        }
        "frameVelocity" => {
            let previous = placed(options, "previous")?;
            let optional_velocity = |name: &str| match options.get(name) {
                Some(_) => options.vector::<3>(name),
                None => Ok([0.0; 3]),
            };
            let velocity = (optional_velocity("linear")?, optional_velocity("angular")?);
            let frame = frame(model, &options.name("frame")?)?;
            let step = options.needed("timeStep")?;
            visitor.visit(FrameVelocity::new(frame, previous, step, velocity))
        }
        "jointCoupling" => {
            let coefficients = options.by_name("coefficients")?;
            let joints = coefficients.iter().map(|(joint, coefficient)| {
                let joint = model.inner.joint(joint.as_str()).map_err(raise)?;
                Ok((joint, *coefficient))
            });
            let joints = joints.collect::<Result<Vec<_>, JsError>>()?;
            let offset = options.number("offset")?.unwrap_or(0.0);
            visitor.visit(JointCoupling::new(&model.inner, joints, offset))
        }
        _ => {
            let frame = frame(model, &options.name("frame")?)?;
            let least = options.needed("least")?;
            let task = Manipulability::new(&model.inner, base(options, model)?, frame, least);
            visitor.visit(match options.text("of")?.as_deref() {
                None | Some("pose") => task,
                Some("position") => task.of_position(),
                Some("orientation") => task.of_orientation(),
                Some(other) => {
                    let names = ["pose", "position", "orientation"];
                    return Err(raise(UnknownName::new("of", other, names)));
                }
            })
        }
    }
}

/// Returns the masses of the task, else those of the body. Given masses are kilograms by frame, at its origin, or four
/// numbers: kilograms and a position in its coordinates.
fn masses(options: &NamedArguments, model: &Model) -> Result<Masses, JsError> {
    let Some(masses) = options.get("masses") else {
        return crate::masses::masses_of(model);
    };
    let mut points = Vec::new();
    for (name, value) in arguments::entries(Some(&masses), "masses")? {
        let what = format!("the mass of {name}");
        let [mass, x, y, z] = match value.as_f64() {
            Some(mass) => [mass, 0.0, 0.0, 0.0],
            None => arguments::vector::<4>(&value, &what)?,
        };
        points.push(PointMass {
            at: Vector3::new(x, y, z),
            frame: frame(model, &name)?,
            mass,
        });
    }
    Masses::new(&model.inner, points).map_err(raise)
}

/// Reads a list of positions.
fn points(value: Option<&JsValue>, what: &str) -> Result<Vec<Vector3<f64>>, JsError> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let not_a_list = || JsError::new(&format!("{what} must be a list of positions"));
    let positions = arguments::list(value).ok_or_else(not_a_list)?;
    let positions = positions
        .iter()
        .map(|position| arguments::vector::<3>(&position, what));
    let positions = positions.map(|position| position.map(Vector3::from));
    positions.collect()
}
