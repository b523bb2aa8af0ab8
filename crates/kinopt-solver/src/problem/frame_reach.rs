//! Reach of a frame: origin and length of its kinematic chain.

use kinopt_kinematics::model::{FrameId, Model, ParameterMap};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A sphere that contains a frame at every configuration.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct Anchor {
    /// The name of the first joint of the chain.
    pub(crate) joint: String,
    /// Position of that joint in the world, metres.
    pub(crate) centre: Vector3<f64>,
    /// Length of the chain, metres: all offsets and the largest travel of its prismatic joints.
    pub(crate) reach: f64,
}

/// Relative rounding error of the lengths.
const RELATIVE_ROUNDING: f64 = 1e-9;

impl Anchor {
    /// The distance of a target from the centre and the largest reach of a point at `offset` from the frame, metres.
    ///
    /// `None` unless the target is proven unreachable within `tolerance`.
    #[doc(hidden)]
    pub fn falls_short_of(
        &self,
        position: Vector3<f64>,
        offset: Vector3<f64>,
        tolerance: f64,
    ) -> Option<(f64, f64)> {
        let distance = (position - self.centre).norm();
        let reach = self.reach + offset.norm();
        let is_unreachable = distance - reach > tolerance + RELATIVE_ROUNDING * (distance + reach);
        (is_unreachable && distance.is_finite()).then_some((distance, reach))
    }
}

/// The reach of a frame; `None` if no joint moves it or a prismatic joint has no limit.
pub(super) fn anchor(model: &Model, map: &ParameterMap, frame: FrameId) -> Option<Anchor> {
    let frame = model.frames().get(frame.index())?;
    let mut chain = Vec::new();
    let mut ancestor = frame.joint;
    while let Some(id) = ancestor {
        chain.push(id);
        ancestor = model.joints()[id.index()].parent;
    }
    let mut world_from_joint = Placement::identity();
    let mut anchor_found: Option<Anchor> = None;
    for &id in chain.iter().rev() {
        let joint = &model.joints()[id.index()];
        let travel = match model.coordinate(id) {
            Some(coordinate) if joint.kind.slides() => max_distance_from_zero(map, coordinate),
            _ => 0.0,
        };
        match &mut anchor_found {
            Some(anchor) => anchor.reach += joint.parent_from_joint.translation.norm() + travel,
            None => {
                world_from_joint = world_from_joint * joint.parent_from_joint;
                if joint.kind.moves() {
                    anchor_found = Some(Anchor {
                        joint: joint.name.clone(),
                        centre: world_from_joint.translation,
                        reach: travel,
                    });
                }
            }
        }
    }
    let mut anchor = anchor_found?;
    anchor.reach += frame.joint_from_frame.translation.norm();
    anchor.reach.is_finite().then_some(anchor)
}

/// Largest distance of a coordinate from zero.
fn max_distance_from_zero(map: &ParameterMap, coordinate: usize) -> f64 {
    let source = map.sources()[coordinate];
    let [lower, upper] = [map.lower(), map.upper()].map(|bound| source.at(bound).abs());
    lower.max(upper)
}
