//! Promise: keyframes are interpolated by Catmull-Rom segments over their own times. The curve passes every key
//! exactly, has no kink, and equals the classic matrix at even times.

use kinopt::animation::{ClipError, EulerClip, EulerKey, EulerTrack, Playback};
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::{Placement, Vector3};

/// Chain of bones, for their ids.
fn chain(bones: usize) -> Skeleton {
    let mut list: Vec<Bone> = Vec::new();
    let mut skeleton = Skeleton::new("chain", Vec::new());
    for index in 0..bones {
        let parent = index
            .checked_sub(1)
            .and_then(|i| skeleton.as_ref().ok()?.bone_at(i));
        list.push(Bone {
            name: format!("bone/{index}"),
            parent,
            length: 1.0,
            model_from_rest: Placement::translation(Vector3::new(index as f64, 0.0, 0.0)),
            limits: [Limits::UNBOUNDED; 3],
        });
        skeleton = Skeleton::new("chain", list.clone());
    }
    skeleton.unwrap()
}

/// Times (s) and angles (rad).
type Keys<'a> = &'a [(f64, [f64; 3])];

fn clip(bones: usize, tracks: &[(usize, Keys)]) -> EulerClip {
    let skeleton = chain(bones);
    let tracks = tracks.iter().map(|(bone, keys)| EulerTrack {
        bone: skeleton.bone_at(*bone).unwrap(),
        keys: keys
            .iter()
            .map(|&(time, angles)| EulerKey { time, angles })
            .collect(),
    });
    EulerClip::new(tracks.collect()).unwrap()
}

fn sample(clip: &EulerClip, bones: usize, time: f64, playback: Playback) -> Vec<f64> {
    // Filled with other values, because angles without keys must be reset.
    let mut q = vec![99.0; 3 * bones];
    clip.sample(time, playback, &mut q).unwrap();
    q
}

const UNEVEN: [(f64, [f64; 3]); 6] = [
    (-0.3, [0.1, -0.7, 2.0]),
    (0.1, [0.4, 0.2, -6.3]),
    (1.7, [-0.9, 0.25, 0.0]),
    (1.75, [-0.8, 1.9, 0.3]),
    (4.0, [3.3, -1.1, 0.3]),
    (9.5, [0.7, 0.01, -2.2]),
];

#[test]
fn every_key_is_met_exactly() {
    let clip = clip(3, &[(1, &UNEVEN)]);
    for playback in [Playback::Hold, Playback::Loop] {
        for (time, angles) in UNEVEN {
            let q = sample(&clip, 3, time, playback);
            assert_eq!(q[3..6], angles, "at {time} s");
            assert_eq!((&q[..3], &q[6..]), (&[0.0; 3][..], &[0.0; 3][..]));
        }
    }
}

#[test]
fn uneven_segment_matches_hand_values() {
    // P = 0, 1, 3, 2 at t = 0, 1, 3, 4; at t = 2 the middle of the segment of length 2:
    // m₁ = (3 − 0)/(3 − 0) = 1, m₂ = (2 − 1)/(4 − 1) = 1/3,
    // P = ½·1 + ½·3 + ⅛·2·(1 − 1/3) = 2 + 1/6.
    let keys = [0.0, 1.0, 3.0, 4.0]
        .into_iter()
        .zip([0.0, 1.0, 3.0, 2.0])
        .map(|(t, v)| (t, [v, 0.0, 0.0]));
    let keys: Vec<_> = keys.collect();
    let clip = clip(1, &[(0, &keys)]);
    let q = sample(&clip, 1, 2.0, Playback::Hold);
    assert!((q[0] - (2.0 + 1.0 / 6.0)).abs() < 1e-15, "{}", q[0]);
    // The first segment: one-sided m₀ = 1, m₁ = 1, so it is a straight line.
    let q = sample(&clip, 1, 0.3, Playback::Hold);
    assert!((q[0] - 0.3).abs() < 1e-15, "{}", q[0]);
    // The last one: m₂ = 1/3, one-sided m₃ = −1, length 1; at u = ½: 2.5 + ⅛ (1/3 + 1).
    let q = sample(&clip, 1, 3.5, Playback::Hold);
    assert!((q[0] - (2.5 + 1.0 / 6.0)).abs() < 1e-15, "{}", q[0]);
}

