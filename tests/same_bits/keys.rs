//! Promise: so it is for a rig's own keys that are solved for: under each kind of spline, within limits and beyond them, and for what is
//! refused.
#![allow(clippy::unwrap_used)]

use glam::DVec3;
use kinopt::Scalar;
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::animation::{EulerClip, EulerInterpolation, EulerKey, EulerTrack};
use kinopt::model::Limits;
use kinopt::motion::clip_ik::{ClipIkError, EditedKeys, KeyframeIk, Reach};
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use kinopt::spatial::{Placement, Vector3};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};

/// A trunk that branches into an arm of three bones and a head.
pub(crate) fn skeleton() -> Skeleton {
    let mut builder = Skeleton::builder("torso");
    let limits = |twist: f64, low: f64, high: f64| {
        [
            Limits::new(-twist, twist),
            Limits::new(low, high),
            Limits::new(-0.5, 0.5),
        ]
    };
    let bones = [
        ("trunk", None, [0.0, 0.0, 0.0], limits(0.3, -0.2, 0.2)),
        ("upper", Some(0), [0.5, 0.0, 0.0], limits(1.0, -1.5, 1.5)),
        ("fore", Some(1), [0.9, 0.0, 0.0], limits(0.0, 0.0, 2.0)),
        ("hand", Some(2), [1.2, 0.0, 0.0], limits(0.5, -0.6, 0.6)),
        ("head", Some(0), [0.5, 0.2, 0.0], limits(0.5, -0.5, 0.5)),
    ];
    let mut ids: Vec<BoneId> = Vec::new();
    for (name, parent, at, limits) in bones {
        ids.push(builder.add(Bone {
            name: name.into(),
            parent: parent.map(|parent: usize| ids[parent]),
            length: if name == "hand" { 0.1 } else { 0.3 },
            model_from_rest: Placement::translation(Vector3::from(at)),
            limits,
        }));
    }
    builder.build().unwrap()
}

/// Keys every quarter of a second, but on some bones fewer, waving; `beyond` is added to the bends of the forearm.
pub(crate) fn keys(skeleton: &Skeleton, beyond: impl Fn(usize) -> f64) -> EulerClip {
    let bones = [
        ("trunk", 3, 4),
        ("upper", 5, 2),
        ("fore", 9, 1),
        ("hand", 3, 4),
        ("head", 1, 1),
    ];
    let tracks = bones.map(|(name, count, every)| {
        let bone = skeleton.bone(name).unwrap();
        let keys = (0..count).map(|k| {
            let time = 0.25 * f64::from(k * every);
            let (sin, cos) = Scalar::sin_cos(2.0 * time + f64::from(count));
            let bend = match name {
                "fore" => 0.9 + 0.5 * sin + beyond(k as usize),
                "trunk" => 0.15 * cos,
                _ => 0.4 * sin,
            };
            let angles = [
                if name == "fore" { 0.0 } else { 0.2 * cos },
                bend,
                0.1 * sin,
            ];
            EulerKey { time, angles }
        });
        EulerTrack {
            bone,
            keys: keys.collect(),
        }
    });
    EulerClip::new(tracks.to_vec()).unwrap()
}

pub(crate) fn add(digest: &mut Digest, solved: Result<EditedKeys, ClipIkError>) {
    match solved {
        Ok(solved) => {
            add_text(
                digest,
                &format!("{:?} {:?}", solved.clip.tracks(), solved.clip.keyless()),
            );
            for track in solved.clip.tracks() {
                add_text(
                    digest,
                    &format!("{:?}", solved.clip.interpolation(track.bone)),
                );
            }
            add_text(
                digest,
                &format!(
                    "{:?} {} {:?}",
                    solved.led, solved.keys_changed, solved.beyond
                ),
            );
        }
        Err(error) => add_error(digest, &error),
    }
}

