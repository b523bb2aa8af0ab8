//! What stands still around a chain, and how near points in lanes are to it.

use crate::collision::box_tree::{BoxTree, Contents};
use crate::collision::{Ball, BoundingBox, Shape, ShapeKind};
use crate::lanes::lane::LaneScalar;
use crate::spatial::{Placement, Vector3};

/// Fewer solids are looked at one after another.
const LISTED: usize = 512;

/// A shape whose distance from a point has a closed form in lanes, or another; lengths in metres.
#[derive(Clone, Debug)]
enum Solid {
    /// Half its lengths along the axes.
    Box([f64; 3]),
    /// Along z: radius and half the length.
    Cylinder(f64, f64),
    /// Along z: radius and half the length of the cylinder in it.
    Capsule(f64, f64),
    Sphere(f64),
    /// All below z = 0.
    HalfSpace,
    /// One point after another.
    Other(Shape),
}

/// A solid in its place.
#[derive(Clone, Debug)]
struct Placed {
    /// Around it, in the base.
    bound: Ball,
    solid_from_base: Placement<f64>,
    solid: Solid,
}

/// What a chain is kept away from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solids {
    placed: Vec<Placed>,
    /// Over their boxes, where there are many.
    tree: Option<BoxTree>,
    /// Those that each body can ever come near to, where there are few.
    within_reach: Vec<Vec<u32>>,
}

impl Solids {
    /// Shapes, each by where it stands in the chain's base; balls that the bodies never leave, and how near to a solid they are not to
    /// come, metres.
    pub(crate) fn new<'a>(
        shapes: impl IntoIterator<Item = (&'a Shape, Placement<f64>)>,
        rooms: &[Ball],
        margin: f64,
    ) -> Self {
        let mut boxes: Vec<BoundingBox> = Vec::new();
        let placed = shapes.into_iter().map(|(shape, base_from_solid)| {
            boxes.push(shape.bounding_box().placed(&base_from_solid));
            let own = shape.bounding_sphere();
            Placed {
                bound: Ball {
                    centre: base_from_solid.apply(own.centre),
                    radius: own.radius,
                },
                solid_from_base: base_from_solid.inverse(),
                solid: Solid::of(shape),
            }
        });
        let placed: Vec<Placed> = placed.collect();
        let tree =
            (placed.len() > LISTED).then(|| BoxTree::new(placed.len(), |index| boxes[index]));
        let reached = |room: &Ball| {
            let reach = room.radius + margin;
            // A tree finds what is near by itself.
            let listed = boxes.iter().filter(|_| tree.is_none());
            let near = (0..).zip(listed);
            let near = near.filter(|(_, solid)| {
                let apart = solid.squared_distance(room.centre);
                // Not a number about a half-space's corner at infinity.
                apart.is_nan() || apart <= reach * reach
            });
            near.map(|(number, _)| number).collect()
        };
        Self {
            within_reach: rooms.iter().map(reached).collect(),
            placed,
            tree,
        }
    }

