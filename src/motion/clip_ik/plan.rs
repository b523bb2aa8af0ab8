//! Targets of all bones in each frame of a clip, and between frames.

use std::cmp::Ordering;

use glam::DVec3;

use super::clip_solver::{ClipIk, ClipRequest};
use super::planting::Planted;
use super::sampling::LimbWay;
use crate::skeleton::BoneId;
use crate::spatial::Vector3;

/// Target position in the model, and its weight from 0 to 1.
pub(super) type Goal = (DVec3, f64);

/// Sample time: a frame and a fraction of the interval to the next frame.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Moment {
    pub(super) frame: usize,
    pub(super) share: f64,
}

impl Moment {
    pub(super) fn at(frame: usize) -> Self {
        Self { frame, share: 0.0 }
    }

    pub(super) fn total_cmp(&self, other: &Self) -> Ordering {
        let of_frame = self.frame.cmp(&other.frame);
        of_frame.then(self.share.total_cmp(&other.share))
    }

    /// Returns the sample time in frames.
    fn position(self) -> f64 {
        self.frame as f64 + self.share
    }

    /// Returns the sample times that split the interval to `next` into equal parts.
    pub(super) fn between(self, next: Self, parts: usize) -> impl Iterator<Item = Self> {
        let (from, to) = (self.position(), next.position());
        let frame = self.frame;
        (1..parts).map(move |part| {
            let at = from + (to - from) * part as f64 / parts as f64;
            Self {
                frame,
                share: at - frame as f64,
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
    pub(super) limbs: &'a [LimbWay],
    /// Feet of the first limbs.
    pub(super) feet: &'a [Planted],
    /// Displacement of the root by frame, without the travel of the clip.
    pub(super) moved: Vec<DVec3>,
}

impl Plan<'_> {
    pub(super) fn time(&self, moment: Moment) -> f32 {
        let time = |frame: usize| f64::from(self.times[frame]);
        match moment.share > 0.0 {
            true => {
                let (from, to) = (time(moment.frame), time(moment.frame + 1));
                (from + (to - from) * moment.share) as f32
            }
            false => self.times[moment.frame],
        }
    }

    /// Returns the travel of the clip until a sample time.
    pub(super) fn travelled(&self, moment: Moment) -> DVec3 {
        travelled(self.request, self.time(moment))
    }

    pub(super) fn moved(&self, Moment { frame, share }: Moment) -> DVec3 {
        match share > 0.0 {
            true => self.moved[frame].lerp(self.moved[frame + 1], share),
            false => self.moved[frame],
        }
    }

    /// Returns the target of a bone that is at `free` in the clip.
    pub(super) fn goal(&self, bone: usize, moment: Moment, free: DVec3) -> Goal {
        match self.feet.get(bone) {
            Some(foot) => {
                let frame = moment.frame;
                let at = match foot.stands_from(frame) {
                    Some(place) => dvec(place),
                    None if moment.share == 0.0 => dvec(foot.way[frame]),
                    None => {
                        let way = &self.limbs[bone].way;
                        let slip = |frame: usize| dvec(foot.way[frame]) - way[frame];
                        free + slip(frame).lerp(slip(frame + 1), moment.share)
                    }
                };
                (at, 1.0)
            }
            None => {
                let time = f64::from(self.time(moment));
                reached(self.ik, self.request, self.request.bones[bone], time, free)
            }
        }
    }

    /// Returns the commanded position of a bone that is at `free` in the clip. The part without target weight moves
    /// with the root.
    pub(super) fn place(&self, moment: Moment, free: DVec3, (at, weight): Goal) -> DVec3 {
        (free + self.moved(moment)).lerp(at, weight)
    }
}

/// Returns the travel of a clip on the spot until a time, seconds.
pub(super) fn travelled(request: &ClipRequest, time: f32) -> DVec3 {
    request.root_velocity * (f64::from(time) - request.span[0])
}

/// Returns the target from the reaches of a bone that is at `free` in the clip.
fn reached(ik: &ClipIk<'_>, request: &ClipRequest, bone: BoneId, time: f64, free: DVec3) -> Goal {
    let own = ik.reaches.iter().filter(|reach| reach.bone == bone);
    let asked = own.map(|reach| (reach.target(time), reach.weight(time, request.span)));
    asked.fold(
        (free, 0.0),
        |found, goal| if goal.1 > 0.0 { goal } else { found },
    )
}

pub(super) fn dvec(at: Vector3<f64>) -> DVec3 {
    DVec3::from(at.to_array())
}
