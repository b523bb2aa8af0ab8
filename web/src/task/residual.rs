//! Residuals of each kind of task.

use kinopt::model::{FrameId, UnknownName};
use kinopt::task::{
    Camera, Distance, Gaze, LimitCentring, LookAt, Orientation, Pixel, Plane, Point, Pose, Ray,
};
use wasm_bindgen::prelude::*;

use super::{BoxedTask, Visit, known, posture};
use crate::arguments::NamedArguments;
use crate::model::Model;
use crate::{placement, raise};

/// Kinds of tasks, with the keys that they have in addition to the common ones.
const KINDS: [(&str, &[&str]); 17] = [
    ("point", &["frame", "target", "at", "base"]),
    ("pose", &["frame", "target", "tool", "goal", "base"]),
    ("orientation", &["frame", "target", "base"]),
    ("lookAt", &["frame", "axis", "target"]),
    (
        "gaze",
        &["frame", "axis", "halfAngle", "target", "direction"],
    ),
    ("distance", &["a", "b", "distance"]),
    ("plane", &["frame", "point", "normal"]),
    ("ray", &["frame", "eye", "through"]),
    ("pixel", &["frame", "camera", "target"]),
    ("posture", &["reference", "jointWeights"]),
    ("smoothness", &["previous", "timeStep", "jointWeights"]),
    ("limitCentring", &[]),
    ("centerOfMass", &["target", "free", "base", "masses"]),
    (
        "supportPolygon",
        &["points", "on", "margin", "up", "masses"],
    ),
    (
        "frameVelocity",
        &["frame", "previous", "timeStep", "linear", "angular"],
    ),
    ("jointCoupling", &["coefficients", "offset"]),
    ("manipulability", &["frame", "least", "base", "of"]),
];

/// Reads the keys of a task of a kind.
pub(super) fn task_options(task: JsValue, kind: &str) -> Result<NamedArguments, JsError> {
    let Some((_, names)) = KINDS.iter().find(|(known, _)| *known == kind) else {
        let kinds = KINDS.iter().map(|(known, _)| *known).chain(["bounded"]);
        return Err(raise(UnknownName::new("kind of task", kind, kinds)));
    };
    NamedArguments::new(task, "option of a task", &known(names))
}

/// Converts the residual of a task that wraps no other task.
pub(super) fn read(
    options: &NamedArguments,
    model: &Model,
    kind: &str,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let frame = |name: &str| frame(model, &options.name(name)?);
    match kind {
        "point" => {
            let mut point = Point::new(frame("frame")?, options.vector::<3>("target")?);
            if options.get("at").is_some() {
                point = point.at(options.vector::<3>("at")?);
            }
            visitor.visit(match base(options, model)? {
                Some(base) => point.relative_to(base),
                None => point,
            })
        }
        "pose" => {
            let mut pose = Pose::new(frame("frame")?, placed(options, "target")?);
            if let Some(tool) = options.placement("tool")? {
                pose = pose.with_tool(tool);
            }
            if let Some(goal) = options.get("goal") {
                pose = pose.with_goal(crate::arm::goal(&goal)?);
            }
            visitor.visit(match base(options, model)? {
                Some(base) => pose.relative_to(base),
                None => pose,
            })
        }
        "orientation" => {
            let orientation =
                Orientation::new(frame("frame")?, placed(options, "target")?.rotation);
            visitor.visit(match base(options, model)? {
                Some(base) => orientation.relative_to(base),
                None => orientation,
            })
        }
        "lookAt" => {
            let axis = options.vector::<3>("axis")?;
            let target = options.vector::<3>("target")?;
            visitor.visit(LookAt::new(frame("frame")?, axis, target))
        }
        "gaze" => {
            let (frame, axis) = (frame("frame")?, options.vector::<3>("axis")?);
            let half_angle = options.needed("halfAngle")?;
            visitor.visit(match (options.get("target"), options.get("direction")) {
                (None, Some(_)) => {
                    Gaze::along(frame, axis, options.vector::<3>("direction")?, half_angle)
                }
                (Some(_), None) => {
                    Gaze::at(frame, axis, options.vector::<3>("target")?, half_angle)
                }
                _ => return Err(JsError::new("gaze needs either `target` or `direction`")),
            })
        }
        "distance" => {
            let distance = options.needed("distance")?;
            visitor.visit(Distance::new(frame("a")?, frame("b")?, distance))
        }
        "plane" => {
            let (point, normal) = (
                options.vector::<3>("point")?,
                options.vector::<3>("normal")?,
            );
            visitor.visit(Plane::new(frame("frame")?, point, normal))
        }
        "ray" => {
            let (eye, through) = (options.vector::<3>("eye")?, options.vector::<3>("through")?);
            visitor.visit(Ray::new(frame("frame")?, eye, through))
        }
        "pixel" => {
            let [a, b, c, d, e, f, g, h, i, j, k, l] = options.vector::<12>("camera")?;
            let camera = Camera {
                pixel_from_world: [[a, b, c, d], [e, f, g, h], [i, j, k, l]],
            };
            let target = options.vector::<2>("target")?;
            visitor.visit(Pixel::new(frame("frame")?, camera, target))
        }
        "posture" => posture::posture(options, model, visitor),
        "smoothness" => posture::smoothness(options, model, visitor),
        "limitCentring" => visitor.visit(LimitCentring::new(&model.inner)),
        #[cfg(feature = "bodies")]
        kind => super::body_tasks::read(options, model, kind, visitor),
        #[cfg(not(feature = "bodies"))]
        kind => Err(JsError::new(&format!(
            "tasks of kind {kind} need a build with the feature `bodies`"
        ))),
    }
}

pub(super) fn frame(model: &Model, name: &str) -> Result<FrameId, JsError> {
    model.inner.frame(name).map_err(raise)
}

/// Reference frame of a target; `None` for the world.
pub(super) fn base(options: &NamedArguments, model: &Model) -> Result<Option<FrameId>, JsError> {
    let base = options.text("base")?;
    base.map(|base| frame(model, &base)).transpose()
}

/// Reads a required placement.
pub(super) fn placed(
    options: &NamedArguments,
    name: &str,
) -> Result<kinopt::spatial::Placement<f64>, JsError> {
    placement::of(&options.required(name)?, name)
}
