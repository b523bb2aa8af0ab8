//! The parts of a robot and the obstacles of a world, put together.

use super::CheckerError;
use super::motion_bound::MotionBound;
use crate::collision::box_tree::BoxTree;
use crate::collision::model::pairs_apart;
use crate::collision::{BoundingBox, CollisionModel, Separation, Shape, World, separation_within};
use crate::model::{FrameId, FrameRef};
use crate::spatial::{Placement, Vector3};

/// Something that stands in the world.
#[derive(Clone, Debug)]
struct Standing {
    name: String,
    shape: Shape,
    world_from_shape: Placement<f64>,
}

/// What moves with one frame.
#[derive(Clone, Debug)]
struct Part {
    name: String,
    frame: FrameId,
    shapes: Vec<(Shape, Placement<f64>)>,
}

/// Two of them, by place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pair {
    /// A part, and something that stands.
    Standing(usize, usize),
    /// Two parts.
    Parts(usize, usize),
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    parts: Vec<Part>,
    /// Parts that are kept apart, by place.
    pairs: Vec<[usize; 2]>,
    standing: Vec<Standing>,
    /// Over what stands.
    tree: BoxTree,
    motion_bound: MotionBound,
}

impl Scene {
    pub(super) fn new(model: &CollisionModel, world: &World) -> Result<Self, CheckerError> {
        let link = |link: &FrameId| Part {
            name: model.name_of(*link).to_owned(),
            frame: *link,
            shapes: (model.objects_of(*link))
                .map(|object| (object.shape.clone(), object.link_from_shape))
                .collect(),
        };
        let mut parts: Vec<Part> = model.links().iter().map(link).collect();
        let own = parts.len();
        let mut standing = Vec::new();
        for obstacle in world.obstacles() {
            let (name, shape) = (obstacle.name.clone(), obstacle.shape.clone());
            match &obstacle.attached {
                None => standing.push(Standing {
                    name,
                    shape,
                    world_from_shape: obstacle.placement,
                }),
                Some(frame) => {
                    let frame = FrameRef::from(frame.as_str()).resolve(model.model());
                    let frame = frame.map_err(|unknown| CheckerError::Attached {
                        obstacle: name.clone(),
                        unknown,
                    })?;
                    parts.push(Part {
                        name,
                        frame,
                        shapes: vec![(shape, obstacle.placement)],
                    });
                }
            }
        }
        let boxes: Vec<BoundingBox> = standing.iter().map(Standing::bounds).collect();
        Ok(Self {
            pairs: pairs(model, &parts, own),
            motion_bound: MotionBound::new(model.model(), parts.iter().map(Part::balls)),
            tree: BoxTree::new(standing.len(), |index| boxes[index]),
            parts,
            standing,
        })
    }

