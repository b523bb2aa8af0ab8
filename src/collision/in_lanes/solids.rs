//! What stands still around a chain, and how near points in lanes are to it.

use std::sync::Arc;

use super::bodies::{Body, BodyChain};
use super::many_solids::{ManySolids, SolidChange};
use super::passed::Passed;
use crate::collision::{Ball, BoundingBox, Shape, ShapeKind};
use crate::lanes::lane::LaneScalar;
use crate::spatial::{Placement, Vector3};

/// So many solids are looked at one after another.
const LISTED: usize = 512;
/// So are so many points or triangles of one.
const FEW: usize = 32;

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
    bounds: BoundingBox,
    solid_from_base: Placement<f64>,
    solid: Solid,
}

/// What a chain is kept away from.
#[derive(Clone, Debug)]
pub(crate) struct Solids {
    listed: Arc<Listed>,
    /// All others.
    many: Option<ManySolids>,
    passed: Passed,
    /// How many there are of one shape that is soon looked at.
    simple: usize,
    /// How near to a solid, or to each other, bodies are not to come, metres.
    margin: f64,
}

/// Solids that are looked at one after another.
#[derive(Clone, Debug, Default)]
struct Listed {
    /// In the order of their numbers.
    numbers: Vec<u64>,
    placed: Vec<Placed>,
    /// Those of them that each body can ever come near to, by place, and the balls around them; two together.
    within_reach: Vec<Vec<([u32; 2], [Reached; 2])>>,
}

/// A solid of two worlds that is not in both the same, by its shape and where it stands in the chain's base.
pub(crate) struct SolidMoved<'a> {
    /// Solids are in the order of their numbers.
    pub(crate) number: u64,
    pub(crate) before: Option<&'a Shape>,
    pub(crate) after: Option<(&'a Shape, Placement<f64>)>,
}

/// The ball around a solid, as one body's ball meets it: |c − s|² < r² as |c|² − (r² − |s|²) − 2 s·c < 0, which takes three products where
/// |c|² is known.
#[derive(Clone, Copy, Debug)]
struct Reached {
    /// −2 s.
    slope: Vector3<f64>,
    /// r² − |s|².
    below: f64,
}

impl Reached {
    /// What rounding may take from either side, of the squares that are subtracted.
    const ROUNDING: f64 = 1e-14;

    fn new(solid: &Ball, body: &Ball, margin: f64) -> Self {
        let apart = body.radius + margin + solid.radius;
        let (away, apart) = (solid.centre.norm_squared(), apart * apart);
        Self {
            slope: solid.centre * -2.0,
            below: apart - away + Self::ROUNDING * (apart + away),
        }
    }

    /// Two of them together, the last with one that is met nowhere.
    fn paired(reached: &[(u32, Self)]) -> Vec<([u32; 2], [Self; 2])> {
        let nowhere = Self {
            slope: Vector3::zero(),
            below: f64::NEG_INFINITY,
        };
        let paired = reached.chunks(2).map(|chunk| match *chunk {
            [(a, of_a), (b, of_b)] => ([a, b], [of_a, of_b]),
            _ => ([chunk[0].0; 2], [chunk[0].1, nowhere]),
        });
        paired.collect()
    }

    /// Below zero where a ball about a point, of which the squared length is given too, meets it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn beyond<V: LaneScalar>(&self, centre: Vector3<V>, squared: V) -> V {
        let side = squared - V::constant(self.below);
        let side = centre.x.mul_add(V::constant(self.slope.x), side);
        let side = centre.y.mul_add(V::constant(self.slope.y), side);
        centre.z.mul_add(V::constant(self.slope.z), side)
    }
}

impl Solids {
    /// Shapes with their numbers, each by where it stands in the chain's base; how near to a solid the bodies are not to
    /// come, metres, but for those that they may touch.
    pub(crate) fn new<'a>(
        shapes: impl IntoIterator<Item = (u64, &'a Shape, Placement<f64>)>,
        chain: &BodyChain,
        passed: Passed,
        margin: f64,
    ) -> Self {
        let all: Vec<_> = shapes.into_iter().collect();
        let simple = all.iter().filter(|(_, shape, _)| is_simple(shape)).count();
        let (listed, many): (Vec<_>, Vec<_>) = all
            .into_iter()
            .partition(|(number, shape, _)| is_listed(shape, simple) || passed.has(*number));
        let placed = listed
            .into_iter()
            .map(|(number, shape, at)| (number, Placed::new(shape, at)));
        Self {
            listed: Arc::new(Listed::new(placed, chain, &passed, margin)),
            many: (!many.is_empty()).then(|| ManySolids::new(many)),
            passed,
            simple,
            margin,
        }
    }

