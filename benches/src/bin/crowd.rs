//! One frame of a crowd, on one core: each character is sampled from two clips, blended, and its two limbs reach
//! targets; then model transforms. Reports the time by stage, and the cost of two end effectors by the optimiser
//! instead of the limbs. With feature `rayon`, on all cores as well.
//!
//!     cargo run --release -p kinopt-benches --bin crowd [-- CHARACTERS BONES]
#![allow(clippy::print_stdout, clippy::expect_used)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Affine3A, Vec3A};
use kinopt::animation::{
    Armature, Character, Clip, Crowd, Cursor, EulerPoseMap, Limb, LimbGoal, Playback, PlayingClip,
    ReachLayer,
};
use kinopt::ik::Restarts;
use kinopt::solver::Stopping;
use kinopt::spatial::Vector3;
use kinopt::{Skeleton, Solver};
use kinopt_benches::{Keying, Sequence, armature, at_ease, clip, figure};

const FRAMES: u32 = 300;
const FRAME_TIME: f64 = 1.0 / 60.0;
const ONE_ARMATURE: &str = "everything is of one armature";

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|n| n.parse().ok())
        .collect();
    let [characters, bones] =
        [(0, 1000), (1, 60)].map(|(k, default)| *numbers.get(k).unwrap_or(&default));
    for keying in Keying::ALL {
        let armature = armature(bones);
        let mut random = Sequence::new(0.5);
        let clips = [(); 2].map(|()| Arc::new(clip(&armature, keying, &mut random)));
        let limbs = [limb(&armature, bones - 1), limb(&armature, bones - 5)];
        let mut crowd = crowd(&armature, &clips, limbs, characters);
        let time = best(|| crowd.advance(FRAME_TIME).expect(ONE_ARMATURE));
        println!("{characters} characters of {bones} bones, {keying:?}: {time:.2} ms a frame");
        #[cfg(feature = "rayon")]
        {
            let time = best(|| crowd.advance_parallel(FRAME_TIME).expect(ONE_ARMATURE));
            println!("    over threads: {time:.2} ms a frame");
        }
        for (stage, time) in stages(&armature, &clips, &limbs) {
            let time_per_bone = time / bones as f64;
            println!("    {stage:<15} {time:>6.0} ns a character, {time_per_bone:5.1} ns a bone");
        }
    }
    reach(characters);
}

/// Shortest time of several frames, in milliseconds.
fn best(mut frame: impl FnMut()) -> f64 {
    let times = (0..FRAMES).map(|_| {
        let start = Instant::now();
        frame();
        start.elapsed()
    });
    1e3 * times.min().unwrap_or_default().as_secs_f64()
}

/// A limb of maximal depth: a late bone and its two ancestors.
fn limb(armature: &Armature, end: usize) -> Limb {
    let hand = armature.bone_at(end).expect("it is there");
    let lower = armature.parent(hand).expect("not a root");
    let upper = armature.parent(lower).expect("not a root");
    let reach = armature
        .rest()
        .local(hand)
        .expect("it is there")
        .translation;
    Limb::new(armature, upper, lower, reach).expect("a chain")
}

fn goal(side: usize) -> LimbGoal {
    LimbGoal {
        pole: Some(Vec3A::Z),
        weight: 0.8,
        ..LimbGoal::at(Vec3A::new(0.1, 0.5 + 0.2 * side as f32, 0.15))
    }
}

fn crowd(
    armature: &Armature,
    clips: &[Arc<Clip>; 2],
    limbs: [Limb; 2],
    characters: usize,
) -> Crowd {
    let mut crowd = Crowd::new(armature.clone(), limbs.to_vec());
    for number in 0..characters {
        let mut playing = clips.clone().map(PlayingClip::new);
        playing[1].share = 0.3;
        for playing in &mut playing {
            playing.playhead.advance(0.013 * number as f64);
        }
        let character: &mut Character = crowd.add(playing.into()).expect(ONE_ARMATURE);
        for (side, limb_goal) in character.goals_mut().iter_mut().enumerate() {
            *limb_goal = goal(side);
        }
    }
    crowd
}

