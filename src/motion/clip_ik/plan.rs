//! What is asked of every frame of a clip, and of moments between two.

use std::cmp::Ordering;

use glam::DVec3;

use super::clip_solver::{ClipIk, ClipRequest};
use super::planting::Planted;
use super::sampling::LimbWay;
use crate::skeleton::BoneId;
use crate::spatial::Vector3;

/// Where a bone should be, and how much of the way it goes there.
pub(super) type Goal = (DVec3, f64);

/// A frame, and a share of the way to the next.
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

    /// Where it is among the frames.
    fn position(self) -> f64 {
        self.frame as f64 + self.share
    }

    /// Moments that part what lies between this one and the next into so many equal parts.
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

/// What is asked of each frame.
pub(super) struct Plan<'a> {
    pub(super) ik: &'a ClipIk<'a>,
    pub(super) request: &'a ClipRequest,
    /// Of the frames, in seconds.
    pub(super) times: &'a [f32],
    pub(super) limbs: &'a [LimbWay],
    /// Of the first limbs.
    pub(super) feet: &'a [Planted],
    /// How far the root moves from where the clip has it and its travel.
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

    /// How far the clip has travelled by then.
    pub(super) fn travelled(&self, moment: Moment) -> DVec3 {
        travelled(self.request, self.time(moment))
    }

    pub(super) fn moved(&self, Moment { frame, share }: Moment) -> DVec3 {
        match share > 0.0 {
            true => self.moved[frame].lerp(self.moved[frame + 1], share),
            false => self.moved[frame],
        }
    }

    /// What is asked of a bone that the clip has at `free`, on its way.
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

    /// Where a bone should be that the clip has at `free`: what is not asked for goes with the root.
    pub(super) fn place(&self, moment: Moment, free: DVec3, (at, weight): Goal) -> DVec3 {
        (free + self.moved(moment)).lerp(at, weight)
    }
}

/// How far a clip on the spot has travelled at a time of it, in seconds.
pub(super) fn travelled(request: &ClipRequest, time: f32) -> DVec3 {
    request.root_velocity * (f64::from(time) - request.span[0])
}

/// What the reaches ask of a bone that the clip has at `free`.
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
