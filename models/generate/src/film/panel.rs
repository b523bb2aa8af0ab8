//! Panel of the film: a view, and one scene per frame.

use glam::DVec3;

use crate::picture::{PAPER, ring};
use crate::render::{Image, Quality, Scene, View, linear, render};

const QUALITY: Quality = Quality {
    samples: 3,
    paper_samples: 1,
    sky: 96,
    sun: 16,
    texels: 700,
};

/// Scene of one frame, and the targets that are marked in it.
pub(super) struct PanelFrame {
    pub(super) scene: Scene,
    pub(super) targets: Vec<DVec3>,
}

impl PanelFrame {
    /// A frame without targets on an empty paper.
    pub(super) fn new() -> Self {
        Self {
            scene: Scene {
                paper: linear(PAPER),
                ..Scene::default()
            },
            targets: Vec::new(),
        }
    }
}

/// View and frames of a panel.
pub(super) struct Panel {
    view: View,
    frames: Vec<PanelFrame>,
}

impl Panel {
    /// Creates a panel whose scenes have equal bounds, so that the light on resting parts is equal in all frames.
    pub(super) fn new(view: View, mut frames: Vec<PanelFrame>) -> Self {
        let all = || frames.iter().flat_map(|frame| &frame.scene.positions);
        let low = all().fold(DVec3::INFINITY, |low, p| low.min(*p));
        let high = all().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
        for frame in &mut frames {
            frame.scene.extend_bounds(low, high);
        }
        Self { view, frames }
    }

    pub(super) fn render(&self, frame: usize, size: [usize; 2]) -> Image {
        let PanelFrame { scene, targets } = &self.frames[frame];
        let mut image = render(scene, &self.view, size, QUALITY);
        for &target in targets {
            ring(&mut image, &self.view, target);
        }
        image
    }
}