    /// The same with some of them changed, in the order of their numbers; `None` where so many became so few, or the other way, that all
    /// are looked at in another way, and where bodies may touch others.
    pub(crate) fn changed(
        &self,
        changes: &[SolidMoved<'_>],
        chain: &BodyChain,
        passed: &Passed,
    ) -> Option<Self> {
        let count = |shapes: &mut dyn Iterator<Item = &Shape>| {
            shapes.filter(|shape| is_simple(shape)).count()
        };
        let before = count(&mut changes.iter().filter_map(|change| change.before));
        let after = count(&mut changes.iter().filter_map(|change| Some(change.after?.0)));
        let simple = (self.simple + after).checked_sub(before)?;
        if are_many(simple) != are_many(self.simple) || *passed != self.passed {
            return None;
        }
        let (mut listed, mut many): (Vec<SolidChange<'_>>, Vec<SolidChange<'_>>) =
            Default::default();
        for change in changes {
            let is_passed = passed.has(change.number);
            let is_listed = |shape: &&Shape| is_passed || is_listed(shape, simple);
            let now = change.after.filter(|(shape, _)| is_listed(shape));
            if now.is_some() || change.before.filter(is_listed).is_some() {
                listed.push((change.number, now));
            }
            let now = change.after.filter(|(shape, _)| !is_listed(shape));
            if now.is_some() || change.before.filter(|shape| !is_listed(shape)).is_some() {
                many.push((change.number, now));
            }
        }
        let many = match &self.many {
            Some(known) => Some(known.changed(&many)).filter(|many| !many.is_empty()),
            None => {
                let added = many.into_iter().filter_map(|(number, now)| {
                    let (shape, at) = now?;
                    Some((number, shape, at))
                });
                let added: Vec<_> = added.collect();
                (!added.is_empty()).then(|| ManySolids::new(added))
            }
        };
        let listed = match listed.is_empty() {
            true => Arc::clone(&self.listed),
            false => Arc::new(self.listed.changed(&listed, chain, passed, self.margin)),
        };
        Some(Self {
            listed,
            many,
            passed: passed.clone(),
            simple,
            margin: self.margin,
        })
    }

    /// Those that are not listed.
    pub(super) fn many(&self) -> Option<&ManySolids> {
        self.many.as_ref()
    }

    /// How near to a solid, or to each other, bodies are not to come, metres.
    pub(super) fn margin(&self) -> f64 {
        self.margin
    }

    /// Those listed that the ball about a body comes nearer to in any lane than the margin, by number: by the balls around them first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near<V: LaneScalar>(
        &self,
        body: usize,
        centre: Vector3<V>,
        chain: &BodyChain,
        found: &mut Vec<u32>,
    ) {
        let reach = chain.bodies[body].bound.radius + self.margin;
        found.clear();
        let squared = centre.norm_squared();
        // Two at a time, as most are far away.
        for (numbers, [a, b]) in &self.listed.within_reach[body] {
            let beyond = [a.beyond(centre, squared), b.beyond(centre, squared)];
            // One comparison of the lesser: masks of both would be put together bit by bit.
            if !V::any(beyond[0].min(beyond[1]).less_than(V::zero())) {
                continue;
            }
            for (&number, beyond) in numbers.iter().zip(beyond) {
                if V::any(beyond.less_than(V::zero())) {
                    found.push(number);
                }
            }
        }
        // In a loop of its own, so that the first has room for the centre in registers.
        let mut near = 0;
        for place in 0..found.len() {
            let number = found[place];
            if V::any(self.is_near(number, centre, reach)) {
                found[near] = number;
                near += 1;
            }
        }
        found.truncate(near);
    }

