//! Promise: a planted foot clears the edge of a step as high as necessary, measured from the lower of its two contacts.
//! It does not climb anything higher than a step.

use glam::{DVec3, Vec3};
use kinopt::animation::{Armature, Clip};

use crate::clip_ik::{HIPS, at, bend, figure, planted, pose, walk};

/// A pole is not a step: the foot moves as without it, up to one and a half times the height of the step.
#[test]
fn obstacle_higher_than_a_step_is_not_climbed() {
    let armature = figure();
    let walk = walk(&armature, true);
    let level = planted(&armature).solve(&walk).unwrap();
    for rise in [0.0, 0.1] {
        // Three metres high, in front of a step.
        let ground = move |at: DVec3| match (0.1..0.3).contains(&at.z) {
            true => 3.0,
            false => rise * f64::from(at.z > 0.3),
        };
        let edited = planted(&armature)
            .with_ground(move |at| ground(at.into()))
            .solve(&walk)
            .unwrap();
        let passes = |foot: &str, time| {
            let at = at(&armature, &level.clip, foot, time);
            (0.1..0.3).contains(&at.z)
        };
        let mut passed = 0;
        for step in 0..=400 {
            let time = f64::from(step) / 200.0;
            for foot in ["foot.l", "foot.r"] {
                passed += usize::from(passes(foot, time));
                let [after, before] = [&edited.clip, &level.clip]
                    .map(|clip| f64::from(at(&armature, clip, foot, time).y));
                let lift = after - before;
                assert!(
                    (-5e-3..2.5 * rise + 5e-3).contains(&lift),
                    "{foot} at {time} s: {lift} m"
                );
            }
        }
        assert!(passed > 5, "{passed}");
    }
}

/// The left foot moves forward by a pace, from flat on the ground to on its toes.
fn pace(armature: &Armature, raised: [f32; 2]) -> Clip {
    let id = |name: &str| armature.bone(name).unwrap();
    let limb = ["thigh.l", "shin.l", "foot.l"].map(id);
    let times: Vec<f32> = (0..=90).map(|k| k as f32 / 60.0).collect();
    let poses = times.iter().map(|&time| {
        let mut pose = armature.rest().clone();
        let share = ((time - 0.5) / 0.5).clamp(0.0, 1.0);
        let eased = share * share * (3.0 - 2.0 * share);
        let height = raised[0] + (raised[1] - raised[0]) * eased;
        bend(
            &mut pose,
            limb,
            Vec3::new(0.0, height - HIPS + 0.1, 0.5 * eased - 0.25),
        );
        pose
    });
    let poses: Vec<_> = poses.collect();
    Clip::through_poses("pace", armature, &times, &poses).unwrap()
}

/// Over the edge the foot has the clearance of its lower contact, no less and no more.
#[test]
fn edge_is_cleared_from_the_lower_contact() {
    let armature = figure();
    let foot = armature.bone("foot.l").unwrap();
    for raised in [[0.0, 0.04], [0.04, 0.0]] {
        let ground = |at: DVec3| 0.2 * f64::from(at.z > -0.12);
        let edited = kinopt::motion::clip_ik::ClipIk::new(&armature)
            .with_planted(foot)
            .with_ground(move |at| ground(at.into()))
            .solve(&pace(&armature, raised))
            .unwrap();
        assert_eq!(edited.report.stances.len(), 2);
        // Height of the sole over the ground where it is flat.
        let lowest = 0.1;
        let places =
            (0..=90).map(|k| at(&armature, &edited.clip, "foot.l", f64::from(k) / 60.0).as_dvec3());
        // Only near the edge: the motion starts and ends on the ground.
        let over = places
            .filter(|at| (-0.12..0.05).contains(&at.z))
            .map(|at| at.y - ground(at) - lowest);
        let smallest = over.fold(f64::INFINITY, f64::min);
        assert!(
            smallest.abs() < 2e-3,
            "{raised:?}: {smallest} m over the edge"
        );
    }
}

/// Neither the start nor the end of a contact is closer to the clip than the other.
#[test]
fn reversed_clip_gives_the_reversed_result() {
    let armature = figure();
    let walk = walk(&armature, true);
    let moments: Vec<f64> = (0..=60).map(|k| f64::from(k) / 30.0).collect();
    let times: Vec<f32> = moments.iter().map(|time| *time as f32).collect();
    let poses = moments.iter().rev();
    let poses: Vec<_> = poses.map(|time| pose(&armature, &walk, *time)).collect();
    let back = Clip::through_poses("back", &armature, &times, &poses).unwrap();
    for height in [0.0, 0.12] {
        let solve = |clip: &Clip| {
            let stairs = move |at: DVec3| height * (at.z / 0.4).floor().max(0.0);
            planted(&armature)
                .with_ground(move |at| stairs(at.into()))
                .with_keys_per_second(30.0)
                .solve(clip)
                .unwrap()
        };
        let [forward, backward] = [&walk, &back].map(solve);
        assert_eq!(forward.report.stances.len(), backward.report.stances.len());
        for time in &moments {
            for foot in ["foot.l", "foot.r"] {
                let one = at(&armature, &forward.clip, foot, *time);
                let other = at(&armature, &backward.clip, foot, 2.0 - time);
                let deviation = one.distance(other);
                assert!(
                    deviation < 2e-4,
                    "{foot} at {time} s, {height} m: {deviation} m"
                );
            }
        }
    }
}

/// A foot blends out of its contact and into the next over the configured time, and moves as in the clip in between.
#[test]
fn blend_of_a_contact_has_the_configured_duration() {
    use kinopt::motion::ContactDetection;
    let armature = figure();
    let walk = walk(&armature, true);
    let detection = ContactDetection::default().with_speed(0.4).with_height(0.1);
    let moved = |lead: f64| -> [f32; 2] {
        let planted = planted(&armature).with_detection(detection.with_lead(lead));
        let edited = planted.with_keys_per_second(120.0).solve(&walk).unwrap();
        let mut largest = [0.0_f32; 2];
        for foot in ["foot.l", "foot.r"] {
            let bone = armature.bone(foot).unwrap();
            let spans = edited
                .report
                .stances
                .iter()
                .filter(|stance| stance.bone == bone);
            let spans: Vec<_> = spans.map(|stance| stance.span).collect();
            for pair in spans.windows(2) {
                let [end, next] = [pair[0][1], pair[1][0]];
                // Just after a contact, and in the middle of the swing phase.
                for (k, time) in [end + 0.015, 0.5 * (end + next)].into_iter().enumerate() {
                    let [old, new] =
                        [&walk, &edited.clip].map(|clip| at(&armature, clip, foot, time));
                    largest[k] = largest[k].max(old.distance(new));
                }
            }
        }
        largest
    };
    let [short, long] = [0.05, 0.4].map(moved);
    assert!(short[0] > 2e-3 && long[0] > 2e-3, "{short:?} {long:?}");
    assert!(short[1] < 2e-4 && long[1] > 5e-4, "{short:?} {long:?}");
}
