//! Promise: so it is for captures: what BVH files hold, how motion is written as one, and what is refused.
#![allow(clippy::unwrap_used)]

use glam::{Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, Clip, LocalTransform, Pose};
use kinopt::io::bvh::{self, BvhChannel, MotionCapture};
use support::random::Random;

use crate::animated::{bone, changed, check_single, rotation, turn, vector};
use crate::digest::{Digest, Value};

/// Two roots, End Sites, channels in every order, whole turns, and frames.
pub(crate) const FILE: &str = "HIERARCHY
ROOT Hips {
  OFFSET 1 90.5 -2
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Left  Leg {
    OFFSET 8 -4 0.25
    CHANNELS 3 Yrotation Xrotation Yrotation
    End Site { OFFSET 0 -40 1 }
    End Site { OFFSET 0 -41 1 }
  }
  joint Spine { offset 0 10 0 channels 2 Zposition xrotation
    JOINT Head { OFFSET 0 50 0 CHANNELS 0 End Site { OFFSET 0 20 0 } } }
}
ROOT Prop { OFFSET 0 0 0 CHANNELS 1 Xrotation End Site { OFFSET 0 0 5 } }
MOTION
Frames: 3
Frame Time:0.25
0 90 0 10 20 30 1 2 3 0.5 -45 90
1 91 2 170 -80 300 10 -20 30 0.75 45 370
2 92 4 -170 95 -300 1e1 0 0 1 0 -10
";

pub(crate) fn add(digest: &mut Digest, capture: &MotionCapture) {
    digest.debug((capture.armature.names(), capture.frames, capture.frame_time));
    digest.debug((&capture.channels, &capture.notes));
    capture
        .notes
        .iter()
        .for_each(|note| digest.text(note.to_string()));
    digest.debug(capture.turning_bones());
    let bones = capture.armature.bone_ids();
    digest.debug(
        bones
            .map(|b| capture.armature.parent(b))
            .collect::<Vec<_>>(),
    );
    digest.pose(capture.armature.rest());
    digest.clip(&capture.armature, &capture.clip);
}

