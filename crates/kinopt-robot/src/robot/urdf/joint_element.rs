//! Reader of one `<joint>`: every required attribute is present and valid, or the error names it.

use roxmltree::Node;

use super::origin;
use super::version::Version;
use crate::robot::DriveLimits;
use crate::robot::xml::{Element, Named, ParseIssue, Read, Reading, RepairKind};
use kinopt_kinematics::model::{JointKind, Limits};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Child elements of a joint that are read, with their attributes.
pub(super) const READ_ELEMENTS: [(&str, &[&str]); 7] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    (
        "limit",
        &[
            "lower",
            "upper",
            "effort",
            "velocity",
            "acceleration",
            "jerk",
        ],
    ),
    ("mimic", &["joint", "multiplier", "offset"]),
    (
        "safety_controller",
        &["soft_lower_limit", "soft_upper_limit"],
    ),
];

/// A joint whose links are names of the file.
#[derive(Clone, Debug)]
pub(super) struct JointElement {
    pub(super) named: Named,
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) kind: JointKind,
    pub(super) chain: JointChain,
    pub(super) parent_from_joint: Placement<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) limits: Limits,
    pub(super) drive: DriveLimits,
    pub(super) mimic: Option<MimicElement>,
}

/// The joints of the model that represent a joint of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointChain {
    One,
    Free,
    Planar,
}

/// Mimic relation of a joint.
#[derive(Clone, Debug)]
pub(super) struct MimicElement {
    pub(super) source: String,
    pub(super) ratio: f64,
    pub(super) offset: f64,
}

/// Reads one joint and its child elements.
pub(super) fn read<'a>(
    reading: &'a Reading<'a>,
    node: Node<'a, 'a>,
    version: Version,
) -> Read<JointElement> {
    let named = Element::new(reading, node, "<joint>".to_owned()).named()?;
    let joint = Element::new(reading, node, format!("joint `{}`", named.name));
    let kind = joint.name("type")?;
    let (kind, chain) = match kind.as_str() {
        "revolute" => (JointKind::Revolute, JointChain::One),
        "prismatic" => (JointKind::Prismatic, JointChain::One),
        "continuous" => (JointKind::Continuous, JointChain::One),
        "fixed" => (JointKind::Fixed, JointChain::One),
        "spherical" => (JointKind::Ball, JointChain::One),
        "floating" => (JointKind::Ball, JointChain::Free),
        "planar" => (JointKind::Continuous, JointChain::Planar),
        _ => return Err(joint.fault(ParseIssue::UnknownJointType { kind })),
    };

    let mut children = READ_ELEMENTS.map(|_| None);
    for (slot, (name, attributes)) in children.iter_mut().zip(READ_ELEMENTS) {
        *slot = joint.child(name)?;
        if let Some(child) = slot {
            child.check_attributes(attributes)?;
        }
    }
    for child in node.children().filter(Node::is_element) {
        joint.check_child(child, &READ_ELEMENTS.map(|(name, _)| name))?;
    }
    let [_, parent, child, axis, limit, mimic, safety] = children;

    let link = |element: Option<Element<'_>>, child| match element {
        Some(element) => element.name("link"),
        None => Err(joint.fault(ParseIssue::MissingElement { child })),
    };
    Ok(JointElement {
        parent: link(parent, "parent")?,
        child: link(child, "child")?,
        kind,
        chain,
        parent_from_joint: origin::read(&joint, version)?,
        axis: self::axis(axis, kind)?,
        limits: limits(&joint, limit.as_ref(), kind, version)?,
        drive: drive(limit, safety, kind)?,
        mimic: read_mimic(mimic, kind)?,
        named,
    })
}

