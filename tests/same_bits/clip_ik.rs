//! Promise: so it is for inverse kinematics over clips: feet that are planted, hands that reach, roots that follow, grounds, travel,
//! bones with limits, what is reported and what is refused.
#![allow(clippy::unwrap_used)]

use glam::{DVec3, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, Channel, Clip};
use kinopt::model::Limits;
use kinopt::motion::ContactDetection;
use kinopt::motion::clip_ik::{ClipIk, ClipIkError, EditedClip, Reach, ground_speed};
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::spatial::{Placement, Vector3};

use crate::animated::check_single;
use crate::digest::{Digest, Value};
use crate::robot_texts::{add_error, add_text};
use crate::walking_figure::{figure, turn, walk};

pub(crate) fn add(
    digest: &mut Digest,
    armature: &Armature,
    edited: Result<EditedClip, ClipIkError>,
) {
    match edited {
        Ok(edited) => {
            for (bone, channel) in edited.clip.channels(armature).unwrap() {
                add_text(digest, &format!("{bone:?} {channel:?}"));
            }
            add_text(
                digest,
                &format!(
                    "{:?} {:?} {:?}",
                    edited.clip.name(),
                    edited.clip.span(),
                    edited.clip.events()
                ),
            );
            add_text(
                digest,
                &format!(
                    "{:?} {:?} {}",
                    edited.stances, edited.led, edited.root_moved
                ),
            );
        }
        Err(error) => add_error(digest, &error),
    }
}

fn planted(armature: &Armature) -> ClipIk<'_> {
    let feet = ["foot.l", "foot.r"].map(|name| armature.bone(name).unwrap());
    let ik = ClipIk::new(armature).with_keys_per_second(11.0);
    ik.with_planted(feet[0]).with_planted(feet[1])
}

/// Feet under each setting.
fn feet() -> Value {
    let mut digest = Digest::new();
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let (walks, steps) = (walk(&armature, true), walk(&armature, false));
    let detection = ContactDetection::default().with_speed(0.4).with_height(0.1);
    let stairs = |at: Vector3<f64>| {
        if at.z > 0.8 {
            0.15
        } else if at.z > 0.4 {
            0.05
        } else {
            0.0
        }
    };
    let down = |at: Vector3<f64>| if at.z > 0.6 { -0.12 } else { 0.02 * at.x };
    let asked = [
        planted(&armature),
        planted(&armature).with_keys_per_second(7.0),
        planted(&armature).with_detection(detection.with_lead(0.4)),
        planted(&armature).with_detection(detection.with_shortest(0.5)),
        planted(&armature).with_detection(detection.with_height(0.0)),
        planted(&armature).with_ground(stairs),
        planted(&armature)
            .with_ground(down)
            .with_detection(detection),
        planted(&armature).with_root(id("world")),
        planted(&armature).with_up([0.0, 0.0, 3.0]),
        ClipIk::new(&armature)
            .with_keys_per_second(11.0)
            .with_planted(id("foot.l")),
    ];
    for ik in asked {
        add(&mut digest, &armature, ik.solve(&walks));
    }
    for both in [[0, 1], [1, 0], [0, 0]] {
        let feet = both.map(|foot| id(["foot.l", "foot.r"][foot]));
        for up in [Vec3::Y, Vec3::new(0.3, 2.0, 0.0)] {
            let speed = ground_speed(&armature, &steps, &feet, up, 30.0).unwrap();
            digest.singles(speed.to_array());
            let travel = planted(&armature).with_root_velocity(speed).with_up(up);
            if both == [0, 1] && up != Vec3::Y {
                add(&mut digest, &armature, travel.solve(&steps));
            }
        }
    }
    digest.value()
}

