//! Promise: a target moved by a small step within the residual, by which solutions are differentiated, is where the
//! task's own setter puts it.
#![allow(clippy::unwrap_used)]

use kinopt::model::{JointId, Model};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{Gaze, Point, Residual};

fn same<R: Residual>(task: &R, moved: &R, step: &[f64]) {
    let placed = Placement::new(
        rotation_exp(Vector3::new(0.4, -0.3, 0.8)),
        Vector3::new(0.2, 0.5, -0.1),
    );
    let frames = vec![placed; task.frames().len()];
    let rows: usize = task.rows().iter().map(|rows| rows.count).sum();
    let mut own = vec![0.0; rows];
    let [mut by_step, mut by_setter] = [own.clone(), own.clone()];
    task.evaluate(&frames, &[], &mut own);
    task.evaluate_moved(&frames, &[], step, &mut by_step);
    moved.evaluate(&frames, &[], &mut by_setter);
    let off = |a: &[f64], b: &[f64]| {
        let pairs = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        pairs.fold(0.0, f64::max)
    };
    let kind = task.kind();
    assert!(off(&own, &by_step) > 1e-6, "{kind}: {own:?} {by_step:?}");
    assert!(
        off(&by_step, &by_setter) < 1e-12,
        "{kind}: {by_step:?} {by_setter:?}"
    );
}

#[test]
fn places_and_directions_are_moved_by_the_step_itself() {
    let mut builder = Model::builder("eye");
    let frame = builder.frame("eye", None::<JointId>, Placement::identity());
    builder.build().unwrap();
    let (target, step) = (Vector3::new(1.0, 0.5, 2.0), [1e-3, -2e-3, 3e-3]);
    let there = target + Vector3::from(step);
    let axis = [1.0, 0.2, 0.0];
    for gaze in [
        Gaze::at(frame, axis, target, 0.1),
        Gaze::along(frame, axis, target, 0.1),
    ] {
        let mut moved = gaze;
        moved.set_target(there);
        same(&gaze, &moved, &step);
    }
    same(&Point::new(frame, target), &Point::new(frame, there), &step);
}
