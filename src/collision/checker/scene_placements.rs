//! Placements of a scene's parts, computed on demand.

use std::ops::Range;

use super::parts::Scene;
use super::placed_shapes::{Placed, PlacedShapes};
use super::sphere_cover::PlacedCover;
use crate::collision::Separation;
use crate::spatial::Placement;

/// Workspace of checks at one configuration after another: the shapes and covers placed so far, and the obstacles near
/// a part.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneWorkspace {
    pub(super) shapes: Vec<Placed>,
    /// True for each part whose shapes are placed.
    has_shapes: Vec<bool>,
    pub(super) covers: Vec<PlacedCover>,
    /// Fixed obstacles near a part, by index.
    pub(super) near: Vec<(u32, Separation)>,
}

impl Scene {
    /// Starts a new configuration: no part is placed.
    pub(super) fn begin(&self, room: &mut SceneWorkspace) {
        room.has_shapes.clear();
        room.has_shapes.resize(self.parts.len(), false);
        let count = self.shape_ends.last().copied().unwrap_or(0);
        room.shapes.resize(count, Placed::nowhere());
        room.covers
            .resize_with(self.parts.len(), PlacedCover::default);
        for cover in &mut room.covers {
            cover.forget();
        }
    }

    /// The shapes of a part with their placements.
    pub(super) fn placed<'a>(
        &'a self,
        part: usize,
        placements: &[Placement<f64>],
        room: &'a mut SceneWorkspace,
    ) -> PlacedShapes<'a> {
        self.place(part, placements, room);
        (&self.parts[part].shapes, &room.shapes[self.shapes_of(part)])
    }

    /// Computes the placements of a part's shapes on first use.
    pub(super) fn place(
        &self,
        part: usize,
        placements: &[Placement<f64>],
        room: &mut SceneWorkspace,
    ) {
        if !std::mem::replace(&mut room.has_shapes[part], true) {
            let own = &self.parts[part].shapes;
            let places = room.shapes[self.shapes_of(part)].iter_mut();
            for (place, own) in places.zip(own) {
                *place = own.placed(&placements[part]);
            }
        }
    }

    /// Range of a part's shapes among all shapes.
    pub(super) fn shapes_of(&self, part: usize) -> Range<usize> {
        let end = |part: usize| self.shape_ends[part];
        part.checked_sub(1).map_or(0, end)..end(part)
    }
}
