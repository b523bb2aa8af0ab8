//! Promise: motion written as BVH is read back as the same motion, to single precision. This includes changed captures
//! and bones that are rotated at rest. Motion that the format cannot represent is an error.

use std::f32::consts::PI;

use crate::bvh::matrices::{File, Joint};
use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{
    Armature, ArmatureBone, Channel, Clip, Cursor, LocalTransform, Playback, Pose,
};
use kinopt::io::FormatError;
use kinopt::io::bvh::{self, BvhChannel, MotionCapture};
use support::fault_tables::ExpectedError;
use support::random::Random;

fn bone(name: &str, parent: Option<usize>, translation: Vec3A, rotation: Quat) -> ArmatureBone {
    let rest = LocalTransform {
        translation,
        rotation,
        scale: Vec3A::ONE,
    };
    let name = name.to_owned();
    ArmatureBone { name, parent, rest }
}

fn turn(random: &mut Random) -> Quat {
    let mut component = || random.within(-1.0, 1.0) as f32;
    Quat::from_xyzw(component(), component(), component(), component()).normalize()
}

fn vector(random: &mut Random) -> Vec3A {
    Vec3A::from(std::array::from_fn::<f32, 3, _>(|_| {
        random.within(-1.0, 1.0) as f32
    }))
}

/// Six bones in two trees, not in file order: a branch continues after its sibling.
fn armature(turned: bool) -> Armature {
    let mut random = Random::new(5);
    let mut bones = Vec::new();
    for (name, parent) in [
        ("hips", None),
        ("left leg", Some(0)),
        ("spine", Some(0)),
        ("prop", None),
        ("left foot", Some(1)),
        ("spine/tip", Some(2)),
    ] {
        let position = vector(&mut random);
        let turn = turn(&mut random);
        bones.push(bone(
            name,
            parent,
            position,
            if turned { turn } else { Quat::IDENTITY },
        ));
    }
    Armature::new(bones, Vec::new()).unwrap()
}

/// Poses with rotations of every bone and displacements of the roots and the foot.
fn poses(armature: &Armature, count: usize) -> Vec<Pose> {
    let mut random = Random::new(6);
    let poses = (0..count).map(|_| {
        let mut pose = armature.rest().clone();
        for index in 0..5 {
            let bone = armature.bone_at(index).unwrap();
            let mut local = pose.local(bone).unwrap();
            local.rotation = turn(&mut random);
            if matches!(index, 0 | 3 | 4) {
                local.translation = vector(&mut random);
            }
            pose.set_local(bone, local).unwrap();
        }
        pose
    });
    poses.collect()
}

fn placed(armature: &Armature, pose: &Pose) -> Vec<Affine3A> {
    let mut placed = vec![Affine3A::IDENTITY; armature.bones()];
    armature.local_to_model(pose, &mut placed).unwrap();
    placed
}

