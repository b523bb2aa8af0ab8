//! AABB tree with eight boxes a node, for queries near a point.
//!
//! Eight boxes are compared at once in single precision. The boxes are rounded outward, and the query distance is
//! enlarged by the rounding of the point. No near item is lost, and the predicate tests the remaining items exactly.

use super::aabb_tree::{AabbTree, Contents};
use super::bounding_box::BoundingBox;
use kinopt_kinematics::spatial::Vector3;

/// Number of boxes a node, from three halvings.
const BOXES_PER_NODE: usize = 8;
const HALVINGS: usize = 3;
/// Bit of each lane. No bit is 1: with it the compiler computes the first lane separately.
const LANE_BITS: [u32; BOXES_PER_NODE] = [2, 4, 8, 16, 32, 64, 128, 256];
const ALL_BITS: u32 = 510;
/// Limit of coordinates and distances, metres: larger squares overflow single precision.
const MAX_COORDINATE: f64 = 1e18;
/// Stack size; exceeds the number of open nodes in a descent through 2³¹ items.
const STACK_SIZE: usize = 12;
/// Value of `count` that marks a child node.
const CHILD_NODE: u8 = u8::MAX;
/// Relative rounding bound, slightly above half the spacing of single-precision numbers. It also covers the rounding of
/// the arithmetic.
const SINGLE_ROUNDING: f64 = 1.2e-7;

/// Nodes over the items of an [`AabbTree`].
#[derive(Clone, Debug, Default)]
pub(super) struct WideNodes {
    nodes: Vec<WideNode>,
}

/// Eight boxes, coordinate by coordinate, and their contents; four cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct WideNode {
    min: [[f32; BOXES_PER_NODE]; 3],
    max: [[f32; BOXES_PER_NODE]; 3],
    /// Index of the child node, or of the first item.
    first: [u32; BOXES_PER_NODE],
    /// Number of items, or [`CHILD_NODE`].
    count: [u8; BOXES_PER_NODE],
}

/// Content of the smallest boxes.
#[derive(Clone, Copy)]
pub(super) enum LeafContent {
    /// One item each, with its box.
    Boxes,
    /// Up to eight points: single boxes would not be tighter.
    Points,
}

impl WideNodes {
    /// Converts a binary tree.
    ///
    /// `ranges` holds the range of each node among the tree's items. `bounds` returns the box of an item.
    pub(super) fn new(
        tree: &AabbTree,
        ranges: &[[u32; 2]],
        small: LeafContent,
        bounds: impl Fn(usize) -> BoundingBox,
    ) -> Self {
        let mut wide_nodes = Self::default();
        if ranges.is_empty() {
            return wide_nodes;
        }
        let is_small = |node: u32| -> bool {
            let [start, end] = ranges[node as usize];
            (end - start) as usize <= BOXES_PER_NODE
        };
        // About one node for 3 items, or for 24 points.
        wide_nodes.nodes.reserve(match small {
            LeafContent::Boxes => tree.items().len().div_ceil(3),
            LeafContent::Points => tree.items().len().div_ceil(24),
        });
        wide_nodes.nodes.push(WideNode::EMPTY);
        // Nodes that remain to be filled, each with its node of the binary tree.
        let mut pending = vec![(0, 0)];
        while let Some((from, node)) = pending.pop() {
            if is_small(from) && matches!(small, LeafContent::Boxes) {
                let [start, end] = ranges[from as usize];
                for (lane, position) in (start..end).enumerate() {
                    let item = tree.items()[position as usize];
                    wide_nodes.nodes[node].fill(lane, &bounds(item as usize), position, 1);
                }
                continue;
            }
            let (parts, count) = descendants(tree, from, is_small);
            for (lane, &part) in parts[..count].iter().enumerate() {
                let part_bounds = tree.node_bounds(part);
                let [start, end] = ranges[part as usize];
                if is_small(part) && matches!(small, LeafContent::Points) {
                    wide_nodes.nodes[node].fill(lane, &part_bounds, start, (end - start) as u8);
                    continue;
                }
                let child = wide_nodes.nodes.len();
                wide_nodes.nodes.push(WideNode::EMPTY);
                wide_nodes.nodes[node].fill(lane, &part_bounds, child as u32, CHILD_NODE);
                pending.push((part, child));
            }
        }
        wide_nodes
    }