/// Hands over spans, with what moves the root, beside feet, one after another.
fn hands() -> Value {
    let mut digest = Digest::new();
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let (hand, head) = (id("hand"), id("head"));
    let walks = walk(&armature, true);
    let to = |at: [f64; 3]| Reach::to(hand, at).unwrap();
    let way = KeyedCurve::catmull_rom(
        vec![0.2, 0.6, 1.0],
        vec![
            DVec3::new(0.5, 1.2, 0.4),
            DVec3::new(0.4, 1.4, 0.9),
            DVec3::new(0.6, 1.1, 1.4),
        ],
    );
    let along = Reach::along(hand, way.unwrap());
    let ik = || ClipIk::new(&armature).with_keys_per_second(9.0);
    let asked = [
        ik().with_reach(to([0.5, 1.2, 0.6])),
        ik().with_reach(to([0.5, 1.2, 0.6]).with_span(0.33..=0.91).with_fade(0.0)),
        ik().with_reach(to([0.5, 1.2, 0.6]).with_span(-1.0..=0.5).with_fade(0.1)),
        ik().with_reach(to([0.5, 1.2, 0.6]).with_span(0.7..=4.0)),
        ik().with_reach(along.clone().with_span(0.2..=1.0))
            .with_root(id("chest")),
        ik().with_reach(to([3.0, 1.2, 0.6]).with_span(0.6..=0.9)),
        ik().with_reach(to([0.4, 1.3, 0.2]).with_span(0.1..=0.5))
            .with_reach(to([0.6, 1.2, 1.0]).with_span(0.5..=1.05)),
        planted(&armature).with_reach(to([1.2, 1.2, 0.6]).with_span(0.3..=0.9)),
        ik().with_reach(to([0.5, 1.2, 0.6]).with_span(0.4..=0.8))
            .with_reach(
                Reach::to(head, [0.1, 1.4, 0.7])
                    .unwrap()
                    .with_span(0.6..=1.1),
            ),
        planted(&armature)
            .with_reach(along.with_span(0.3..=1.0))
            .with_keys_per_second(9.0),
    ];
    let asked = asked.into_iter().chain([
        ik().with_reach(to([0.4, 1.3, 0.2]).with_span(0.1..=0.5).with_fade(0.0))
            .with_reach(to([0.6, 1.2, 1.0]).with_span(0.5..=0.8).with_fade(0.0)),
        // The shin alone turns.
        ik().with_planted(id("foot.l")).with_root(id("thigh.l")),
    ]);
    for ik in asked {
        add(&mut digest, &armature, ik.solve(&walks));
    }
    digest.value()
}

/// Channels of steps and of one key, events, and a span that is longer than they are.
fn spliced() -> Value {
    let mut digest = Digest::new();
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    for kind in 0..4 {
        let mut builder = Clip::builder("held", &armature);
        for (bone, angle) in [("chest", 0.1), ("arm", -0.3), ("forearm", 0.4)] {
            let turns = [0.0, 1.0, 0.4].map(|share| turn(Vec3::Z, angle * share));
            let curve = match kind {
                0 => RotationCurve::slerp(vec![0.25], vec![turns[1]]),
                1 => RotationCurve::step(vec![0.1, 0.7, 1.4], turns.to_vec()),
                2 => RotationCurve::squad(vec![0.0, 0.7, 1.4], turns.to_vec()),
                _ => RotationCurve::slerp(vec![0.3, 0.7, 1.4], turns.to_vec()),
            };
            builder
                .channel(id(bone), Channel::Rotation(curve.unwrap()))
                .unwrap();
        }
        let places = [[0.0, 0.88, 0.0], [0.0, 0.85, 0.1]]
            .map(Vec3A::from)
            .to_vec();
        let places = match kind {
            0 | 1 => KeyedCurve::step(vec![0.2, 1.0], places),
            _ => KeyedCurve::linear(vec![0.2, 1.0], places),
        };
        builder
            .channel(id("hips"), Channel::Translation(places.unwrap()))
            .unwrap();
        for (time, name) in [(0.7, "nod"), (1.2, "touch")] {
            builder.event(time, name).unwrap();
        }
        builder.span(0.1, 1.6).unwrap();
        let clip = builder.build();
        for at in [[0.5, 1.3, 0.3], [1.5, 1.3, 0.3]] {
            let reach = Reach::to(id("hand"), at).unwrap();
            let ik = ClipIk::new(&armature).with_keys_per_second(9.0);
            let ik = ik.with_reach(reach.with_span(0.4..=1.0).with_fade(0.1));
            add(&mut digest, &armature, ik.solve(&clip));
        }
    }
    let joints = skeleton();
    let own = Armature::of_skeleton(&joints);
    let mut builder = Clip::builder("bent", &own);
    for (bone, angle) in own.bone_ids().skip(1).zip([0.2, 0.4, 0.1]) {
        let rest = own.rest().local(bone).unwrap().rotation;
        let turns = [0.5, 1.0]
            .map(|share| rest * turn(Vec3::Z, angle * share))
            .to_vec();
        let turns = RotationCurve::slerp(vec![0.0, 0.4], turns).unwrap();
        builder.channel(bone, Channel::Rotation(turns)).unwrap();
    }
    builder.span(0.0, 0.4).unwrap();
    let clip = builder.build();
    let hand = own.bone("hand").unwrap();
    for at in [[0.6, 0.9, 0.3], [1.4, 0.2, 0.0], [0.3, 0.1, 0.0]] {
        let ik = || {
            ClipIk::new(&own)
                .with_keys_per_second(10.0)
                .with_reach(Reach::to(hand, at).unwrap())
        };
        add(&mut digest, &own, ik().solve(&clip));
        add(&mut digest, &own, ik().with_joints_of(&joints).solve(&clip));
        let planted = ClipIk::new(&own).with_joints_of(&joints).with_planted(hand);
        add(&mut digest, &own, planted.solve(&clip));
    }
    digest.value()
}