fn frame(capture: &MotionCapture, frame: usize) -> Vec<Affine3A> {
    let mut pose = capture.armature.rest().clone();
    let seconds = frame as f64 * capture.frame_time;
    (capture.clip)
        .sample(seconds, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    placed(&capture.armature, &pose)
}

fn read(text: &str) -> MotionCapture {
    bvh::from_bytes(text.as_bytes(), "back.bvh").unwrap()
}

/// Pairs of the written and the read bone.
fn pairs(from: &Armature, to: &Armature) -> Vec<[usize; 2]> {
    let names = from.names().iter().enumerate();
    let pairs = names.map(|(index, name)| [index, to.bone(name).unwrap().index()]);
    pairs.collect()
}

#[test]
fn modified_poses_survive_a_round_trip() {
    let armature = armature(false);
    let poses = poses(&armature, 20);
    let capture = read(&bvh::poses_to_text(&armature, &poses, 25.0).unwrap());
    assert_eq!((capture.frames, capture.frame_time), (20, 0.04));
    for (index, pose) in poses.iter().enumerate() {
        let (original, back) = (placed(&armature, pose), frame(&capture, index));
        for [a, b] in pairs(&armature, &capture.armature) {
            assert!(
                original[a].abs_diff_eq(back[b], 2e-6),
                "frame {index}, bone {a}"
            );
        }
    }
    // Only moving bones have position channels, and the end of the foot is new.
    let names = [
        "hips",
        "left leg",
        "left foot",
        "left foot/tip",
        "spine",
        "spine/tip",
        "prop",
    ];
    assert_eq!(capture.armature.names()[..7], names.map(String::from));
    let moves = |channels: &Vec<BvhChannel>| channels.contains(&BvhChannel::Xposition);
    let moving: Vec<bool> = capture.channels.iter().map(moves).collect();
    assert_eq!(
        moving,
        [true, false, true, false, false, false, true, false]
    );
}

#[test]
fn bones_rotated_at_rest_survive_a_round_trip() {
    let armature = armature(true);
    let poses = poses(&armature, 20);
    let capture = read(&bvh::poses_to_text(&armature, &poses, 25.0).unwrap());
    let rests = [placed(&armature, armature.rest()), {
        placed(&capture.armature, capture.armature.rest())
    }];
    for [a, b] in pairs(&armature, &capture.armature) {
        let [rest, back] = [&rests[0][a], &rests[1][b]];
        assert!(
            rest.translation.abs_diff_eq(back.translation, 2e-6),
            "bone {a} at rest"
        );
        assert_eq!(back.matrix3, glam::Mat3A::IDENTITY);
        for (index, pose) in poses.iter().enumerate() {
            let (original, back) = (placed(&armature, pose)[a], frame(&capture, index)[b]);
            // Skinning transform of a mesh: from the model at rest to the posed model.
            let original = original * rests[0][a].inverse();
            let back = back * rests[1][b].inverse();
            assert!(original.abs_diff_eq(back, 1e-5), "frame {index}, bone {a}");
        }
    }
}

#[test]
fn file_survives_a_round_trip() {
    let rotations = "Yrotation Xrotation Zrotation";
    let positions = "Xposition Yposition Zposition";
    let joints = vec![
        Joint::new(
            "Hips",
            None,
            [0.1, 9.3, -0.2],
            &format!("{positions} {rotations}"),
        ),
        Joint::new("Chest", Some(0), [0.0, 5.1, 0.0], rotations),
        Joint::end("Chest", 1, [0.0, 3.3, 0.0]),
        Joint::new("Arm", Some(1), [0.0; 3], "Zrotation"),
        Joint::end("Arm", 3, [1.7, 0.0, 0.0]),
    ];
    let frame = |k: i32| {
        (0..10)
            .map(|c| f64::from((k * 37 + c * 71) % 360) - 180.0)
            .collect()
    };
    let file = File {
        joints,
        frame_time: 0.0083333,
        frames: (0..200).map(frame).collect(),
    };
    let capture = read(&file.text());
    let rate = 1.0 / capture.frame_time;
    let text = bvh::to_text(&capture.armature, &capture.clip, rate).unwrap();
    let again = read(&text);
    assert_eq!(again.armature, capture.armature);
    assert_eq!(again.frames, capture.frames);
    for index in 0..200 {
        let pairs = both_placed(&capture, &again, index);
        assert!(
            pairs
                .iter()
                .all(|[original, back]| original.abs_diff_eq(*back, 1e-4)),
            "frame {index}"
        );
    }
    // The lengths of the second file equal those of the first exactly.
    assert!(text.contains("OFFSET 0.1 9.3 -0.2") && text.contains("OFFSET 1.7 0 0"));
}

fn both_placed(a: &MotionCapture, b: &MotionCapture, index: usize) -> Vec<[Affine3A; 2]> {
    let pairs = frame(a, index).into_iter().zip(frame(b, index));
    pairs.map(|(a, b)| [a, b]).collect()
}

#[test]
fn clip_is_sampled_from_start_to_end() {
    let armature = armature(false);
    let mut builder = Clip::builder("walk", &armature);
    let hips = armature.bone("hips").unwrap();
    let line = KeyedCurve::linear(vec![1.0, 2.0], vec![Vec3A::ZERO, Vec3A::X]).unwrap();
    builder.channel(hips, Channel::Translation(line)).unwrap();
    let clip = builder.build();
    for (rate, frames) in [(10.0, 11), (30.0, 31), (0.5, 1), (2.5, 3), (29.97, 30)] {
        let capture = read(&bvh::to_text(&armature, &clip, rate).unwrap());
        assert_eq!(capture.frames, frames, "at {rate} a second");
        for index in 0..frames {
            let x = frame(&capture, index)[0].translation.x;
            let expected = (index as f64 / rate) as f32;
            assert!(
                (x - expected).abs() < 1e-6,
                "frame {index} at {rate} a second: {x}"
            );
        }
    }
}

#[test]
fn written_angles_are_continuous() {
    let armature = Armature::new(
        vec![bone("top", None, Vec3A::ZERO, Quat::IDENTITY)],
        Vec::new(),
    );
    let armature = armature.unwrap();
    let times: Vec<f32> = (0..91).map(|k| k as f32 / 30.0).collect();
    // Three full turns at twelve degrees per frame, about each axis and about an oblique axis.
    let axes = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 2.0, 3.0],
    ];
    for axis in axes.map(|axis| glam::Vec3::from(axis).normalize()) {
        let turns = (0..91).map(|k| Quat::from_axis_angle(axis, k as f32 * PI / 15.0));
        let curve = RotationCurve::slerp(times.clone(), turns.collect()).unwrap();
        let mut builder = Clip::builder("spin", &armature);
        let top = armature.bone("top").unwrap();
        builder.channel(top, Channel::Rotation(curve)).unwrap();
        let text = bvh::to_text(&armature, &builder.build(), 30.0).unwrap();
        let frames = text.split_once("Frame Time").unwrap().1.lines().skip(1);
        let numbers = |line: &str| line.split(' ').map(|w| w.parse::<f64>().unwrap()).collect();
        let frames: Vec<Vec<f64>> = frames.map(numbers).collect();
        assert_eq!(frames.len(), 91);
        for pair in frames.windows(2) {
            for channel in 3..6 {
                let change = (pair[1][channel] - pair[0][channel]).abs();
                assert!(change < 30.0, "about {axis}: {pair:?}");
            }
        }
        let [first, last] = [&frames[0], &frames[90]];
        let on = (3..6).map(|channel| (last[channel] - first[channel]).abs());
        let largest = on.fold(0.0, f64::max);
        assert!((largest - 1080.0).abs() < 1e-3, "about {axis}: {largest}");
    }
}

