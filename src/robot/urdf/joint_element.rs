//! Reads one `<joint>`: every number, name and element in it is there and sound, or named.

use roxmltree::Node;

use super::attributes::{
    Named, check_known, element_once, name_attribute, number_or_left_out, numbers, refuse_misspelt,
};
use super::error::{Fault, UrdfError};
use super::origin;
use super::reading::Reading;
use super::repair::Mended;
use super::version::Version;
use crate::model::{JointKind, Limits};
use crate::robot::Drive;
use crate::spatial::{Placement, Vector3};

/// The children of a joint that are read, with their attributes.
pub(super) const READ: [(&str, &[&str]); 7] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "effort", "velocity"]),
    ("mimic", &["joint", "multiplier", "offset"]),
    (
        "safety_controller",
        &["soft_lower_limit", "soft_upper_limit"],
    ),
];

/// A joint by the names of its file.
#[derive(Clone, Debug)]
pub(super) struct JointElement {
    pub(super) named: Named,
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) kind: JointKind,
    pub(super) parent_from_joint: Placement<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) limits: Limits,
    pub(super) drive: Drive,
    pub(super) follows: Option<Follows>,
}

/// Whom a joint follows, and how.
#[derive(Clone, Debug)]
pub(super) struct Follows {
    pub(super) master: String,
    pub(super) ratio: f64,
    pub(super) offset: f64,
}

/// Reads one joint and everything in it.
pub(super) fn read(
    reading: &Reading<'_>,
    node: Node<'_, '_>,
    version: Version,
) -> Result<JointElement, UrdfError> {
    let named = Named::read(reading, node, "<joint>")?;
    let label = format!("joint `{}`", named.name);
    let kind = name_attribute(reading, node, &label, "type")?;
    let kind = match kind.as_str() {
        "revolute" => JointKind::Revolute,
        "prismatic" => JointKind::Prismatic,
        "continuous" => JointKind::Continuous,
        "fixed" => JointKind::Fixed,
        "floating" | "planar" | "spherical" => {
            return Err(reading.fault(named.at, label, Fault::UnsupportedJointType { kind }));
        }
        _ => return Err(reading.fault(named.at, label, Fault::UnknownJointType { kind })),
    };

    let mut found = [None; READ.len()];
    for (slot, (name, attributes)) in found.iter_mut().zip(READ) {
        *slot = element_once(reading, node, &label, name)?;
        if let Some(child) = *slot {
            let label = format!("{label}, <{name}>");
            for attribute in child.attributes().filter(|a| a.namespace().is_none()) {
                let at = child.range().start;
                check_known(reading, at, &label, attribute.name(), attributes)?;
            }
        }
    }
    for child in node.children().filter(Node::is_element) {
        refuse_misspelt(reading, child, &label, &READ.map(|(name, _)| name))?;
    }
    let [_, parent, child, axis, limit, mimic, safety] = found;

    let link = |element: Option<Node<'_, '_>>, child: &'static str| match element {
        Some(element) => name_attribute(reading, element, &format!("{label}, <{child}>"), "link"),
        None => Err(reading.fault(named.at, label.clone(), Fault::MissingElement { child })),
    };
    Ok(JointElement {
        parent: link(parent, "parent")?,
        child: link(child, "child")?,
        kind,
        parent_from_joint: origin::read(reading, node, &label, version)?,
        axis: self::axis(reading, axis, &label, kind)?,
        limits: limits(reading, limit, (named.at, &label), kind, version)?,
        drive: drive(reading, limit, safety, &label, kind)?,
        follows: follows(reading, mimic, &label, kind)?,
        named,
    })
}

/// The direction of a joint that has one; x where the file gives none.
fn axis(
    reading: &Reading<'_>,
    axis: Option<Node<'_, '_>>,
    label: &str,
    kind: JointKind,
) -> Result<Vector3<f64>, UrdfError> {
    let x = Vector3::new(1.0, 0.0, 0.0);
    let Some(axis) = axis else { return Ok(x) };
    let label = format!("{label}, <axis>");
    name_attribute(reading, axis, &label, "xyz")?;
    match numbers::<3>(reading, axis, &label, "xyz")? {
        // Exporters write a zero axis for joints that have none.
        _ if kind == JointKind::Fixed => Ok(x),
        None | Some([0.0, 0.0, 0.0]) => {
            Err(reading.fault(axis.range().start, label, Fault::NoDirection))
        }
        Some(xyz) => Ok(Vector3::from(xyz)),
    }
}

