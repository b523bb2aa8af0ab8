//! `<joint>` and `<freejoint>`.

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Joint types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointType {
    Free,
    Ball,
    Slide,
    Hinge,
}

const KINDS: [&str; 4] = ["free", "ball", "slide", "hinge"];

impl JointType {
    pub(super) fn name(self) -> &'static str {
        KINDS[self as usize]
    }

    /// Reports whether the joint has one coordinate.
    pub(super) fn is_scalar(self) -> bool {
        matches!(self, Self::Slide | Self::Hinge)
    }
}

/// A joint as its file states it, in radians and metres.
#[derive(Clone, Debug)]
pub(super) struct JointElement<'a> {
    pub(super) tag: Tag<'a>,
    pub(super) kind: JointType,
    /// Position in the frame of its body.
    pub(super) anchor: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    /// `ref`: the coordinate at which the body has the pose of the file, radians or metres.
    pub(super) reference: f64,
    /// Limits, if any. A ball joint has 0 and its largest angle.
    pub(super) range: Option<Limits>,
    pub(super) effort: Option<f64>,
}

/// Reads a joint of a body; `body_from_frame` is the pose of the enclosing frame in the body.
pub(super) fn read<'a>(
    tag: Tag<'a>,
    compiler: &Compiler,
    defaults: &Defaults<'a>,
    enclosing_class: Option<&str>,
    body_from_frame: &Placement<f64>,
) -> Read<JointElement<'a>> {
    if tag.name() == "freejoint" {
        return Ok(free(tag));
    }
    let joint = Attributes::of(tag, defaults, enclosing_class)?;
    let kind = match joint.word("type", &KINDS)? {
        Some(0) => return Ok(free(tag)),
        Some(1) => JointType::Ball,
        Some(2) => JointType::Slide,
        _ => JointType::Hinge,
    };
    // MuJoCo ignores the axis of a ball joint.
    let axis = match (kind, joint.numbers::<3>("axis")?) {
        (JointType::Slide | JointType::Hinge, Some([0.0, 0.0, 0.0])) => {
            return Err(joint.fault(ParseIssue::ZeroLength { attribute: "axis" }));
        }
        (JointType::Slide | JointType::Hinge, Some(axis)) => Vector3::from(axis),
        _ => Vector3::UNITS[2],
    };
    let unit = match kind {
        JointType::Slide => 1.0,
        _ => compiler.angle,
    };
    let reference = match kind.is_scalar() {
        true => joint.number("ref")?.unwrap_or(0.0) * unit,
        false => 0.0,
    };
    let anchor = joint.numbers::<3>("pos")?.unwrap_or_default();
    Ok(JointElement {
        tag,
        kind,
        anchor: body_from_frame.apply(Vector3::from(anchor)),
        axis: body_from_frame.rotation * axis,
        reference,
        range: range(&joint, kind, unit, compiler)?,
        effort: effort(&joint)?,
    })
}

fn free(tag: Tag<'_>) -> JointElement<'_> {
    JointElement {
        tag,
        kind: JointType::Free,
        anchor: Vector3::zero(),
        axis: Vector3::UNITS[2],
        reference: 0.0,
        range: None,
        effort: None,
    }
}

fn range(
    joint: &Attributes<'_>,
    kind: JointType,
    unit: f64,
    compiler: &Compiler,
) -> Read<Option<Limits>> {
    let range = joint.numbers::<2>("range")?;
    let [lower, upper] = range.unwrap_or_default().map(|end| end * unit);
    let limited = match joint.word("limited", &["false", "true", "auto"])? {
        Some(0) => false,
        Some(1) => true,
        _ if range.is_some() && !compiler.auto_limits => {
            return Err(joint.fault(ParseIssue::UnsaidLimits));
        }
        _ => lower != 0.0 || upper != 0.0,
    };
    match (limited, kind) {
        (false, _) => Ok(None),
        (true, JointType::Ball) if lower != 0.0 || upper <= 0.0 => {
            Err(joint.fault(ParseIssue::BadBallRange))
        }
        (true, JointType::Slide | JointType::Hinge) if lower >= upper => {
            Err(joint.fault(ParseIssue::LimitsOutOfOrder { lower, upper }))
        }
        _ => Ok(Some(Limits::new(lower, upper))),
    }
}

/// Largest force or torque of all actuators on the joint together: `actuatorfrcrange`.
fn effort(joint: &Attributes<'_>) -> Read<Option<f64>> {
    let range = joint.numbers::<2>("actuatorfrcrange")?;
    let limited = joint.word("actuatorfrclimited", &["false", "true", "auto"])?;
    let max_effort = range.map(|[lower, upper]| lower.abs().max(upper.abs()));
    Ok(max_effort.filter(|max_effort| *max_effort > 0.0 && limited != Some(0)))
}
