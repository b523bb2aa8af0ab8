//! Placements of a scene's parts, computed on demand.

use std::ops::Range;

use super::parts::Scene;
use super::placed_shapes::{PlacedShape, PlacedShapes};
use super::sphere_cover::PlacedCover;
use crate::collision::Separation;
use kinopt_kinematics::spatial::Placement;

/// Workspace of checks at one configuration after another: the shapes and covers placed so far, and the obstacles near
/// a part.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneWorkspace {
    pub(super) shapes: Vec<PlacedShape>,
    /// True for each part whose shapes are placed.
    has_shapes: Vec<bool>,
    pub(super) covers: Vec<PlacedCover>,
    /// Fixed obstacles near a part, by index.
    pub(super) near: Vec<(u32, Separation)>,
}

impl Scene {
    /// Starts a new configuration: no part is placed.
    pub(super) fn begin(&self, workspace: &mut SceneWorkspace) {
        workspace.has_shapes.clear();
        workspace.has_shapes.resize(self.parts.len(), false);
        let count = self.shape_ends.last().copied().unwrap_or(0);
        workspace.shapes.resize(count, PlacedShape::unplaced());
        workspace
            .covers
            .resize_with(self.parts.len(), PlacedCover::default);
        for cover in &mut workspace.covers {
            cover.reset();
        }
    }

    /// The shapes of a part with their placements.
    pub(super) fn placed<'a>(
        &'a self,
        part: usize,
        placements: &[Placement<f64>],
        workspace: &'a mut SceneWorkspace,
    ) -> PlacedShapes<'a> {
        self.place(part, placements, workspace);
        (
            &self.parts[part].shapes,
            &workspace.shapes[self.shapes_of(part)],
        )
    }

    /// Computes the placements of a part's shapes on first use.
    pub(super) fn place(
        &self,
        part: usize,
        placements: &[Placement<f64>],
        workspace: &mut SceneWorkspace,
    ) {
        if !std::mem::replace(&mut workspace.has_shapes[part], true) {
            let shapes = &self.parts[part].shapes;
            let placed_shapes = workspace.shapes[self.shapes_of(part)].iter_mut();
            for (placed, shape) in placed_shapes.zip(shapes) {
                *placed = shape.placed(&placements[part]);
            }
        }
    }

    /// Range of a part's shapes among all shapes.
    pub(super) fn shapes_of(&self, part: usize) -> Range<usize> {
        let end = |part: usize| self.shape_ends[part];
        part.checked_sub(1).map_or(0, end)..end(part)
    }
}
