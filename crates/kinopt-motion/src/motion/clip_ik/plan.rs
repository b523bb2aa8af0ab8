//! Targets of all bones in each frame of a clip, and between frames.

use std::cmp::Ordering;

use glam::DVec3;

use super::clip_solver::{ClipIk, ClipRequest};
use super::sampling::LimbMotion;
use crate::motion::contact::PlantedFoot;
use kinopt_kinematics::skeleton::BoneId;
use kinopt_kinematics::spatial::Vector3;

/// Target position in the model, and its weight from 0 to 1.
pub(super) type EffectorTarget = (DVec3, f64);

/// Sample time: a frame and a fraction of the interval to the next frame.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct SampleTime {
    pub(super) frame: usize,
    pub(super) fraction: f64,
}

impl SampleTime {
    pub(super) fn at_frame(frame: usize) -> Self {
        Self {
            frame,
            fraction: 0.0,
        }
    }

    pub(super) fn total_cmp(&self, other: &Self) -> Ordering {
        let by_frame = self.frame.cmp(&other.frame);
        by_frame.then(self.fraction.total_cmp(&other.fraction))
    }

    /// Returns the sample time in frames.
    fn position(self) -> f64 {
        self.frame as f64 + self.fraction
    }

    /// Returns the sample times that split the interval to `next` into equal parts.
    pub(super) fn between(self, next: Self, parts: usize) -> impl Iterator<Item = Self> {
        let (from, to) = (self.position(), next.position());
        let frame = self.frame;
        (1..parts).map(move |part| {
            let position = from + (to - from) * part as f64 / parts as f64;
            Self {
                frame,
                fraction: position - frame as f64,
            }
        })
    }
}

/// Targets of all bones in each frame.
pub(super) struct Plan<'a> {
    pub(super) ik: &'a ClipIk<'a>,
    pub(super) request: &'a ClipRequest,
    /// Times of the frames, seconds.
    pub(super) times: &'a [f32],
    pub(super) limbs: &'a [LimbMotion],
    /// Feet of the first limbs.
    pub(super) feet: &'a [PlantedFoot],
    /// Displacement of the root by frame, without the travel of the clip.
    pub(super) moved: Vec<DVec3>,
}

impl Plan<'_> {
    pub(super) fn time(&self, sample: SampleTime) -> f32 {
        let time = |frame: usize| f64::from(self.times[frame]);
        match sample.fraction > 0.0 {
            true => {
                let (from, to) = (time(sample.frame), time(sample.frame + 1));
                (from + (to - from) * sample.fraction) as f32
            }
            false => self.times[sample.frame],
        }
    }

    /// Returns the travel of the clip until a sample time.
    pub(super) fn travelled(&self, sample: SampleTime) -> DVec3 {
        travelled(self.request, self.time(sample))
    }

    pub(super) fn moved(&self, SampleTime { frame, fraction }: SampleTime) -> DVec3 {
        match fraction > 0.0 {
            true => self.moved[frame].lerp(self.moved[frame + 1], fraction),
            false => self.moved[frame],
        }
    }

    /// Returns the target of a bone that is at `free` in the clip.
    pub(super) fn goal(&self, bone: usize, sample: SampleTime, free: DVec3) -> EffectorTarget {
        match self.feet.get(bone) {
            Some(foot) => {
                let frame = sample.frame;
                let position = match foot.contact_position_from(frame) {
                    Some(contact) => dvec(contact),
                    None if sample.fraction == 0.0 => dvec(foot.positions[frame]),
                    None => {
                        let positions = &self.limbs[bone].positions;
                        let slip = |frame: usize| dvec(foot.positions[frame]) - positions[frame];
                        free + slip(frame).lerp(slip(frame + 1), sample.fraction)
                    }
                };
                (position, 1.0)
            }
            None => {
                let time = f64::from(self.time(sample));
                reach_goal(self.ik, self.request, self.request.bones[bone], time, free)
            }
        }
    }

    /// Returns the commanded position of a bone that is at `free` in the clip. The part without target weight moves
    /// with the root.
    pub(super) fn commanded_position(
        &self,
        sample: SampleTime,
        free: DVec3,
        (target, weight): EffectorTarget,
    ) -> DVec3 {
        (free + self.moved(sample)).lerp(target, weight)
    }
}

/// Returns the travel of a clip on the spot until a time, seconds.
pub(super) fn travelled(request: &ClipRequest, time: f32) -> DVec3 {
    request.root_velocity * (f64::from(time) - request.span[0])
}

/// Returns the target from the reaches of a bone that is at `free` in the clip.
fn reach_goal(
    ik: &ClipIk<'_>,
    request: &ClipRequest,
    bone: BoneId,
    time: f64,
    free: DVec3,
) -> EffectorTarget {
    let reaches = ik.reaches.iter().filter(|reach| reach.bone == bone);
    let goals = reaches.map(|reach| (reach.target(time), reach.weight(time, request.span)));
    goals.fold(
        (free, 0.0),
        |last, goal| if goal.1 > 0.0 { goal } else { last },
    )
}

pub(super) fn dvec(vector: Vector3<f64>) -> DVec3 {
    DVec3::from(vector.to_array())
}
