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
const SECONDS: f64 = 1.0 / 60.0;
const OWN: &str = "everything is of one armature";

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|n| n.parse().ok())
        .collect();
    let [characters, bones] =
        [(0, 1000), (1, 60)].map(|(k, usual)| *numbers.get(k).unwrap_or(&usual));
    for keying in Keying::ALL {
        let armature = armature(bones);
        let mut random = Sequence::new(0.5);
        let clips = [(); 2].map(|()| Arc::new(clip(&armature, keying, &mut random)));
        let limbs = [limb(&armature, bones - 1), limb(&armature, bones - 5)];
        let mut crowd = crowd(&armature, &clips, limbs, characters);
        let spent = best(|| crowd.advance(SECONDS).expect(OWN));
        println!("{characters} characters of {bones} bones, {keying:?}: {spent:.2} ms a frame");
        #[cfg(feature = "rayon")]
        {
            let spent = best(|| crowd.advance_parallel(SECONDS).expect(OWN));
            println!("    over threads: {spent:.2} ms a frame");
        }
        for (stage, spent) in stages(&armature, &clips, &limbs) {
            let each = spent / bones as f64;
            println!("    {stage:<15} {spent:>6.0} ns a character, {each:5.1} ns a bone");
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
        let added: &mut Character = crowd.add(playing.into()).expect(OWN);
        for (side, own) in added.goals_mut().iter_mut().enumerate() {
            *own = goal(side);
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
    const EACH: usize = 8;
    let mut least = [Duration::MAX; 4];
    let mut pose = armature.rest().clone();
    let mut other = pose.clone();
    let mut model = vec![Affine3A::IDENTITY; armature.bones()];
    let mut cursors = vec![[Cursor::new(), Cursor::new()]; EACH];
    for frame in 0..5000 {
        let mut spent = [Duration::ZERO; 4];
        for (number, [first, second]) in cursors.iter_mut().enumerate() {
            let elapsed = 0.013 * number as f64 + SECONDS * f64::from(frame);
            let mut since = Instant::now();
            let mut done = |stage: usize| {
                spent[stage] += since.elapsed();
                since = Instant::now();
            };
            let [walk, run] = clips;
            walk.sample(elapsed, Playback::Loop, first, &mut pose)
                .expect(OWN);
            run.sample(elapsed, Playback::Loop, second, &mut other)
                .expect(OWN);
            done(0);
            pose.cross_fade(&other, 0.3).expect(OWN);
            done(1);
            for (side, limb) in limbs.iter().enumerate() {
                limb.reach(armature, &mut pose, &goal(side)).expect(OWN);
            }
            done(2);
            armature.local_to_model(&pose, &mut model).expect(OWN);
            done(3);
        }
        for (least, spent) in least.iter_mut().zip(spent) {
            *least = (*least).min(spent / EACH as u32);
        }
    }
    let names = ["two samples", "blend", "two limbs", "local to model"];
    let mut named = names.into_iter().zip(least);
    std::array::from_fn(|_| {
        let (name, spent) = named.next().unwrap_or_default();
        (name, spent.as_nanos() as f64)
    })
}

/// Solves two hands of a skeleton of 60 bones with joint limits. Each target is on a circle of 5 cm radius, 5 cm in
/// front of the hand's position in the pose.
fn reach(characters: usize) {
    let (skeleton, tips) = figure(10, 10);
    let quick = Solver::default()
        .with_stopping(Stopping::default().with_max_iterations(5))
        .with_restarts(Restarts::none());
    for (name, solver) in [("to the end", Solver::default()), ("5 iterations", quick)] {
        let (spent, reached, iterations) = reach_by(&skeleton, &tips[1..3], solver, characters);
        println!(
            "{characters} characters of {} bones, two effectors by the optimiser, {name}: {spent:.1} ms a \
             frame, {:.1} us each; {:.1} % reached, {iterations:.1} iterations",
            skeleton.bones().len(),
            1e3 * spent / characters as f64,
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
    let easy = at_ease(skeleton);
    let mut posed = Armature::of_skeleton(skeleton).rest().clone();
    bridge.pose_of(&easy, &mut posed).expect("its own angles");
    let at = skeleton.pose(&easy).expect("its own pose");
    let tips: Vec<_> = hands
        .iter()
        .map(|&hand| at.tip(skeleton, hand).expect("its own hand"))
        .collect();
    let mut layer = ReachLayer::new(skeleton, hands, solver).expect("a valid problem");
    let mut pose = posed.clone();
    let (mut least, mut reached, mut iterations) = (Duration::MAX, 0, 0);
    let frames = 3;
    for _ in 0..frames {
        let start = Instant::now();
        for number in 0..characters {
            // Each character has another phase on the circle, so that their searches differ.
            pose.copy_from(&posed);
            let (sin, cos) = (0.1 * number as f64).sin_cos();
            let moved = Vector3::new(0.05 * cos, 0.05 * sin, 0.05);
            for (&hand, &tip) in hands.iter().zip(&tips) {
                layer
                    .set_goal(hand, tip + moved, 1.0)
                    .expect("a hand of it");
            }
            let solution = layer.apply(&mut pose).expect("finite targets");
            if let Some(solution) = solution {
                reached += usize::from(solution.reached);
                iterations += solution.iterations;
            }
        }
        least = least.min(start.elapsed());
    }
    let all = (frames * characters) as f64;
    let share = |count: usize| count as f64 / all;
    (1e3 * least.as_secs_f64(), share(reached), share(iterations))
}
