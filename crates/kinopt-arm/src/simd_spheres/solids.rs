//! Fixed solids around a chain, and distance tests of points in SIMD lanes.

use std::sync::Arc;

use super::bodies::{BodyChain, ChainBody};
use super::passed::Passed;
use super::solid_tree::{SolidChange, SolidTree};
use crate::simd_ik::lane::LaneScalar;
use kinopt_collision::collision::{Ball, BoundingBox, Shape, ShapeKind};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Largest number of solids that are searched linearly.
const MAX_LISTED: usize = 512;
/// Largest number of points or triangles of a shape that is searched linearly.
const MAX_SIMPLE_ELEMENTS: usize = 32;

/// A shape with a closed-form distance in lanes, or any other shape. Lengths are in metres.
#[derive(Clone, Debug)]
enum LaneSolid {
    /// Half lengths along the axes.
    Box([f64; 3]),
    /// Along z: radius and half length.
    Cylinder(f64, f64),
    /// Along z: radius and half length of the segment.
    Capsule(f64, f64),
    Sphere(f64),
    /// The half-space below z = 0.
    HalfSpace,
    /// Evaluated lane by lane.
    Other(Shape),
}

/// A solid with its placement and bounds.
#[derive(Clone, Debug)]
struct PlacedSolid {
    /// Bounding sphere in the base frame.
    bound: Ball,
    bounds: BoundingBox,
    solid_from_base: Placement<f64>,
    solid: LaneSolid,
}

/// Solids that a chain must not touch.
#[derive(Clone, Debug)]
pub(crate) struct Solids {
    listed: Arc<Listed>,
    /// Solids in an AABB tree, if any.
    solid_tree: Option<SolidTree>,
    allowed: Passed,
    /// Number of [simple](is_simple) solids.
    simple: usize,
    /// Required distance of the bodies from solids and from each other, metres.
    margin: f64,
}

/// Solids that are searched linearly.
#[derive(Clone, Debug, Default)]
struct Listed {
    /// Sorted.
    numbers: Vec<u64>,
    placed: Vec<PlacedSolid>,
    /// Solids that each body can reach, by index, with their bounding spheres; in pairs.
    within_reach: Vec<Vec<([u32; 2], [ReachableBound; 2])>>,
}

/// A difference between two worlds: a solid whose shape or placement in the chain's base frame changed.
pub(crate) struct SolidMoved<'a> {
    /// Number of the solid. Solids are in the order of their numbers.
    pub(crate) number: u64,
    pub(crate) before: Option<&'a Shape>,
    pub(crate) after: Option<(&'a Shape, Placement<f64>)>,
}

/// Bounding sphere of a solid, prepared for the test against one body's bounding sphere.
///
/// |c − s|² < r² is |c|² − (r² − |s|²) − 2 s·c < 0, which takes three products once |c|² is known.
#[derive(Clone, Copy, Debug)]
struct ReachableBound {
    /// −2 s.
    slope: Vector3<f64>,
    /// r² − |s|².
    below: f64,
}

impl ReachableBound {
    /// Rounding of the difference, relative to the squares in it.
    const ROUNDING: f64 = 1e-14;

    fn new(solid: &Ball, body: &Ball, margin: f64) -> Self {
        let reach = body.radius + margin + solid.radius;
        let (squared_distance, reach) = (solid.centre.norm_squared(), reach * reach);
        Self {
            slope: solid.centre * -2.0,
            below: reach - squared_distance + Self::ROUNDING * (reach + squared_distance),
        }
    }

    /// Pairs of entries. An odd last entry is paired with one that never matches.
    fn paired(reached: &[(u32, Self)]) -> Vec<([u32; 2], [Self; 2])> {
        let unreachable = Self {
            slope: Vector3::zero(),
            below: f64::NEG_INFINITY,
        };
        let paired = reached.chunks(2).map(|chunk| match *chunk {
            [(a, of_a), (b, of_b)] => ([a, b], [of_a, of_b]),
            _ => ([chunk[0].0; 2], [chunk[0].1, unreachable]),
        });
        paired.collect()
    }

    /// Negative if the body's bounding sphere at `centre` meets it. `squared` is the squared norm of `centre`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excess<V: LaneScalar>(&self, centre: Vector3<V>, squared: V) -> V {
        let side = squared - V::constant(self.below);
        let side = centre.x.mul_add(V::constant(self.slope.x), side);
        let side = centre.y.mul_add(V::constant(self.slope.y), side);
        centre.z.mul_add(V::constant(self.slope.z), side)
    }
}