#[test]
fn line_through_uneven_keys_stays_a_line() {
    let line = |t: f64| [0.5 + 0.75 * t, -2.0 * t, 0.125];
    let keys = UNEVEN.map(|(t, _)| (t, line(t)));
    let clip = clip(1, &[(0, &keys)]);
    for part in 0..=1000 {
        let time = -0.3 + 9.8 * f64::from(part) / 1000.0;
        let time = time.clamp(-0.3, 9.5);
        for (actual, want) in sample(&clip, 1, time, Playback::Hold)
            .iter()
            .zip(line(time))
        {
            assert!(
                (actual - want).abs() < 2e-14,
                "{actual} is not {want} at {time} s"
            );
        }
    }
}

#[test]
fn speed_is_continuous_at_keys() {
    let clip = clip(1, &[(0, &UNEVEN)]);
    let h = 1e-6;
    for (time, at) in &UNEVEN[1..UNEVEN.len() - 1] {
        let before = sample(&clip, 1, time - h, Playback::Hold);
        let after = sample(&clip, 1, time + h, Playback::Hold);
        for k in 0..3 {
            let (arriving, leaving) = ((at[k] - before[k]) / h, (after[k] - at[k]) / h);
            // One-sided differences have an error of h/2 times the second derivative, here below 1e4.
            assert!(
                (arriving - leaving).abs() < 2e-2,
                "speed jumps from {arriving} to {leaving} at {time} s"
            );
        }
    }
}

#[test]
fn values_are_held_outside_the_keys() {
    let clip = clip(1, &[(0, &UNEVEN)]);
    for (time, key) in [(-0.31, 0), (-1e300, 0), (9.6, 5), (1e300, 5)] {
        assert_eq!(sample(&clip, 1, time, Playback::Hold), UNEVEN[key].1);
    }
}

#[test]
fn loop_repeats_with_the_clips_span() {
    // The second track is shorter than the clip and holds its end values within each cycle.
    let short = [(1.0, [1.0, 2.0, 3.0]), (2.0, [2.0, 0.0, 1.0])];
    let clip = clip(2, &[(0, &UNEVEN), (1, &short)]);
    let period = 9.5 + 0.3;
    for time in [-0.2, 0.6, 1.3, 1.72, 3.0, 5.0, 9.0] {
        let once = sample(&clip, 2, time, Playback::Loop);
        assert_eq!(once, sample(&clip, 2, time, Playback::Hold));
        for rounds in [-3.0, -1.0, 1.0, 2.0, 5.0] {
            let again = sample(&clip, 2, time + rounds * period, Playback::Loop);
            for (a, b) in once.iter().zip(&again) {
                assert!(
                    (a - b).abs() < 1e-11,
                    "{a} is not {b} after {rounds} rounds"
                );
            }
        }
    }
}

#[test]
fn one_key_is_constant_and_none_is_rest() {
    let single = clip(1, &[(0, &[(3.0, [0.1, 0.2, 0.3])])]);
    for playback in [Playback::Hold, Playback::Loop] {
        for time in [-5.0, 3.0, 8.0] {
            assert_eq!(sample(&single, 1, time, playback), [0.1, 0.2, 0.3]);
            assert_eq!(sample(&EulerClip::default(), 1, time, playback), [0.0; 3]);
        }
    }
}

#[test]
fn invalid_samples_are_errors() {
    let clip = clip(4, &[(2, &UNEVEN)]);
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = clip.sample(time, Playback::Hold, &mut [0.0; 12]);
        assert!(matches!(error, Err(ClipError::NonFiniteSampleTime { .. })));
    }
    assert_eq!(
        clip.sample(0.0, Playback::Hold, &mut [0.0; 8]),
        Err(ClipError::TooFewAngles { bone: 2, angles: 8 })
    );
    assert_eq!(clip.sample(0.0, Playback::Hold, &mut [0.0; 9]), Ok(()));
}

#[test]
fn tracks_without_keys_are_reported() {
    let clip = clip(3, &[(2, &[]), (0, &[(0.0, [0.1, 0.2, 0.3])]), (1, &[])]);
    let keyless: Vec<usize> = clip.keyless().iter().map(|bone| bone.index()).collect();
    assert_eq!((clip.tracks().len(), keyless), (1, vec![2, 1]));
}
