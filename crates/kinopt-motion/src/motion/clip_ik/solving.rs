//! Steps of a solve: targets of the bones, displacement of the root, then each sample time.

use std::ops::Range;

use glam::DVec3;

use super::ClipIkError;
use super::clip_solver::{ClipIk, ClipRequest};
use super::edited::{EditReport, EditedClip, FootPlant, ReachResult};
use super::foot_drift::FootDrift;
use super::plan::{EffectorTarget, Plan, SampleTime, dvec, travelled};
use super::posed_bones::PosedBones;
use super::root::{self, RootDemand};
use super::sampling::{LimbMotion, limb_motions, sample_times};
use super::solved_samples::SolvedSamples;
use super::splice::spliced;
use crate::motion::contact::{Ground, PlantedFoot, plant};
use kinopt_animation::animation::Clip;
use kinopt_kinematics::spatial::Vector3;

/// Usable fraction of a limb's length, so that limbs are not stretched straight.
const MAX_STRETCH_RATIO: f64 = 0.998;
/// Largest number of passes that add keys where a foot in contact drifts.
const MAX_REFINEMENTS: usize = 3;

impl ClipIk<'_> {
    /// Solves a clip.
    ///
    /// # Errors
    /// Returns an error for:
    /// - no reach and no planted bone,
    /// - a bone of another armature, a bone with two tasks at one time, or a bone that is not below the root,
    /// - a span that does not overlap the clip or is shorter than its two fades,
    /// - options out of range.
    ///
    /// A target that is not reached is not an error: [`EditReport::led`] has the distance.
    pub fn solve(&self, clip: &Clip) -> Result<EditedClip, ClipIkError> {
        let request = self.check(clip)?;
        solve(self, &request, clip)
    }
}

fn solve(ik: &ClipIk<'_>, request: &ClipRequest, clip: &Clip) -> Result<EditedClip, ClipIkError> {
    let spans = ik.reaches.iter().flat_map(|reach| reach.span(request.span));
    let (times, rate) = sample_times(clip, ik.rate, spans)?;
    let mut posed = PosedBones::new(ik.armature, request.root, &request.bones, |bone| {
        ik.hinges(bone)
    })?;
    let mut limbs = limb_motions(ik.armature, clip, &times, &request.bones, &mut posed)?;
    let travel: Vec<DVec3> = times.iter().map(|time| travelled(request, *time)).collect();
    for limb in &mut limbs {
        limb.move_by(&travel);
    }
    let feet: Vec<PlantedFoot> = limbs[..ik.planted.len()]
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
    let goals = |(bone, limb): (usize, &LimbMotion)| -> Vec<EffectorTarget> {
        let frames = limb.positions.iter().enumerate();
        let goals = frames.map(|(frame, free)| plan.goal(bone, SampleTime::at_frame(frame), *free));
        goals.collect()
    };
    let goals: Vec<Vec<EffectorTarget>> = limbs.iter().enumerate().map(goals).collect();
    let runs = match request.root_velocity == DVec3::ZERO {
        true => runs(&goals),
        false => std::iter::once(0..times.len()).collect(),
    };
    plan.moved = root_displacement(request, (&limbs, &goals, &feet), &runs, rate)?;
    let mut solved = SolvedSamples::empty(&plan, clip, &posed)?;
    solved.add(
        runs.iter().cloned().flatten().map(SampleTime::at_frame),
        &mut posed,
    )?;
    let mut refinements = 0;
    let (edited, samples, drifts) = loop {
        let edited = spliced(clip, ik.armature, &times, &runs, solved.keys())?;
        let samples = solved.sample_times();
        let drifts = FootDrift::measure(&plan, &samples, &edited, &mut posed)?;
        let additional = drifts.additional_samples(&plan, &solved);
        if refinements == MAX_REFINEMENTS || additional.is_empty() {
            break (edited, samples, drifts);
        }
        solved.add(additional, &mut posed)?;
        refinements += 1;
    };
    let stances = feet.iter().enumerate().flat_map(|(k, foot)| {
        let (times, samples, drifts) = (&times, &samples, &drifts);
        let errors: Vec<f64> = solved.errors(k).collect();
        foot.stances.iter().map(move |(span, position)| {
            let (first, last) = (span.start, span.end - 1);
            let index_of = |frame: usize| {
                samples.partition_point(|sample| *sample < SampleTime::at_frame(frame))
            };
            let (from, to) = (index_of(first), index_of(last));
            FootPlant {
                bone: request.bones[k],
                span: [first, last].map(|frame| f64::from(times[frame])),
                place: dvec(*position),
                slide: errors[from..=to].iter().copied().fold(0.0, f64::max),
                stray: drifts.largest(k, from, to),
            }
        })
    });
    let results = request.bones.iter().enumerate().map(|(k, bone)| {
        let errors = solved.errors(k).zip(&samples);
        let worst = errors.max_by(|one, other| one.0.total_cmp(&other.0));
        let (miss, time) = worst.map_or((0.0, times[0]), |(miss, time)| (miss, plan.time(*time)));
        ReachResult {
            bone: *bone,
            miss,
            at: f64::from(time),
        }
    });
    let report = EditReport {
        stances: stances.collect(),
        led: results.collect(),
        root_moved: plan
            .moved
            .iter()
            .map(|displacement| displacement.length())
            .fold(0.0, f64::max),
        ..EditReport::default()
    };
    Ok(EditedClip {
        clip: edited,
        report,
    })
}

