//! Residuals of each kind of task.

use kinopt::model::{FrameId, UnknownName};
use kinopt::task::{
    Camera, Distance, Gaze, LimitCentring, LookAt, Orientation, Pixel, Plane, Point, Pose, Ray,
};
use wasm_bindgen::prelude::*;

use super::{BoxedTask, Visit, known, posture};
use crate::given::Given;
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
pub(super) fn given(task: JsValue, kind: &str) -> Result<Given, JsError> {
    let Some((_, own)) = KINDS.iter().find(|(known, _)| *known == kind) else {
        let kinds = KINDS.iter().map(|(known, _)| *known).chain(["bounded"]);
        return Err(raise(UnknownName::new("kind of task", kind, kinds)));
    };
    Given::new(task, "part of a task", &known(own))
}

/// Converts the residual of a task that wraps no other task.
pub(super) fn read(
    given: &Given,
    model: &Model,
    kind: &str,
    visitor: impl Visit,
) -> Result<BoxedTask, JsError> {
    let frame = |name: &str| frame(model, &given.name(name)?);
    match kind {
        "point" => {
            let mut point = Point::new(frame("frame")?, given.vector::<3>("target")?);
            if given.get("at").is_some() {
                point = point.at(given.vector::<3>("at")?);
            }
            visitor.visit(match base(given, model)? {
                Some(base) => point.relative_to(base),
                None => point,
            })
        }
        "pose" => {
            let mut pose = Pose::new(frame("frame")?, placed(given, "target")?);
            if let Some(tool) = given.placement("tool")? {
                pose = pose.with_tool(tool);
            }
            if let Some(goal) = given.get("goal") {
                pose = pose.with_goal(crate::arm::goal(&goal)?);
            }
            visitor.visit(match base(given, model)? {
                Some(base) => pose.relative_to(base),
                None => pose,
            })
        }
        "orientation" => {
            let own = Orientation::new(frame("frame")?, placed(given, "target")?.rotation);
            visitor.visit(match base(given, model)? {
                Some(base) => own.relative_to(base),
                None => own,
            })
        }
        "lookAt" => {
            let axis = given.vector::<3>("axis")?;
            let target = given.vector::<3>("target")?;
            visitor.visit(LookAt::new(frame("frame")?, axis, target))
        }
        "gaze" => {
            let (frame, axis) = (frame("frame")?, given.vector::<3>("axis")?);
            let half_angle = given.needed("halfAngle")?;
            visitor.visit(match (given.get("target"), given.get("direction")) {
                (None, Some(_)) => {
                    Gaze::along(frame, axis, given.vector::<3>("direction")?, half_angle)
                }
                (Some(_), None) => Gaze::at(frame, axis, given.vector::<3>("target")?, half_angle),
                _ => return Err(JsError::new("gaze takes a target or a direction")),
            })
        }
        "distance" => {
            let distance = given.needed("distance")?;
            visitor.visit(Distance::new(frame("a")?, frame("b")?, distance))
        }
        "plane" => {
            let (point, normal) = (given.vector::<3>("point")?, given.vector::<3>("normal")?);
            visitor.visit(Plane::new(frame("frame")?, point, normal))
        }
        "ray" => {
            let (eye, through) = (given.vector::<3>("eye")?, given.vector::<3>("through")?);
            visitor.visit(Ray::new(frame("frame")?, eye, through))
        }
        "pixel" => {
            let [a, b, c, d, e, f, g, h, i, j, k, l] = given.vector::<12>("camera")?;
            let camera = Camera {
                pixel_from_world: [[a, b, c, d], [e, f, g, h], [i, j, k, l]],
            };
            let target = given.vector::<2>("target")?;
            visitor.visit(Pixel::new(frame("frame")?, camera, target))
        }
        "posture" => posture::posture(given, model, visitor),
        "smoothness" => posture::smoothness(given, model, visitor),
        "limitCentring" => visitor.visit(LimitCentring::new(&model.inner)),
        #[cfg(feature = "bodies")]
        kind => super::body_tasks::read(given, model, kind, visitor),
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
pub(super) fn base(given: &Given, model: &Model) -> Result<Option<FrameId>, JsError> {
    let base = given.text("base")?;
    base.map(|base| frame(model, &base)).transpose()
}

/// Reads a required placement.
pub(super) fn placed(
    given: &Given,
    name: &str,
) -> Result<kinopt::spatial::Placement<f64>, JsError> {
    placement::of(&given.required(name)?, name)
}