#[test]
fn written_angles_pass_gimbal_lock() {
    let top = vec![bone("top", None, Vec3A::ZERO, Quat::IDENTITY)];
    let armature = Armature::new(top, Vec::new()).unwrap();
    let top = armature.bone("top").unwrap();
    for sign in [1.0, -1.0_f32] {
        let turn = |x: f32| {
            let z = Quat::from_rotation_z(40_f32.to_radians());
            let y = Quat::from_rotation_y(-25_f32.to_radians());
            z * Quat::from_rotation_x((sign * x).to_radians()) * y
        };
        let posed = |x: f32| {
            let mut pose = armature.rest().clone();
            let rotation = turn(x);
            let local = LocalTransform {
                rotation,
                ..LocalTransform::IDENTITY
            };
            pose.set_local(top, local).unwrap();
            pose
        };
        let bends: Vec<f32> = (0..19).map(|k| 10.0 * k as f32).collect();
        let poses: Vec<Pose> = bends.iter().map(|&x| posed(x)).collect();
        let text = bvh::poses_to_text(&armature, &poses, 30.0).unwrap();
        let lines = text.split_once("Frame Time").unwrap().1.lines().skip(1);
        for (line, x) in lines.zip(&bends) {
            let words: Vec<f32> = line.split(' ').map(|w| w.parse().unwrap()).collect();
            let offset = [words[3] - 40.0, words[4] - sign * x, words[5] + 25.0];
            assert!(
                offset.iter().all(|deviation| deviation.abs() < 1e-3),
                "{line}, not {x}"
            );
        }
        let capture = read(&text);
        let locked = frame(&capture, 9)[0];
        assert!(locked.abs_diff_eq(Affine3A::from_quat(turn(90.0)), 3e-6));
    }
}

