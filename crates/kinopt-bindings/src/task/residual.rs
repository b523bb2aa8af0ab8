//! Residuals of each kind of task.

use kinopt::task::{
    Distance, FramePose, Gaze, LimitCentring, LookAt, Orientation, Pixel, Plane, Point, Ray,
};

use super::{BoxedTask, TaskModel, Visit, joints};
use crate::error::ErrorKind;
use crate::value::{Arguments, ErrorOf, Value};

/// Converts the residual of a task of a kind of [`KINDS`](super::KINDS), except `bounded`.
///
/// # Errors
/// If an argument is missing or has another type, a frame or joint is unknown, or the kind is unknown.
pub fn residual<A: Arguments>(
    arguments: &A,
    on: &TaskModel<'_, A::Value>,
    kind: &str,
    visitor: impl Visit<A::Value>,
) -> Result<BoxedTask<A::Value>, ErrorOf<A>> {
    let model = on.model;
    let frame = |name: &str| arguments.frame(model, name);
    match kind {
        "point" => {
            let mut point = Point::new(frame("frame")?, arguments.array::<3>("target")?);
            if let Some(at) = arguments.optional_array::<3>("at")? {
                point = point.at(at);
            }
            visitor.visit(match arguments.optional_frame(model, "base")? {
                Some(base) => point.relative_to(base),
                None => point,
            })
        }
        "pose" => {
            let mut pose = FramePose::new(frame("frame")?, arguments.placement("target")?);
            if let Some(tool) = arguments.get("tool")? {
                pose = pose.with_tool(tool.placement("tool")?);
            }
            if let Some(goal) = arguments.get("goal")? {
                pose = pose.with_goal(goal.pose_bounds("goal")?);
            }
            visitor.visit(match arguments.optional_frame(model, "base")? {
                Some(base) => pose.relative_to(base),
                None => pose,
            })
        }
        "orientation" => {
            let target = arguments.required("target")?.rotation("target")?;
            let orientation = Orientation::new(frame("frame")?, target);
            visitor.visit(match arguments.optional_frame(model, "base")? {
                Some(base) => orientation.relative_to(base),
                None => orientation,
            })
        }
        "look at" => {
            let (axis, target) = (
                arguments.array::<3>("axis")?,
                arguments.array::<3>("target")?,
            );
            visitor.visit(LookAt::new(frame("frame")?, axis, target))
        }
        "gaze" => {
            let (frame, axis) = (frame("frame")?, arguments.array::<3>("axis")?);
            let half_angle = arguments.number("half_angle")?;
            let target = arguments.optional_array::<3>("target")?;
            visitor.visit(
                match (target, arguments.optional_array::<3>("direction")?) {
                    (Some(target), None) => Gaze::at(frame, axis, target, half_angle),
                    (None, Some(direction)) => Gaze::along(frame, axis, direction, half_angle),
                    _ => {
                        return Err(A::Value::error(
                            ErrorKind::InvalidValue,
                            "gaze needs either `target` or `direction`".to_owned(),
                        ));
                    }
                },
            )
        }
        "distance" => {
            let distance = arguments.number("distance")?;
            visitor.visit(Distance::new(frame("a")?, frame("b")?, distance))
        }
        "plane" => {
            let (point, normal) = (
                arguments.array::<3>("point")?,
                arguments.array::<3>("normal")?,
            );
            visitor.visit(Plane::new(frame("frame")?, point, normal))
        }
        "ray" => {
            let (eye, through) = (
                arguments.array::<3>("eye")?,
                arguments.array::<3>("through")?,
            );
            visitor.visit(Ray::new(frame("frame")?, eye, through))
        }
        "pixel" => {
            let camera = arguments.required("camera")?.camera("camera")?;
            let target = arguments.array("target")?;
            visitor.visit(Pixel::new(frame("frame")?, camera, target))
        }
        "posture" => joints::posture(arguments, model, visitor),
        "smoothness" => joints::smoothness(arguments, model, visitor),
        "limit centring" => visitor.visit(LimitCentring::new(model)),
        #[cfg(feature = "bodies")]
        kind => super::body::residual(arguments, on, kind, visitor),
        #[cfg(not(feature = "bodies"))]
        kind => Err(A::Value::error(
            ErrorKind::InvalidValue,
            format!("tasks of kind {kind} need a build with the feature `bodies`"),
        )),
    }
}