impl Solids {
    /// Prepares shapes, each with its number and its placement in the chain's base frame.
    ///
    /// `margin` is the required distance in metres from all solids except the allowed ones in `allowed`.
    pub(crate) fn new<'a>(
        shapes: impl IntoIterator<Item = (u64, &'a Shape, Placement<f64>)>,
        chain: &BodyChain,
        allowed: Passed,
        margin: f64,
    ) -> Self {
        let all: Vec<_> = shapes.into_iter().collect();
        let simple = all.iter().filter(|(_, shape, _)| is_simple(shape)).count();
        let (listed, solid_tree): (Vec<_>, Vec<_>) = all
            .into_iter()
            .partition(|(number, shape, _)| is_listed(shape, simple) || allowed.has(*number));
        let placed = listed
            .into_iter()
            .map(|(number, shape, at)| (number, PlacedSolid::new(shape, at)));
        Self {
            listed: Arc::new(Listed::new(placed, chain, &allowed, margin)),
            solid_tree: (!solid_tree.is_empty()).then(|| SolidTree::new(solid_tree)),
            allowed,
            simple,
            margin,
        }
    }

    /// A copy with changes, which are in the order of their numbers.
    ///
    /// `None` if the allowed collisions differ, or if the number of solids requires the other search method.
    pub(crate) fn changed(
        &self,
        changes: &[SolidMoved<'_>],
        chain: &BodyChain,
        allowed: &Passed,
    ) -> Option<Self> {
        let count = |shapes: &mut dyn Iterator<Item = &Shape>| {
            shapes.filter(|shape| is_simple(shape)).count()
        };
        let before = count(&mut changes.iter().filter_map(|change| change.before));
        let after = count(&mut changes.iter().filter_map(|change| Some(change.after?.0)));
        let simple = (self.simple + after).checked_sub(before)?;
        if needs_tree(simple) != needs_tree(self.simple) || *allowed != self.allowed {
            return None;
        }
        let (mut listed, mut solid_tree): (Vec<SolidChange<'_>>, Vec<SolidChange<'_>>) =
            Default::default();
        for change in changes {
            let is_allowed = allowed.has(change.number);
            let is_listed = |shape: &&Shape| is_allowed || is_listed(shape, simple);
            let after = change.after.filter(|(shape, _)| is_listed(shape));
            if after.is_some() || change.before.filter(is_listed).is_some() {
                listed.push((change.number, after));
            }
            let after = change.after.filter(|(shape, _)| !is_listed(shape));
            if after.is_some() || change.before.filter(|shape| !is_listed(shape)).is_some() {
                solid_tree.push((change.number, after));
            }
        }
        let solid_tree = match &self.solid_tree {
            Some(current) => {
                Some(current.changed(&solid_tree)).filter(|solid_tree| !solid_tree.is_empty())
            }
            None => {
                let added = solid_tree.into_iter().filter_map(|(number, after)| {
                    let (shape, at) = after?;
                    Some((number, shape, at))
                });
                let added: Vec<_> = added.collect();
                (!added.is_empty()).then(|| SolidTree::new(added))
            }
        };
        let listed = match listed.is_empty() {
            true => Arc::clone(&self.listed),
            false => Arc::new(self.listed.changed(&listed, chain, allowed, self.margin)),
        };
        Some(Self {
            listed,
            solid_tree,
            allowed: allowed.clone(),
            simple,
            margin: self.margin,
        })
    }

    /// Solids in an AABB tree.
    pub(super) fn solid_tree(&self) -> Option<&SolidTree> {
        self.solid_tree.as_ref()
    }

    /// Required distance of the bodies from solids and from each other, metres.
    pub(super) fn margin(&self) -> f64 {
        self.margin
    }

    /// Indices of the listed solids nearer than the margin to the bounding sphere of a body in any lane.
    ///
    /// The bounding spheres of the solids come first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near<V: LaneScalar>(
        &self,
        body: usize,
        centre: Vector3<V>,
        chain: &BodyChain,
        near_solids: &mut Vec<u32>,
    ) {
        let reach = chain.bodies[body].bound.radius + self.margin;
        near_solids.clear();
        let squared = centre.norm_squared();
        // Two at a time, as most are far away.
        for (numbers, [a, b]) in &self.listed.within_reach[body] {
            let excess = [a.excess(centre, squared), b.excess(centre, squared)];
            // One comparison of the minimum: merging two masks is slower.
            if !V::any(excess[0].min(excess[1]).less_than(V::zero())) {
                continue;
            }
            for (&number, excess) in numbers.iter().zip(excess) {
                if V::any(excess.less_than(V::zero())) {
                    near_solids.push(number);
                }
            }
        }
        // A loop of its own, so that the first loop keeps the centre in registers.
        let mut near_count = 0;
        for index in 0..near_solids.len() {
            let number = near_solids[index];
            if V::any(self.is_near(number, centre, reach)) {
                near_solids[near_count] = number;
                near_count += 1;
            }
        }
        near_solids.truncate(near_count);
    }