    /// True if `predicate` holds for an item whose box is nearer to `point` than `reach`, metres.
    ///
    /// `items` are the items of the binary tree. Items whose boxes are slightly farther may be tested as well.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn any<M: Predicate<u32>>(
        &self,
        items: &[u32],
        point: Vector3<f64>,
        reach: f64,
        predicate: &M,
    ) -> bool {
        let Some(root) = self.nodes.first() else {
            return false;
        };
        let position = [point.x as f32, point.y as f32, point.z as f32];
        let size = point.x.abs() + point.y.abs() + point.z.abs();
        let reach = (reach.abs() + size * SINGLE_ROUNDING) * (1.0 + 16.0 * SINGLE_ROUNDING);
        // Squares of tiny distances underflow in single precision.
        let max_squared_distance = (reach * reach) as f32 + f32::MIN_POSITIVE;
        let always_open = if size + reach < MAX_COORDINATE {
            0
        } else {
            ALL_BITS
        };
        // Stack of nodes with boxes left to open, one bit a box.
        let mut stack = [(0_u32, 0_u32); STACK_SIZE];
        let mut height = 0;
        let mut node = root;
        let mut index = 0;
        let mut open = root.near(position, max_squared_distance) | always_open;
        loop {
            while open == 0 {
                if height == 0 {
                    return false;
                }
                height -= 1;
                (index, open) = stack[height];
                node = &self.nodes[index as usize];
            }
            let lane = (open.trailing_zeros() as usize).wrapping_sub(1) % BOXES_PER_NODE;
            open &= open - 1;
            let first = node.first[lane];
            match node.count[lane] {
                CHILD_NODE => {
                    let child = &self.nodes[first as usize];
                    let nearby = child.near(position, max_squared_distance) | always_open;
                    if nearby != 0 {
                        stack[height] = (index, open);
                        height += usize::from(open != 0);
                        (node, index, open) = (child, first, nearby);
                    }
                }
                count => {
                    let first = first as usize;
                    for &item in &items[first..first + usize::from(count)] {
                        if predicate.is_met(item) {
                            return true;
                        }
                    }
                }
            }
        }
    }
}

/// Predicate on nearby items. A trait, since closures are not compiled for the selected instruction set.
#[doc(hidden)]
pub trait Predicate<T> {
    /// True if the predicate holds for an item.
    fn is_met(&self, thing: T) -> bool;
}

/// The nodes up to three levels below a node, or fewer levels for small nodes, and their number.
fn descendants(
    tree: &AabbTree,
    node: u32,
    is_small: impl Fn(u32) -> bool,
) -> ([u32; BOXES_PER_NODE], usize) {
    let (mut parts, mut count) = ([node; BOXES_PER_NODE], 1);
    for _ in 0..HALVINGS {
        let (previous, previous_count) = (parts, count);
        count = 0;
        for &part in &previous[..previous_count] {
            let halves = match tree.contents(part) {
                Contents::Nodes(halves) if !is_small(part) => halves,
                _ => [part; 2],
            };
            parts[count] = halves[0];
            count += 1;
            if halves[1] != halves[0] {
                parts[count] = halves[1];
                count += 1;
            }
        }
    }
    (parts, count)
}

impl WideNode {
    /// A node of empty boxes without contents.
    const EMPTY: Self = Self {
        min: [[f32::INFINITY; BOXES_PER_NODE]; 3],
        max: [[f32::NEG_INFINITY; BOXES_PER_NODE]; 3],
        first: [0; BOXES_PER_NODE],
        count: [0; BOXES_PER_NODE],
    };

    fn fill(&mut self, lane: usize, bounds: &BoundingBox, first: u32, count: u8) {
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        for axis in 0..3 {
            self.min[axis][lane] = rounded_down(min[axis]);
            self.max[axis][lane] = -rounded_down(-max[axis]);
        }
        self.first[lane] = first;
        self.count[lane] = count;
    }

    /// Bit mask of the boxes whose squared distance to a point is at most `max_squared_distance`.
    #[allow(
        clippy::needless_range_loop,
        reason = "lane by lane, as the compiler takes them together"
    )]
    #[inline(always)]
    fn near(&self, point: [f32; 3], max_squared_distance: f32) -> u32 {
        // Loops over eight lanes vectorise. A comparison would not: the compiler gathers its bits one by one.
        let mut squared = [0.0; BOXES_PER_NODE];
        for axis in 0..3 {
            for lane in 0..BOXES_PER_NODE {
                let below = self.min[axis][lane] - point[axis];
                let above = point[axis] - self.max[axis][lane];
                // Not `f32::max`: its NaN handling costs extra instructions.
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                squared[lane] += gap * gap;
            }
        }
        let mut far_bits = 0;
        for lane in 0..BOXES_PER_NODE {
            let sign = (max_squared_distance - squared[lane]).to_bits() as i32 >> 31;
            far_bits |= sign as u32 & LANE_BITS[lane];
        }
        !far_bits & ALL_BITS
    }
}

