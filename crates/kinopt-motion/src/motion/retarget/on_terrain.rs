//! Targets on a terrain: feet in contact on its planes, and a body at the mean height of its feet.

use super::contacts::LimbContact;
use super::limbs::Limbs;
use super::orientations::{direction, horizontal};
use super::terrain::{GroundPlane, Terrain};
use crate::motion::contact::smooth;
use kinopt_kinematics::spatial::Vector3;

/// Time over which the height of the body follows the mean height of its feet, seconds.
const BODY_WINDOW_S: f64 = 0.4;

/// Ground under a limb that makes contact, by capture frame.
#[derive(Clone, Debug)]
pub(super) struct LimbGround {
    pub(super) limb: usize,
    /// Height of the ground, metres.
    pub(super) heights: Vec<f64>,
    /// Plane of each contact.
    pub(super) planes: Vec<GroundPlane>,
}

/// Ground under the sole of a foot in a capture frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SoleGround {
    /// Height under each ball, metres.
    pub(super) heights: Vec<f64>,
    /// Tilt of each level direction on the ground.
    pub(super) tilts: Vec<f64>,
}

/// Rotates a vector by the smallest rotation of the upward axis to a normal.
pub(super) fn tilted(normal: Vector3<f64>, v: Vector3<f64>) -> Vector3<f64> {
    let up = Vector3::UNITS[2];
    let axis = up.cross(normal);
    v + axis.cross(v) + axis.cross(axis.cross(v)) * (1.0 / (1.0 + normal.z).max(1e-3))
}

/// Normals of the ground by capture frame: those of the contacts, and interpolated between them.
fn normals(contacts: &[(&LimbContact, GroundPlane)], frames: usize) -> Vec<Vector3<f64>> {
    let up = Vector3::UNITS[2];
    let mut normals = vec![up; frames];
    let mut last: Option<(usize, Vector3<f64>)> = None;
    for (contact, plane) in contacts {
        let normal = plane.normal();
        let (end, from) = last.unwrap_or((0, normal));
        let count = contact.span.start.saturating_sub(end) as f64;
        let between = normals.iter_mut().take(contact.span.start).skip(end);
        for (k, mixed) in between.enumerate() {
            let fraction = smooth((k + 1) as f64 / (count + 1.0));
            *mixed = from + (normal - from) * fraction;
            *mixed = *mixed * (1.0 / mixed.norm());
        }
        normals[contact.span.clone()].fill(normal);
        last = Some((contact.span.end, normal));
    }
    if let Some((end, normal)) = last {
        normals[end..].fill(normal);
    }
    normals
}

impl Limbs {
    /// Moves targets and directions of all capture frames onto a terrain. Contact points are already on it. Returns the
    /// ground under each sole, frame by frame.
    pub(super) fn follow_terrain(
        &self,
        terrain: &Terrain,
        rate: f64,
        contacts: &[LimbContact],
        grounds: &[LimbGround],
        targets: &mut [Vector3<f64>],
        directions: &mut [Vector3<f64>],
    ) -> Vec<SoleGround> {
        let n = self.all.len();
        let frames = targets.len() / n.max(1);
        let width = directions.len() / frames.max(1);
        let window = (BODY_WINDOW_S * rate).ceil() as usize;
        let body = body_heights(
            grounds
                .iter()
                .filter(|ground| self.foot_limb(ground.limb) == ground.limb),
            frames,
            window,
        );
        for (targets, height) in targets.chunks_exact_mut(n.max(1)).zip(&body) {
            for (target, _) in targets
                .iter_mut()
                .zip(&self.all)
                .filter(|(_, limb)| !limb.makes_contact)
            {
                target.z += height;
            }
        }
        let normals: Vec<Vec<Vector3<f64>>> = (0..n)
            .map(|limb| {
                let ground = grounds.iter().find(|ground| ground.limb == limb);
                let planes = ground
                    .map(|ground| ground.planes.as_slice())
                    .unwrap_or_default();
                let own = contacts.iter().filter(|contact| contact.limb == limb);
                normals(&own.zip(planes.iter().copied()).collect::<Vec<_>>(), frames)
            })
            .collect();
        let feet: Vec<(usize, Vector3<f64>)> = self.orientations.feet().collect();
        for (k, (ankle, _)) in feet.iter().enumerate() {
            for (frame, normal) in normals[*ankle].iter().enumerate() {
                for direction in &mut directions[frame * width + 2 * k..][..2] {
                    *direction = tilted(*normal, *direction);
                }
            }
        }
        let mut soles = Vec::with_capacity(frames * self.soles.len());
        for frame in 0..frames {
            for sole in &self.soles {
                let ankle = self.foot_limb(sole.balls.first().map_or(0, |(_, limb)| *limb));
                let normal = normals[ankle][frame];
                let heading = feet.iter().position(|(limb, _)| *limb == ankle);
                let heading = heading.map(|k| (feet[k].1, directions[frame * width + 2 * k]));
                let turned = |v: Vector3<f64>| tilted(normal, headed(heading, v));
                let heights = sole.stance_balls.iter().map(|ball| {
                    let position =
                        targets[frame * n + ankle] + turned(*ball - self.all[ankle].stance);
                    terrain.height(position.x, position.y)
                });
                soles.push(SoleGround {
                    heights: heights.collect(),
                    tilts: sole
                        .stance_level
                        .iter()
                        .map(|level| turned(*level).z)
                        .collect(),
                });
            }
        }
        soles
    }

    /// Returns the ankle of a toe that makes contact, or else the limb.
    fn foot_limb(&self, limb: usize) -> usize {
        let parent = self.all[limb].parent;
        parent
            .filter(|parent| self.all[*parent].makes_contact)
            .unwrap_or(limb)
    }
}

/// Rotates a vector of the stance about the vertical axis, from the foot's direction in the stance to its heading.
fn headed(heading: Option<(Vector3<f64>, Vector3<f64>)>, v: Vector3<f64>) -> Vector3<f64> {
    let Some((stance, heading)) =
        heading.and_then(|(stance, heading)| Some((stance, direction(horizontal(heading))?)))
    else {
        return v;
    };
    let (cosine, sine) = (stance.dot(heading), stance.cross(heading).z);
    Vector3::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z)
}

/// Returns the mean height of the ground under all feet by capture frame, averaged over `window` frames before and after.
fn body_heights<'a>(
    feet: impl Iterator<Item = &'a LimbGround>,
    frames: usize,
    window: usize,
) -> Vec<f64> {
    let feet: Vec<&LimbGround> = feet.collect();
    let mean = |frame: usize| {
        let sum: f64 = feet.iter().map(|foot| foot.heights[frame]).sum();
        sum / feet.len().max(1) as f64
    };
    let mut sums = vec![0.0];
    for frame in 0..frames {
        sums.push(sums[frame] + mean(frame));
    }
    let averaged = (0..frames).map(|frame| {
        // Windows are symmetric, so that a slope causes no delay.
        let half = window.min(frame).min(frames - 1 - frame);
        (sums[frame + half + 1] - sums[frame - half]) / (2 * half + 1) as f64
    });
    averaged.collect()
}