/// Axis of a joint; x by default.
fn axis(axis: Option<Element<'_>>, kind: JointKind) -> Read<Vector3<f64>> {
    let x = Vector3::new(1.0, 0.0, 0.0);
    let Some(axis) = axis else { return Ok(x) };
    axis.name("xyz")?;
    match axis.numbers::<3>("xyz")? {
        // Exporters write a zero axis for joints without an axis.
        _ if matches!(kind, JointKind::Fixed | JointKind::Ball) => Ok(x),
        None | Some([0.0, 0.0, 0.0]) => Err(axis.fault(ParseIssue::NoDirection)),
        Some(xyz) => Ok(Vector3::from(xyz)),
    }
}

/// Position limits of a joint. A missing bound gets the standard's default, with a note.
fn limits(
    joint: &Element<'_>,
    limit: Option<&Element<'_>>,
    kind: JointKind,
    version: Version,
) -> Read<Limits> {
    let locked = Limits::new(0.0, 0.0);
    let name = match kind {
        JointKind::Fixed => return Ok(locked),
        JointKind::Continuous | JointKind::Ball => return Ok(Limits::UNBOUNDED),
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    };
    let Some(limit) = limit else {
        joint.repair_or_fail(ParseIssue::NoLimits { kind: name }, |_| {
            RepairKind::HeldAtZero
        })?;
        return Ok(locked);
    };
    let bound = |missing, value: f64| -> Read<f64> {
        let unlimited = if missing == "lower" {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        };
        let text = limit.text(missing).map(str::trim);
        if limit.reading.lenient && text.and_then(|text| text.parse().ok()) == Some(unlimited) {
            limit.note(RepairKind::Unlimited { attribute: missing });
            return Ok(unlimited);
        }
        let given = limit.number(missing)?;
        if given.is_none() {
            limit.note(RepairKind::BoundByDefault { missing, value });
        }
        Ok(given.unwrap_or(value))
    };
    let default = version.default_limits();
    let (lower, upper) = (bound("lower", default.0)?, bound("upper", default.1)?);
    if lower <= upper {
        return Ok(Limits::new(lower, upper));
    }
    let fault = ParseIssue::LimitsOutOfOrder { lower, upper };
    let (lower, upper) = (upper, lower);
    limit.repair_or_fail(fault, |_| RepairKind::LimitsExchanged { lower, upper })?;
    Ok(Limits::new(lower, upper))
}

/// Velocity, effort, acceleration, jerk and soft limits of a joint.
fn drive(
    limit: Option<Element<'_>>,
    safety: Option<Element<'_>>,
    kind: JointKind,
) -> Read<DriveLimits> {
    let number = |element: &Option<Element<'_>>, attribute| match element {
        Some(element) => element.number_or_left_out(attribute),
        None => Ok(None),
    };
    let soft = |attribute| number(&safety, attribute);
    let (lower, upper) = (soft("soft_lower_limit")?, soft("soft_upper_limit")?);
    // Files without known limits write 0.
    let positive = |value: Option<f64>| value.filter(|value| *value > 0.0);
    let drive = DriveLimits {
        velocity: positive(number(&limit, "velocity")?),
        effort: positive(number(&limit, "effort")?),
        acceleration: positive(number(&limit, "acceleration")?),
        jerk: positive(number(&limit, "jerk")?),
        soft_limits: lower.or(upper).map(|_| {
            let unbounded = Limits::UNBOUNDED;
            Limits::new(
                lower.unwrap_or(unbounded.lower),
                upper.unwrap_or(unbounded.upper),
            )
        }),
    };
    Ok(match kind {
        JointKind::Fixed => DriveLimits::default(),
        _ => drive,
    })
}

fn read_mimic(mimic: Option<Element<'_>>, kind: JointKind) -> Read<Option<MimicElement>> {
    let Some(mimic) = mimic else { return Ok(None) };
    let mimic = MimicElement {
        ratio: mimic.number("multiplier")?.unwrap_or(1.0),
        offset: mimic.number("offset")?.unwrap_or(0.0),
        source: mimic.name("joint")?,
    };
    // Tools that fix joints leave `<mimic>` in the file; it has no effect there.
    Ok((kind != JointKind::Fixed).then_some(mimic))
}