/// Under each interpolation, and each thing that is asked.
fn asked() -> Value {
    let mut digest = Digest::new();
    let skeleton = skeleton();
    let id = |name: &str| skeleton.bone(name).unwrap();
    let clip = keys(&skeleton, |_| 0.0);
    let hand = id("hand");
    let way = KeyedCurve::catmull_rom(
        vec![0.3, 1.0, 1.7],
        vec![
            DVec3::new(0.9, 0.4, 0.1),
            DVec3::new(1.0, 0.1, 0.3),
            DVec3::new(0.8, 0.5, -0.1),
        ],
    );
    let way = Reach::along(hand, way.unwrap()).with_span(0.3..=1.7);
    let controls = TensionContinuityBias {
        tension: 0.3,
        continuity: -0.2,
        bias: 0.4,
    };
    for kind in 0..3 {
        let clip = clip.clone().interpolated(|track| match kind {
            0 => EulerInterpolation::default(),
            1 => EulerInterpolation::kochanek_bartels(track, controls),
            _ if track.bone == id("fore") => EulerInterpolation::default(),
            _ => EulerInterpolation::Linear,
        });
        let ik = KeyframeIk::new(&skeleton).with_moments_per_second(12.0);
        add(
            &mut digest,
            ik.with_reach(way.clone()).solve(&clip.unwrap()),
        );
    }
    let ik = || KeyframeIk::new(&skeleton).with_moments_per_second(10.0);
    let to = |bone: &str, at: [f64; 3]| Reach::to(id(bone), at).unwrap();
    for ik in [
        ik().with_reach(to("hand", [0.9, 0.5, 0.2])),
        ik().with_reach(
            to("hand", [0.9, 0.5, 0.2])
                .with_span(0.4..=1.4)
                .with_fade(0.0),
        ),
        ik().with_reach(
            to("hand", [0.9, 0.5, 0.2])
                .with_span(0.4..=1.4)
                .with_fade(0.5),
        ),
        ik().with_reach(to("hand", [3.0, 0.5, 0.2])),
        ik().with_reach(to("hand", [0.7, 0.1, 0.0]))
            .with_root(id("upper")),
        ik().with_reach(to("hand", [0.9, 0.5, 0.2]))
            .with_root(id("trunk")),
        ik().with_reach(to("hand", [0.9, 0.5, 0.2]).with_span(0.1..=0.8))
            .with_reach(to("hand", [1.0, 0.3, 0.2]).with_span(0.8..=1.9)),
        ik().with_reach(to("hand", [0.9, 0.5, 0.2]))
            .with_reach(to("head", [0.6, 0.4, 0.2]).with_span(0.3..=1.2)),
        ik().with_reach(to("fore", [0.9, 0.5, 0.2]))
            .with_moments_per_second(3.0),
    ] {
        add(&mut digest, ik.solve(&clip));
    }
    digest.value()
}

/// Keys that are beyond their limits, all of them, one, the first, the last, alternately.
fn beyond() -> Value {
    let mut digest = Digest::new();
    let skeleton = skeleton();
    let hand = skeleton.bone("hand").unwrap();
    let all: [&dyn Fn(usize) -> f64; 7] = [
        &|_| 1.0,
        &|k| if k == 4 { 0.9 } else { 0.0 },
        &|k| if k == 0 { 1.2 } else { 0.0 },
        &|k| if k == 8 { -1.5 } else { 0.0 },
        &|k| if k % 2 == 0 { 0.9 } else { -0.9 },
        &|k| if k < 3 { -1.2 } else { 0.4 },
        &|k| if k > 5 { 1.3 } else { 0.0 },
    ];
    for (case, own) in all.into_iter().enumerate() {
        let clip = keys(&skeleton, own);
        for span in [0.6..=1.4, 0.0..=2.0].into_iter().take(1 + (case % 3) / 2) {
            let reach = Reach::to(hand, [0.8, 0.4, 0.2]).unwrap().with_span(span);
            let ik = KeyframeIk::new(&skeleton).with_moments_per_second(8.0);
            add(&mut digest, ik.with_reach(reach).solve(&clip));
        }
    }
    digest.value()
}

fn refusals() -> Value {
    let mut digest = Digest::new();
    let skeleton = skeleton();
    let id = |name: &str| skeleton.bone(name).unwrap();
    let clip = keys(&skeleton, |_| 0.0);
    let reach = || Reach::to(id("hand"), [0.9, 0.4, 0.1]).unwrap();
    let ik = || KeyframeIk::new(&skeleton);
    for ik in [
        ik(),
        ik().with_reach(reach()).with_reach(reach()),
        ik().with_reach(reach().with_span(7.0..=8.0)),
        ik().with_reach(reach().with_span(1.05..=1.15)),
        ik().with_reach(reach()).with_moments_per_second(f64::NAN),
        ik().with_reach(reach()).with_moments_per_second(0.0),
        ik().with_reach(reach()).with_moments_per_second(1e12),
        ik().with_reach(reach()).with_root(id("head")),
        ik().with_reach(reach().with_fade(2.0)),
    ] {
        add(&mut digest, ik.solve(&clip));
    }
    add(
        &mut digest,
        ik().with_reach(reach()).solve(&EulerClip::default()),
    );
    let mut builder = Skeleton::builder("one");
    builder.add(Bone {
        name: "one".into(),
        parent: None,
        length: 1.0,
        model_from_rest: Placement::identity(),
        limits: [Limits::new(-1.0, 1.0); 3],
    });
    let one = builder.build().unwrap();
    add(
        &mut digest,
        KeyframeIk::new(&one).with_reach(reach()).solve(&clip),
    );
    let own = Reach::to(one.bone("one").unwrap(), [0.5, 0.5, 0.5]).unwrap();
    add(
        &mut digest,
        KeyframeIk::new(&one).with_reach(own).solve(&clip),
    );
    digest.value()
}

#[test]
fn of_keys_that_are_solved_for() {
    check(&[
        ("keys of a rig: what is asked", asked()),
        ("keys of a rig: beyond their limits", beyond()),
        ("keys of a rig: what is refused", refusals()),
    ]);
}