/// The greatest single-precision number not above `value`.
fn rounded_down(value: f64) -> f32 {
    let single = value as f32;
    match f64::from(single) > value {
        true => single.next_down(),
        false => single,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    use kinopt_kinematics::random::RandomStream;

    /// Records the tested items; the predicate is never true.
    #[derive(Default)]
    struct Recorder(RefCell<Vec<u32>>);

    impl Predicate<u32> for Recorder {
        fn is_met(&self, item: u32) -> bool {
            self.0.borrow_mut().push(item);
            false
        }
    }

    struct Counted(RefCell<usize>, u32);

    impl Predicate<u32> for Counted {
        fn is_met(&self, item: u32) -> bool {
            *self.0.borrow_mut() += 1;
            item == self.1
        }
    }

    #[test]
    fn search_ends_at_the_first_match() {
        let tree = AabbTree::new(100, |i| {
            BoundingBox::around([Vector3::new(i as f64, 0.0, 0.0)])
        });
        let counted = Counted(RefCell::new(0), 40);
        assert!(tree.any(Vector3::zero(), 200.0, &counted));
        assert!(*counted.0.borrow() < 100);
    }

    /// The tested items. No item occurs twice.
    fn tested_items(tree: &AabbTree, point: Vector3<f64>, reach: f64) -> Vec<u32> {
        let all = Recorder::default();
        assert!(!tree.any(point, reach, &all));
        let mut tested_items = all.0.into_inner();
        tested_items.sort_unstable();
        assert!(tested_items.windows(2).all(|pair| pair[0] < pair[1]));
        tested_items
    }

    /// A number sampled uniformly within [-1, 1).
    fn signed(stream: &mut RandomStream) -> f64 {
        2.0 * stream.unit() - 1.0
    }

    /// A point with each coordinate in [-`size`, `size`).
    fn point_in_cube(stream: &mut RandomStream, size: f64) -> Vector3<f64> {
        Vector3::new(signed(stream), signed(stream), signed(stream)) * size
    }

    #[test]
    fn search_visits_near_boxes_and_few_others() {
        let stream = &mut RandomStream::new(7, 0);
        for (scale, offset) in [
            (1.0, 0.0),
            (1e-12, 0.0),
            (1e-30, 0.0),
            (1e15, 0.0),
            (1.0, 1e6),
        ] {
            for count in [0, 1, 2, 7, 8, 9, 33, 64, 65, 700] {
                let middle = Vector3::new(offset, -offset, offset);
                let boxes: Vec<_> = (0..count)
                    .map(|_| {
                        let corner = middle + point_in_cube(stream, scale);
                        BoundingBox::around([corner, corner + point_in_cube(stream, 0.05 * scale)])
                    })
                    .collect();
                let points: Vec<_> = boxes.iter().map(|bounds| bounds.min).collect();
                let trees = [
                    (AabbTree::new(count, |i| boxes[i]), false),
                    (AabbTree::of_points(&points), true),
                ];
                let (mut extra_tests, mut near_count) = (0, 0);
                for _ in 0..200 {
                    let point = middle + point_in_cube(stream, 1.2 * scale);
                    let reach = (0.15 + 0.15 * signed(stream)) * scale;
                    for (tree, are_points) in &trees {
                        let near = |item: &u32| {
                            let bounds = match are_points {
                                true => BoundingBox::around([points[*item as usize]]),
                                false => boxes[*item as usize],
                            };
                            bounds.squared_distance(point) < reach * reach
                        };
                        let tested = tested_items(tree, point, reach);
                        let expected: Vec<u32> = (0..count as u32).filter(near).collect();
                        let missing = expected.iter().find(|item| !tested.contains(item));
                        assert_eq!(missing, None, "{scale} {offset} {count}");
                        if !are_points {
                            extra_tests += tested.len() - expected.len();
                            near_count += expected.len();
                        }
                    }
                }
                // Squares of the smallest coordinates underflow in single precision.
                assert!(scale < 1e-20 || offset > 0.0 || 100 * extra_tests <= near_count);
            }
        }
    }

    #[test]
    fn search_handles_huge_and_nan_coordinates() {
        let boxes = [1e39, -1e39, 3.0, 1e300].map(|x| {
            let at = Vector3::new(x, 0.0, 0.0);
            BoundingBox::around([at, at * 1.5])
        });
        let tree = AabbTree::new(4, |i| boxes[i]);
        for (at, reach) in [
            (1.2e39, 1.0),
            (-1e39, 1e38),
            (2.5, 0.6),
            (1.2e300, 1e299),
            (0.0, 1e301),
        ] {
            let point = Vector3::new(at, 0.0, 0.0);
            let tested = tested_items(&tree, point, reach);
            for (item, bounds) in boxes.iter().enumerate() {
                let gap = (bounds.min.x - at).max(at - bounds.max.x);
                assert!(gap >= reach || tested.contains(&(item as u32)));
            }
        }
        let nan_point = Vector3::new(f64::NAN, 0.0, 0.0);
        assert!(!tree.any(nan_point, 1.0, &Recorder::default()));
    }
}