#[test]
fn moving_tips_are_written_as_joints() {
    let armature = armature(false);
    let tip = armature.bone("spine/tip").unwrap();
    let mut poses = poses(&armature, 3);
    let mut local = poses[1].local(tip).unwrap();
    local.rotation = Quat::from_rotation_x(1e-3);
    poses[1].set_local(tip, local).unwrap();
    let text = bvh::poses_to_text(&armature, &poses, 1.0).unwrap();
    assert!(text.contains("JOINT spine/tip\n"), "{text}");
    let capture = read(&text);
    let back = capture.armature.bone("spine/tip").unwrap().index();
    let (original, back) = (placed(&armature, &poses[1])[5], frame(&capture, 1)[back]);
    assert!(original.abs_diff_eq(back, 2e-6));
}

/// All motionless tips of a joint are End Sites, whose names are not written.
#[test]
fn motionless_tips_are_written_as_end_sites() {
    let names = ["hand", "hand/tip", "hand/tip/2", "hand/tip/3"];
    let bones = names.iter().zip([0.0, 1.0, 2.0, 3.0]).map(|(name, x)| {
        let parent = (x > 0.0).then_some(0);
        bone(name, parent, Vec3A::X * x, Quat::IDENTITY)
    });
    let armature = Armature::new(bones.collect(), Vec::new()).unwrap();
    let text = bvh::poses_to_text(&armature, &[armature.rest().clone()], 1.0).unwrap();
    assert_eq!(text.matches("End Site").count(), 3, "{text}");
    assert_eq!(read(&text).armature.names(), names);
}

/// An End Site has no child joints.
#[test]
fn tip_with_children_is_written_as_a_joint() {
    let still = |name, parent| bone(name, parent, Vec3A::Y, Quat::IDENTITY);
    let bones = vec![
        still("hips", None),
        still("hips/tip", Some(0)),
        still("hat", Some(1)),
    ];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let poses = [armature.rest().clone()];
    let text = bvh::poses_to_text(&armature, &poses, 30.0).unwrap();
    let back = read(&text);
    for [original, other] in pairs(&armature, &back.armature) {
        let [original, other] = [
            placed(&armature, &poses[0])[original],
            frame(&back, 0)[other],
        ];
        assert!(original.abs_diff_eq(other, 1e-6));
    }
}

#[test]
fn unrepresentable_motion_is_rejected() {
    let good = armature(false);
    let write = |armature: &Armature, poses: &[Pose], rate| {
        bvh::poses_to_text(armature, poses, rate).unwrap_err()
    };
    let none = Armature::new(Vec::new(), Vec::new()).unwrap();
    assert!(matches!(write(&none, &[], 1.0), FormatError::NoBones));
    for name in ["", " hips", "a  b", "a\nb", "{", "a}"] {
        let bones = vec![bone(name, None, Vec3A::ZERO, Quat::IDENTITY)];
        let error = write(&Armature::new(bones, Vec::new()).unwrap(), &[], 1.0);
        assert!(
            matches!(&error, FormatError::Name { bone } if bone == name),
            "{error}"
        );
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        assert!(
            matches!(write(&good, &[], rate), FormatError::Rate { .. }),
            "{rate}"
        );
    }
    let mut poses = poses(&good, 2);
    let foot = good.bone("left foot").unwrap();
    let mut local = poses[1].local(foot).unwrap();
    local.scale.y = 1.5;
    poses[1].set_local(foot, local).unwrap();
    let error = write(&good, &poses, 1.0).to_string();
    assert_eq!(
        error,
        "bone `left foot` is scaled in frame 1; a BVH file has no scales"
    );
    local.scale.y = 1.0;
    local.translation.x = 1e31;
    poses[1].set_local(foot, local).unwrap();
    let error = write(&good, &poses, 1.0).to_string();
    assert_eq!(
        error,
        "bone `left foot` in frame 1: its transform must be finite and within 1e30 of its parent"
    );
    assert!(matches!(
        write(&good, &[none.rest().clone()], 1.0),
        FormatError::Size(_)
    ));

    let mut clip = Clip::builder("long", &good);
    clip.span(0.0, 1e6).unwrap();
    bvh::to_text(&good, &clip.build(), 100.0).says("at most 16777216 frames");
    let empty = Clip::builder("empty", &good).build();
    let error = bvh::write(&good, &empty, 1.0, "no such folder/out.bvh").unwrap_err();
    assert!(
        error.to_string().starts_with("no such folder/out.bvh: "),
        "{error}"
    );
}