fn read() -> Value {
    let mut digest = Digest::new();
    let capture = |text: &str| bvh::from_bytes(text.as_bytes(), "folder/steps.take.bvh");
    changed(
        &mut digest,
        FILE,
        &[
            ("HIERARCHY", "\u{feff}hierarchy"),
            ("HIERARCHY", "HIERRCHY"),
            ("ROOT Hips", "JOINT Hips"),
            ("ROOT Hips {", "ROOT {"),
            ("ROOT Hips {", "ROOT Hips ["),
            ("OFFSET 1 90.5 -2\n", ""),
            ("OFFSET 1 90.5 -2", "OFFSET 1 nan -2"),
            ("OFFSET 1 90.5 -2", "OFFSET 1 90.5 1e31"),
            ("OFFSET 1 90.5 -2", "OFFSET 1 90.5"),
            ("OFFSET 1 90.5 -2", "OFFSET 1 90.5 -2 OFFSET 0 0 0"),
            ("CHANNELS 6", "CHANNELS 7"),
            ("CHANNELS 6", "CHANNELS -1"),
            ("CHANNELS 6 Xposition", "CHANNELS 6 Yposition"),
            ("CHANNELS 6 Xposition", "CHANNELS 6 Xrotation"),
            ("CHANNELS 6 Xposition", "CHANNELS 6 Wposition"),
            (
                "Yrotation Xrotation Yrotation",
                "Yrotation Yrotation Xrotation",
            ),
            ("  JOINT Left  Leg", "  JOINT Hips"),
            ("JOINT Left  Leg", "JOINT Prop"),
            (
                "End Site { OFFSET 0 -41 1 }",
                "End Site { OFFSET 0 -41 1 CHANNELS 0 }",
            ),
            ("End Site { OFFSET 0 -41 1 }", "End Site { }"),
            ("End Site { OFFSET 0 -41 1 }", "End { OFFSET 0 -41 1 }"),
            (
                "End Site { OFFSET 0 -41 1 }",
                "JOINT Toe { OFFSET 0 1 2 } OFFSET 1 2 3",
            ),
            (
                "End Site { OFFSET 0 -41 1 }",
                "JOINT Toe { OFFSET 0 1 2 } CHANNELS 0",
            ),
            ("End Site { OFFSET 0 -41 1 }", "ROOT Toe { OFFSET 0 1 2 }"),
            (
                "CHANNELS 1 Xrotation End Site { OFFSET 0 0 5 }",
                "End Site { OFFSET 0 0 5 } CHANNELS 1 Xrotation",
            ),
            ("ROOT Prop", "JOINT Prop"),
            ("ROOT Prop", "}"),
            (
                "MOTION",
                "MOTIONLESS_AND_A_VERY_LONG_WORD_THAT_IS_CUT_SOMEWHERE",
            ),
            ("Frames: 3", "Frames: three"),
            ("Frames: 3", "Frame: 3"),
            ("Frames: 3", "Frames 2"),
            ("Frames: 3", "Frames: 1"),
            ("Frames: 3", "Frames: 0"),
            ("Frames: 3", "Frames: 4"),
            ("Frames: 3", "Frames: 400000"),
            ("Frame Time:0.25", "Frame Time: 0"),
            ("Frame Time:0.25", "frame  time 1e-60"),
            ("Frame Time:0.25", "Frame Rate: 4"),
            ("Frame Time:0.25", "Frame Time: 1e-9"),
            ("1e1 0 0", "1e1 0 x"),
            ("2 92 4", "2 92 1e31"),
            ("2 92 4", "2 92 inf"),
            ("1 0 -10\n", "1 0\n"),
            ("1 0 -10\n", "1 0 -10 5\n"),
            ("1 0 -10\n", "1 0 -10\n\r1 2 3 4 5 6 7 8 9 10 11 12"),
            ("1 0 -10\n", "1 0 -10\r\rend"),
        ],
        capture,
        add,
    );
    digest.refused(bvh::from_bytes(b"HIERARCHY\nROOT \xff", "x.bvh"));
    digest.refused(bvh::from_bytes(b"", "x.bvh"));
    let still = "HIERARCHY ROOT a { OFFSET 0 1 0 JOINT b { OFFSET 1 0 0 } } MOTION Frames: 7 Frame Time: 0.5";
    add(&mut digest, &capture(still).unwrap());
    digest.refused(capture(&format!("{still} 1")));
    for channel in BvhChannel::ALL {
        digest.debug((channel.name(), channel.axis(), channel.is_rotation()));
    }
    add(
        &mut digest,
        &bvh::read("../models/captures/steps.bvh").unwrap(),
    );
    digest.value()
}

