//! Parts of a robot and obstacles of a world, combined for checks.

use std::sync::Arc;

use super::allowed_collisions::AllowedCollisions;
use super::motion_bound::ChainMotionBound;
use super::placed_shapes::{PartShape, PlacedShapes, part_to_part};
use super::scene_placements::SceneWorkspace;
use super::sphere_cover::{PartCover, PlacedCover};
use crate::collision::WorldError;
use crate::collision::dynamic_aabb_tree::DynamicAabbTree;
use crate::collision::model::Bodies;
use crate::collision::world::Change;
use crate::collision::{
    BoundingBox, CollisionModel, Obstacle, Separation, Shape, SphereModel, World, separation_within,
};
use kinopt_kinematics::clock::deadline::is_over;
use kinopt_kinematics::model::{FrameId, FrameRef};
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::problem::BodyKind;

/// Number of the first plane of a model; numbers of obstacles are smaller.
#[doc(hidden)]
pub const FIRST_PLANE: u64 = 1 << 63;

/// Shapes that move with one frame: those of a link, or of an attached obstacle.
#[derive(Clone, Debug)]
pub(super) struct Part {
    name: String,
    kind: BodyKind,
    frame: FrameId,
    pub(super) shapes: Vec<PartShape>,
    /// Spheres that cover all shapes, if set.
    cover: Option<PartCover>,
    /// Sorted numbers of the model's planes and the obstacles that it may touch.
    allowed: Vec<u64>,
}

/// A checked pair, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// A part and a fixed obstacle.
    FixedObstacle(usize, usize),
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
    motion_bound: Arc<ChainMotionBound>,
    /// Fixed obstacles, by their numbers in the world.
    fixed_obstacles: DynamicAabbTree<Arc<Obstacle>>,
}

impl Scene {
    pub(super) fn new(model: &CollisionModel, world: &World) -> Result<Self, WorldError> {
        let planes = model.planes().iter().map(|plane| &plane.obstacle);
        let all = world.numbered().chain((FIRST_PLANE..).zip(planes));
        let fixed_obstacles = all.filter_map(|(number, obstacle)| {
            let (obstacle, bounds) = with_bounds(obstacle)?;
            Some((number, obstacle, bounds))
        });
        let scene = Self {
            fixed_obstacles: DynamicAabbTree::new(fixed_obstacles),
            ..Self::default()
        };
        scene.with_attached(model, world)
    }

