//! `<equality>`: active equality constraints, and mimic joints.

use super::attributes::Attributes;
use super::defaults::Defaults;
use super::names::ElementNames;
use super::tree::Tag;
use crate::robot::Mimic;
use crate::robot::xml::{ParseIssue, Read};
use kinopt_kinematics::model::{JointId, Limits, ModelBuilder};

/// Reads the active equality constraints of a document.
pub(super) fn read_all<'a>(root: Tag<'a>, defaults: &Defaults<'a>) -> Read<Vec<Attributes<'a>>> {
    let sections = root.children_named("equality");
    let mut active = Vec::new();
    for tag in sections.flat_map(|section| section.children()) {
        // Default classes have one element `equality` for all kinds.
        let equality = Attributes::named(tag, "equality", defaults, None)?;
        if equality.flag("active")? != Some(false) {
            active.push(equality);
        }
    }
    Ok(active)
}

/// Meaning of a `<joint>` equality.
pub(super) enum Coupling {
    /// A mimic joint.
    MimicJoint(Mimic),
    /// A joint locked at a value, in radians or metres.
    Locked(JointId, f64),
}

/// Reads a `<joint>` equality: a linear relation of two joints, or the value of one joint.
pub(super) fn coupling(equality: &Attributes<'_>, names: &ElementNames<'_>) -> Read<Coupling> {
    let attribute = "joint1";
    let missing = || equality.fault(ParseIssue::MissingAttribute { attribute });
    let first = equality.text(attribute).ok_or_else(missing)?;
    let first = names.joint(equality, first)?;
    let (polynomial, _) = equality
        .up_to::<5>("polycoef")?
        .unwrap_or(([0.0, 1.0, 0.0, 0.0, 0.0], 2));
    let [constant, ratio, higher @ ..] = polynomial;
    // MuJoCo's relation is y - y₀ = c + r (x - x₀), with the reference positions x₀ and y₀.
    let at = |joint: &super::names::NamedJoint| match joint.is_scalar {
        true => Ok((joint.id, joint.reference)),
        false => Err(equality.fault(ParseIssue::NotLinear)),
    };
    let (joint, y) = at(&first)?;
    let Some(second) = equality.text("joint2") else {
        return Ok(Coupling::Locked(joint, y + constant));
    };
    let (source, x) = at(&names.joint(equality, second)?)?;
    if higher != [0.0; 3] {
        return Err(equality.fault(ParseIssue::NotLinear));
    }
    let offset = y + constant - ratio * x;
    Ok(Coupling::MimicJoint(Mimic {
        joint,
        master: source,
        ratio,
        offset,
    }))
}

/// Adds a relation to the mimic joints or locks a joint. Returns an error if it contradicts an earlier relation or a
/// limit.
pub(super) fn add_coupling(
    equality: &Attributes<'_>,
    coupling: Coupling,
    mimics: &mut Vec<Mimic>,
    builder: &mut ModelBuilder,
) -> Read<()> {
    match coupling {
        Coupling::Locked(joint, value) => {
            if let Some(limits) = builder
                .limits(joint)
                .filter(|limits| !limits.contains(value))
            {
                let joint = equality.text("joint1").unwrap_or_default().to_owned();
                let Limits { lower, upper } = limits;
                return Err(equality.fault(ParseIssue::StandsOutside {
                    joint,
                    value,
                    lower,
                    upper,
                }));
            }
            builder.narrow(joint, Limits::new(value, value));
        }
        Coupling::MimicJoint(mimic) => {
            let source_of = |joint| {
                let mut mimics = mimics.iter();
                mimics
                    .find(|other: &&Mimic| other.joint == joint)
                    .map(|other| other.master)
            };
            let mut ancestor = Some(mimic.master);
            while let Some(joint) = ancestor.filter(|joint| *joint != mimic.joint) {
                ancestor = source_of(joint);
            }
            if ancestor.is_some() || source_of(mimic.joint).is_some() {
                let joint = equality.text("joint1").unwrap_or_default().to_owned();
                return Err(equality.fault(ParseIssue::FollowsAlready { joint }));
            }
            mimics.push(mimic);
        }
    }
    Ok(())
}
