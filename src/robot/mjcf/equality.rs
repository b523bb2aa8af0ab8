//! `<equality>`: joints that follow others, and loops.

use super::attributes::Attributes;
use super::defaults::Defaults;
use super::names::Names;
use super::tree::Tag;
use crate::kinematics::ForwardKinematics;
use crate::model::{FrameId, JointId, Limits, Model, ModelBuilder};
use crate::robot::Mimic;
use crate::robot::closure::{Closure, ClosureKind};
use crate::robot::xml::{Fault, RobotFileError, rotation_of_wxyz};
use crate::spatial::{Placement, Vector3};

/// The active equalities of a document.
pub(super) fn read_all<'a>(
    root: Tag<'a>,
    defaults: &Defaults<'a>,
) -> Result<Vec<Attributes<'a>>, RobotFileError> {
    let sections = root.children_named("equality");
    let mut active = Vec::new();
    for tag in sections.flat_map(|section| section.children()) {
        // The class says one thing for every kind, under this name.
        let equality = Attributes::named(tag, "equality", defaults, None)?;
        if equality.flag("active")? != Some(false) {
            active.push(equality);
        }
    }
    Ok(active)
}

/// What a `<joint>` among the equalities asks of its joints.
pub(super) enum Coupling {
    /// One follows another.
    Follows(Mimic),
    /// It stands at one value, in radians or metres.
    Stands(JointId, f64),
}

/// A relation between two joints, or the value of one.
pub(super) fn coupling(
    equality: &Attributes<'_>,
    names: &Names<'_>,
) -> Result<Coupling, RobotFileError> {
    let attribute = "joint1";
    let missing = || equality.fault(Fault::MissingAttribute { attribute });
    let first = equality.text(attribute).ok_or_else(missing)?;
    let first = names.joint(equality, first)?;
    let (polynomial, _) = equality
        .up_to::<5>("polycoef")?
        .unwrap_or(([0.0, 1.0, 0.0, 0.0, 0.0], 2));
    let [constant, ratio, higher @ ..] = polynomial;
    // y - y₀ = c + r (x - x₀), from where the file has both.
    let at = |joint: &super::names::NamedJoint| match joint.is_scalar {
        true => Ok((joint.id, joint.reference)),
        false => Err(equality.fault(Fault::NotLinear)),
    };
    let (joint, y) = at(&first)?;
    let Some(second) = equality.text("joint2") else {
        return Ok(Coupling::Stands(joint, y + constant));
    };
    let (master, x) = at(&names.joint(equality, second)?)?;
    if higher != [0.0; 3] {
        return Err(equality.fault(Fault::NotLinear));
    }
    let offset = y + constant - ratio * x;
    Ok(Coupling::Follows(Mimic {
        joint,
        master,
        ratio,
        offset,
    }))
}

/// Takes a relation up among those that are there, or says why not.
pub(super) fn take(
    equality: &Attributes<'_>,
    coupling: Coupling,
    mimics: &mut Vec<Mimic>,
    builder: &mut ModelBuilder,
) -> Result<(), RobotFileError> {
    match coupling {
        Coupling::Stands(joint, value) => builder.narrow(joint, Limits::new(value, value)),
        Coupling::Follows(mimic) => {
            let master_of = |joint| {
                let mut mimics = mimics.iter();
                mimics
                    .find(|other: &&Mimic| other.joint == joint)
                    .map(|other| other.master)
            };
            let mut above = Some(mimic.master);
            while let Some(joint) = above.filter(|joint| *joint != mimic.joint) {
                above = master_of(joint);
            }
            if above.is_some() || master_of(mimic.joint).is_some() {
                let joint = equality.text("joint1").unwrap_or_default().to_owned();
                return Err(equality.fault(Fault::FollowsAlready { joint }));
            }
            mimics.push(mimic);
        }
    }
    Ok(())
}

/// Where frames stand in the configuration that the file draws the robot in.
pub(super) fn as_drawn(model: &Model, q: &[f64]) -> Vec<Placement<f64>> {
    let mut kinematics = ForwardKinematics::new(model);
    match kinematics.place(q) {
        Ok(placements) => placements.to_vec(),
        // A model that is sound, and a configuration of its length, of finite numbers.
        Err(_) => vec![Placement::identity(); model.frames().len()],
    }
}

/// A `connect` or `weld`.
pub(super) fn closure(
    equality: &Attributes<'_>,
    kind: ClosureKind,
    names: &Names<'_>,
    drawn: &[Placement<f64>],
) -> Result<Closure, RobotFileError> {
    let at = |frame: FrameId| {
        drawn
            .get(frame.index())
            .copied()
            .unwrap_or(Placement::identity())
    };
    let same = Placement::identity();
    let name = equality.tag.text("name").map(str::to_owned);
    let between = |frames, frame_from_place| Closure {
        name: name.clone(),
        kind,
        frames,
        frame_from_place,
    };
    if let (Some(first), Some(second)) = (equality.text("site1"), equality.text("site2")) {
        let frames = [names.site(equality, first)?, names.site(equality, second)?];
        return Ok(between(frames, [same; 2]));
    }
    let attribute = "body1";
    let missing = || equality.fault(Fault::MissingAttribute { attribute });
    let first = names.body(equality, equality.text(attribute).ok_or_else(missing)?)?;
    let second = names.body(equality, equality.text("body2").unwrap_or("world"))?;
    let frames = [first, second];
    let anchor = equality.numbers::<3>("anchor")?;
    let second_from_first = at(second).inverse() * at(first);
    match kind {
        ClosureKind::Connect => {
            let attribute = "anchor";
            let missing = || equality.fault(Fault::MissingAttribute { attribute });
            let anchor = Vector3::from(anchor.ok_or_else(missing)?);
            let here = Placement::translation(anchor);
            let there = Placement::translation(second_from_first.apply(anchor));
            Ok(between(frames, [here, there]))
        }
        ClosureKind::Weld => {
            let anchor = Placement::translation(Vector3::from(anchor.unwrap_or_default()));
            let relative = equality.numbers::<7>("relpose")?;
            let first_from_second = match relative {
                Some([x, y, z, w, i, j, k]) if [w, i, j, k] != [0.0; 4] => {
                    let attribute = "relpose";
                    let zero = || equality.fault(Fault::ZeroLength { attribute });
                    let rotation = rotation_of_wxyz([w, i, j, k]).ok_or_else(zero)?;
                    Placement::new(rotation, Vector3::new(x, y, z))
                }
                // As both are drawn.
                _ => second_from_first.inverse(),
            };
            Ok(between(frames, [first_from_second * anchor, anchor]))
        }
    }
}
