//! Parts of a robot and obstacles of a world, combined for checks.

use std::sync::Arc;

use super::CheckerError;
use super::motion_bound::MotionBound;
use super::placed_shapes::{PartShape, PlacedShapes, part_to_part};
use super::scene_placements::SceneWorkspace;
use super::sphere_cover::{Cover, PlacedCover};
use super::touches::Touches;
use crate::clock::deadline::is_over;
use crate::collision::dynamic_aabb_tree::ChangingTree;
use crate::collision::model::Bodies;
use crate::collision::world::Change;
use crate::collision::{
    BoundingBox, CollisionModel, Obstacle, Separation, Shape, SphereModel, World, separation_within,
};
use crate::model::{FrameId, FrameRef};
use crate::problem::BodyKind;
use crate::spatial::{Placement, Vector3};

/// Number of the first plane of a model; numbers of obstacles are smaller.
pub(crate) const FIRST_PLANE: u64 = 1 << 63;

/// Shapes that move with one frame: those of a link, or of an attached obstacle.
#[derive(Clone, Debug)]
pub(super) struct Part {
    name: String,
    kind: BodyKind,
    frame: FrameId,
    pub(super) shapes: Vec<PartShape>,
    /// Spheres that cover all shapes, if set.
    cover: Option<Cover>,
    /// Sorted numbers of the model's planes and the obstacles that it may touch.
    passes: Vec<u64>,
}

/// A checked pair, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// A part and a fixed obstacle.
    Standing(usize, usize),
    /// Two parts.
    Parts(usize, usize),
}

/// All parts and fixed obstacles, with the checked pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    pub(super) parts: Arc<Vec<Part>>,
    /// End of each part's range among all shapes.
    pub(super) shape_ends: Arc<[usize]>,
    /// Checked pairs of parts, by index.
    pairs: Arc<[[usize; 2]]>,
    motion_bound: Arc<MotionBound>,
    /// Fixed obstacles, by their numbers in the world.
    standing: ChangingTree<Arc<Obstacle>>,
}

impl Scene {
    pub(super) fn new(model: &CollisionModel, world: &World) -> Result<Self, CheckerError> {
        let planes = model.planes().iter().map(|plane| &plane.obstacle);
        let all = world.numbered().chain((FIRST_PLANE..).zip(planes));
        let standing = all.filter_map(|(number, obstacle)| {
            let (obstacle, bounds) = standing(obstacle)?;
            Some((number, obstacle, bounds))
        });
        let scene = Self {
            standing: ChangingTree::new(standing),
            ..Self::default()
        };
        scene.with_attached(model, world)
    }

    /// A copy after changes of the world that do not affect attached obstacles.
    pub(super) fn changed(&self, changes: &[Change<'_>]) -> Self {
        let changes = changes.iter();
        let changes = changes.map(|change| (change.number, change.after.and_then(standing)));
        Self {
            standing: self.standing.changed(changes.collect()),
            ..self.clone()
        }
    }

    /// A copy with the parts of a model, without sphere covers, and the attached obstacles of a world.
    pub(super) fn with_attached(
        self,
        model: &CollisionModel,
        world: &World,
    ) -> Result<Self, CheckerError> {
        let link = |link: &FrameId| Part {
            name: model.name_of(*link).to_owned(),
            kind: BodyKind::Link,
            frame: *link,
            shapes: (model.objects_of(*link))
                .map(|object| PartShape::new(object.shape.clone(), object.link_from_shape))
                .collect(),
            cover: None,
            passes: passes(model, *link),
        };
        let mut parts: Vec<Part> = model.links().iter().map(link).collect();
        let own = parts.len();
        for obstacle in world.attached() {
            let Some(frame) = &obstacle.attached else {
                continue;
            };
            let frame = FrameRef::from(frame.as_str()).resolve(model.model());
            let frame = frame.map_err(|unknown| CheckerError::Attached {
                obstacle: obstacle.name.clone(),
                unknown,
            })?;
            parts.push(Part {
                name: obstacle.name.clone(),
                kind: BodyKind::Obstacle,
                frame,
                shapes: vec![PartShape::new(obstacle.shape.clone(), obstacle.placement)],
                cover: None,
                passes: passes(model, frame),
            });
        }
        let touches = Touches::of(model, world)?;
        for part in &mut parts {
            touches.add_passes(&part.name, &mut part.passes);
        }
        let pairs = pairs(model, &parts, own, &touches);
        let ends = parts.iter().scan(0, |end, part| {
            *end += part.shapes.len();
            Some(*end)
        });
        Ok(Self {
            shape_ends: ends.collect(),
            pairs: pairs.into(),
            motion_bound: Arc::new(MotionBound::new(
                model.model(),
                parts.iter().map(Part::balls),
            )),
            parts: Arc::new(parts),
            standing: self.standing,
        })
    }

    /// A copy with spheres that cover the links' shapes.
    pub(super) fn covered_by(mut self, spheres: &SphereModel) -> Self {
        let parts = Arc::make_mut(&mut self.parts);
        for group in spheres.groups() {
            let mut own = parts.iter_mut();
            if let Some(part) = own.find(|part| part.frame == group.link) {
                part.cover = Some(Cover::of(group));
            }
        }
        self
    }

    /// Frames of the parts.
    pub(super) fn frames(&self) -> impl ExactSizeIterator<Item = FrameId> + '_ {
        self.parts.iter().map(|part| part.frame)
    }

