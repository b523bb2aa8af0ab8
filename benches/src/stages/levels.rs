//! Priority levels with an unreachable second level: a hand is dragged out of reach while feet, head and the other hand
//! stay. One run is a few frames of a drag.

use std::error::Error;
use std::hint::black_box;

use kinopt::Problem;
use kinopt::ik::Drag;
use kinopt::spatial::Vector3;
use kinopt::task::{Point, Task};

use super::{Run, Stage};
use crate::{at_ease, figure};

const FRAMES: usize = 10;

pub(super) fn stages() -> Vec<Stage> {
    vec![Stage {
        name: "two levels, the second out of reach, 22 bones, a frame",
        elements: FRAMES as u64,
        unit: "frame",
        build: pulled_hand,
    }]
}

fn pulled_hand() -> Result<Run, Box<dyn Error>> {
    let (skeleton, tips) = figure(2, 4);
    let start = at_ease(&skeleton);
    let pose = skeleton.pose(&start)?;
    let mut builder = Problem::builder(skeleton.model());
    let [head, hand, pinned_tips @ ..] = tips.as_slice() else {
        return Err("a figure without limbs".into());
    };
    for &tip in pinned_tips.iter().chain([head]) {
        builder.add(Point::new(skeleton.tip(tip), pose.tip(&skeleton, tip)?));
    }
    let unreachable = pose.tip(&skeleton, *hand)? + Vector3::new(1.0, 0.5, 0.0);
    let hand_task =
        builder.add(Task::new(Point::new(skeleton.tip(*hand), unreachable)).at_level(1));
    let mut drag = Drag::new(builder.build()?, &start)?;
    drag.follow(200);
    let stretched = drag.q().to_vec();
    let mut run = move || -> Result<bool, Box<dyn Error>> {
        drag.set_configuration(&stretched)?;
        let mut all_missed = true;
        for frame in 0..FRAMES {
            let offset = Vector3::new(0.0, 0.01 * frame as f64, 0.0);
            drag.target_mut(hand_task)?.set_target(unreachable + offset);
            all_missed &= !black_box(drag.advance()).reached;
        }
        Ok(all_missed)
    };
    if !run()? {
        return Err("the hand is not out of reach".into());
    }
    Ok(Box::new(move || {
        black_box(run().is_ok());
    }))
}