/// Computes the planted motion of a foot.
fn foot(ik: &ClipIk<'_>, request: &ClipRequest, limb: &LimbMotion, rate: f64) -> PlantedFoot {
    let positions: Vec<Vector3<f64>> = limb
        .positions
        .iter()
        .map(|position| position.to_array().into())
        .collect();
    let detection = ik.detection_of(&positions, limb.max_length(), rate);
    let ground = ik.ground.as_deref().map(|height| height as Ground<'_>);
    plant(&detection, &positions, request.up, ground, rate)
}

/// Returns ranges of frames with any target, each extended by one unchanged frame at both ends.
fn runs(goals: &[Vec<EffectorTarget>]) -> Vec<Range<usize>> {
    let frames = goals.first().map_or(0, Vec::len);
    let has_target = |frame: usize| goals.iter().any(|goals| goals[frame].1 > 0.0);
    let mut runs: Vec<Range<usize>> = Vec::new();
    for frame in (0..frames).filter(|&frame| has_target(frame)) {
        let (before, after) = (frame.saturating_sub(1), (frame + 2).min(frames));
        match runs.last_mut() {
            Some(run) if run.end >= before => run.end = after,
            _ => runs.push(before..after),
        }
    }
    runs
}

/// Computes the displacement of the root by frame.
fn root_displacement(
    request: &ClipRequest,
    (limbs, goals, feet): (&[LimbMotion], &[Vec<EffectorTarget>], &[PlantedFoot]),
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
        let preferred: Vec<DVec3> = run.clone().map(lift).collect();
        let demands = limbs.iter().zip(goals).map(|(limb, goals)| {
            let demand = run.clone().map(|frame| {
                let (target, weight) = goals[frame];
                let position = limb.positions[frame].lerp(target, weight);
                let in_clip = limb.positions[frame].distance(limb.upper[frame]);
                RootDemand {
                    offset: (position - limb.upper[frame]).to_array().into(),
                    // A limb that is stretched in the clip may stay stretched.
                    length: (MAX_STRETCH_RATIO * limb.lengths[frame]).max(in_clip),
                }
            });
            demand.collect()
        });
        let is_unchanged = |frame: usize| goals.iter().all(|goals| goals[frame].1 == 0.0);
        let ends = [is_unchanged(run.start), is_unchanged(run.end - 1)];
        let displacement =
            root::root_displacements(&preferred, demands.collect(), ends, 1.0 / rate)?;
        moved[run.clone()].copy_from_slice(&displacement);
    }
    Ok(moved)
}
