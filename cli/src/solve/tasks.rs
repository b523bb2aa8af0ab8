//! What is asked, as tasks of a problem.

use kinopt::Problem;
use kinopt::model::FrameId;
use kinopt::spatial::{Placement, Quaternion, Vector3};
use kinopt::task::{Point, Pose, Quantity, Ray, Task};

use super::Arguments;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// How a task came about, in the order of the problem's tasks.
#[derive(Clone, Debug)]
pub(super) struct AskedTask {
    /// The frame as it was typed; for a held tip the bone's name.
    pub(super) frame: String,
    /// A pinned tip that is kept where it was, rather than something asked for.
    pub(super) held: bool,
}

/// The targets, the rays, and the pinned tips as they stand at `start`.
pub(super) fn problem(
    loaded: &LoadedModel,
    arguments: &Arguments,
    start: &[f64],
) -> Outcome<(Problem, Vec<AskedTask>)> {
    let mut builder = Problem::builder(&loaded.model);
    let (length, angle) = match arguments.tolerance {
        Some(tolerance) => (tolerance, tolerance),
        None => loaded.default_tolerances(),
    };
    builder
        .tolerance(Quantity::Metres, length)
        .tolerance(Quantity::Radians, angle);

    let mut asked = Vec::new();
    let mut taken: Vec<FrameId> = Vec::new();
    for target in &arguments.targets {
        let frame = loaded.frame(&target.frame, BareName::Tip)?;
        let name = format!("target {}", target.frame);
        let position = Vector3::from(target.position);
        match target.quaternion {
            None => {
                builder.add(Task::new(Point::new(frame, position)).named(name));
            }
            Some([w, x, y, z]) => {
                let turn = Quaternion {
                    w,
                    v: Vector3::new(x, y, z),
                };
                let placement = Placement::new(turn.to_matrix(), position);
                builder.add(Task::new(Pose::new(frame, placement)).named(name));
            }
        }
        taken.push(frame);
        asked.push(AskedTask {
            frame: target.frame.clone(),
            held: false,
        });
    }
    for ray in &arguments.rays {
        let frame = loaded.frame(&ray.frame, BareName::Tip)?;
        let task = Task::new(Ray::new(frame, ray.eye, ray.through));
        builder.add(task.named(format!("ray {}", ray.frame)));
        taken.push(frame);
        asked.push(AskedTask {
            frame: ray.frame.clone(),
            held: false,
        });
    }
    if !arguments.free {
        for (name, frame, position) in held_tips(loaded, &taken, start) {
            builder.add(Task::new(Point::new(frame, position)).named(format!("hold {name}")));
            asked.push(AskedTask {
                frame: name,
                held: true,
            });
        }
    }
    Ok((builder.build()?, asked))
}

/// Where the pinned tips that nothing else is asked of stand at the start.
fn held_tips(
    loaded: &LoadedModel,
    taken: &[FrameId],
    start: &[f64],
) -> Vec<(String, FrameId, Vector3<f64>)> {
    let Some(rig) = &loaded.rig else {
        return Vec::new();
    };
    let pose = rig.skeleton.pose(start);
    let pinned = rig.constrained.iter().filter_map(|&bone| {
        let tip = rig.skeleton.tip(bone);
        let name = rig.skeleton.bones().get(bone.index())?.name.clone();
        (!taken.contains(&tip)).then(|| (name, tip, pose.tip(&rig.skeleton, bone)))
    });
    pinned.collect()
}
