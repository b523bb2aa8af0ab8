//! Where the chain of a frame begins, and how far from there the frame can be.

use crate::model::{FrameId, Model, ParameterMap};
use crate::spatial::{Placement, Vector3};

/// The ball that a frame cannot leave.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Anchor {
    /// The joint that begins the chain.
    pub(crate) joint: String,
    /// Where that joint stands in the world.
    pub(crate) centre: Vector3<f64>,
    /// The chain's length: all its offsets and the longest ways of its slides.
    pub(crate) reach: f64,
}

/// Rounding of the lengths that are compared, as a share of them.
const ROUNDING: f64 = 1e-9;

impl Anchor {
    /// How far a place is from where the chain begins, and how far that reaches with a point's offset from its tip,
    /// metres; none unless it certainly reaches no place within a tolerance of there.
    pub(crate) fn falls_short_of(
        &self,
        place: Vector3<f64>,
        offset: Vector3<f64>,
        tolerance: f64,
    ) -> Option<(f64, f64)> {
        let distance = (place - self.centre).norm();
        let reach = self.reach + offset.norm();
        let certain = distance - reach > tolerance + ROUNDING * (distance + reach);
        (certain && distance.is_finite()).then_some((distance, reach))
    }
}

/// The anchor of a frame; `None` where nothing moves it or a slide has no end.
pub(super) fn anchor(model: &Model, map: &ParameterMap, frame: FrameId) -> Option<Anchor> {
    let frame = model.frames().get(frame.index())?;
    let mut chain = Vec::new();
    let mut above = frame.joint;
    while let Some(id) = above {
        chain.push(id);
        above = model.joints()[id.index()].parent;
    }
    let mut world = Placement::identity();
    let mut found: Option<Anchor> = None;
    for &id in chain.iter().rev() {
        let joint = &model.joints()[id.index()];
        let slide = match model.coordinate(id) {
            Some(coordinate) if joint.kind.slides() => farthest(map, coordinate),
            _ => 0.0,
        };
        match &mut found {
            Some(anchor) => anchor.reach += joint.parent_from_joint.translation.norm() + slide,
            None => {
                world = world * joint.parent_from_joint;
                if joint.kind.moves() {
                    found = Some(Anchor {
                        joint: joint.name.clone(),
                        centre: world.translation,
                        reach: slide,
                    });
                }
            }
        }
    }
    let mut anchor = found?;
    anchor.reach += frame.joint_from_frame.translation.norm();
    anchor.reach.is_finite().then_some(anchor)
}

/// How far from zero a coordinate can be.
fn farthest(map: &ParameterMap, coordinate: usize) -> f64 {
    let source = map.sources()[coordinate];
    let [one, other] = [map.lower(), map.upper()].map(|end| source.at(end).abs());
    one.max(other)
}