    /// Those that the ball about a body comes nearer to in any lane than `margin`, by number.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near<V: LaneScalar>(
        &self,
        body: usize,
        centre: Vector3<V>,
        ball: &Ball,
        margin: f64,
        found: &mut Vec<u32>,
    ) {
        let reach = ball.radius + margin;
        found.clear();
        let Some(tree) = &self.tree else {
            for &number in &self.within_reach[body] {
                if self.near_one(number, centre, reach) != 0 {
                    found.push(number);
                }
            }
            return;
        };
        for lane in 0..V::WIDTH {
            let [x, y, z] = centre.to_array();
            let centre = Vector3::new(x.lane(lane), y.lane(lane), z.lane(lane));
            near_in(tree, centre, reach, found);
        }
        found.sort_unstable();
        found.dedup();
        // No closure: what is in one is compiled for any processor.
        let mut kept = 0;
        for place in 0..found.len() {
            let number = found[place];
            if self.near_one(number, centre, reach) != 0 {
                found[kept] = number;
                kept += 1;
            }
        }
        found.truncate(kept);
    }

    /// The lanes, bit by bit, in which a point is nearer than so far to a solid, or in it: by the ball around that first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near_one<V: LaneScalar>(
        &self,
        number: u32,
        point: Vector3<V>,
        reach: f64,
    ) -> u32 {
        let bound = &self.placed[number as usize].bound;
        let around = reach + bound.radius;
        let away = point - Vector3::constant(bound.centre);
        match V::mask_bits(away.norm_squared().less_than(V::constant(around * around))) {
            0 => 0,
            _ => V::mask_bits(self.is_near(number, point, reach)),
        }
    }

    /// The lanes in which a point is nearer than so far to a solid, or in it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_near<V: LaneScalar>(&self, number: u32, point: Vector3<V>, reach: f64) -> V::Mask {
        let c = V::constant;
        let placed = &self.placed[number as usize];
        let p = Placement::constant(&placed.solid_from_base).apply(point);
        match &placed.solid {
            Solid::Box([x, y, z]) => {
                let gap = Vector3::new(beyond(p.x, *x), beyond(p.y, *y), beyond(p.z, *z));
                gap.norm_squared().less_than(c(reach * reach))
            }
            Solid::Cylinder(radius, half) => {
                let from_axis = p.x.mul_add(p.x, p.y * p.y).sqrt();
                let (side, end) = (beyond(from_axis, *radius), beyond(p.z, *half));
                side.mul_add(side, end * end).less_than(c(reach * reach))
            }
            Solid::Capsule(radius, half) => {
                let gap = Vector3::new(p.x, p.y, beyond(p.z, *half));
                let reach = radius + reach;
                gap.norm_squared().less_than(c(reach * reach))
            }
            Solid::Sphere(radius) => {
                let reach = radius + reach;
                p.norm_squared().less_than(c(reach * reach))
            }
            Solid::HalfSpace => p.z.less_than(c(reach)),
            Solid::Other(shape) => {
                let mut distance = V::zero();
                for lane in 0..V::WIDTH {
                    let p = Vector3::new(p.x.lane(lane), p.y.lane(lane), p.z.lane(lane));
                    distance.set_lane(lane, shape.signed_distance(p));
                }
                distance.less_than(c(reach))
            }
        }
    }
}

impl Solid {
    fn of(shape: &Shape) -> Self {
        match shape.kind() {
            ShapeKind::Cuboid { size } => Self::Box(size.map(|length| 0.5 * length)),
            ShapeKind::Cylinder { radius, length } => Self::Cylinder(*radius, 0.5 * length),
            ShapeKind::Capsule { radius, length } => Self::Capsule(*radius, 0.5 * length),
            ShapeKind::Sphere { radius } => Self::Sphere(*radius),
            ShapeKind::HalfSpace => Self::HalfSpace,
            _ => Self::Other(shape.clone()),
        }
    }
}

/// How far a value is beyond so far from zero.
#[cfg_attr(not(debug_assertions), inline(always))]
fn beyond<V: LaneScalar>(value: V, half: f64) -> V {
    (value.abs() - V::constant(half)).max(V::zero())
}

/// Adds those whose boxes a ball meets.
fn near_in(tree: &BoxTree, centre: Vector3<f64>, reach: f64, found: &mut Vec<u32>) {
    /// Deeper than any tree of 2³² things.
    const DEEP: usize = 64;
    let (mut stack, mut height) = ([0; DEEP], 1);
    while height > 0 {
        height -= 1;
        let node = stack[height];
        if tree.node_bounds(node).squared_distance(centre) >= reach * reach {
            continue;
        }
        match tree.contents(node) {
            Contents::Items(items) => found.extend_from_slice(items),
            Contents::Nodes(children) => {
                for child in children {
                    stack[height] = child;
                    height += 1;
                }
            }
        }
    }
}