/// Bones that are turned at rest, one that moves, and one at a tip.
fn body(random: &mut Random) -> Armature {
    let of = |name: &str, parent, rotation: Quat, translation: Vec3A| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation,
            rotation,
            scale: Vec3A::ONE,
        },
    };
    let mut at = || vector(random, 2.0);
    let (a, b, c) = (at(), at(), at());
    let bones = vec![
        of("hips", None, turn(random, 0.5), a),
        of("long leg", Some(0), rotation(random), b),
        of("hips/tip", Some(0), Quat::IDENTITY, c),
        of("long leg/tip", Some(1), rotation(random), -a),
        of("hips/tip/2", Some(0), Quat::IDENTITY, -b),
        of("prop", None, Quat::IDENTITY, Vec3A::ZERO),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

fn poses(body: &Armature, random: &mut Random, moves: bool) -> Vec<Pose> {
    let mut pose = body.rest().clone();
    let each = (0..5).map(|frame| {
        for index in [0, 1, 5] {
            let by = match frame {
                // Quarter turns, where two of the angles are one.
                3 => Quat::from_xyzw(1.0, 0.0, 0.0, 1.0).normalize(),
                _ => turn(random, 1.5),
            };
            let now = pose.rotations()[index] * by;
            pose.set_rotation(bone(body, index), now).unwrap();
        }
        if frame > 2 {
            // The middle of its three angles a quarter turn, or one back.
            let [about_z, about_y] = [0.3, 0.7].map(|size| 0.1 * frame as f32 + size);
            let way = if frame == 3 { 1.0 } else { -1.0 };
            let quarter = Quat::from_xyzw(way, 0.0, 0.0, 1.0).normalize();
            let first = Quat::from_xyzw(0.0, 0.0, about_z, 1.0).normalize();
            let last = Quat::from_xyzw(0.0, about_y, 0.0, 1.0).normalize();
            let locked = first * quarter * last;
            pose.set_rotation(bone(body, 5), locked).unwrap();
        }
        pose.set_translation(bone(body, 0), vector(random, 3.0))
            .unwrap();
        if moves {
            pose.set_translation(bone(body, 1), vector(random, 1.0))
                .unwrap();
            pose.set_rotation(bone(body, 3), rotation(random)).unwrap();
        }
        pose.clone()
    });
    each.collect()
}

fn written() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(171));
    let body = body(&mut random);
    let mut all = Vec::new();
    for moves in [false, true] {
        all = poses(&body, &mut random, moves);
        let text = bvh::poses_to_text(&body, &all, 24.0).unwrap();
        digest.bytes(&text);
        add(
            &mut digest,
            &bvh::from_bytes(text.as_bytes(), "again.bvh").unwrap(),
        );
        let times = [0.5, 0.75, 1.0, 2.0, 2.125];
        let clip = Clip::through_poses("c", &body, &times, &all).unwrap();
        for rate in [4.0, 8.0, 30.0, 0.25] {
            digest.bytes(bvh::to_text(&body, &clip, rate).unwrap());
        }
        for rate in [0.0, f64::NAN, 1e40, -3.0, 1e-50, 2e7] {
            digest.refused(bvh::to_text(&body, &clip, rate));
        }
    }
    digest.bytes(bvh::poses_to_text(&body, &[], 10.0).unwrap());
    digest.refused(bvh::poses_to_text(&body, &all, 1e-38));
    let none = Armature::new(Vec::new(), Vec::new()).unwrap();
    digest.refused(bvh::poses_to_text(&none, &[], 10.0));
    digest.refused(bvh::poses_to_text(&body, &[none.rest().clone()], 10.0));
    let odd = |change: fn(&mut LocalTransform)| {
        let mut local = LocalTransform::IDENTITY;
        change(&mut local);
        local
    };
    let named = |name: &str, rest| {
        let bones = vec![ArmatureBone {
            name: name.into(),
            parent: None,
            rest,
        }];
        Armature::new(bones, Vec::new()).unwrap()
    };
    for rest in [
        odd(|local| local.scale.y = 1.1),
        odd(|local| local.translation.z = 2e30),
    ] {
        digest.refused(bvh::poses_to_text(&named("a", rest), &[], 10.0));
        let own = named("a", LocalTransform::IDENTITY);
        let mut pose = own.rest().clone();
        pose.set_local(bone(&own, 0), rest).unwrap();
        digest.refused(bvh::poses_to_text(&own, &[own.rest().clone(), pose], 10.0));
    }
    for name in ["", "a  b", " a", "a{b", "a\nb"] {
        let own = named(name, LocalTransform::IDENTITY);
        digest.refused(bvh::poses_to_text(&own, &[], 10.0));
    }
    let wrong = bvh::write(
        &body,
        &Clip::builder("c", &body).build(),
        30.0,
        "no/such/folder/a.bvh",
    );
    digest.text(wrong.unwrap_err().to_string().split(':').next().unwrap());
    digest.value()
}

#[test]
fn of_captures() {
    check_single(&[("captures, read", read()), ("captures, written", written())]);
}
