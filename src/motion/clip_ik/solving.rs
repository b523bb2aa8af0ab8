//! Steps of a solve: targets of the bones, displacement of the root, then each sample time.

use std::ops::Range;

use glam::DVec3;

use super::ClipIkError;
use super::clip_solver::{ClipIk, ClipRequest};
use super::edited::{EditedClip, FootPlant, ReachResult};
use super::foot_drift::Strays;
use super::plan::{Goal, Moment, Plan, dvec, travelled};
use super::planting::{Ground, Planted, plant};
use super::posed_bones::PosedBones;
use super::root::{self, RootDemand};
use super::sampling::{LimbWay, limb_ways, sample_times};
use super::solved_moments::SolvedMoments;
use super::splice::spliced;
use crate::animation::Clip;
use crate::spatial::Vector3;

/// Usable fraction of a limb's length, so that limbs are not stretched straight.
const NOT_STRETCHED: f64 = 0.998;
/// Largest number of passes that add keys where a foot in contact drifts.
const MOST_REFINEMENTS: usize = 3;

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
    let on_its_way: Vec<DVec3> = times.iter().map(|time| travelled(request, *time)).collect();
    for limb in &mut limbs {
        limb.move_by(&on_its_way);
    }
    let feet: Vec<Planted> = limbs[..ik.planted.len()]
        .iter()
        .map(|limb| foot(ik, request, limb, rate))
        .collect();
    let mut plan = Plan {
        ik,
        request,
        times: &times,
        limbs: &limbs,
        feet: &feet,
        moved: Vec::new(),
    };
    let goals = |(bone, limb): (usize, &LimbWay)| -> Vec<Goal> {
        let frames = limb.way.iter().enumerate();
        let goals = frames.map(|(frame, free)| plan.goal(bone, Moment::at(frame), *free));
        goals.collect()
    };
    let goals: Vec<Vec<Goal>> = limbs.iter().enumerate().map(goals).collect();
    let runs = match request.root_velocity == DVec3::ZERO {
        true => runs(&goals),
        false => std::iter::once(0..times.len()).collect(),
    };
    plan.moved = root_moves(request, (&limbs, &goals, &feet), &runs, rate)?;
    let mut solved = SolvedMoments::none(&plan, clip, &posed)?;
    solved.add(runs.iter().cloned().flatten().map(Moment::at), &mut posed)?;
    let mut refinements = 0;
    let (edited, moments, strays) = loop {
        let edited = spliced(clip, ik.armature, &times, &runs, solved.keys())?;
        let moments = solved.moments();
        let strays = Strays::measured(&plan, &moments, &edited, &mut posed)?;
        let more = strays.more_moments(&plan, &solved);
        if refinements == MOST_REFINEMENTS || more.is_empty() {
            break (edited, moments, strays);
        }
        solved.add(more, &mut posed)?;
        refinements += 1;
    };
    let stances = feet.iter().enumerate().flat_map(|(k, foot)| {
        let (times, moments, strays) = (&times, &moments, &strays);
        let misses: Vec<f64> = solved.misses(k).collect();
        foot.stances.iter().map(move |(span, place)| {
            let (first, last) = (span.start, span.end - 1);
            let of = |frame: usize| moments.partition_point(|moment| *moment < Moment::at(frame));
            let (from, to) = (of(first), of(last));
            FootPlant {
                bone: request.bones[k],
                span: [first, last].map(|frame| f64::from(times[frame])),
                place: dvec(*place),
                slide: misses[from..=to].iter().copied().fold(0.0, f64::max),
                stray: strays.most(k, from, to),
            }
        })
    });
    let led = request.bones.iter().enumerate().map(|(k, bone)| {
        let misses = solved.misses(k).zip(&moments);
        let worst = misses.max_by(|one, other| one.0.total_cmp(&other.0));
        let (miss, at) = worst.map_or((0.0, times[0]), |(miss, at)| (miss, plan.time(*at)));
        ReachResult {
            bone: *bone,
            miss,
            at: f64::from(at),
        }
    });
    Ok(EditedClip {
        stances: stances.collect(),
        led: led.collect(),
        root_moved: plan.moved.iter().map(|by| by.length()).fold(0.0, f64::max),
        clip: edited,
    })
}

/// Computes the planted motion of a foot.
fn foot(ik: &ClipIk<'_>, request: &ClipRequest, limb: &LimbWay, rate: f64) -> Planted {
    let way: Vec<Vector3<f64>> = limb.way.iter().map(|at| at.to_array().into()).collect();
    let detection = ik.detection_of(&way, limb.longest(), rate);
    let ground = ik.ground.as_deref().map(|height| height as Ground<'_>);
    plant(&detection, &way, request.up, ground, rate)
}

/// Returns ranges of frames with any target, each extended by one unchanged frame at both ends.
fn runs(goals: &[Vec<Goal>]) -> Vec<Range<usize>> {
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

/// Computes the displacement of the root by frame.
fn root_moves(
    request: &ClipRequest,
    (limbs, goals, feet): (&[LimbWay], &[Vec<Goal>], &[Planted]),
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
                RootDemand {
                    apart: (place - limb.upper[frame]).to_array().into(),
                    // A limb that is stretched in the clip may stay stretched.
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
