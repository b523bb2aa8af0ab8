//! From what is asked to a new clip: where bones should be, how the root moves, then frame by frame.

use std::ops::Range;

use glam::{DVec3, Quat, Vec3A};

use super::ClipIkError;
use super::clip_solver::{ClipIk, ClipRequest};
use super::edited::{EditedClip, Led, Stance};
use super::frame_solver::FrameSolver;
use super::planting::{Ground, Planted, plant};
use super::posed_bones::PosedBones;
use super::root::{self, Demand};
use super::sampling::{LimbWay, Poses, limb_ways, sample_times};
use super::splice::{NewKeys, spliced};
use crate::animation::Clip;
use crate::skeleton::BoneId;
use crate::spatial::Vector3;

/// A limb counts as this share of its length, so that it need not be stretched.
const NOT_STRETCHED: f64 = 0.998;

/// Where a bone should be in each frame, and how much of the way it goes there.
type Goals = Vec<(DVec3, f64)>;

pub(super) fn solve(
    ik: &ClipIk<'_>,
    request: &ClipRequest,
    clip: &Clip,
) -> Result<EditedClip, ClipIkError> {
    let spans = ik.reaches.iter().flat_map(|reach| reach.span(request.span));
    let (times, rate) = sample_times(clip, ik.rate, spans)?;
    let mut posed = PosedBones::new(ik.armature, request.root, &request.bones, |bone| {
        ik.hinges(bone)
    })?;
    let mut limbs = limb_ways(ik.armature, clip, &times, &request.bones, &mut posed)?;
    let travelled: Vec<DVec3> = times
        .iter()
        .map(|time| request.travel * (f64::from(*time) - request.span[0]))
        .collect();
    for limb in &mut limbs {
        limb.move_by(&travelled);
    }
    let feet: Vec<Planted> = limbs[..ik.planted.len()]
        .iter()
        .map(|limb| foot(ik, request, limb, rate))
        .collect();
    let goals: Vec<Goals> = (0..limbs.len())
        .map(|k| match feet.get(k) {
            Some(foot) => foot.way.iter().map(|at| (dvec(*at), 1.0)).collect(),
            None => reached(ik, request, request.bones[k], &limbs[k], &times),
        })
        .collect();
    let runs = match request.travel == DVec3::ZERO {
        true => runs(&goals),
        false => std::iter::once(0..times.len()).collect(),
    };
    let moved = root_moves(request, (&limbs, &goals, &feet), &runs, rate)?;
    let frames = Frames {
        times: &times,
        limbs: &limbs,
        goals: &goals,
        travelled: &travelled,
        moved: &moved,
        runs: &runs,
    };
    let (keys, at) = frames.solve(ik, request, clip, &mut posed)?;
    let bones = request.bones.iter().enumerate();
    let stances = feet
        .iter()
        .zip(bones.clone())
        .flat_map(|(foot, (k, bone))| {
            let at = &at[k];
            let (times, spans) = (&times, foot.stances.iter());
            spans.map(move |(span, place)| {
                let place = dvec(*place);
                let off = |at: &DVec3| at.distance(place);
                Stance {
                    bone: *bone,
                    span: [span.start, span.end - 1].map(|frame| f64::from(times[frame])),
                    place,
                    slide: at[span.clone()].iter().map(off).fold(0.0, f64::max),
                }
            })
        });
    let led = bones.clone().map(|(k, bone)| {
        let miss = |frame: usize| at[k][frame].distance(frames.place(k, frame));
        let misses = (0..times.len()).map(|frame| (miss(frame), frame));
        let worst = misses.max_by(|one, other| one.0.total_cmp(&other.0));
        let (miss, frame) = worst.unwrap_or((0.0, 0));
        Led {
            bone: *bone,
            miss,
            at: f64::from(times[frame]),
        }
    });
    Ok(EditedClip {
        stances: stances.collect(),
        led: led.collect(),
        root_moved: moved.iter().map(|by| by.length()).fold(0.0, f64::max),
        clip: spliced(clip, ik.armature, &times, &runs, keys)?,
    })
}

