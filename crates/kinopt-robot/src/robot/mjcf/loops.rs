//! `<equality>`: loop closures.

use super::attributes::Attributes;
use super::body::BodyElement;
use super::names::{ElementNames, FreshNames};
use crate::robot::xml::{ParseIssue, Read, RobotFileError, rotation_of_wxyz};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, Loop, LoopKind, Model};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Reads the loop closures of `connect` and `weld`. `reference_configuration` is the configuration in which the body
/// poses are those of the file.
pub(super) fn read_all(
    equalities: &[Attributes<'_>],
    bodies: &[BodyElement<'_>],
    names: &ElementNames<'_>,
    model: &Model,
    reference_configuration: &[f64],
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
    let mut loop_names = FreshNames::default();
    for name in closing
        .iter()
        .filter_map(|(closed, _)| closed.tag.text("name"))
    {
        loop_names.reserve(name);
    }
    let placements = placements_at(model, reference_configuration);
    let mocap = mocap_frames(bodies, names);
    let mut loops = Vec::with_capacity(closing.len());
    for (equality, kind) in closing {
        let (frames, anchors) = frames_and_anchors(equality, kind, names, &placements)?;
        if frames.iter().any(|frame| mocap.contains(frame)) {
            left_out.push(equality.fault(ParseIssue::HeldFromOutside));
            continue;
        }
        let name = equality.tag.text("name").map(str::to_owned);
        let name = name.unwrap_or_else(|| {
            let frame_name = &model.frames()[frames[0].index()].name;
            loop_names.fresh(format!("{frame_name}/{}", kind.name()))
        });
        let closed = match kind {
            LoopKind::Connect => Loop::connect(name, frames),
            LoopKind::Weld => Loop::weld(name, frames),
        };
        loops.push(closed.at(anchors));
    }
    Ok(loops)
}

/// Frames of mocap bodies, which a program moves, and of their sites. A constraint to such a body is a target and no
/// loop.
fn mocap_frames(bodies: &[BodyElement<'_>], names: &ElementNames<'_>) -> Vec<FrameId> {
    let mocap_bodies = bodies
        .iter()
        .filter(|body| body.tag.text("mocap") == Some("true"));
    mocap_bodies
        .flat_map(|body| names.frames_of(body))
        .collect()
}

/// Frame poses at a configuration.
fn placements_at(model: &Model, q: &[f64]) -> Vec<Placement<f64>> {
    let mut kinematics = ForwardKinematics::new(model);
    match kinematics.place(q) {
        Ok(placements) => placements.to_vec(),
        // Unreachable: the model is valid, and the configuration is finite and has its length.
        Err(_) => vec![Placement::identity(); model.frames().len()],
    }
}

/// The two frames of a `connect` or `weld`, and the closure pose in each frame.
fn frames_and_anchors(
    equality: &Attributes<'_>,
    kind: LoopKind,
    names: &ElementNames<'_>,
    placements: &[Placement<f64>],
) -> Read<([FrameId; 2], [Placement<f64>; 2])> {
    let placement = |frame: FrameId| {
        placements
            .get(frame.index())
            .copied()
            .unwrap_or(Placement::identity())
    };
    let identity = Placement::identity();
    if let (Some(first), Some(second)) = (equality.text("site1"), equality.text("site2")) {
        let frames = [names.site(equality, first)?, names.site(equality, second)?];
        return Ok((frames, [identity; 2]));
    }
    let attribute = "body1";
    let missing = || equality.fault(ParseIssue::MissingAttribute { attribute });
    let first = names.body(equality, equality.text(attribute).ok_or_else(missing)?)?;
    let second = names.body(equality, equality.text("body2").unwrap_or("world"))?;
    let frames = [first, second];
    let anchor = equality.numbers::<3>("anchor")?;
    let second_from_first = placement(second).inverse() * placement(first);
    match kind {
        LoopKind::Connect => {
            let attribute = "anchor";
            let missing = || equality.fault(ParseIssue::MissingAttribute { attribute });
            let anchor = Vector3::from(anchor.ok_or_else(missing)?);
            let anchor_in_first = Placement::translation(anchor);
            let anchor_in_second = Placement::translation(second_from_first.apply(anchor));
            Ok((frames, [anchor_in_first, anchor_in_second]))
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