/// How far the joint may go. What is missing is the standard's default, with a note.
fn limits(
    reading: &Reading<'_>,
    limit: Option<Node<'_, '_>>,
    (joint_at, joint_label): (usize, &str),
    kind: JointKind,
    version: Version,
) -> Result<Limits, UrdfError> {
    let held = Limits::new(0.0, 0.0);
    let name = match kind {
        JointKind::Fixed => return Ok(held),
        JointKind::Continuous => return Ok(Limits::UNBOUNDED),
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    };
    let Some(limit) = limit else {
        let fault = Fault::NoLimits { kind: name };
        reading.mend(joint_at, joint_label, fault, |_| Mended::HeldAtZero)?;
        return Ok(held);
    };
    let (at, label) = (limit.range().start, format!("{joint_label}, <limit>"));
    let bound = |missing, value: f64| -> Result<f64, UrdfError> {
        let read = numbers::<1>(reading, limit, &label, missing)?;
        Ok(read.map_or_else(
            || {
                reading.note(at, &label, Mended::BoundByDefault { missing, value });
                value
            },
            |[given]| given,
        ))
    };
    let default = version.default_limits();
    let (lower, upper) = (bound("lower", default.0)?, bound("upper", default.1)?);
    if lower <= upper {
        return Ok(Limits::new(lower, upper));
    }
    let fault = Fault::LimitsOutOfOrder { lower, upper };
    let (lower, upper) = (upper, lower);
    reading.mend(at, &label, fault, |_| Mended::LimitsExchanged {
        lower,
        upper,
    })?;
    Ok(Limits::new(lower, upper))
}

/// What moves the joint, as far as files tell it.
fn drive(
    reading: &Reading<'_>,
    limit: Option<Node<'_, '_>>,
    safety: Option<Node<'_, '_>>,
    label: &str,
    kind: JointKind,
) -> Result<Drive, UrdfError> {
    let number = |node: Option<Node<'_, '_>>, tag: &str, attribute| match node {
        Some(node) => number_or_left_out(reading, node, &format!("{label}, <{tag}>"), attribute),
        None => Ok(None),
    };
    let soft = |attribute| number(safety, "safety_controller", attribute);
    let (lower, upper) = (soft("soft_lower_limit")?, soft("soft_upper_limit")?);
    // What a file that knows no speed or force writes, 0, is no limit.
    let stated = |value: Option<f64>| value.filter(|value| *value > 0.0);
    let drive = Drive {
        velocity: stated(number(limit, "limit", "velocity")?),
        effort: stated(number(limit, "limit", "effort")?),
        soft_limits: (lower.is_some() || upper.is_some()).then(|| {
            Limits::new(
                lower.unwrap_or(f64::NEG_INFINITY),
                upper.unwrap_or(f64::INFINITY),
            )
        }),
    };
    Ok(match kind {
        JointKind::Fixed => Drive::default(),
        _ => drive,
    })
}

fn follows(
    reading: &Reading<'_>,
    mimic: Option<Node<'_, '_>>,
    label: &str,
    kind: JointKind,
) -> Result<Option<Follows>, UrdfError> {
    let Some(mimic) = mimic else { return Ok(None) };
    let label = format!("{label}, <mimic>");
    let number = |attribute, default| -> Result<f64, UrdfError> {
        let read = numbers::<1>(reading, mimic, &label, attribute)?;
        Ok(read.map_or(default, |[value]| value))
    };
    let follows = Follows {
        ratio: number("multiplier", 1.0)?,
        offset: number("offset", 0.0)?,
        master: name_attribute(reading, mimic, &label, "joint")?,
    };
    // Files in which some joints were made fixed keep their <mimic>; fixed is fixed.
    Ok((kind != JointKind::Fixed).then_some(follows))
}