/// Where a planted foot goes.
fn foot(ik: &ClipIk<'_>, request: &ClipRequest, limb: &LimbWay, rate: f64) -> Planted {
    let way: Vec<Vector3<f64>> = limb.way.iter().map(|at| at.to_array().into()).collect();
    let detection = ik.detection_of(&way, limb.longest(), rate);
    let ground = ik.ground.as_deref().map(|height| height as Ground<'_>);
    plant(&detection, &way, request.up, ground, rate)
}

/// Where a bone that reaches should be.
fn reached(
    ik: &ClipIk<'_>,
    request: &ClipRequest,
    bone: BoneId,
    limb: &LimbWay,
    times: &[f32],
) -> Goals {
    let moments = times.iter().map(|time| f64::from(*time));
    let goals = moments.zip(&limb.way).map(|(time, free)| {
        let own = ik.reaches.iter().filter(|reach| reach.bone == bone);
        let nearest = own.map(|reach| (reach.target(time), reach.weight(time, request.span)));
        nearest.fold(
            (*free, 0.0),
            |found, goal| if goal.1 > 0.0 { goal } else { found },
        )
    });
    goals.collect()
}

/// Stretches of frames in which anything is asked, with a frame on either side that is as the clip has it.
fn runs(goals: &[Goals]) -> Vec<Range<usize>> {
    let frames = goals.first().map_or(0, Vec::len);
    let asked = |frame: usize| goals.iter().any(|goals| goals[frame].1 > 0.0);
    let mut runs: Vec<Range<usize>> = Vec::new();
    for frame in (0..frames).filter(|&frame| asked(frame)) {
        let (before, after) = (frame.saturating_sub(1), (frame + 2).min(frames));
        match runs.last_mut() {
            Some(run) if run.end >= before => run.end = after,
            _ => runs.push(before..after),
        }
    }
    runs
}

/// How far the root moves in each frame.
fn root_moves(
    request: &ClipRequest,
    (limbs, goals, feet): (&[LimbWay], &[Goals], &[Planted]),
    runs: &[Range<usize>],
    rate: f64,
) -> Result<Vec<DVec3>, ClipIkError> {
    let frames = goals.first().map_or(0, Vec::len);
    let mut moved = vec![DVec3::ZERO; frames];
    if request.root.is_none() {
        return Ok(moved);
    }
    let up = dvec(request.up);
    for run in runs {
        let lift = |frame: usize| {
            let lifts = feet.iter().map(|foot| foot.ground[frame]);
            up * (lifts.sum::<f64>() / feet.len().max(1) as f64)
        };
        let wanted: Vec<DVec3> = run.clone().map(lift).collect();
        let demands = limbs.iter().zip(goals).map(|(limb, goals)| {
            let own = run.clone().map(|frame| {
                let (at, weight) = goals[frame];
                let place = limb.way[frame].lerp(at, weight);
                let in_clip = limb.way[frame].distance(limb.upper[frame]);
                Demand {
                    apart: (place - limb.upper[frame]).to_array().into(),
                    // Who is stretched in the clip may be.
                    length: (NOT_STRETCHED * limb.lengths[frame]).max(in_clip),
                }
            });
            own.collect()
        });
        let as_clip = |frame: usize| goals.iter().all(|goals| goals[frame].1 == 0.0);
        let ends = [as_clip(run.start), as_clip(run.end - 1)];
        let own = root::moves(&wanted, demands.collect(), ends, 1.0 / rate)?;
        moved[run.clone()].copy_from_slice(&own);
    }
    Ok(moved)
}

/// What is wanted of each frame.
struct Frames<'a> {
    times: &'a [f32],
    limbs: &'a [LimbWay],
    goals: &'a [Goals],
    /// How far the root is from where the clip has it, on its way and beside it.
    travelled: &'a [DVec3],
    moved: &'a [DVec3],
    runs: &'a [Range<usize>],
}

impl Frames<'_> {
    /// Where a bone should be: what is not asked for goes with the root.
    fn place(&self, bone: usize, frame: usize) -> DVec3 {
        let (at, weight) = self.goals[bone][frame];
        (self.limbs[bone].way[frame] + self.moved[frame]).lerp(at, weight)
    }

    /// The new keys, and where each bone then is in each frame.
    fn solve(
        &self,
        ik: &ClipIk<'_>,
        request: &ClipRequest,
        clip: &Clip,
        posed: &mut PosedBones,
    ) -> Result<(NewKeys, Vec<Vec<DVec3>>), ClipIkError> {
        let longest = self.limbs.iter().map(LimbWay::longest).fold(0.0, f64::max);
        let planted = ik.planted.len();
        let effectors = request.bones.iter().enumerate();
        let effectors: Vec<(BoneId, bool)> =
            effectors.map(|(k, bone)| (*bone, k < planted)).collect();
        let mut solver = FrameSolver::new(posed, &effectors, longest)?;
        let turning: Vec<BoneId> = posed.turning().collect();
        let mut rotations: Vec<Vec<Quat>> = vec![Vec::new(); turning.len()];
        let mut translations: Vec<Vec3A> = Vec::new();
        let mut at: Vec<Vec<DVec3>> = self.limbs.iter().map(|limb| limb.way.clone()).collect();
        let mut places = vec![DVec3::ZERO; request.bones.len()];
        let mut poses = Poses::new(ik.armature, clip);
        for frame in self.runs.iter().cloned().flatten() {
            let pose = poses.at(self.times[frame])?;
            let moved = self.travelled[frame] + self.moved[frame];
            let is_asked = self.goals.iter().any(|goals| goals[frame].1 > 0.0);
            if is_asked || moved != DVec3::ZERO {
                posed.take(ik.armature, pose)?;
                for (k, place) in places.iter_mut().enumerate() {
                    *place = self.place(k, frame);
                }
                solver.solve((ik.armature, posed), &places, moved, pose)?;
                posed.take(ik.armature, pose)?;
                for (at, &bone) in at.iter_mut().zip(&request.bones) {
                    at[frame] = posed.place(bone);
                }
            }
            for (keys, bone) in rotations.iter_mut().zip(&turning) {
                keys.push(pose.rotations()[bone.index()]);
            }
            translations.extend(request.root.map(|root| pose.translations()[root.index()]));
        }
        let stays = |frame: usize| self.travelled[frame] + self.moved[frame] == DVec3::ZERO;
        let root = request.root.filter(|_| !(0..self.times.len()).all(stays));
        let keys = NewKeys {
            rotations: turning.into_iter().zip(rotations).collect(),
            translations: root.map(|root| (root, translations)).into_iter().collect(),
        };
        Ok((keys, at))
    }
}

fn dvec(at: Vector3<f64>) -> DVec3 {
    DVec3::from(at.to_array())
}
