//! `<equality>`: loop closures.

use super::attributes::Attributes;
use super::body::Body;
use super::names::{ElementNames, FreshNames};
use crate::kinematics::ForwardKinematics;
use crate::model::{FrameId, Loop, LoopKind, Model};
use crate::robot::xml::{ParseIssue, Read, RobotFileError, rotation_of_wxyz};
use crate::spatial::{Placement, Vector3};

/// Reads the loop closures of `connect` and `weld`. `drawn` is the configuration in which the body poses are those of
/// the file.
pub(super) fn read_all(
    equalities: &[Attributes<'_>],
    bodies: &[Body<'_>],
    names: &ElementNames<'_>,
    model: &Model,
    drawn: &[f64],
    left_out: &mut Vec<RobotFileError>,
) -> Read<Vec<Loop>> {
    let kinds = [LoopKind::Connect, LoopKind::Weld];
    let closing = equalities.iter().filter_map(|equality| {
        let kind = kinds.into_iter().find(|k| k.name() == equality.tag.name());
        Some((equality, kind?))
    });
    let closing: Vec<_> = closing.collect();
    if closing.is_empty() {
        return Ok(Vec::new());
    }
    let mut called = FreshNames::default();
    for name in closing.iter().filter_map(|(own, _)| own.tag.text("name")) {
        called.take(name);
    }
    let placements = as_drawn(model, drawn);
    let mocap = mocap_frames(bodies, names);
    let mut loops = Vec::with_capacity(closing.len());
    for (equality, kind) in closing {
        let (frames, places) = joined(equality, kind, names, &placements)?;
        if frames.iter().any(|frame| mocap.contains(frame)) {
            left_out.push(equality.fault(ParseIssue::HeldFromOutside));
            continue;
        }
        let name = equality.tag.text("name").map(str::to_owned);
        let name = name.unwrap_or_else(|| {
            let on = &model.frames()[frames[0].index()].name;
            called.fresh(format!("{on}/{}", kind.name()))
        });
        let own = match kind {
            LoopKind::Connect => Loop::connect(name, frames),
            LoopKind::Weld => Loop::weld(name, frames),
        };
        loops.push(own.at(places));
    }
    Ok(loops)
}

/// Frames of mocap bodies, which a program moves, and of their sites. A constraint to such a body is a target and no
/// loop.
fn mocap_frames(bodies: &[Body<'_>], names: &ElementNames<'_>) -> Vec<FrameId> {
    let moved = bodies
        .iter()
        .filter(|body| body.tag.text("mocap") == Some("true"));
    moved.flat_map(|body| names.frames_of(body)).collect()
}

/// Frame poses at a configuration.
fn as_drawn(model: &Model, q: &[f64]) -> Vec<Placement<f64>> {
    let mut kinematics = ForwardKinematics::new(model);
    match kinematics.place(q) {
        Ok(placements) => placements.to_vec(),
        // Unreachable: the model is valid, and the configuration is finite and has its length.
        Err(_) => vec![Placement::identity(); model.frames().len()],
    }
}

/// The two frames of a `connect` or `weld`, and the closure pose in each frame.
fn joined(
    equality: &Attributes<'_>,
    kind: LoopKind,
    names: &ElementNames<'_>,
    drawn: &[Placement<f64>],
) -> Read<([FrameId; 2], [Placement<f64>; 2])> {
    let at = |frame: FrameId| {
        drawn
            .get(frame.index())
            .copied()
            .unwrap_or(Placement::identity())
    };
    let same = Placement::identity();
    if let (Some(first), Some(second)) = (equality.text("site1"), equality.text("site2")) {
        let frames = [names.site(equality, first)?, names.site(equality, second)?];
        return Ok((frames, [same; 2]));
    }
    let attribute = "body1";
    let missing = || equality.fault(ParseIssue::MissingAttribute { attribute });
    let first = names.body(equality, equality.text(attribute).ok_or_else(missing)?)?;
    let second = names.body(equality, equality.text("body2").unwrap_or("world"))?;
    let frames = [first, second];
    let anchor = equality.numbers::<3>("anchor")?;
    let second_from_first = at(second).inverse() * at(first);
    match kind {
        LoopKind::Connect => {
            let attribute = "anchor";
            let missing = || equality.fault(ParseIssue::MissingAttribute { attribute });
            let anchor = Vector3::from(anchor.ok_or_else(missing)?);
            let here = Placement::translation(anchor);
            let there = Placement::translation(second_from_first.apply(anchor));
            Ok((frames, [here, there]))
        }
        LoopKind::Weld => {
            let anchor = Placement::translation(Vector3::from(anchor.unwrap_or_default()));
            let relative = equality.numbers::<7>("relpose")?;
            let first_from_second = match relative {
                Some([x, y, z, w, i, j, k]) if [w, i, j, k] != [0.0; 4] => {
                    let attribute = "relpose";
                    let zero = || equality.fault(ParseIssue::ZeroLength { attribute });
                    let rotation = rotation_of_wxyz([w, i, j, k]).ok_or_else(zero)?;
                    Placement::new(rotation, Vector3::new(x, y, z))
                }
                // Without `relpose` the relative pose is that of the file.
                _ => second_from_first.inverse(),
            };
            Ok((frames, [first_from_second * anchor, anchor]))
        }
    }
}
