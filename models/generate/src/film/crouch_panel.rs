//! Drag of the humanoid's left hand: down, ahead, up and back, with both feet flat and in balance.

use std::path::Path;

use glam::DVec3;
use kinopt::io::rig::Rig;
use kinopt::spatial::Vector3;

use super::FRAMES;
use super::panel::{Panel, PanelFrame};
use crate::Failure;
use crate::crouching::{Crouch, EYE_OFFSET, body};
use crate::picture::POSED;
use crate::render::{View, linear};
use crate::skin::add_placed;

/// Positions of the hand, metres. The hand starts and ends in the crouched configuration.
const KEYS: [[f64; 3]; 3] = [[0.4, 0.3, 0.35], [0.85, 0.2, 0.8], [0.75, 0.2, 1.75]];
/// Frames of the drag for each frame of the film.
const STEPS: usize = 4;
/// Number of rounds of the hand. The film shows the last one, which ends as it starts.
const ROUNDS: usize = 3;

/// Returns the position of the target after a share of the round.
fn target(start: Vector3<f64>, share: f64) -> Vector3<f64> {
    let [down, ahead, up] = KEYS.map(Vector3::from);
    let keys = [start, down, ahead, up, start];
    let progress = share * (keys.len() - 1) as f64;
    let key = (progress as usize).min(keys.len() - 2);
    let fraction = progress - key as f64;
    let eased = fraction * fraction * (3.0 - 2.0 * fraction);
    keys[key] + (keys[key + 1] - keys[key]) * eased
}

/// Solves and meshes the panel.
pub(super) fn panel(root: &Path) -> Result<Panel, Failure> {
    let rig = Rig::read(root.join("models/humanoid/humanoid.json"))?;
    let body = body(&rig, &root.join("models/humanoid/cones.json"))?;
    let mut crouch = Crouch::new(&rig, &body)?;
    let start = crouch.start;
    let mut frames = Vec::new();
    for round in 0..ROUNDS {
        for step in 0..FRAMES * STEPS {
            let target = target(start, step as f64 / (FRAMES * STEPS) as f64);
            crouch.advance(target)?;
            if round + 1 < ROUNDS || step % STEPS > 0 {
                continue;
            }
            let mut frame = PanelFrame::new();
            let placements = body.pose(crouch.drag.q())?;
            add_placed(
                &mut frame.scene,
                &rig,
                &placements,
                DVec3::ZERO,
                linear(POSED),
            )?;
            frame.targets.push(DVec3::from(target));
            frames.push(frame);
        }
    }
    let centre = DVec3::new(0.2, 0.0, 0.92);
    Ok(Panel::new(
        View::new(centre + EYE_OFFSET, centre, 2.05),
        frames,
    ))
}