    /// Mask of the lanes in which a point is in a solid or nearer than `reach`. The solid's bounding sphere comes
    /// first.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn near_one<V: LaneScalar>(
        &self,
        number: u32,
        point: Vector3<V>,
        reach: f64,
    ) -> V::Mask {
        let bound = &self.listed.placed[number as usize].bound;
        let max_distance = reach + bound.radius;
        let offset = point - Vector3::constant(bound.centre);
        let near = offset
            .norm_squared()
            .less_than(V::constant(max_distance * max_distance));
        match V::any(near) {
            true => self.is_near(number, point, reach),
            false => near,
        }
    }

    /// Mask of the lanes in which a point is in a solid or nearer than `reach`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_near<V: LaneScalar>(&self, number: u32, point: Vector3<V>, reach: f64) -> V::Mask {
        let c = V::constant;
        let placed = &self.listed.placed[number as usize];
        let p = Placement::constant(&placed.solid_from_base).apply(point);
        match &placed.solid {
            LaneSolid::Box([x, y, z]) => {
                let gap = Vector3::new(excess(p.x, *x), excess(p.y, *y), excess(p.z, *z));
                gap.norm_squared().less_than(c(reach * reach))
            }
            LaneSolid::Cylinder(radius, half) => {
                let from_axis = p.x.mul_add(p.x, p.y * p.y).sqrt();
                let (side, end) = (excess(from_axis, *radius), excess(p.z, *half));
                side.mul_add(side, end * end).less_than(c(reach * reach))
            }
            LaneSolid::Capsule(radius, half) => {
                let gap = Vector3::new(p.x, p.y, excess(p.z, *half));
                let reach = radius + reach;
                gap.norm_squared().less_than(c(reach * reach))
            }
            LaneSolid::Sphere(radius) => {
                let reach = radius + reach;
                p.norm_squared().less_than(c(reach * reach))
            }
            LaneSolid::HalfSpace => p.z.less_than(c(reach)),
            LaneSolid::Other(shape) => {
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
        solids: impl IntoIterator<Item = (u64, PlacedSolid)>,
        chain: &BodyChain,
        allowed: &Passed,
        margin: f64,
    ) -> Self {
        let (numbers, placed): (Vec<u64>, Vec<PlacedSolid>) = solids.into_iter().unzip();
        let reached = |(index, (reach_bound, body)): (usize, (Ball, &ChainBody))| {
            let reach = reach_bound.radius + margin;
            let checked = (0..).zip(&placed).zip(&numbers);
            let checked = checked.filter(|(_, number)| !allowed.is_allowed(index, **number));
            let near = checked.map(|(solid, _)| solid).filter(|(_, solid)| {
                let squared_distance = solid.bounds.squared_distance(reach_bound.centre);
                // NaN at a half-space's corner at infinity.
                squared_distance.is_nan() || squared_distance <= reach * reach
            });
            let near =
                near.map(|(n, solid)| (n, ReachableBound::new(&solid.bound, &body.bound, margin)));
            ReachableBound::paired(&near.collect::<Vec<_>>())
        };
        Self {
            within_reach: chain
                .reach_bounds()
                .into_iter()
                .zip(&chain.bodies)
                .enumerate()
                .map(reached)
                .collect(),
            numbers,
            placed,
        }
    }

    /// A copy with changes.
    fn changed(
        &self,
        changes: &[SolidChange<'_>],
        chain: &BodyChain,
        allowed: &Passed,
        margin: f64,
    ) -> Self {
        let is_unchanged = |(number, _): &(u64, PlacedSolid)| {
            changes
                .binary_search_by_key(number, |(changed, _)| *changed)
                .is_err()
        };
        let previous = self
            .numbers
            .iter()
            .copied()
            .zip(self.placed.iter().cloned());
        let mut all: Vec<_> = previous.filter(is_unchanged).collect();
        all.extend(changes.iter().filter_map(|(number, after)| {
            let (shape, at) = (*after)?;
            Some((*number, PlacedSolid::new(shape, at)))
        }));
        all.sort_by_key(|(number, _)| *number);
        Self::new(all, chain, allowed, margin)
    }
}

impl PlacedSolid {
    fn new(shape: &Shape, base_from_solid: Placement<f64>) -> Self {
        let local_bound = shape.bounding_sphere();
        Self {
            bound: Ball {
                centre: base_from_solid.apply(local_bound.centre),
                radius: local_bound.radius,
            },
            bounds: shape.bounding_box().placed(&base_from_solid),
            solid_from_base: base_from_solid.inverse(),
            solid: LaneSolid::of(shape),
        }
    }
}

/// True if the number of simple solids requires a tree.
fn needs_tree(simple: usize) -> bool {
    simple > MAX_LISTED
}

/// True if a shape is searched linearly, given the number of simple solids. Unbounded half-spaces always are.
fn is_listed(shape: &Shape, simple: usize) -> bool {
    shape.is_half_space() || is_simple(shape) && !needs_tree(simple)
}

/// True if the distance to a shape is cheap without a tree.
fn is_simple(shape: &Shape) -> bool {
    match shape.kind() {
        ShapeKind::Mesh(mesh) => mesh.triangles().len() <= MAX_SIMPLE_ELEMENTS,
        ShapeKind::Points(cloud) => cloud.positions().len() <= MAX_SIMPLE_ELEMENTS,
        ShapeKind::HeightField(_) => false,
        _ => true,
    }
}

impl LaneSolid {
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

/// Excess of the absolute value over `half`, at least 0.
#[cfg_attr(not(debug_assertions), inline(always))]
fn excess<V: LaneScalar>(value: V, half: f64) -> V {
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
