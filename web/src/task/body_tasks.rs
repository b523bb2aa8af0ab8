//! Tasks of whole bodies: balance, velocities, joint couplings.

use kinopt::model::{Masses, PointMass, UnknownName};
use kinopt::spatial::Vector3;
use kinopt::task::{
    Axis, CentreOfMass, FrameVelocity, JointCoupling, Manipulability, SupportPolygon,
};
use wasm_bindgen::prelude::*;

use super::residual::{base, frame, placed};
use super::{BoxedTask, Visit};
use crate::given::{self, Given};
use crate::model::Model;
use crate::raise;

/// Reads the residual of a task of a kind.
pub(super) fn read(
    given: &Given,
    model: &Model,
    kind: &str,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    match kind {
        "centerOfMass" => {
            let target = given.numbers("target")?.unwrap_or_default();
            let mut free = given.text("free")?.unwrap_or_default();
            let place = match target[..] {
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
            let mut task = CentreOfMass::new(&masses(given, model)?, place);
            for axis in free.chars() {
                task = task.free_along(match axis {
                    'x' => Axis::X,
                    'y' => Axis::Y,
                    'z' => Axis::Z,
                    _ => return Err(JsError::new("free must be axes such as \"z\" or \"xy\"")),
                });
            }
            visitor.visit(match base(given, model)? {
                Some(base) => task.relative_to(base),
                None => task,
            })
        }
        "supportPolygon" => {
            let mut polygon = SupportPolygon::new(&masses(given, model)?)
                .with_points(points(given.get("points").as_ref(), "points")?)
                .with_margin(given.number("margin")?.unwrap_or(0.0));
            if given.get("up").is_some() {
                polygon = polygon.with_up(given.vector::<3>("up")?);
            }
            for (name, on) in given::entries(given.get("on").as_ref(), "on")? {
                let own = points(Some(&on), &format!("the points on {name}"))?;
                polygon = polygon.with_points_on(frame(model, &name)?, own);
            }
            visitor.visit(polygon)
        }
        "frameVelocity" => {
            let previous = placed(given, "previous")?;
            let still = |name: &str| match given.get(name) {
                Some(_) => given.vector::<3>(name),
                None => Ok([0.0; 3]),
            };
            let velocity = (still("linear")?, still("angular")?);
            let own = frame(model, &given.name("frame")?)?;
            let step = given.needed("timeStep")?;
            visitor.visit(FrameVelocity::new(own, previous, step, velocity))
        }
        "jointCoupling" => {
            let coefficients = given.by_name("coefficients")?;
            let joints = coefficients.iter().map(|(joint, coefficient)| {
                let joint = model.inner.joint(joint.as_str()).map_err(raise)?;
                Ok((joint, *coefficient))
            });
            let joints = joints.collect::<Result<Vec<_>, JsError>>()?;
            let offset = given.number("offset")?.unwrap_or(0.0);
            visitor.visit(JointCoupling::new(&model.inner, joints, offset))
        }
        _ => {
            let own = frame(model, &given.name("frame")?)?;
            let least = given.needed("least")?;
            let task = Manipulability::new(&model.inner, base(given, model)?, own, least);
            visitor.visit(match given.text("of")?.as_deref() {
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
fn masses(given: &Given, model: &Model) -> Result<Masses, JsError> {
    let Some(own) = given.get("masses") else {
        return crate::masses::masses_of(model);
    };
    let mut points = Vec::new();
    for (name, value) in given::entries(Some(&own), "masses")? {
        let what = format!("the mass of {name}");
        let [mass, x, y, z] = match value.as_f64() {
            Some(mass) => [mass, 0.0, 0.0, 0.0],
            None => given::vector::<4>(&value, &what)?,
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
    let no = || JsError::new(&format!("{what} must be a list of positions"));
    let places = given::list(value).ok_or_else(no)?;
    let places = places.iter().map(|place| given::vector::<3>(&place, what));
    let places = places.map(|place| place.map(Vector3::from));
    places.collect()
}