/// An arm of four bones within limits.
pub(crate) fn skeleton() -> Skeleton {
    let mut builder = Skeleton::builder("arm");
    let mut parent = None;
    for (k, name) in ["base", "upper", "fore", "hand"].iter().enumerate() {
        let bend = if k == 0 {
            Limits::new(0.0, 0.0)
        } else {
            Limits::new(0.0, 0.6)
        };
        parent = Some(builder.add(Bone {
            name: (*name).into(),
            parent,
            length: 0.4,
            model_from_rest: Placement::translation(Vector3::new(0.4 * k as f64, 0.0, 0.0)),
            limits: [Limits::new(-0.1, 0.1), bend, Limits::new(-0.2, 0.1)],
        }));
    }
    builder.build().unwrap()
}

fn refusals() -> Value {
    let mut digest = Digest::new();
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let walks = walk(&armature, true);
    let reach = |bone: &str| Reach::to(id(bone), [0.5, 1.0, 0.0]).unwrap();
    let ik = || ClipIk::new(&armature).with_keys_per_second(10.0);
    let joints = skeleton();
    let bad = ContactDetection::default();
    let mut sheared = Clip::builder("sheared", &armature);
    let scale = KeyedCurve::linear(vec![0.0, 1.0], vec![Vec3A::ONE, Vec3A::new(1.0, 2.0, 1.0)]);
    sheared
        .channel(id("arm"), Channel::Scale(scale.unwrap()))
        .unwrap();
    let sheared = sheared.build();
    let empty = Clip::builder("empty", &armature).build();
    let asked = [
        ik(),
        ik().with_reach(reach("hand")).with_root(id("shin.l")),
        ik().with_reach(reach("hand")).with_planted(id("hand")),
        ik().with_reach(reach("hand")).with_reach(reach("hand")),
        ik().with_planted(id("foot.l")).with_planted(id("foot.l")),
        ik().with_reach(reach("hand").with_span(1.0..=0.5)),
        ik().with_reach(reach("hand").with_span(5.0..=6.0)),
        ik().with_reach(reach("hand").with_span(0.0..=1.0).with_fade(0.6)),
        ik().with_reach(reach("hand").with_fade(f64::NAN)),
        ik().with_reach(reach("hand").with_fade(-0.1)),
        ik().with_planted(id("foot.l")).with_keys_per_second(0.0),
        ik().with_planted(id("foot.l")).with_keys_per_second(1e9),
        ik().with_planted(id("foot.l")).with_up(Vec3::ZERO),
        ik().with_reach(reach("hips")).with_root_velocity(Vec3::X),
        ik().with_reach(reach("hand")).with_root_velocity(Vec3::NAN),
        ik().with_planted(id("foot.l")).with_joints_of(&joints),
        ik().with_planted(id("foot.l"))
            .with_detection(bad.with_speed(-1.0)),
        ik().with_planted(id("foot.l"))
            .with_detection(bad.with_lead(f64::NAN)),
        ik().with_reach(reach("hand").with_span(0.2..=0.6))
            .with_reach(reach("hand").with_span(0.5..=0.9)),
        ik().with_reach(reach("world")),
        ik().with_reach(reach("hips")),
    ];
    for ik in asked {
        for clip in [&walks, &sheared, &empty] {
            add(&mut digest, &armature, ik.solve(clip));
        }
    }
    for at in [[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]] {
        add_error(&mut digest, &Reach::to(id("hand"), at).unwrap_err());
    }
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    let whole = ik().with_reach(reach("hand").with_span(0.1..=0.8));
    add(&mut digest, &armature, whole.solve(&sheared));
    add_error(
        &mut digest,
        &ClipIk::new(&other)
            .with_planted(id("hand"))
            .solve(&walks)
            .unwrap_err(),
    );
    let few = Armature::of_skeleton(&joints);
    let still = Clip::builder("still", &few).build();
    add_error(
        &mut digest,
        &ClipIk::new(&few)
            .with_planted(id("head"))
            .solve(&still)
            .unwrap_err(),
    );
    for (feet, up, rate) in [
        (&[id("hand")][..], Vec3::ZERO, 30.0),
        (&[id("head")], Vec3::Y, 0.0),
        (&[], Vec3::Y, 30.0),
    ] {
        match ground_speed(&armature, &walks, feet, up, rate) {
            Ok(speed) => digest.singles(speed.to_array()),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    add_error(
        &mut digest,
        &ground_speed(&few, &still, &[id("head")], Vec3::Y, 30.0).unwrap_err(),
    );
    digest.value()
}

#[test]
fn of_feet_and_hands_over_clips() {
    check_single(&[
        ("clip IK: feet that stand", feet()),
        ("clip IK: hands that reach", hands()),
        ("clip IK: new keys between others", spliced()),
        ("clip IK: what is refused", refusals()),
    ]);
}
