//! Feet of a skeleton at rest: the bones to pin, the ground below them, and their support points.

use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::Vector3;

use super::body_axes::unit;
use super::body_limb::{BodyLimb, BodyLimbKind};

/// Largest height of a foot of an unknown limb above the lowest one, relative to the size of the skeleton.
const MAX_RELATIVE_FOOT_HEIGHT: f64 = 0.1;
/// Length of the heel behind the ankle, relative to the distance from the ankle to the toes.
const RELATIVE_HEEL: f64 = 0.25;
/// Half width of a sole, relative to the distance from the ankle to the toes.
const RELATIVE_HALF_WIDTH: f64 = 0.25;
/// Half width of the foot of an unknown limb, relative to the size of the skeleton.
const RELATIVE_PAW: f64 = 0.01;

/// A foot at rest.
#[derive(Clone, Debug)]
pub(super) struct StandingFoot {
    /// Bone that is pinned.
    pub(super) bone: BoneId,
    /// Bones of the leg, toes included. A drag of one of them lifts the foot.
    pub(super) leg: Vec<BoneId>,
    /// Corners of its contact area, in model coordinates.
    pub(super) support: Vec<Vector3<f64>>,
}

/// The feet of a skeleton at rest, and the ground.
#[derive(Clone, Debug)]
pub(super) struct Stance {
    pub(super) feet: Vec<StandingFoot>,
    /// Unit vertical.
    pub(super) up: Vector3<f64>,
    /// Height of the ground along `up`.
    pub(super) ground: f64,
}

impl Stance {
    /// The stance of a skeleton with `limbs`. `up` defaults to the axis of the model that is nearest to the legs, from
    /// feet to hips. `None` without feet.
    pub(super) fn of(
        skeleton: &Skeleton,
        limbs: &[BodyLimb],
        up: Option<Vector3<f64>>,
    ) -> Option<Self> {
        let has_legs = limbs.iter().any(|limb| limb.kind == BodyLimbKind::Leg);
        let candidates = limbs.iter().filter(|limb| match has_legs {
            true => limb.kind == BodyLimbKind::Leg,
            false => limb.kind == BodyLimbKind::Other,
        });
        let candidates: Vec<&BodyLimb> = candidates.collect();
        let zero = Vector3::zero();
        let legs = candidates.iter();
        let along = legs.fold(zero, |sum, leg| sum + leg.joints[0] - leg.joints[2]);
        let up = unit(up.unwrap_or_else(|| nearest_axis(along)))?;
        let lowest = |limb: &BodyLimb| {
            let points = [Some(limb.joints[2]), limb.toe_position]
                .into_iter()
                .flatten();
            points
                .map(|point| point.dot(up))
                .fold(f64::INFINITY, f64::min)
        };
        let ground = candidates
            .iter()
            .map(|leg| lowest(leg))
            .fold(f64::INFINITY, f64::min);
        let max_height = ground + MAX_RELATIVE_FOOT_HEIGHT * skeleton.size();
        let standing = candidates
            .into_iter()
            .filter(|leg| lowest(leg) <= max_height);
        let feet: Vec<StandingFoot> = standing
            .map(|leg| StandingFoot::of(skeleton, leg, up))
            .collect();
        (!feet.is_empty()).then_some(Self { feet, up, ground })
    }
}

impl StandingFoot {
    fn of(skeleton: &Skeleton, leg: &BodyLimb, up: Vector3<f64>) -> Self {
        let ankle = leg.joints[2];
        let toe = leg.toe_position.unwrap_or(ankle);
        let horizontal = (toe - ankle) - up * (toe - ankle).dot(up);
        let side = horizontal.cross(up) * RELATIVE_HALF_WIDTH;
        let paw = RELATIVE_PAW * skeleton.size();
        let support = match leg.kind {
            BodyLimbKind::Leg if horizontal.norm() > paw => {
                let heel = ankle - horizontal * RELATIVE_HEEL;
                vec![toe + side, toe - side, heel + side, heel - side]
            }
            _ => {
                let across = [Vector3::UNITS[0], Vector3::UNITS[1], Vector3::UNITS[2]]
                    .map(|axis| axis - up * axis.dot(up));
                let corners = across
                    .iter()
                    .flat_map(|axis| [toe + *axis * paw, toe - *axis * paw]);
                corners.collect()
            }
        };
        let bone = leg.end.unwrap_or(leg.lower);
        let bones = [Some(leg.upper), Some(leg.lower), leg.end, leg.toe];
        Self {
            bone,
            leg: bones.into_iter().flatten().collect(),
            support,
        }
    }
}

/// The signed coordinate axis with the smallest angle to a direction; z for the zero vector.
fn nearest_axis(direction: Vector3<f64>) -> Vector3<f64> {
    let axes = Vector3::UNITS.into_iter().flat_map(|axis| [axis, -axis]);
    let nearest = axes.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
    nearest
        .filter(|_| direction.norm() > 0.0)
        .unwrap_or(Vector3::UNITS[2])
}

impl Stance {
    /// Corners of all feet, in model coordinates.
    pub(super) fn support_points(&self) -> Vec<Vector3<f64>> {
        let corners = self
            .feet
            .iter()
            .flat_map(|foot| foot.support.iter().copied());
        corners.collect()
    }

    /// Distance of a point from the edges of the support polygon, seen along the vertical. Negative outside, and without
    /// feet: a point is inside if it is on the inner side of every edge.
    pub(super) fn margin(&self, point: Vector3<f64>) -> f64 {
        let corners = self.support_points();
        let horizontal = |v: Vector3<f64>| v - self.up * v.dot(self.up);
        let mut margin: Option<f64> = None;
        for a in &corners {
            for b in &corners {
                // An edge has all corners on its left side.
                let Some(normal) = unit(self.up.cross(horizontal(*b - *a))) else {
                    continue;
                };
                let depth = |p: Vector3<f64>| normal.dot(p - *a);
                if corners
                    .iter()
                    .all(|corner| depth(*corner) >= -1e-9 * (*b - *a).norm())
                {
                    let distance = depth(point);
                    margin = Some(margin.map_or(distance, |least| least.min(distance)));
                }
            }
        }
        margin.unwrap_or(f64::NEG_INFINITY)
    }
}
