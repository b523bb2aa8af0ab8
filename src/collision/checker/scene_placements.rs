//! Where the parts of a scene stand, as far as anybody asked.

use std::ops::Range;

use super::parts::Scene;
use super::placed_shapes::{Placed, PlacedShapes};
use super::sphere_cover::PlacedCover;
use crate::collision::Separation;
use crate::spatial::Placement;

/// Memory for checks of one configuration after another: what was placed by now, as most is told apart before, and what a part is near to.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneRoom {
    pub(super) shapes: Vec<Placed>,
    /// By part, whether its shapes are there.
    has_shapes: Vec<bool>,
    pub(super) covers: Vec<PlacedCover>,
    /// What stands near a part, by place.
    pub(super) near: Vec<(u32, Separation)>,
}

impl Scene {
    /// Forgets where anything stood.
    pub(super) fn begin(&self, room: &mut SceneRoom) {
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

    /// The shapes of a part where they stand.
    pub(super) fn placed<'a>(
        &'a self,
        part: usize,
        placements: &[Placement<f64>],
        room: &'a mut SceneRoom,
    ) -> PlacedShapes<'a> {
        self.place(part, placements, room);
        (&self.parts[part].shapes, &room.shapes[self.shapes_of(part)])
    }

    /// Places the shapes of a part, once.
    pub(super) fn place(&self, part: usize, placements: &[Placement<f64>], room: &mut SceneRoom) {
        if !std::mem::replace(&mut room.has_shapes[part], true) {
            let own = &self.parts[part].shapes;
            let places = room.shapes[self.shapes_of(part)].iter_mut();
            for (place, own) in places.zip(own) {
                *place = own.placed(&placements[part]);
            }
        }
    }

    /// Where a part's shapes are among those of all.
    pub(super) fn shapes_of(&self, part: usize) -> Range<usize> {
        let end = |part: usize| self.shape_ends[part];
        part.checked_sub(1).map_or(0, end)..end(part)
    }
}