    /// The lanes in which a point is nearer than so far to a solid, or in it: by the ball around that first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near_one<V: LaneScalar>(
        &self,
        number: u32,
        point: Vector3<V>,
        reach: f64,
    ) -> V::Mask {
        let bound = &self.listed.placed[number as usize].bound;
        let around = reach + bound.radius;
        let away = point - Vector3::constant(bound.centre);
        let near = away.norm_squared().less_than(V::constant(around * around));
        match V::any(near) {
            true => self.is_near(number, point, reach),
            false => near,
        }
    }

    /// The lanes in which a point is nearer than so far to a solid, or in it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_near<V: LaneScalar>(&self, number: u32, point: Vector3<V>, reach: f64) -> V::Mask {
        let c = V::constant;
        let placed = &self.listed.placed[number as usize];
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
                    distance.set_lane(lane, shape.signed_distance(in_lane(&p, lane)));
                }
                distance.less_than(c(reach))
            }
        }
    }
}

impl Listed {
    fn new(
        solids: impl IntoIterator<Item = (u64, Placed)>,
        chain: &BodyChain,
        passed: &Passed,
        margin: f64,
    ) -> Self {
        let (numbers, placed): (Vec<u64>, Vec<Placed>) = solids.into_iter().unzip();
        let reached = |(index, (room, body)): (usize, (Ball, &Body))| {
            let reach = room.radius + margin;
            let kept = (0..).zip(&placed).zip(&numbers);
            let kept = kept.filter(|(_, number)| !passed.is_passed(index, **number));
            let near = kept.map(|(solid, _)| solid).filter(|(_, solid)| {
                let apart = solid.bounds.squared_distance(room.centre);
                // Not a number about a half-space's corner at infinity.
                apart.is_nan() || apart <= reach * reach
            });
            let near = near.map(|(n, solid)| (n, Reached::new(&solid.bound, &body.bound, margin)));
            Reached::paired(&near.collect::<Vec<_>>())
        };
        Self {
            within_reach: chain
                .rooms()
                .into_iter()
                .zip(&chain.bodies)
                .enumerate()
                .map(reached)
                .collect(),
            numbers,
            placed,
        }
    }

    /// The same with some of them changed.
    fn changed(
        &self,
        changes: &[SolidChange<'_>],
        chain: &BodyChain,
        passed: &Passed,
        margin: f64,
    ) -> Self {
        let stays = |(number, _): &(u64, Placed)| {
            changes
                .binary_search_by_key(number, |(changed, _)| *changed)
                .is_err()
        };
        let known = self
            .numbers
            .iter()
            .copied()
            .zip(self.placed.iter().cloned());
        let mut all: Vec<_> = known.filter(stays).collect();
        all.extend(changes.iter().filter_map(|(number, now)| {
            let (shape, at) = (*now)?;
            Some((*number, Placed::new(shape, at)))
        }));
        all.sort_by_key(|(number, _)| *number);
        Self::new(all, chain, passed, margin)
    }
}

impl Placed {
    fn new(shape: &Shape, base_from_solid: Placement<f64>) -> Self {
        let own = shape.bounding_sphere();
        Self {
            bound: Ball {
                centre: base_from_solid.apply(own.centre),
                radius: own.radius,
            },
            bounds: shape.bounding_box().placed(&base_from_solid),
            solid_from_base: base_from_solid.inverse(),
            solid: Solid::of(shape),
        }
    }
}

/// Whether so many that are soon looked at are not looked at one after another.
fn are_many(simple: usize) -> bool {
    simple > LISTED
}

/// Whether a shape is looked at by itself, where there are so many that are simple; a half-space, which has no bounds, is always.
fn is_listed(shape: &Shape, simple: usize) -> bool {
    shape.is_half_space() || is_simple(shape) && !are_many(simple)
}

/// Whether a shape is soon looked at, in place of many by itself.
fn is_simple(shape: &Shape) -> bool {
    match shape.kind() {
        ShapeKind::Mesh(mesh) => mesh.triangles().len() <= FEW,
        ShapeKind::Points(cloud) => cloud.positions().len() <= FEW,
        ShapeKind::HeightField(_) => false,
        _ => true,
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

/// The point of one lane.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn in_lane<V: LaneScalar>(points: &Vector3<V>, lane: usize) -> Vector3<f64> {
    Vector3::new(
        points.x.lane(lane),
        points.y.lane(lane),
        points.z.lane(lane),
    )
}