    /// Names and kinds of both bodies of a pair.
    pub(super) fn bodies(&self, pair: Pair) -> [(&str, BodyKind); 2] {
        let part = |at: usize| (&*self.parts[at].name, self.parts[at].kind);
        match pair {
            Pair::Standing(a, b) => {
                let standing = self.standing.thing(b as u32);
                let kind = match self.standing.number(b as u32) {
                    number if number < FIRST_PLANE => BodyKind::Obstacle,
                    _ => BodyKind::Link,
                };
                [part(a), (&standing.name, kind)]
            }
            Pair::Parts(a, b) => [part(a), part(b)],
        }
    }

    /// Sorted numbers of the fixed solids that a part may touch.
    pub(super) fn passes(&self, part: usize) -> &[u64] {
        &self.parts[part].passes
    }

    getters! {
        /// Checked pairs of parts, by index.
        pub(super) fn pairs(&self) -> &[[usize; 2]] = &self.pairs;
        pub(super) fn motion_bound(&self) -> &MotionBound = &self.motion_bound;
    }

    /// Visits all pairs at most `within` metres apart, each with its closest shapes. Stops if `each` returns false or
    /// the time is [over](crate::clock::deadline).
    pub(super) fn visit(
        &self,
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneWorkspace,
        mut each: impl FnMut(Pair, &Separation) -> bool,
    ) {
        self.begin(room);
        for part in 0..self.parts.len() {
            if is_over() {
                return;
            }
            self.find_standing(part, placements, within, room);
            for (standing, separation) in &room.near {
                if !each(Pair::Standing(part, *standing as usize), separation) {
                    return;
                }
            }
        }
        for &pair in &*self.pairs {
            if is_over() {
                return;
            }
            if let Some(separation) = self.apart(pair, placements, within, room)
                && !each(Pair::Parts(pair[0], pair[1]), &separation)
            {
                return;
            }
        }
    }

    /// Finds the fixed obstacles at most `within` metres from a part. Writes each with the separation of its closest
    /// shape to `room.near`.
    pub(super) fn find_standing(
        &self,
        part: usize,
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneWorkspace,
    ) {
        room.near.clear();
        if self.standing.is_empty() {
            return;
        }
        self.place(part, placements, room);
        let SceneWorkspace { shapes, near, .. } = room;
        let placed = (&*self.parts[part].shapes, &shapes[self.shapes_of(part)]);
        self.near(placed, within, |standing, separation| {
            match near.iter_mut().find(|(known, _)| *known == standing) {
                Some((_, known)) if known.distance <= separation.distance => {}
                Some((_, known)) => *known = separation,
                None => near.push((standing, separation)),
            }
        });
        let passes = &self.parts[part].passes;
        if !passes.is_empty() {
            let passed = |standing| {
                passes
                    .binary_search(&self.standing.number(standing))
                    .is_ok()
            };
            near.retain(|(standing, _)| !passed(*standing));
        }
        near.sort_by_key(|(standing, _)| self.standing.number(*standing));
    }

    /// The separation of two parts, if it is at most `within` metres.
    pub(super) fn apart(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneWorkspace,
    ) -> Option<Separation> {
        if !self.covers_meet([a, b], placements, within, &mut room.covers) {
            return None;
        }
        self.apart_by_shapes([a, b], placements, within, room)
    }

