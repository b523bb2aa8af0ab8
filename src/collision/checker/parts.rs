//! The parts of a robot and the obstacles of a world, put together.

use std::sync::Arc;

use super::CheckerError;
use super::motion_bound::MotionBound;
use super::placed_shapes::{PartShape, PlacedShapes, part_to_part};
use super::scene_placements::SceneRoom;
use super::sphere_cover::{Cover, PlacedCover};
use super::touches::Touches;
use crate::clock::cut_short::is_over;
use crate::collision::changing_tree::ChangingTree;
use crate::collision::model::Bodies;
use crate::collision::world::Change;
use crate::collision::{
    BoundingBox, CollisionModel, Obstacle, Separation, Shape, SphereModel, World, separation_within,
};
use crate::model::{FrameId, FrameRef};
use crate::problem::BodyKind;
use crate::spatial::{Placement, Vector3};

/// The numbers of a model's planes, beyond those of any world.
pub(crate) const FIRST_PLANE: u64 = 1 << 63;

/// What moves with one frame.
#[derive(Clone, Debug)]
pub(super) struct Part {
    name: String,
    kind: BodyKind,
    frame: FrameId,
    pub(super) shapes: Vec<PartShape>,
    /// Around all of its shapes, where that was given.
    cover: Option<Cover>,
    /// The numbers of what stands that it may touch, in order: of the model's planes, and of obstacles.
    passes: Vec<u64>,
}

/// Two of them, by place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// A part, and something that stands.
    Standing(usize, usize),
    /// Two parts.
    Parts(usize, usize),
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    pub(super) parts: Arc<Vec<Part>>,
    /// Where the shapes of each part end, among those of all.
    pub(super) shape_ends: Arc<[usize]>,
    /// Parts that are kept apart, by place.
    pairs: Arc<[[usize; 2]]>,
    motion_bound: Arc<MotionBound>,
    /// What stands in the world, by the numbers that it has there.
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

    /// The same after changes of the world, none of them of what is attached.
    pub(super) fn changed(&self, changes: &[Change<'_>]) -> Self {
        let changes = changes.iter();
        let changes = changes.map(|change| (change.number, change.after.and_then(standing)));
        Self {
            standing: self.standing.changed(changes.collect()),
            ..self.clone()
        }
    }

    /// The same with the parts of a model, without the spheres that cover them, and with what is attached in a world.
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

    /// The same with spheres that cover the links' shapes, which tell most pairs apart before the shapes are looked at.
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

    /// The frames that carry the parts.
    pub(super) fn frames(&self) -> impl ExactSizeIterator<Item = FrameId> + '_ {
        self.parts.iter().map(|part| part.frame)
    }

    /// The names of both, and what they are.
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

    /// The numbers of what stands that the part may touch, in order.
    pub(super) fn passes(&self, part: usize) -> &[u64] {
        &self.parts[part].passes
    }

    getters! {
        /// The parts that are kept apart, by place.
        pub(super) fn pairs(&self) -> &[[usize; 2]] = &self.pairs;
        pub(super) fn motion_bound(&self) -> &MotionBound = &self.motion_bound;
    }

    /// Visits all pairs that are at most `within` apart, each by its shapes that are nearest, until told to stop or
    /// [cut short](crate::clock::cut_short).
    pub(super) fn visit(
        &self,
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneRoom,
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

    /// Finds what stands at most `within` from a part, each by the shape that is nearest to it, into the room.
    pub(super) fn find_standing(
        &self,
        part: usize,
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneRoom,
    ) {
        room.near.clear();
        if self.standing.is_empty() {
            return;
        }
        self.place(part, placements, room);
        let SceneRoom { shapes, near, .. } = room;
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

    /// How far two parts are apart, if that is at most `within`.
    pub(super) fn apart(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneRoom,
    ) -> Option<Separation> {
        if !self.covers_meet([a, b], placements, within, &mut room.covers) {
            return None;
        }
        self.apart_by_shapes([a, b], placements, within, room)
    }

    /// Whether the spheres around two parts meet, or may as there are none.
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

    /// How far two parts are apart, if that is at most `within`, whatever their spheres say.
    pub(super) fn apart_by_shapes(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        within: f64,
        room: &mut SceneRoom,
    ) -> Option<Separation> {
        self.place(a, placements, room);
        self.place(b, placements, room);
        let placed = |part: usize| {
            let own = &*self.parts[part].shapes;
            (own, &room.shapes[self.shapes_of(part)])
        };
        part_to_part(placed(a), placed(b), within)
    }

    /// Something that stands, and where.
    pub(super) fn standing_at(&self, index: usize) -> (&Shape, &Placement<f64>) {
        let standing = self.standing.thing(index as u32);
        (&standing.shape, &standing.placement)
    }

    /// Visits what stands at most `within` from a part's shapes.
    fn near(
        &self,
        (shapes, placed): PlacedShapes<'_>,
        within: f64,
        mut each: impl FnMut(u32, Separation),
    ) {
        for (own, at) in shapes.iter().zip(placed) {
            let reach = own.ball.radius + within;
            let apart = |bounds: &BoundingBox| bounds.squared_distance(at.centre);
            // Nothing is ever nearer than the bound: all whose boxes the ball meets are visited.
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

/// An obstacle that stands in the world, and the box around it there.
fn standing(obstacle: &Arc<Obstacle>) -> Option<(Arc<Obstacle>, BoundingBox)> {
    let bounds = obstacle.shape.bounding_box().placed(&obstacle.placement);
    obstacle
        .attached
        .is_none()
        .then(|| (Arc::clone(obstacle), bounds))
}

/// The numbers of the planes that what is on a frame may be through.
fn passes(model: &CollisionModel, frame: FrameId) -> Vec<u64> {
    let planes = (FIRST_PLANE..).zip(model.planes());
    let passed = planes.filter(|(_, plane)| !plane.holds(model.model(), frame));
    passed.map(|(number, _)| number).collect()
}

impl Part {
    /// Its frame, and balls around its shapes there.
    fn balls(&self) -> (FrameId, Vec<(Vector3<f64>, f64)>) {
        let ball = |own: &PartShape| {
            let middle = own.part_from_shape.apply(own.ball.centre);
            (middle, own.ball.radius)
        };
        (self.frame, self.shapes.iter().map(ball).collect())
    }
}

/// Parts that are kept apart: links as the model has it, attached obstacles from all but what may hold them.
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
        // Where a body carries the holding one and no other, as a forearm its hand, it does not hold.
        let kept = (0..attached).filter(|&other| {
            bodies.are_apart(other, attached)
                || other < own && bodies.is_above_alone(other, attached)
        });
        let kept = kept.filter(|&other| !touches.may(&parts[other].name, &parts[attached].name));
        pairs.extend(kept.map(|other| [other, attached]));
    }
    pairs
}
