//! Proportions of a subject and a character: the ratio of their legs, and heights of feet over the ground.

use glam::DVec3;

use super::super::BodyPart;
use super::correspondence::Correspondence;
use super::rotation::heading;

/// Largest difference of corresponding lengths of bodies with the same proportions, relative to the leg.
const SAME_PROPORTIONS: f64 = 2e-3;

/// Parts of both legs from the hip outwards.
pub(super) const LEGS: [[BodyPart; 4]; 2] = [
    [
        BodyPart::LeftHip,
        BodyPart::LeftKnee,
        BodyPart::LeftAnkle,
        BodyPart::LeftToe,
    ],
    [
        BodyPart::RightHip,
        BodyPart::RightKnee,
        BodyPart::RightAnkle,
        BodyPart::RightToe,
    ],
];

/// Sizes of a character relative to a subject.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sizes {
    /// Ratio of the leg lengths.
    pub(super) stride: f64,
    /// Length of the character's leg, in its unit.
    pub(super) leg: f64,
    /// Height of the subject's feet over the ground in the reference pose, in its unit.
    pub(super) subject_clearance: Vec<(BodyPart, f64)>,
    /// Height of the character's feet over the ground at rest, in its unit.
    pub(super) clearance: Vec<(BodyPart, f64)>,
    /// Distance of the character's hips less the scaled distance of the subject's.
    pub(super) wider_hips: f64,
    /// True if the legs of both have the same proportions, so that equal rotations give equal positions of the feet.
    pub(super) are_same: bool,
}

impl Sizes {
    /// Measures both bodies. `below_ankles` are heights of all points of the feet, of the subject and the character.
    pub(super) fn new(
        relation: &Correspondence,
        subject: &[DVec3],
        character: &[DVec3],
        below_ankles: [&[usize]; 2],
    ) -> Self {
        let of_subject = |part: BodyPart| relation.joints.get(&part).map(|joint| subject[*joint]);
        let of_character = |part: BodyPart| relation.bones.get(&part).map(|bone| character[*bone]);
        let length = |at: &dyn Fn(BodyPart) -> Option<DVec3>, from, to| -> Option<f64> {
            Some(at(from)?.distance(at(to)?))
        };
        let leg_length = |at: &dyn Fn(BodyPart) -> Option<DVec3>| {
            let legs = LEGS.iter().filter_map(|[hip, knee, ankle, _]| {
                Some(length(at, *hip, *knee)? + length(at, *knee, *ankle)?)
            });
            let lengths: Vec<f64> = legs.collect();
            lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
        };
        let (subject_leg, leg) = (leg_length(&of_subject), leg_length(&of_character));
        let stride = match subject_leg > 0.0 && leg > 0.0 {
            true => leg / subject_leg,
            false => 1.0,
        };
        let clearances =
            |at: &dyn Fn(BodyPart) -> Option<DVec3>, positions: &[DVec3], below: &[usize]| {
                let feet = LEGS.iter().flat_map(|[.., ankle, toe]| [*ankle, *toe]);
                let heights: Vec<_> = feet.filter_map(|part| Some((part, at(part)?.z))).collect();
                let lowest = below.iter().map(|joint| positions[*joint].z);
                let lowest = lowest.chain(heights.iter().map(|(_, height)| *height));
                let ground = lowest.fold(f64::INFINITY, f64::min);
                heights
                    .into_iter()
                    .map(|(part, height)| (part, height - ground))
                    .collect::<Vec<_>>()
            };
        let facing = match (
            of_subject(BodyPart::LeftHip).zip(of_subject(BodyPart::RightHip)),
            of_character(BodyPart::LeftHip).zip(of_character(BodyPart::RightHip)),
        ) {
            (Some((left, right)), Some((from, to))) => heading(from - to, left - right),
            _ => heading(DVec3::X, DVec3::X),
        };
        let are_same = LEGS.iter().all(|parts| {
            let mut last = BodyPart::Pelvis;
            parts.iter().enumerate().all(|(k, part)| {
                let from = std::mem::replace(&mut last, *part);
                let segments = (
                    of_subject(from).zip(of_subject(*part)),
                    of_character(from).zip(of_character(*part)),
                );
                match segments {
                    (Some((a, b)), Some((c, d))) => {
                        // Hips are rigid with the pelvis. Other segments have the same directions.
                        let difference = match k {
                            0 => (facing * (d - c)).distance((b - a) * stride),
                            _ => (c.distance(d) - a.distance(b) * stride).abs(),
                        };
                        difference <= SAME_PROPORTIONS * leg
                    }
                    (None, None) => true,
                    _ => false,
                }
            })
        });
        let width = |at: &dyn Fn(BodyPart) -> Option<DVec3>| {
            length(at, BodyPart::LeftHip, BodyPart::RightHip)
        };
        let widths = width(&of_character).zip(width(&of_subject));
        Self {
            stride,
            leg,
            wider_hips: widths.map_or(0.0, |(own, subject)| own - stride * subject),
            subject_clearance: clearances(&of_subject, subject, below_ankles[0]),
            clearance: clearances(&of_character, character, below_ankles[1]),
            are_same: are_same && leg > 0.0,
        }
    }

    /// Height that a part of a foot gains in addition to its scaled height.
    pub(super) fn rise(&self, part: BodyPart) -> f64 {
        let of = |list: &[(BodyPart, f64)]| {
            let found = list.iter().find(|(known, _)| *known == part);
            found.map_or(0.0, |(_, height)| *height)
        };
        of(&self.clearance) - self.stride * of(&self.subject_clearance)
    }
}
