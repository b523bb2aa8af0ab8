//! Promise: a clip of given poses passes through them. A baked clip equals its source at its samples, and motionless
//! channels need no keys.

use kinopt::animation::{Armature, Channel, Clip, ClipError, Cursor, Playback, Pose};
use support::armatures::{armature, difference, pose};
use support::bones::humanoid;
use support::random::Random;

pub(crate) fn at(clip: &Clip, armature: &Armature, time: f32) -> Pose {
    let mut pose = armature.rest().clone();
    let time = f64::from(time);
    clip.sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    pose
}

/// Poses at uneven times that do not begin at zero.
pub(crate) fn poses(
    armature: &Armature,
    count: usize,
    random: &mut Random,
) -> (Vec<f32>, Vec<Pose>) {
    let mut time = -0.7;
    let times = (0..count).map(|_| {
        time += random.within(0.02, 0.3) as f32;
        time
    });
    let times = times.collect();
    (times, (0..count).map(|_| pose(armature, random)).collect())
}

#[test]
fn clip_passes_through_its_poses() {
    let random = &mut Random::new(31);
    for count in [1, 2, 17] {
        let armature = armature(9, random);
        let (times, poses) = poses(&armature, count, random);
        let clip = Clip::through_poses("all", &armature, &times, &poses).unwrap();
        assert_eq!(clip.span(), [times[0], times[count - 1]]);
        for (time, pose) in times.iter().zip(&poses) {
            assert!(difference(&at(&clip, &armature, *time), pose) < 1e-5);
        }
    }
}

#[test]
fn constant_channels_have_one_key_or_none() {
    let random = &mut Random::new(32);
    let armature = armature(5, random);
    let still = pose(&armature, random);
    let mut moving = still.clone();
    let bone = armature.bone("bone 3").unwrap();
    let mut local = still.local(bone).unwrap();
    local.translation.x += 1.0;
    moving.set_local(bone, local).unwrap();
    let clip =
        Clip::through_poses("still", &armature, &[0.0, 1.0], &[still.clone(), moving]).unwrap();
    let keys = |poses: &[Pose]| {
        let clip = Clip::through_poses("same", &armature, &[0.0, 1.0], poses).unwrap();
        clip.channels(&armature).unwrap().len()
    };
    // One moving translation, single keys for everything else: 5 × 3 channels in all.
    assert_eq!(clip.channels(&armature).unwrap().len(), 15);
    assert_eq!(keys(&[still.clone(), still]), 15);
    assert_eq!(keys(&[armature.rest().clone(), armature.rest().clone()]), 0);
}

#[test]
fn baked_clip_equals_the_clip_at_samples() {
    let rig = humanoid();
    let armature = Armature::of_skeleton(&rig.skeleton);
    let mut builder = Clip::builder("keys", &armature);
    builder.euler_clip(&rig.clip).unwrap();
    builder.event(0.25, "step").unwrap();
    let clip = builder.build();
    let baked = clip.baked(&armature, 24.0).unwrap();
    assert_eq!((baked.span(), baked.events()), (clip.span(), clip.events()));
    let [start, end] = clip.span();
    let frames = ((end - start) * 24.0) as usize;
    for frame in 0..=frames {
        let time = start + frame as f32 / 24.0;
        let apart = difference(&at(&clip, &armature, time), &at(&baked, &armature, time));
        assert!(apart < 1e-5, "{apart} at {time} s");
    }
    let apart = difference(&at(&clip, &armature, end), &at(&baked, &armature, end));
    assert!(apart < 1e-5, "{apart} at the end");
}

/// A clip that does not return to its start ends at its end.
#[test]
fn last_sample_is_the_end_of_the_clip() {
    let random = &mut Random::new(34);
    let armature = armature(4, random);
    let (times, poses) = poses(&armature, 5, random);
    let clip = Clip::through_poses("way", &armature, &times, &poses).unwrap();
    assert!(difference(&poses[0], &poses[4]) > 0.1);
    for rate in [3.0, 30.0] {
        let baked = clip.baked(&armature, rate).unwrap();
        assert_eq!(baked.span(), clip.span());
        let [first, last] = clip.span().map(|time| at(&baked, &armature, time));
        assert!(difference(&first, &poses[0]) < 1e-5);
        assert!(difference(&last, &poses[4]) < 1e-5);
    }
}

#[test]
fn invalid_poses_and_rates_are_named() {
    let random = &mut Random::new(33);
    let armature = armature(4, random);
    let other = support::armatures::armature(5, random);
    let rest = armature.rest();
    let through =
        |times: &[f32], poses: &[Pose]| Clip::through_poses("no", &armature, times, poses);
    assert!(matches!(through(&[], &[]), Err(ClipError::Keys(_))));
    assert!(matches!(
        through(&[0.0, 0.0], &[rest.clone(), rest.clone()]),
        Err(ClipError::Keys(_))
    ));
    assert!(matches!(
        through(&[0.0, f32::NAN], &[rest.clone(), rest.clone()]),
        Err(ClipError::Keys(_))
    ));
    assert!(matches!(
        through(&[0.0, 1.0], std::slice::from_ref(rest)),
        Err(ClipError::Keys(_))
    ));
    assert!(matches!(
        through(&[0.0], std::slice::from_ref(other.rest())),
        Err(ClipError::Size(_))
    ));
    let clip = through(&[0.0, 1.0], &[rest.clone(), rest.clone()]).unwrap();
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
        assert!(
            matches!(clip.baked(&armature, rate), Err(ClipError::BadRate { .. })),
            "{rate}"
        );
    }
    assert!(matches!(clip.baked(&other, 10.0), Err(ClipError::Size(_))));
}

/// If a clip's duration is a whole number of steps up to rounding, its end is not sampled twice.
#[test]
fn rounding_adds_no_extra_sample() {
    let random = &mut Random::new(35);
    let armature = armature(2, random);
    let poses = [(); 2].map(|()| pose(&armature, random));
    for (begin, steps, rate) in [
        (1.3, 3, 10.0),
        (1.3, 11, 10.0),
        (0.1, 6, 10.0),
        (0.7, 40, 30.0),
    ] {
        for later in [0, 1] {
            let end = (f64::from(begin) + f64::from(steps) / rate) as f32;
            let times = [begin, f32::from_bits(end.to_bits() + later)];
            let clip = Clip::through_poses("way", &armature, &times, &poses).unwrap();
            let baked = clip.baked(&armature, rate).unwrap();
            for (_, channel) in baked.channels(&armature).unwrap() {
                let Channel::Translation(curve) = channel else {
                    continue;
                };
                assert_eq!(curve.times().len(), steps as usize + 1, "{times:?}");
            }
        }
    }
}
