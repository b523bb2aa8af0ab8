//! A tree of boxes over many things, for clouds, meshes and height fields.

use super::bounding_box::BoundingBox;
use super::wide_nodes::{Met, Small, WideNodes};
use crate::spatial::Vector3;

/// Things in one leaf at most.
const LEAF: usize = 4;
/// More than a tree of 2³¹ things is deep, as both halves of a node are of one size.
const DEEP: usize = 40;

/// Boxes around boxes around things that are told apart by number.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    /// The things' numbers, so that those of one leaf stand together.
    items: Vec<u32>,
    wide: WideNodes,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: BoundingBox,
    /// Of a leaf the range of `items`; else the two children's indices.
    first: u32,
    second: u32,
    leaf: bool,
}

/// What a node holds.
pub(crate) enum Contents<'a> {
    /// These things.
    Items(&'a [u32]),
    /// These nodes.
    Nodes([u32; 2]),
}

impl BoxTree {
    /// Over `count` things, at most 2³¹, with their boxes.
    pub(crate) fn new(count: usize, bounds: impl Fn(usize) -> BoundingBox) -> Self {
        Self::of(count, Small::Boxes, bounds)
    }

    /// Over points.
    pub(crate) fn of_points(points: &[Vector3<f64>]) -> Self {
        let bounds = |place: usize| BoundingBox::around([points[place]]);
        Self::of(points.len(), Small::Points, bounds)
    }

    fn of(count: usize, small: Small, bounds: impl Fn(usize) -> BoundingBox) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(count.div_ceil(LEAF) * 2),
            items: (0..count as u32).collect(),
            wide: WideNodes::default(),
        };
        if count == 0 {
            return tree;
        }
        let centres: Vec<_> = (0..count).map(|i| bounds(i).centre()).collect();
        // Ranges that are still to be split, each with the node it becomes.
        let mut left = vec![(0, count, tree.push())];
        let mut ranges = Vec::with_capacity(tree.nodes.capacity());
        while let Some((start, end, node)) = left.pop() {
            ranges.resize(tree.nodes.len(), [0; 2]);
            ranges[node] = [start as u32, end as u32];
            let items = &mut tree.items[start..end];
            if items.len() <= LEAF {
                let around = items.iter().map(|&i| bounds(i as usize));
                tree.nodes[node].bounds = around.fold(BoundingBox::EMPTY, BoundingBox::union);
                tree.nodes[node].first = start as u32;
                tree.nodes[node].second = end as u32;
                continue;
            }
            let spread = BoundingBox::around(items.iter().map(|&i| centres[i as usize]));
            let axis = longest(spread.max - spread.min);
            let at = |&i: &u32| centres[i as usize].to_array()[axis];
            let middle = items.len() / 2;
            items.select_nth_unstable_by(middle, |a, b| at(a).total_cmp(&at(b)));
            let children = [tree.push(), tree.push()];
            tree.nodes[node].first = children[0] as u32;
            tree.nodes[node].second = children[1] as u32;
            tree.nodes[node].leaf = false;
            left.push((start, start + middle, children[0]));
            left.push((start + middle, end, children[1]));
        }
        // Children come after their parents.
        for node in (0..tree.nodes.len()).rev() {
            if let Contents::Nodes(children) = tree.contents(node as u32) {
                let [a, b] = children.map(|child| tree.node_bounds(child));
                tree.nodes[node].bounds = a.union(b);
            }
        }
        tree.wide = WideNodes::new(&tree, &ranges, small, bounds);
        tree
    }

    fn push(&mut self) -> usize {
        self.nodes.push(Node {
            bounds: BoundingBox::EMPTY,
            first: 0,
            second: 0,
            leaf: true,
        });
        self.nodes.len() - 1
    }

    /// The box around all.
    pub(crate) fn bounds(&self) -> BoundingBox {
        self.nodes
            .first()
            .map_or(BoundingBox::EMPTY, |node| node.bounds)
    }

    /// The things' numbers, so that those of one node stand together.
    pub(super) fn items(&self) -> &[u32] {
        &self.items
    }

    /// The box around a node.
    #[inline]
    pub(crate) fn node_bounds(&self, node: u32) -> BoundingBox {
        self.nodes[node as usize].bounds
    }

    /// What a node holds; node 0 holds all.
    #[inline]
    pub(crate) fn contents(&self, node: u32) -> Contents<'_> {
        let node = &self.nodes[node as usize];
        match node.leaf {
            true => Contents::Items(&self.items[node.first as usize..node.second as usize]),
            false => Contents::Nodes([node.first, node.second]),
        }
    }

    /// Whether any of the things whose boxes are nearer to a point than so far is met, in no order; some that are farther are asked about
    /// as well.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn any<M: Met<u32>>(&self, point: Vector3<f64>, reach: f64, met: &M) -> bool {
        self.wide.any(&self.items, point, reach, met)
    }

    /// Visits things in the order of nearness, as far as boxes tell: `bound` is the least that a box may hold,
    /// `visit` gets a thing and gives the least value so far, beyond which nothing is visited.
    pub(crate) fn nearest(
        &self,
        mut best: f64,
        bound: impl Fn(&BoundingBox) -> f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        if self.nodes.is_empty() {
            return best;
        }
        let mut stack = [(0, 0.0); DEEP];
        stack[0] = (0, bound(&self.nodes[0].bounds));
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (node, least) = stack[height];
            if least >= best {
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
                    let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    stack[height] = far;
                    stack[height + 1] = near;
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
