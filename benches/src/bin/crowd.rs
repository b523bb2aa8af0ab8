//! A frame of a crowd, on one core: each character sampled from two clips, blended, two limbs
//! brought to targets, and model transforms. Where the time goes, stage by stage.
//!
//!     cargo run --release -p kinopt-benches --bin crowd [-- CHARACTERS BONES]
#![allow(clippy::print_stdout, clippy::expect_used)]

use std::time::{Duration, Instant};

use glam::{Affine3A, Vec3A};
use kinopt::animation::{Armature, Clip, Cursor, Limb, LimbGoal, Playback, Pose};
use kinopt_benches::{Keying, Sequence, armature, clip};

const FRAMES: u32 = 300;

/// What one character keeps from frame to frame.
struct Character {
    cursors: [Cursor; 2],
    ahead: f64,
    pose: Pose,
    model: Vec<Affine3A>,
}

/// What all characters share.
struct Scene {
    armature: Armature,
    clips: [Clip; 2],
    limbs: [Limb; 2],
}

const STAGES: [&str; 5] = ["sample", "sample", "blend", "two limbs", "local to model"];

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|n| n.parse().ok())
        .collect();
    let [characters, bones] =
        [(0, 1000), (1, 60)].map(|(k, usual)| *numbers.get(k).unwrap_or(&usual));
    for keying in [
        Keying::Body,
        Keying::Everything,
        Keying::Reduced,
        Keying::ReducedEverything,
    ] {
        let scene = scene(bones, keying);
        let mut crowd: Vec<Character> = (0..characters).map(|k| scene.character(k)).collect();
        let mut other = scene.armature.rest().clone();
        let mut best = Duration::MAX;
        // A quiet moment of a busy machine, stage by stage and character by character.
        let mut stages = [Duration::MAX; STAGES.len()];
        for frame in 0..FRAMES {
            let start = Instant::now();
            for character in &mut crowd {
                scene.frame(character, &mut other, frame, |_| {});
            }
            best = best.min(start.elapsed());
        }
        for (frame, group) in crowd.chunks_mut(8).enumerate() {
            for repeat in 0..50 {
                let mut spent = [Duration::ZERO; STAGES.len()];
                for character in group.iter_mut() {
                    let mut since = Instant::now();
                    scene.frame(character, &mut other, (frame + repeat) as u32, |stage| {
                        spent[stage] += since.elapsed();
                        since = Instant::now();
                    });
                }
                for (best, spent) in stages.iter_mut().zip(spent) {
                    *best = (*best).min(spent / group.len() as u32);
                }
            }
        }
        println!(
            "{characters} characters of {bones} bones, {keying:?}: {:.2} ms a frame (best of {FRAMES})",
            1e3 * best.as_secs_f64()
        );
        for (stage, spent) in STAGES.iter().zip(stages) {
            let nanoseconds = spent.as_nanos();
            let each = nanoseconds as f64 / bones as f64;
            println!("    {stage:<15} {nanoseconds:>6} ns a character, {each:5.1} ns a bone");
        }
    }
}

fn scene(bones: usize, keying: Keying) -> Scene {
    let armature = armature(bones);
    let mut random = Sequence::new(0.5);
    let clips = [(); 2].map(|()| clip(&armature, keying, &mut random));
    // Two limbs as deep as they come: the last bones and their parents.
    let limb = |end: usize| {
        let hand = armature.bone_at(end).expect("it is there");
        let lower = armature.parent(hand).expect("not a root");
        let upper = armature.parent(lower).expect("not a root");
        let reach = armature.rest().local(hand).translation;
        Limb::new(&armature, upper, lower, reach).expect("a chain")
    };
    let limbs = [limb(bones - 1), limb(bones - 5)];
    Scene {
        limbs,
        clips,
        armature,
    }
}

impl Scene {
    fn character(&self, number: usize) -> Character {
        Character {
            cursors: [Cursor::new(), Cursor::new()],
            ahead: number as f64 * 0.013,
            pose: self.armature.rest().clone(),
            model: vec![Affine3A::IDENTITY; self.armature.bones()],
        }
    }

    /// One frame of one character; `done` hears of each stage.
    fn frame(
        &self,
        character: &mut Character,
        other: &mut Pose,
        frame: u32,
        mut done: impl FnMut(usize),
    ) {
        let Character {
            cursors,
            ahead,
            pose,
            model,
        } = character;
        let elapsed = *ahead + f64::from(frame) / 60.0;
        let own = "everything is of one armature";
        let [walk, run] = &self.clips;
        let [first, second] = cursors;
        walk.sample(elapsed, Playback::Loop, first, pose)
            .expect(own);
        done(0);
        run.sample(elapsed, Playback::Loop, second, other)
            .expect(own);
        done(1);
        pose.cross_fade(other, 0.3).expect(own);
        done(2);
        for (side, limb) in self.limbs.iter().enumerate() {
            let goal = LimbGoal {
                target: Vec3A::new(0.1, 0.5 + 0.2 * side as f32, 0.15),
                pole: Some(Vec3A::Z),
                weight: 0.8,
            };
            limb.reach(&self.armature, pose, &goal).expect(own);
        }
        done(3);
        self.armature.local_to_model(pose, model).expect(own);
        done(4);
    }
}