    /// The frames that carry the parts.
    pub(super) fn frames(&self) -> impl ExactSizeIterator<Item = FrameId> + '_ {
        self.parts.iter().map(|part| part.frame)
    }

    pub(super) fn motion_bound(&self) -> &MotionBound {
        &self.motion_bound
    }

    pub(super) fn names(&self, pair: Pair) -> [&str; 2] {
        match pair {
            Pair::Standing(a, b) => [&self.parts[a].name, &self.standing[b].name],
            Pair::Parts(a, b) => [&self.parts[a].name, &self.parts[b].name],
        }
    }

    /// Visits all pairs that are at most `within` apart, each by its shapes that are nearest, until told to stop.
    pub(super) fn visit(
        &self,
        placements: &[Placement<f64>],
        within: f64,
        mut each: impl FnMut(Pair, &Separation) -> bool,
    ) {
        let mut near: Vec<(u32, Separation)> = Vec::new();
        for (place, (part, placement)) in self.parts.iter().zip(placements).enumerate() {
            near.clear();
            self.near(part, placement, within, |standing, separation| {
                match near.iter_mut().find(|(known, _)| *known == standing) {
                    Some((_, known)) if known.distance <= separation.distance => {}
                    Some((_, known)) => *known = separation,
                    None => near.push((standing, separation)),
                }
            });
            near.sort_by_key(|(standing, _)| *standing);
            for (standing, separation) in &near {
                if !each(Pair::Standing(place, *standing as usize), separation) {
                    return;
                }
            }
        }
        for &[a, b] in &self.pairs {
            if let Some(separation) =
                self.part_to_part([a, b], [&placements[a], &placements[b]], within)
                && !each(Pair::Parts(a, b), &separation)
            {
                return;
            }
        }
    }

    /// The least distance of two parts, if that is at most `within`.
    fn part_to_part(
        &self,
        [a, b]: [usize; 2],
        [world_from_a, world_from_b]: [&Placement<f64>; 2],
        within: f64,
    ) -> Option<Separation> {
        let mut nearest: Option<Separation> = None;
        for (first, a_from_first) in &self.parts[a].shapes {
            let world_from_first = *world_from_a * *a_from_first;
            for (second, b_from_second) in &self.parts[b].shapes {
                let world_from_second = *world_from_b * *b_from_second;
                let balls = [(first, &world_from_first), (second, &world_from_second)];
                if balls_are_apart(balls, within) {
                    continue;
                }
                let separation =
                    separation_within(first, &world_from_first, second, &world_from_second, within);
                if let Some(separation) = separation {
                    keep_nearer(&mut nearest, separation);
                }
            }
        }
        nearest
    }

    /// Visits what stands at most `within` from a part's shapes.
    fn near(
        &self,
        part: &Part,
        world_from_part: &Placement<f64>,
        within: f64,
        mut each: impl FnMut(u32, Separation),
    ) {
        for (shape, part_from_shape) in &part.shapes {
            let world_from_shape = *world_from_part * *part_from_shape;
            let ball = shape.bounding_sphere();
            let centre = world_from_shape.apply(ball.centre);
            let reach = ball.radius + within;
            let apart = |bounds: &BoundingBox| bounds.squared_distance(centre);
            // Nothing is ever nearer than the bound: all whose boxes the ball meets are visited.
            self.tree
                .nearest((reach * reach).next_up(), apart, |index, bound| {
                    let standing = &self.standing[index as usize];
                    let separation = separation_within(
                        shape,
                        &world_from_shape,
                        &standing.shape,
                        &standing.world_from_shape,
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

impl Part {
    /// Its frame, and balls around its shapes there.
    fn balls(&self) -> (FrameId, Vec<(Vector3<f64>, f64)>) {
        let ball = |(shape, frame_from_shape): &(Shape, Placement<f64>)| {
            let ball = shape.bounding_sphere();
            (frame_from_shape.apply(ball.centre), ball.radius)
        };
        (self.frame, self.shapes.iter().map(ball).collect())
    }
}

impl Standing {
    fn bounds(&self) -> BoundingBox {
        self.shape.bounding_box().placed(&self.world_from_shape)
    }
}

/// Parts that are kept apart: links as the model has it, attached obstacles from all but what may hold them.
fn pairs(model: &CollisionModel, parts: &[Part], own: usize) -> Vec<[usize; 2]> {
    let place = |frame: FrameId| parts[..own].iter().position(|part| part.frame == frame);
    let links = model.pairs().iter();
    let mut pairs: Vec<[usize; 2]> = links
        .filter_map(|[a, b]| Some([place(*a)?, place(*b)?]))
        .collect();
    let frames: Vec<FrameId> = parts.iter().map(|part| part.frame).collect();
    let apart = pairs_apart(model.model(), &frames);
    for attached in own..parts.len() {
        for other in 0..attached {
            let frames = [parts[other].frame, parts[attached].frame];
            if apart.contains(&frames) || apart.contains(&[frames[1], frames[0]]) {
                pairs.push([other, attached]);
            }
        }
    }
    pairs
}

/// Whether two shapes are surely further apart than `within`, by the balls around them.
fn balls_are_apart(shapes: [(&Shape, &Placement<f64>); 2], within: f64) -> bool {
    let [(a, a_from), (b, b_from)] = shapes.map(|(shape, world_from_shape)| {
        let ball = shape.bounding_sphere();
        (ball.radius, world_from_shape.apply(ball.centre))
    });
    let reach = a + b + within;
    (a_from - b_from).norm_squared() > reach * reach
}

fn keep_nearer(nearest: &mut Option<Separation>, other: Separation) {
    if nearest
        .as_ref()
        .is_none_or(|known| other.distance < known.distance)
    {
        *nearest = Some(other);
    }
}