/// Time of each stage for one character, in nanoseconds: the minimum of several means over eight of them.
fn stages(
    armature: &Armature,
    clips: &[Arc<Clip>; 2],
    limbs: &[Limb; 2],
) -> [(&'static str, f64); 4] {
    const CHARACTERS_PER_FRAME: usize = 8;
    let mut fastest = [Duration::MAX; 4];
    let mut pose = armature.rest().clone();
    let mut other = pose.clone();
    let mut model = vec![Affine3A::IDENTITY; armature.bones()];
    let mut cursors = vec![[Cursor::new(), Cursor::new()]; CHARACTERS_PER_FRAME];
    for frame in 0..5000 {
        let mut times = [Duration::ZERO; 4];
        for (number, [first, second]) in cursors.iter_mut().enumerate() {
            let elapsed = 0.013 * number as f64 + FRAME_TIME * f64::from(frame);
            let mut started = Instant::now();
            let mut end_stage = |stage: usize| {
                times[stage] += started.elapsed();
                started = Instant::now();
            };
            let [walk, run] = clips;
            walk.sample(elapsed, Playback::Loop, first, &mut pose)
                .expect(ONE_ARMATURE);
            run.sample(elapsed, Playback::Loop, second, &mut other)
                .expect(ONE_ARMATURE);
            end_stage(0);
            pose.cross_fade(&other, 0.3).expect(ONE_ARMATURE);
            end_stage(1);
            for (side, limb) in limbs.iter().enumerate() {
                limb.reach(armature, &mut pose, &goal(side))
                    .expect(ONE_ARMATURE);
            }
            end_stage(2);
            armature
                .local_to_model(&pose, &mut model)
                .expect(ONE_ARMATURE);
            end_stage(3);
        }
        for (best_time, time) in fastest.iter_mut().zip(times) {
            *best_time = (*best_time).min(time / CHARACTERS_PER_FRAME as u32);
        }
    }
    let names = ["two samples", "blend", "two limbs", "local to model"];
    let mut named_times = names.into_iter().zip(fastest);
    std::array::from_fn(|_| {
        let (name, time) = named_times.next().unwrap_or_default();
        (name, time.as_nanos() as f64)
    })
}

/// Solves two hands of a skeleton of 60 bones with joint limits. Each target is on a circle of 5 cm radius, 5 cm in
/// front of the hand's position in the pose.
fn reach(characters: usize) {
    let (skeleton, tips) = figure(10, 10);
    let limited = Solver::default()
        .with_stopping(Stopping::default().with_max_iterations(5))
        .with_restarts(Restarts::none());
    for (name, solver) in [("to the end", Solver::default()), ("5 iterations", limited)] {
        let (milliseconds, reached, iterations) =
            reach_by(&skeleton, &tips[1..3], solver, characters);
        println!(
            "{characters} characters of {} bones, two effectors by the optimiser, {name}: {milliseconds:.1} ms a \
             frame, {:.1} us each; {:.1} % reached, {iterations:.1} iterations",
            skeleton.bones().len(),
            1e3 * milliseconds / characters as f64,
            100.0 * reached,
        );
    }
}

/// Milliseconds for each frame, fraction of characters that reach, and iterations for each.
fn reach_by(
    skeleton: &Skeleton,
    hands: &[kinopt::skeleton::BoneId],
    solver: Solver,
    characters: usize,
) -> (f64, f64, f64) {
    let bridge = EulerPoseMap::new(skeleton);
    let start = at_ease(skeleton);
    let mut rest_pose = Armature::of_skeleton(skeleton).rest().clone();
    bridge
        .pose_of(&start, &mut rest_pose)
        .expect("its own angles");
    let start_pose = skeleton.pose(&start).expect("its own pose");
    let tips: Vec<_> = hands
        .iter()
        .map(|&hand| start_pose.tip(skeleton, hand).expect("its own hand"))
        .collect();
    let mut layer = ReachLayer::new(skeleton, hands, solver).expect("a valid problem");
    let mut pose = rest_pose.clone();
    let (mut fastest, mut reached, mut iterations) = (Duration::MAX, 0, 0);
    let frames = 3;
    for _ in 0..frames {
        let started = Instant::now();
        for number in 0..characters {
            // Each character has another phase on the circle, so that their searches differ.
            pose.copy_from(&rest_pose);
            let (sin, cos) = (0.1 * number as f64).sin_cos();
            let offset = Vector3::new(0.05 * cos, 0.05 * sin, 0.05);
            for (&hand, &tip) in hands.iter().zip(&tips) {
                layer
                    .set_goal(hand, tip + offset, 1.0)
                    .expect("a hand of it");
            }
            let solution = layer.apply(&mut pose).expect("finite targets");
            if let Some(solution) = solution {
                reached += usize::from(solution.reached);
                iterations += solution.iterations;
            }
        }
        fastest = fastest.min(started.elapsed());
    }
    let solves = (frames * characters) as f64;
    let mean = |count: usize| count as f64 / solves;
    (1e3 * fastest.as_secs_f64(), mean(reached), mean(iterations))
}
