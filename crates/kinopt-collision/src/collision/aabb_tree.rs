//! AABB tree over points, triangles or obstacles.

use super::bounding_box::BoundingBox;
use super::wide_aabb_tree::{LeafContent, Predicate, WideNodes};
use kinopt_kinematics::spatial::Vector3;

/// Largest number of items in a leaf.
const MAX_LEAF_ITEMS: usize = 4;
/// Stack size; exceeds the depth of a tree of 2³¹ items, since each node is split in halves.
const STACK_SIZE: usize = 40;

/// Binary AABB tree over items that are identified by index.
#[derive(Clone, Debug, Default)]
pub(crate) struct AabbTree {
    nodes: Vec<AabbNode>,
    /// Item indices, ordered so that the items of each leaf are contiguous.
    items: Vec<u32>,
    wide_nodes: WideNodes,
}

#[derive(Clone, Copy, Debug)]
struct AabbNode {
    bounds: BoundingBox,
    /// Range of `items` for a leaf, else the indices of the two children.
    first: u32,
    second: u32,
    leaf: bool,
}

/// Contents of a node.
pub(crate) enum Contents<'a> {
    /// Item indices of a leaf.
    Items(&'a [u32]),
    /// Indices of the two children.
    Nodes([u32; 2]),
}

impl AabbTree {
    /// Builds a tree over `count` items, at most 2³¹, from their boxes.
    pub(crate) fn new(count: usize, bounds: impl Fn(usize) -> BoundingBox) -> Self {
        Self::of(count, LeafContent::Boxes, bounds)
    }

    /// Builds a tree over points.
    pub(crate) fn of_points(points: &[Vector3<f64>]) -> Self {
        let bounds = |index: usize| BoundingBox::around([points[index]]);
        Self::of(points.len(), LeafContent::Points, bounds)
    }

    fn of(count: usize, small: LeafContent, bounds: impl Fn(usize) -> BoundingBox) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(count.div_ceil(MAX_LEAF_ITEMS) * 2),
            items: (0..count as u32).collect(),
            wide_nodes: WideNodes::default(),
        };
        if count == 0 {
            return tree;
        }
        let centres: Vec<_> = (0..count).map(|i| bounds(i).centre()).collect();
        // Ranges that remain to be split, each with its node.
        let mut pending = vec![(0, count, tree.push())];
        let mut ranges = Vec::with_capacity(tree.nodes.capacity());
        while let Some((start, end, node)) = pending.pop() {
            ranges.resize(tree.nodes.len(), [0; 2]);
            ranges[node] = [start as u32, end as u32];
            let items = &mut tree.items[start..end];
            if items.len() <= MAX_LEAF_ITEMS {
                let item_bounds = items.iter().map(|&i| bounds(i as usize));
                tree.nodes[node].bounds = item_bounds.fold(BoundingBox::EMPTY, BoundingBox::union);
                tree.nodes[node].first = start as u32;
                tree.nodes[node].second = end as u32;
                continue;
            }
            let spread = BoundingBox::around(items.iter().map(|&i| centres[i as usize]));
            let axis = longest(spread.max - spread.min);
            let coordinate = |&i: &u32| centres[i as usize].to_array()[axis];
            let middle = items.len() / 2;
            items.select_nth_unstable_by(middle, |a, b| coordinate(a).total_cmp(&coordinate(b)));
            let children = [tree.push(), tree.push()];
            tree.nodes[node].first = children[0] as u32;
            tree.nodes[node].second = children[1] as u32;
            tree.nodes[node].leaf = false;
            pending.push((start, start + middle, children[0]));
            pending.push((start + middle, end, children[1]));
        }
        // Children have greater indices than their parents.
        for node in (0..tree.nodes.len()).rev() {
            if let Contents::Nodes(children) = tree.contents(node as u32) {
                let [a, b] = children.map(|child| tree.node_bounds(child));
                tree.nodes[node].bounds = a.union(b);
            }
        }
        tree.wide_nodes = WideNodes::new(&tree, &ranges, small, bounds);
        tree
    }

    fn push(&mut self) -> usize {
        self.nodes.push(AabbNode {
            bounds: BoundingBox::EMPTY,
            first: 0,
            second: 0,
            leaf: true,
        });
        self.nodes.len() - 1
    }

    /// The box around all items; empty without items.
    pub(crate) fn bounds(&self) -> BoundingBox {
        self.nodes
            .first()
            .map_or(BoundingBox::EMPTY, |node| node.bounds)
    }

    /// Item indices, ordered so that the items of each node are contiguous.
    pub(super) fn items(&self) -> &[u32] {
        &self.items
    }

    #[inline]
    pub(crate) fn node_bounds(&self, node: u32) -> BoundingBox {
        self.nodes[node as usize].bounds
    }

    /// Contents of a node. Node 0 is the root.
    #[inline]
    pub(crate) fn contents(&self, node: u32) -> Contents<'_> {
        let node = &self.nodes[node as usize];
        match node.leaf {
            true => Contents::Items(&self.items[node.first as usize..node.second as usize]),
            false => Contents::Nodes([node.first, node.second]),
        }
    }

    /// True if `predicate` holds for an item whose box is nearer to `point` than `reach`, metres.
    ///
    /// The order of the tests is unspecified. Items whose boxes are slightly farther may be tested as well.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn any<M: Predicate<u32>>(
        &self,
        point: Vector3<f64>,
        reach: f64,
        predicate: &M,
    ) -> bool {
        self.wide_nodes.any(&self.items, point, reach, predicate)
    }

    /// Branch-and-bound search, nearer child first.
    ///
    /// `bound` returns a lower bound of the value of all items in a box. `visit` receives an item and the best value,
    /// and returns the new best value. Boxes whose bound is not below the best value are skipped. Returns the best
    /// value.
    pub(crate) fn nearest(
        &self,
        mut best: f64,
        bound: impl Fn(&BoundingBox) -> f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        if self.nodes.is_empty() {
            return best;
        }
        let mut stack = [(0, 0.0); STACK_SIZE];
        stack[0] = (0, bound(&self.nodes[0].bounds));
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (node, lower_bound) = stack[height];
            if lower_bound >= best {
                continue;
            }
            match self.contents(node) {
                Contents::Items(items) => {
                    for &item in items {
                        best = visit(item, best);
                    }
                }
                Contents::Nodes([a, b]) => {
                    let a = (a, bound(&self.nodes[a as usize].bounds));
                    let b = (b, bound(&self.nodes[b as usize].bounds));
                    let (nearer, farther) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    stack[height] = farther;
                    stack[height + 1] = nearer;
                    height += 2;
                }
            }
        }
        best
    }
}

fn longest(extent: Vector3<f64>) -> usize {
    let [x, y, z] = extent.to_array();
    match (x >= y && x >= z, y >= z) {
        (true, _) => 0,
        (_, true) => 1,
        _ => 2,
    }
}
