//! Promise: new keys replace those in the solved spans, and a clip's own keys remain elsewhere.

use glam::{DVec3, Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{Armature, Channel, Clip, EulerCurve};
use kinopt::motion::clip_ik::{ClipIk, Reach};
use support::bones::humanoid;

use crate::clip_ik::{figure, pose};

/// A bone with a single key, as exporters write motionless bones, gets no keys but the new ones.
#[test]
fn single_key_bones_get_keys_only_in_the_span() {
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let arm = ["chest", "arm", "forearm", "hand"];
    for step in [false, true] {
        let mut builder = Clip::builder("held", &armature);
        let curve = |times: Vec<f32>, turns: Vec<Quat>| match step {
            true => RotationCurve::step(times, turns).unwrap(),
            false => RotationCurve::slerp(times, turns).unwrap(),
        };
        for bone in arm {
            let held = curve(vec![0.25], vec![Quat::from_rotation_z(0.2)]);
            builder.channel(id(bone), Channel::Rotation(held)).unwrap();
        }
        // It extends the clip to two seconds.
        let nods = [0.0, 0.3].map(Quat::from_rotation_x).to_vec();
        let nods = RotationCurve::slerp(vec![0.0, 2.0], nods).unwrap();
        builder
            .channel(id("head"), Channel::Rotation(nods))
            .unwrap();
        for (time, name) in [(0.7, "nod"), (1.2, "touch"), (2.0, "end")] {
            builder.event(time, name).unwrap();
        }
        builder.span(0.0, 2.5).unwrap();
        let clip = builder.build();
        let reach = Reach::to(id("hand"), DVec3::new(0.5, 1.3, 0.3)).unwrap();
        let reach = reach.with_span(0.8..=1.6).with_fade(0.2);
        let edited = ClipIk::new(&armature)
            .with_reach(reach)
            .solve(&clip)
            .unwrap();
        assert_eq!(edited.clip.events(), clip.events());
        let [old, new] = [&clip, &edited.clip].map(|clip| (clip.name(), clip.span()));
        assert_eq!(new, old);
        let mut moved = 0;
        for (bone, channel) in edited.clip.channels(&armature).unwrap() {
            let name = armature.names()[bone.index()].as_str();
            let times = channel.times();
            if name == "head" {
                assert_eq!(times, [0.0, 2.0]);
            } else if times.len() > 1 {
                assert!(arm.contains(&name) && matches!(channel, Channel::Rotation(_)));
                let span = 0.8 - 0.02..1.6 + 0.02;
                assert!(
                    times.iter().all(|time| span.contains(time)),
                    "{name}: {times:?}"
                );
                moved += 1;
            }
        }
        assert!(moved > 1, "{moved}");
        for time in [0.0, 0.25, 0.5, 1.8] {
            let [old, new] = [&clip, &edited.clip].map(|clip| pose(&armature, clip, time));
            for bone in armature.bone_ids() {
                let [old, new] = [&old, &new].map(|pose| pose.local(bone).unwrap());
                assert!(old.rotation.abs_diff_eq(new.rotation, 2e-7), "{time} s");
            }
        }
    }
}

/// A channel of Euler angles between few keys keeps its curve outside the solved spans.
#[test]
fn euler_channel_keeps_its_curve() {
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let mut builder = Clip::builder("wave", &armature);
    for bone in ["arm", "forearm"] {
        let angles = [[0.0, 0.0, 0.0], [0.9, 0.4, -0.5], [-0.6, 0.8, 0.7]].map(Vec3A::from);
        let curve = EulerCurve {
            order: EulerOrder::Zxy,
            before: Quat::from_rotation_x(0.2),
            angles: KeyedCurve::catmull_rom(vec![0.0, 1.0, 2.0], angles.to_vec()).unwrap(),
        };
        builder.channel(id(bone), Channel::Euler(curve)).unwrap();
    }
    let clip = builder.build();
    let reach = Reach::to(id("hand"), DVec3::new(0.5, 1.3, 0.3)).unwrap();
    let reach = reach.with_span(0.9..=1.1).with_fade(0.05);
    let edited = ClipIk::new(&armature).with_reach(reach);
    let edited = edited.with_keys_per_second(30.0).solve(&clip).unwrap();
    for time in [0.0, 0.2, 0.4, 0.6, 0.8, 1.2, 1.4, 1.6, 1.8, 2.0] {
        let [old, new] = [&clip, &edited.clip].map(|clip| pose(&armature, clip, time));
        for bone in armature.bone_ids() {
            let [old, new] = [&old, &new].map(|pose| pose.local(bone).unwrap());
            let apart = old.rotation.angle_between(new.rotation);
            assert!(apart < 2e-3, "{time} s: {apart}");
        }
    }
}

/// If a span ends within a fraction of a frame of the clip's end, the end of the clip is kept.
#[test]
fn end_of_the_clip_is_kept() {
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let mut builder = Clip::builder("swing", &armature);
    for bone in ["arm", "forearm", "chest"] {
        let turns = [0.0, 1.1].map(Quat::from_rotation_z).to_vec();
        let swing = RotationCurve::slerp(vec![0.0, 1.0], turns).unwrap();
        builder.channel(id(bone), Channel::Rotation(swing)).unwrap();
    }
    let clip = builder.build();
    for before in [0.1, 0.3, 0.45, 0.6, 2.0] {
        let end = 1.0 - before / 30.0;
        let reach = Reach::to(id("hand"), DVec3::new(0.4, 1.5, 0.3)).unwrap();
        let reach = reach.with_span(0.3..=end).with_fade(0.1);
        let edited = ClipIk::new(&armature).with_reach(reach);
        let edited = edited.with_keys_per_second(30.0).solve(&clip).unwrap();
        assert_eq!(edited.clip.span(), clip.span());
        for time in [0.0, end, 1.0] {
            let [old, new] = [&clip, &edited.clip].map(|clip| pose(&armature, clip, time));
            for bone in armature.bone_ids() {
                let [old, new] = [&old, &new].map(|pose| pose.local(bone).unwrap());
                let apart = old.rotation.angle_between(new.rotation);
                assert!(apart < 1e-3, "{before} {time} s: {apart}");
            }
        }
    }
}

/// Bones with the limits of a skeleton reach within them; without these they rotate freely.
#[test]
fn limits_of_a_skeleton_are_kept() {
    use kinopt::animation::{Armature, EulerPoseMap};
    use kinopt::model::Limits;
    use kinopt::skeleton::{Bone, Skeleton};
    use kinopt::spatial::{Placement, Vector3};
    let mut builder = Skeleton::builder("arm");
    let mut parent = None;
    for (k, name) in ["base", "upper", "fore", "hand"].iter().enumerate() {
        let bend = match k {
            0 => Limits::new(0.0, 0.0),
            _ => Limits::new(0.0, 0.6),
        };
        let at = Vector3::new(0.4 * k as f64, 0.0, 0.0);
        parent = Some(builder.add(Bone {
            name: (*name).into(),
            parent,
            length: 0.4,
            model_from_rest: Placement::translation(at),
            limits: [Limits::new(-0.1, 0.1), bend, Limits::new(-0.1, 0.1)],
        }));
    }
    let skeleton = builder.build().unwrap();
    let armature = Armature::of_skeleton(&skeleton);
    let mut builder = Clip::builder("still", &armature);
    builder.span(0.0, 0.5).unwrap();
    let clip = builder.build();
    let hand = armature.bone("hand").unwrap();
    let bridge = EulerPoseMap::new(&skeleton);
    let limits: Vec<_> = skeleton.model().limits().collect();
    let outside = |edited: &Clip| {
        let mut largest = 0.0_f64;
        for time in [0.0, 0.2, 0.5] {
            let mut q = vec![0.0; limits.len()];
            bridge
                .angles_of(&pose(&armature, edited, time), &mut q)
                .unwrap();
            for (angle, limits) in q.iter().zip(&limits) {
                largest = largest.max((limits.lower - angle).max(angle - limits.upper));
            }
        }
        largest
    };
    let reach = || Reach::to(hand, DVec3::new(0.6, 0.9, 0.3)).unwrap();
    let free = ClipIk::new(&armature)
        .with_reach(reach())
        .solve(&clip)
        .unwrap();
    assert!(outside(&free.clip) > 0.1);
    let held = ClipIk::new(&armature)
        .with_joints_of(&skeleton)
        .with_reach(reach());
    let held = held.solve(&clip).unwrap();
    assert!(outside(&held.clip) < 2e-3, "{}", outside(&held.clip));
}

/// A rig whose root is rotated in its clip reaches equally, relative to its root.
#[test]
fn rig_with_a_rotated_root_reaches_equally() {
    let rig = humanoid();
    let armature = Armature::of_skeleton(&rig.skeleton);
    let id = |name: &str| armature.bone(name).unwrap();
    let (root, hand) = (id("pelvis"), id("right_hand"));
    let arm = ["right_clavicle", "right_upper_arm", "right_forearm"].map(id);
    let reached = |turn: Quat| {
        let mut still = armature.rest().clone();
        let rest = still.local(root).unwrap();
        still.set_rotation(root, turn * rest.rotation).unwrap();
        let poses = vec![still.clone(); 2];
        let clip = Clip::through_poses("still", &armature, &[0.0, 0.4], &poses).unwrap();
        let origin = rest.translation.as_dvec3();
        let target = armature.model_from_bone(armature.rest(), hand).unwrap();
        let target = target.translation.as_dvec3() + DVec3::new(0.35, 0.1, 0.25);
        let target = origin + turn.as_dquat() * (target - origin);
        let ik = ClipIk::new(&armature).with_joints_of(&rig.skeleton);
        let ik = ik
            .with_root(root)
            .with_reach(Reach::to(hand, target).unwrap());
        let edited = ik.solve(&clip).unwrap();
        let posed = pose(&armature, &edited.clip, 0.2);
        (
            arm.map(|bone| posed.local(bone).unwrap().rotation),
            edited.report.led[0].miss,
        )
    };
    let (plain, miss) = reached(Quat::IDENTITY);
    let moved = plain[2].angle_between(armature.rest().local(arm[2]).unwrap().rotation);
    assert!(moved > 0.1, "{moved}");
    for turn in [Quat::from_rotation_z(1.2), Quat::from_rotation_x(-0.8)] {
        let (turned, actual) = reached(turn);
        assert!((actual - miss).abs() < 1e-4, "{actual} {miss}");
        for (a, b) in turned.iter().zip(&plain) {
            assert!(a.angle_between(*b) < 2e-3, "{a} {b}");
        }
    }
}
