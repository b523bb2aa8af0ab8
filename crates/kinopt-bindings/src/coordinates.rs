//! Names and units of the numbers of a configuration.

use kinopt::Model;
use kinopt::model::JointId;

/// Names of the numbers of a configuration: of the joints, with the component for a ball's quaternion, as in "hip w".
pub fn names(model: &Model) -> Vec<String> {
    let parts = model.moving_joints().iter().enumerate().map(|(at, &id)| {
        let joint = &model.joints()[id.index()];
        let part = at - model.coordinate(id).unwrap_or(at);
        match joint.kind.is_ball() {
            true => format!("{} {}", joint.name, ["w", "x", "y", "z"][part]),
            false => joint.name.clone(),
        }
    });
    parts.collect()
}

/// Unit of the numbers of a joint: "rad", that of the model's lengths, or "" for the components of a quaternion.
pub fn unit(model: &Model, joint: JointId) -> &'static str {
    match model.joints()[joint.index()].kind {
        kind if kind.is_ball() => "",
        kind if kind.slides() => model.length_unit().symbol(),
        _ => "rad",
    }
}
