//! Promise: an angle without limits, or with a single limit, is solved as one with a distant limit.

use kinopt::animation::{EulerClip, EulerKey, EulerTrack};
use kinopt::model::Limits;
use kinopt::motion::clip_ik::{KeyframeIk, Reach};
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::{Placement, Vector3};

fn arm(limits: Limits) -> Skeleton {
    let mut builder = Skeleton::builder("arm");
    let mut parent = None;
    for (k, name) in ["upper", "lower", "hand"].into_iter().enumerate() {
        parent = Some(builder.add(Bone {
            name: name.into(),
            parent,
            length: 0.4,
            model_from_rest: Placement::translation(Vector3::new(0.4 * k as f64, 0.0, 0.0)),
            limits: [limits; 3],
        }));
    }
    builder.build().unwrap()
}

#[test]
fn missing_limit_equals_a_distant_one() {
    let solved = |limits: Limits| {
        let skeleton = arm(limits);
        let tracks = skeleton.bone_ids().map(|bone| EulerTrack {
            bone,
            keys: (0..6)
                .map(|k| EulerKey {
                    time: 0.2 * f64::from(k),
                    angles: [0.0, 0.1 + 0.02 * f64::from(k), 0.0],
                })
                .collect(),
        });
        let clip = EulerClip::new(tracks.collect()).unwrap();
        let hand = skeleton.bone("hand").unwrap();
        let reach = Reach::to(hand, [0.6, 0.7, 0.2]).unwrap();
        let reach = reach.with_span(0.2..=0.8);
        let edited = KeyframeIk::new(&skeleton).with_reach(reach);
        let edited = edited.solve(&clip).unwrap();
        assert!(edited.report.beyond.is_empty() && edited.report.led[0].miss < 0.05);
        edited.clip
    };
    let wide = solved(Limits::new(-1e3, 1e3));
    for limits in [
        Limits::UNBOUNDED,
        Limits::new(-1e3, f64::INFINITY),
        Limits::new(f64::NEG_INFINITY, 1e3),
    ] {
        let unlimited = solved(limits);
        for (unlimited, wide_track) in unlimited.tracks().iter().zip(wide.tracks()) {
            for (unlimited, wide_key) in unlimited.keys.iter().zip(&wide_track.keys) {
                for (unlimited, wide_angle) in unlimited.angles.iter().zip(wide_key.angles) {
                    assert!(
                        (unlimited - wide_angle).abs() < 1e-3,
                        "{limits:?}: {unlimited} {wide_angle}"
                    );
                }
            }
        }
    }
}