/// The number of frames is kept, although a duration in seconds does not define it.
#[test]
fn number_of_frames_survives_a_round_trip() {
    for rate in [24.0, 29.97, 30.0, 60.0, 120.0] {
        for frames in [2, 3, 8, 31, 100, 101, 365] {
            let mut text = format!(
                "HIERARCHY\nROOT hip\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}}\nMOTION\n\
                 Frames: {frames}\nFrame Time: {}\n",
                1.0 / rate
            );
            text += &"7.5\n".repeat(frames);
            let capture = read(&text);
            let again = bvh::to_text(&capture.armature, &capture.clip, rate).unwrap();
            assert_eq!(read(&again).frames, frames, "at {rate} a second");
        }
    }
}

/// A clip without frames has none in another armature either: the rest pose is not a frame.
#[test]
fn clip_without_frames_keeps_none() {
    let text = "HIERARCHY ROOT a\n{OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation\n\
                End Site {OFFSET 0 1 0}}\nMOTION\nFrames: 0\nFrame Time: 0.1\n";
    let capture = kinopt::io::bvh::from_bytes(text.as_bytes(), "none.bvh").unwrap();
    assert!(capture.clip.is_empty());
    let armature = &capture.armature;
    let moved = capture.clip.at_rest_in(armature, armature).unwrap();
    assert!(moved.is_empty());
    assert_eq!(moved.span(), [0.0; 2]);
}

/// The written file equals the returned text.
#[test]
fn written_file_equals_the_returned_text() {
    let text = "HIERARCHY ROOT a\n{OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation\n\
                End Site {OFFSET 0 1 0}}\nMOTION\nFrames: 2\nFrame Time: 0.1\n10 20 30\n5 6 7\n";
    let capture = kinopt::io::bvh::from_bytes(text.as_bytes(), "two.bvh").unwrap();
    let armature = &capture.armature;
    let mut pose = armature.rest().clone();
    let mut cursor = kinopt::animation::Cursor::new();
    let poses = [0.0, 0.05, 0.1].map(|time| {
        let hold = kinopt::animation::Playback::Hold;
        capture
            .clip
            .sample(time, hold, &mut cursor, &mut pose)
            .unwrap();
        pose.clone()
    });
    let text = kinopt::io::bvh::poses_to_text(armature, &poses, 20.0).unwrap();
    let file = std::env::temp_dir().join(format!("kinopt-poses-{}.bvh", std::process::id()));
    kinopt::io::bvh::write_poses(armature, &poses, 20.0, &file).unwrap();
    let written = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(written, text);
    let again = kinopt::io::bvh::from_bytes(text.as_bytes(), "three.bvh").unwrap();
    assert_eq!((again.frames, again.frame_time), (3, 0.05));
}

/// In single precision 0.7 s are slightly less than seven frames of a tenth of a second.
#[test]
fn last_frame_of_a_clip_is_written() {
    let armature = armature(false);
    for (seconds, rate, frames) in [(0.7, 10.0, 8), (0.69, 10.0, 7), (1.1, 30.0, 34)] {
        let mut builder = Clip::builder("ends", &armature);
        builder.span(0.0, seconds).unwrap();
        let text = bvh::to_text(&armature, &builder.build(), rate).unwrap();
        assert_eq!(read(&text).frames, frames, "{seconds}");
    }
}
