//! Promise: a frame of a crowd equals the frames of its characters by their parts. It is bitwise equal over the threads
//! of a rayon pool.

use std::sync::Arc;

use glam::{Affine3A, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{
    Armature, Channel, Clip, Crowd, Cursor, Limb, LimbGoal, Playback, PlayingClip, SizeMismatch,
};
use support::armatures::{armature, difference, rotation, vector};
use support::random::Random;

fn clip(name: &str, armature: &Armature, random: &mut Random) -> Arc<Clip> {
    let mut builder = Clip::builder(name, armature);
    let times = || vec![0.0, 0.3, 1.1, 1.5];
    for index in 0..armature.bones() {
        let bone = armature.bone_at(index).unwrap();
        let turns = times().iter().map(|_| rotation(random, 1.0)).collect();
        let turns = RotationCurve::slerp(times(), turns).unwrap();
        builder.channel(bone, Channel::Rotation(turns)).unwrap();
        let places = times().iter().map(|_| vector(random, 1.0)).collect();
        let places = KeyedCurve::linear(times(), places).unwrap();
        builder.channel(bone, Channel::Translation(places)).unwrap();
    }
    Arc::new(builder.build())
}

const CHARACTERS: usize = 101;

fn crowd(random: &mut Random) -> (Crowd, [Arc<Clip>; 2], Limb) {
    let armature = armature(12, random);
    let clips = ["walk", "run"].map(|name| clip(name, &armature, random));
    let lower = (0..12)
        .filter_map(|k| armature.bone_at(k))
        .find(|&bone| armature.parent(bone).is_some())
        .unwrap();
    let upper = armature.parent(lower).unwrap();
    let limb = Limb::new(&armature, upper, lower, Vec3A::new(0.2, 0.9, 0.1)).unwrap();
    let mut crowd = Crowd::new(armature, vec![limb]);
    for number in 0..CHARACTERS {
        let mut playing = clips.clone().map(PlayingClip::new);
        playing[0].playhead.speed = 0.5 + 0.01 * number as f64;
        playing[1].playback = Playback::PingPong;
        playing[1].share = 0.005 + 0.01 * number as f32;
        let character = crowd.add(playing.into()).unwrap();
        character.goals_mut()[0] = goal(random);
    }
    (crowd, clips, limb)
}

fn goal(random: &mut Random) -> LimbGoal {
    LimbGoal {
        pole: Some(vector(random, 2.0)),
        weight: 0.7,
        ..LimbGoal::at(vector(random, 2.0))
    }
}

#[test]
fn crowd_frame_equals_single_characters() {
    let mut random = Random::new(31);
    let (mut crowd, [walk, run], limb) = crowd(&mut random);
    let mut goals = Vec::new();
    for character in crowd.characters_mut() {
        goals.push(character.goals_mut()[0]);
    }
    for _ in 0..4 {
        crowd.advance(0.4).unwrap();
    }
    let armature = crowd.armature();
    let mut other = armature.rest().clone();
    let mut model = vec![Affine3A::IDENTITY; armature.bones()];
    for (number, character) in crowd.characters().iter().enumerate() {
        let mut pose = armature.rest().clone();
        let mut speed = 0.0;
        for _ in 0..4 {
            speed += 0.4 * (0.5 + 0.01 * number as f64);
        }
        walk.sample(speed, Playback::Loop, &mut Cursor::new(), &mut pose)
            .unwrap();
        run.sample(
            0.4 + 0.4 + 0.4 + 0.4,
            Playback::PingPong,
            &mut Cursor::new(),
            &mut other,
        )
        .unwrap();
        pose.cross_fade(&other, 0.005 + 0.01 * number as f32)
            .unwrap();
        limb.reach(armature, &mut pose, &goals[number]).unwrap();
        armature.local_to_model(&pose, &mut model).unwrap();
        assert_eq!(character.pose(), &pose, "character {number}");
        assert_eq!(character.model_from_bone(), model);
    }
}

#[test]
fn parallel_crowd_equals_serial_exactly() {
    let (mut serial, ..) = crowd(&mut Random::new(32));
    let mut parallel = serial.clone();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
    let pool = pool.unwrap();
    for _ in 0..10 {
        serial.advance(0.1).unwrap();
        pool.install(|| parallel.advance_parallel(0.1)).unwrap();
        for (a, b) in serial.characters().iter().zip(parallel.characters()) {
            assert!(a.pose() == b.pose() && a.model_from_bone() == b.model_from_bone());
        }
    }
}

#[test]
fn clips_of_other_armatures_are_rejected() {
    let mut random = Random::new(33);
    let (mut crowd, ..) = crowd(&mut random);
    let other = armature(13, &mut random);
    let clip = clip("fly", &other, &mut random);
    let refused = crowd.add(vec![PlayingClip::new(clip)]).unwrap_err();
    let (given, expected) = (13, 12);
    assert!(
        matches!(refused, SizeMismatch { given: g, expected: e, .. } if (g, e) == (given, expected))
    );
    assert_eq!(crowd.characters().len(), CHARACTERS);
}

/// A character without clips reaches from the rest pose in every frame.
#[test]
fn character_without_clips_reaches_from_rest() {
    let mut random = Random::new(34);
    let (mut crowd, _, limb) = crowd(&mut random);
    let new_goal = goal(&mut random);
    crowd.add(Vec::new()).unwrap().goals_mut()[0] = new_goal;
    for _ in 0..3 {
        crowd.advance(0.1).unwrap();
    }
    // By a weight, and not from the previous frame.
    for weight in [1.0, 0.5, 0.0] {
        let new_goal = LimbGoal { weight, ..new_goal };
        crowd.characters_mut()[CHARACTERS].goals_mut()[0] = new_goal;
        for _ in 0..2 {
            crowd.advance(0.1).unwrap();
        }
        let mut pose = crowd.armature().rest().clone();
        limb.reach(crowd.armature(), &mut pose, &new_goal).unwrap();
        assert_eq!(crowd.characters()[CHARACTERS].pose(), &pose, "{weight}");
    }
}

/// A second clip is played at full weight until another weight is set.
#[test]
fn clip_plays_at_full_weight_by_default() {
    let random = &mut Random::new(8);
    let armature = armature(3, random);
    let [first, second] = ["walk", "run"].map(|name| clip(name, &armature, random));
    let frame = |clips: Vec<Arc<Clip>>| {
        let mut crowd = Crowd::new(armature.clone(), Vec::new());
        let playing: Vec<_> = clips.into_iter().map(PlayingClip::new).collect();
        crowd.add(playing).unwrap();
        crowd.advance(0.4).unwrap();
        crowd.characters()[0].pose().clone()
    };
    let [both, alone] = [vec![first, second.clone()], vec![second]].map(frame);
    assert!(difference(&both, &alone) < 1e-6);
}