    /// A copy after changes of the world that do not affect attached obstacles.
    pub(super) fn changed(&self, changes: &[Change<'_>]) -> Self {
        let changes = changes.iter();
        let changes = changes.map(|change| (change.number, change.after.and_then(with_bounds)));
        Self {
            fixed_obstacles: self.fixed_obstacles.changed(changes.collect()),
            ..self.clone()
        }
    }

    /// A copy with the parts of a model, without sphere covers, and the attached obstacles of a world.
    pub(super) fn with_attached(
        self,
        model: &CollisionModel,
        world: &World,
    ) -> Result<Self, WorldError> {
        let link = |link: &FrameId| Part {
            name: model.name_of(*link).to_owned(),
            kind: BodyKind::Link,
            frame: *link,
            shapes: (model.objects_of(*link))
                .map(|object| PartShape::new(object.shape.clone(), object.link_from_shape))
                .collect(),
            cover: None,
            allowed: allowed_planes(model, *link),
        };
        let mut parts: Vec<Part> = model.links().iter().map(link).collect();
        let link_count = parts.len();
        for obstacle in world.attached() {
            let Some(frame) = &obstacle.attached else {
                continue;
            };
            let frame = FrameRef::from(frame.as_str()).resolve(model.model());
            let frame = frame.map_err(|unknown| WorldError::Attached {
                obstacle: obstacle.name.clone(),
                unknown,
            })?;
            parts.push(Part {
                name: obstacle.name.clone(),
                kind: BodyKind::Obstacle,
                frame,
                shapes: vec![PartShape::new(obstacle.shape.clone(), obstacle.placement)],
                cover: None,
                allowed: allowed_planes(model, frame),
            });
        }
        let allowed_collisions = AllowedCollisions::of(model, world)?;
        for part in &mut parts {
            allowed_collisions.add_allowed(&part.name, &mut part.allowed);
        }
        let pairs = pairs(model, &parts, link_count, &allowed_collisions);
        let shape_ends = parts.iter().scan(0, |end, part| {
            *end += part.shapes.len();
            Some(*end)
        });
        Ok(Self {
            shape_ends: shape_ends.collect(),
            pairs: pairs.into(),
            motion_bound: Arc::new(ChainMotionBound::new(
                model.model(),
                parts.iter().map(Part::balls),
            )),
            parts: Arc::new(parts),
            fixed_obstacles: self.fixed_obstacles,
        })
    }

    /// A copy with spheres that cover the links' shapes.
    pub(super) fn covered_by(mut self, spheres: &SphereModel) -> Self {
        let parts = Arc::make_mut(&mut self.parts);
        for group in spheres.groups() {
            let mut parts = parts.iter_mut();
            if let Some(part) = parts.find(|part| part.frame == group.link) {
                part.cover = Some(PartCover::of(group));
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
        let part = |index: usize| (&*self.parts[index].name, self.parts[index].kind);
        match pair {
            Pair::FixedObstacle(a, b) => {
                let obstacle = self.fixed_obstacles.item(b as u32);
                let kind = match self.fixed_obstacles.number(b as u32) {
                    number if number < FIRST_PLANE => BodyKind::Obstacle,
                    _ => BodyKind::Link,
                };
                [part(a), (&obstacle.name, kind)]
            }
            Pair::Parts(a, b) => [part(a), part(b)],
        }
    }

    /// Sorted numbers of the fixed solids that a part may touch.
    pub(super) fn allowed_obstacles(&self, part: usize) -> &[u64] {
        &self.parts[part].allowed
    }

    /// Checked pairs of parts, by index.
    #[must_use]
    pub(super) fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    #[must_use]
    pub(super) fn motion_bound(&self) -> &ChainMotionBound {
        &self.motion_bound
    }

    /// Visits all pairs at most `max_distance` metres apart, each with its closest shapes. Stops if `visitor` returns
    /// false or the time is [over](kinopt_kinematics::clock::deadline).
    pub(super) fn visit(
        &self,
        placements: &[Placement<f64>],
        max_distance: f64,
        workspace: &mut SceneWorkspace,
        mut visitor: impl FnMut(Pair, &Separation) -> bool,
    ) {
        self.begin(workspace);
        for part in 0..self.parts.len() {
            if is_over() {
                return;
            }
            self.find_fixed_obstacles(part, placements, max_distance, workspace);
            for (obstacle, separation) in &workspace.near {
                if !visitor(Pair::FixedObstacle(part, *obstacle as usize), separation) {
                    return;
                }
            }
        }
        for &pair in &*self.pairs {
            if is_over() {
                return;
            }
            if let Some(separation) = self.separation(pair, placements, max_distance, workspace)
                && !visitor(Pair::Parts(pair[0], pair[1]), &separation)
            {
                return;
            }
        }
    }

    /// Finds the fixed obstacles at most `max_distance` metres from a part. Writes each with the separation of its
    /// closest shape to `workspace.near`.
    pub(super) fn find_fixed_obstacles(
        &self,
        part: usize,
        placements: &[Placement<f64>],
        max_distance: f64,
        workspace: &mut SceneWorkspace,
    ) {
        workspace.near.clear();
        if self.fixed_obstacles.is_empty() {
            return;
        }
        self.place(part, placements, workspace);
        let SceneWorkspace { shapes, near, .. } = workspace;
        let placed = (&*self.parts[part].shapes, &shapes[self.shapes_of(part)]);
        self.near(placed, max_distance, |obstacle, separation| {
            match near.iter_mut().find(|(nearest, _)| *nearest == obstacle) {
                Some((_, nearest)) if nearest.distance <= separation.distance => {}
                Some((_, nearest)) => *nearest = separation,
                None => near.push((obstacle, separation)),
            }
        });
        let allowed = &self.parts[part].allowed;
        if !allowed.is_empty() {
            let is_allowed = |obstacle| {
                allowed
                    .binary_search(&self.fixed_obstacles.number(obstacle))
                    .is_ok()
            };
            near.retain(|(obstacle, _)| !is_allowed(*obstacle));
        }
        near.sort_by_key(|(obstacle, _)| self.fixed_obstacles.number(*obstacle));
    }

    /// The separation of two parts, if it is at most `max_distance` metres.
    pub(super) fn separation(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        max_distance: f64,
        workspace: &mut SceneWorkspace,
    ) -> Option<Separation> {
        if !self.covers_meet([a, b], placements, max_distance, &mut workspace.covers) {
            return None;
        }
        self.shape_separation([a, b], placements, max_distance, workspace)
    }

    /// True if the sphere covers of two parts are within `max_distance` metres, or if a cover is missing.
    pub(super) fn covers_meet(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        max_distance: f64,
        covers: &mut [PlacedCover],
    ) -> bool {
        let (Some(first), Some(second)) = (&self.parts[a].cover, &self.parts[b].cover) else {
            return true;
        };
        let at = [&placements[a], &placements[b]];
        covers[a].place(first, at[0]);
        covers[b].place(second, at[1]);
        if !covers[a].meets(&covers[b], max_distance) {
            return false;
        }
        covers[a].place_spheres(first, at[0]);
        covers[b].place_spheres(second, at[1]);
        !covers[a].is_apart(&covers[b], max_distance)
    }

    /// The separation of two parts if it is at most `max_distance` metres, without a test of the sphere covers.
    pub(super) fn shape_separation(
        &self,
        [a, b]: [usize; 2],
        placements: &[Placement<f64>],
        max_distance: f64,
        workspace: &mut SceneWorkspace,
    ) -> Option<Separation> {
        self.place(a, placements, workspace);
        self.place(b, placements, workspace);
        let placed = |part: usize| {
            let shapes = &*self.parts[part].shapes;
            (shapes, &workspace.shapes[self.shapes_of(part)])
        };
        part_to_part(placed(a), placed(b), max_distance)
    }

    /// Shape and placement of a fixed obstacle.
    pub(super) fn fixed_obstacle(&self, index: usize) -> (&Shape, &Placement<f64>) {
        let obstacle = self.fixed_obstacles.item(index as u32);
        (&obstacle.shape, &obstacle.placement)
    }

    /// Visits the fixed obstacles at most `max_distance` metres from a part's shapes.
    fn near(
        &self,
        (shapes, placed): PlacedShapes<'_>,
        max_distance: f64,
        mut visitor: impl FnMut(u32, Separation),
    ) {
        for (part_shape, placed_shape) in shapes.iter().zip(placed) {
            let reach = part_shape.ball.radius + max_distance;
            let squared_distance =
                |bounds: &BoundingBox| bounds.squared_distance(placed_shape.centre);
            // The bound never decreases: the search visits all boxes that the ball meets.
            self.fixed_obstacles.nearest(
                (reach * reach).next_up(),
                squared_distance,
                |index, bound| {
                    if is_over() {
                        return f64::NEG_INFINITY;
                    }
                    // The leaves of the tree hold several.
                    let bounds = self.fixed_obstacles.bounds(index);
                    if bounds.squared_distance(placed_shape.centre) > reach * reach {
                        return bound;
                    }
                    let obstacle = self.fixed_obstacles.item(index);
                    let separation = separation_within(
                        &part_shape.shape,
                        &placed_shape.world_from_shape,
                        &obstacle.shape,
                        &obstacle.placement,
                        max_distance,
                    );
                    if let Some(separation) = separation {
                        visitor(index, separation);
                    }
                    bound
                },
            );
        }
    }
}

/// A fixed obstacle with its bounding box in the world; `None` for attached obstacles.
fn with_bounds(obstacle: &Arc<Obstacle>) -> Option<(Arc<Obstacle>, BoundingBox)> {
    let bounds = obstacle.shape.bounding_box().placed(&obstacle.placement);
    obstacle
        .attached
        .is_none()
        .then(|| (Arc::clone(obstacle), bounds))
}

/// Numbers of the planes that the shapes on a frame may penetrate.
fn allowed_planes(model: &CollisionModel, frame: FrameId) -> Vec<u64> {
    let planes = (FIRST_PLANE..).zip(model.planes());
    let allowed = planes.filter(|(_, plane)| !plane.blocks(model.model(), frame));
    allowed.map(|(number, _)| number).collect()
}

impl Part {
    /// The frame, and bounding balls of the shapes in the frame.
    fn balls(&self) -> (FrameId, Vec<(Vector3<f64>, f64)>) {
        let ball = |shape: &PartShape| {
            let centre = shape.part_from_shape.apply(shape.ball.centre);
            (centre, shape.ball.radius)
        };
        (self.frame, self.shapes.iter().map(ball).collect())
    }
}

/// Checked pairs of parts: enabled pairs of links, and attached obstacles with all parts that cannot hold them.
fn pairs(
    model: &CollisionModel,
    parts: &[Part],
    link_count: usize,
    allowed_collisions: &AllowedCollisions<'_>,
) -> Vec<[usize; 2]> {
    let part_index = |frame: FrameId| {
        parts[..link_count]
            .iter()
            .position(|part| part.frame == frame)
    };
    let links = model.pairs().iter();
    let mut pairs: Vec<[usize; 2]> = links
        .filter_map(|[a, b]| Some([part_index(*a)?, part_index(*b)?]))
        .collect();
    let frames: Vec<FrameId> = parts.iter().map(|part| part.frame).collect();
    let bodies = Bodies::new(model.model(), &frames);
    for attached in link_count..parts.len() {
        // A body cannot hold an obstacle if it only carries the holding body, as a forearm carries its hand.
        let enabled = (0..attached).filter(|&other| {
            bodies.are_unconnected(other, attached)
                || other < link_count && bodies.is_parent_of_only(other, attached)
        });
        let enabled = enabled.filter(|&other| {
            !allowed_collisions.is_allowed(&parts[other].name, &parts[attached].name)
        });
        pairs.extend(enabled.map(|other| [other, attached]));
    }
    pairs
}
