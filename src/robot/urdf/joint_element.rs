//! Checks one `<joint>`: every number, name and element that kinematics reads is there and sound.

use roxmltree::Node;

use super::attributes::{
    Named, Place, check_known, element_once, name_attribute, numbers, refuse_misspelt, text_of,
};
use super::error::{Fault, UrdfError};

/// The children of a joint that kinematics reads, with their attributes.
pub(super) const KINEMATIC: [(&str, &[&str]); 6] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "effort", "velocity"]),
    ("mimic", &["joint", "multiplier", "offset"]),
];

/// What urdf-rs does not tell of a joint.
#[derive(Clone, Debug)]
pub(super) struct JointElement {
    pub(super) named: Named,
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) master: Option<String>,
    /// x, y, z, w as in the file, from URDF 1.1 on: urdf-rs turns it into roll, pitch and yaw and
    /// loses digits near a pitch of 90°.
    pub(super) quaternion: Option<[f64; 4]>,
}

/// Checks one joint and everything in it that kinematics reads.
pub(super) fn read(
    place: &Place<'_>,
    node: Node<'_, '_>,
    version: Version,
) -> Result<JointElement, UrdfError> {
    let named = Named::read(place, node, "<joint>")?;
    let label = format!("joint `{}`", named.name);
    let kind = name_attribute(place, node, &label, "type")?;
    let kind = match kind.as_str() {
        "revolute" => "revolute",
        "prismatic" => "prismatic",
        "continuous" => "continuous",
        "fixed" => "fixed",
        "floating" | "planar" | "spherical" => {
            return Err(place.fault(named.at, label, Fault::UnsupportedJointType { kind }));
        }
        _ => return Err(place.fault(named.at, label, Fault::UnknownJointType { kind })),
    };

    let mut found = [None; KINEMATIC.len()];
    for (slot, (name, attributes)) in found.iter_mut().zip(KINEMATIC) {
        *slot = element_once(place, node, &label, name)?;
        if let Some(child) = *slot {
            let label = format!("{label}, <{name}>");
            for attribute in child.attributes().filter(|a| a.namespace().is_none()) {
                let at = child.range().start;
                check_known(place, at, &label, attribute.name(), attributes)?;
            }
        }
    }
    for child in node.children().filter(Node::is_element) {
        refuse_misspelt(place, child, &label, &KINEMATIC.map(|(name, _)| name))?;
    }
    let [origin, parent, child, axis, limit, mimic] = found;

    let link = |element: Option<Node<'_, '_>>, name: &'static str| match element {
        Some(element) => name_attribute(place, element, &format!("{label}, <{name}>"), "link"),
        None => Err(place.fault(
            named.at,
            label.clone(),
            Fault::MissingElement { child: name },
        )),
    };
    let (parent, child) = (link(parent, "parent")?, link(child, "child")?);
    let quaternion = match origin {
        Some(origin) => check_origin(place, origin, &format!("{label}, <origin>"), version)?,
        None => None,
    };
    if let Some(axis) = axis {
        let label = format!("{label}, <axis>");
        name_attribute(place, axis, &label, "xyz")?;
        let xyz = numbers::<3>(place, axis, &label, "xyz")?;
        // Exporters write a zero axis for joints that have none.
        if kind != "fixed" && xyz == Some([0.0; 3]) {
            return Err(place.fault(axis.range().start, label, Fault::NoDirection));
        }
    }
    check_limit(place, limit, (named.at, &label), kind)?;
    let master = match mimic {
        Some(mimic) => {
            let label = format!("{label}, <mimic>");
            numbers::<1>(place, mimic, &label, "multiplier")?;
            numbers::<1>(place, mimic, &label, "offset")?;
            let master = name_attribute(place, mimic, &label, "joint")?;
            // Files in which some joints were made fixed keep their <mimic>; fixed is fixed.
            (kind != "fixed").then_some(master)
        }
        None => None,
    };
    Ok(JointElement {
        named,
        parent,
        child,
        master,
        quaternion,
    })
}

fn check_origin(
    place: &Place<'_>,
    origin: Node<'_, '_>,
    label: &str,
    version: Version,
) -> Result<Option<[f64; 4]>, UrdfError> {
    numbers::<3>(place, origin, label, "xyz")?;
    let rpy = numbers::<3>(place, origin, label, "rpy")?;
    let Some(quaternion) = numbers::<4>(place, origin, label, "quat_xyzw")? else {
        return Ok(None);
    };
    let problem = if version < Version(1, 1) {
        "needs <robot version=\"1.1\">"
    } else if rpy.is_some() {
        "and `rpy` are both given"
    } else if quaternion.iter().all(|&c| c == 0.0) {
        "is zero and no rotation"
    } else {
        return Ok(Some(quaternion));
    };
    let fault = Fault::BadQuaternion { problem };
    Err(place.fault(origin.range().start, label.to_owned(), fault))
}

fn check_limit(
    place: &Place<'_>,
    limit: Option<Node<'_, '_>>,
    (joint_at, joint_label): (usize, &str),
    kind: &'static str,
) -> Result<(), UrdfError> {
    let bounded = matches!(kind, "revolute" | "prismatic");
    let no_limits = Fault::NoLimits { kind };
    let Some(limit) = limit else {
        return match bounded {
            true => Err(place.fault(joint_at, joint_label.to_owned(), no_limits)),
            false => Ok(()),
        };
    };
    let (at, label) = (limit.range().start, format!("{joint_label}, <limit>"));
    let lower = numbers::<1>(place, limit, &label, "lower")?;
    let upper = numbers::<1>(place, limit, &label, "upper")?;
    for extra in ["effort", "acceleration", "deceleration", "jerk"] {
        numbers::<1>(place, limit, &label, extra)?;
    }
    name_attribute(place, limit, &label, "velocity")?;
    numbers::<1>(place, limit, &label, "velocity")?;
    if !bounded {
        return Ok(());
    }
    let one_limit = |missing| Fault::OneLimit { kind, missing };
    let ([lower], [upper]) = match (lower, upper) {
        (Some(lower), Some(upper)) => (lower, upper),
        (Some(_), None) => return Err(place.fault(at, label, one_limit("upper"))),
        (None, Some(_)) => return Err(place.fault(at, label, one_limit("lower"))),
        // [0, 0] by the standard before 1.2: a joint that cannot move, which nobody means.
        (None, None) => return Err(place.fault(at, label, no_limits)),
    };
    if lower > upper {
        return Err(place.fault(at, label, Fault::LimitsOutOfOrder { lower, upper }));
    }
    Ok(())
}

/// Major and minor version of the URDF standard; 1.0 where the file states none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(u32, u32);

impl Version {
    pub(super) fn of(robot: Node<'_, '_>) -> Self {
        text_of(robot, "version")
            .and_then(|version| {
                let (major, minor) = version.trim().split_once('.')?;
                Some(Self(major.parse().ok()?, minor.parse().ok()?))
            })
            .unwrap_or(Self(1, 0))
    }
}
