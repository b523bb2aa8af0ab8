//! What is asked at once, as tasks of one problem.

use kinopt::Problem;
use kinopt::model::FrameId;
use kinopt::task::{Point, Quantity, Ray, Task};

use super::answer::AskedTask;
use super::arguments::Arguments;
use super::base::Base;
use super::bystanders::bystanders;
use super::held::Held;
use super::weights::Weights;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// All that is asked at once.
pub(super) struct Asked {
    pub(super) problem: Problem,
    /// In the order of the problem's tasks.
    pub(super) tasks: Vec<AskedTask>,
    /// Coordinates that no task feels.
    pub(super) bystanders: Vec<usize>,
}

/// The targets, the rays, and what is held as it stands at `start`.
pub(super) fn asked(loaded: &LoadedModel, arguments: &Arguments, start: &[f64]) -> Outcome<Asked> {
    let mut builder = Problem::builder(&loaded.model);
    let (length, angle) = arguments.tolerances(loaded);
    builder
        .derivatives(arguments.derivatives())
        .tolerance(Quantity::Metres, length)
        .tolerance(Quantity::Radians, angle);
    let base = Base::named(loaded, arguments.base.as_deref())?;

    let mut taken: Vec<(String, FrameId)> = Vec::new();
    let named = arguments.targets.iter().map(|target| &target.frame);
    for name in named.chain(arguments.rays.iter().map(|ray| &ray.frame)) {
        taken.push((name.clone(), loaded.target_frame(name, BareName::Tip)?));
    }
    let dragged: Vec<FrameId> = taken.iter().map(|(_, frame)| *frame).collect();
    let held = Held::of(loaded, arguments, &dragged)?;
    builder.parameters(held.parameters(loaded, start)?);
    let posture = held.posture(loaded, start);
    let all = [taken, held.tips.clone()].concat();
    let weights = Weights::of(loaded, &arguments.weights, &all)?;

    let mut asked = Vec::new();
    let mut taken: Vec<FrameId> = Vec::new();
    for target in &arguments.targets {
        let frame = loaded.target_frame(&target.frame, BareName::Tip)?;
        let name = (format!("target {}", target.frame), weights.weight(frame));
        let turns = target.quaternion.is_some() && !arguments.position_only;
        base.add_target(&mut builder, frame, target.placement(), turns, name);
        taken.push(frame);
        asked.push(AskedTask {
            frame: target.frame.clone(),
            held: false,
        });
    }
    for ray in &arguments.rays {
        let frame = loaded.target_frame(&ray.frame, BareName::Tip)?;
        let task = Task::new(Ray::new(frame, ray.eye, ray.through)).times(weights.weight(frame));
        builder.add(task.named(format!("ray {}", ray.frame)));
        taken.push(frame);
        asked.push(AskedTask {
            frame: ray.frame.clone(),
            held: false,
        });
    }
    let placements = loaded.all_frames(start);
    for (name, frame) in held.tips {
        let Some(placed) = placements.get(frame.index()) else {
            continue;
        };
        let point = Task::new(Point::new(frame, placed.translation));
        let point = point.times(weights.weight(frame));
        builder.add(point.named(format!("hold {name}")));
        asked.push(AskedTask {
            frame: name,
            held: true,
        });
    }
    // After what was asked for, in whose order the answer is told.
    for posture in posture {
        builder.add(posture);
    }
    taken.extend(base.moving_frame());
    Ok(Asked {
        problem: builder.build()?,
        tasks: asked,
        bystanders: bystanders(loaded, &taken),
    })
}