    /// True if the sphere covers of two parts are within `within` metres, or if a cover is missing.
    pub(super) fn covers_meet(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        within: f64,
        covers: &mut [PlacedCover],
    ) -> bool {
        let (Some(first), Some(second)) = (&self.parts[a].cover, &self.parts[b].cover) else {
            return true;
        };
        let at = [&placements[a], &placements[b]];
        covers[a].place(first, at[0]);
        covers[b].place(second, at[1]);
        if !covers[a].meets(&covers[b], within) {
            return false;
        }
        covers[a].place_spheres(first, at[0]);
        covers[b].place_spheres(second, at[1]);
        !covers[a].is_apart(&covers[b], within)
    }

    /// The separation of two parts if it is at most `within` metres, without a test of the sphere covers.
    pub(super) fn apart_by_shapes(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneWorkspace,
    ) -> Option<Separation> {
        self.place(a, placements, room);
        self.place(b, placements, room);
        let placed = |part: usize| {
            let own = &*self.parts[part].shapes;
            (own, &room.shapes[self.shapes_of(part)])
        };
        part_to_part(placed(a), placed(b), within)
    }

    /// Shape and placement of a fixed obstacle.
    pub(super) fn standing_at(&self, index: usize) -> (&Shape, &Placement<f64>) {
        let standing = self.standing.thing(index as u32);
        (&standing.shape, &standing.placement)
    }

    /// Visits the fixed obstacles at most `within` metres from a part's shapes.
    fn near(
        &self,
        (shapes, placed): PlacedShapes<'_>,
        within: f64,
        mut each: impl FnMut(u32, Separation),
    ) {
        for (own, at) in shapes.iter().zip(placed) {
            let reach = own.ball.radius + within;
            let apart = |bounds: &BoundingBox| bounds.squared_distance(at.centre);
            // The bound never decreases: the search visits all boxes that the ball meets.
            self.standing
                .nearest((reach * reach).next_up(), apart, |index, bound| {
                    if is_over() {
                        return f64::NEG_INFINITY;
                    }
                    // The leaves of the tree hold several.
                    let bounds = self.standing.bounds(index);
                    if bounds.squared_distance(at.centre) > reach * reach {
                        return bound;
                    }
                    let standing = self.standing.thing(index);
                    let separation = separation_within(
                        &own.shape,
                        &at.world_from_shape,
                        &standing.shape,
                        &standing.placement,
                        within,
                    );
                    if let Some(separation) = separation {
                        each(index, separation);
                    }
                    bound
                });
        }
    }
}

/// A fixed obstacle with its bounding box in the world; `None` for attached obstacles.
fn standing(obstacle: &Arc<Obstacle>) -> Option<(Arc<Obstacle>, BoundingBox)> {
    let bounds = obstacle.shape.bounding_box().placed(&obstacle.placement);
    obstacle
        .attached
        .is_none()
        .then(|| (Arc::clone(obstacle), bounds))
}

/// Numbers of the planes that the shapes on a frame may penetrate.
fn passes(model: &CollisionModel, frame: FrameId) -> Vec<u64> {
    let planes = (FIRST_PLANE..).zip(model.planes());
    let passed = planes.filter(|(_, plane)| !plane.holds(model.model(), frame));
    passed.map(|(number, _)| number).collect()
}

impl Part {
    /// The frame, and bounding balls of the shapes in the frame.
    fn balls(&self) -> (FrameId, Vec<(Vector3<f64>, f64)>) {
        let ball = |own: &PartShape| {
            let middle = own.part_from_shape.apply(own.ball.centre);
            (middle, own.ball.radius)
        };
        (self.frame, self.shapes.iter().map(ball).collect())
    }
}

/// Checked pairs of parts: enabled pairs of links, and attached obstacles with all parts that cannot hold them.
fn pairs(
    model: &CollisionModel,
    parts: &[Part],
    own: usize,
    touches: &Touches<'_>,
) -> Vec<[usize; 2]> {
    let place = |frame: FrameId| parts[..own].iter().position(|part| part.frame == frame);
    let links = model.pairs().iter();
    let mut pairs: Vec<[usize; 2]> = links
        .filter_map(|[a, b]| Some([place(*a)?, place(*b)?]))
        .collect();
    let frames: Vec<FrameId> = parts.iter().map(|part| part.frame).collect();
    let bodies = Bodies::new(model.model(), &frames);
    for attached in own..parts.len() {
        // A body cannot hold an obstacle if it only carries the holding body, as a forearm carries its hand.
        let kept = (0..attached).filter(|&other| {
            bodies.are_apart(other, attached)
                || other < own && bodies.is_above_alone(other, attached)
        });
        let kept = kept.filter(|&other| !touches.may(&parts[other].name, &parts[attached].name));
        pairs.extend(kept.map(|other| [other, attached]));
    }
    pairs
}
