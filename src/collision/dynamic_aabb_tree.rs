//! Dynamic AABB tree over items of which a few change at a time.
//!
//! Unchanged items stay in a large tree, which copies share. Changed items are in a small tree. Replaced items of the
//! large tree are skipped. Once the number of changes exceeds about the square root of the number of items, all items
//! move to one new tree.

use std::sync::Arc;

use super::aabb_tree::AabbTree;
use super::bounding_box::BoundingBox;
use super::wide_aabb_tree::Predicate;
use crate::spatial::Vector3;

/// Items in the order of their numbers, and an AABB tree over their boxes.
#[derive(Clone, Debug)]
struct NumberedItems<T> {
    numbers: Vec<u64>,
    items: Vec<T>,
    bounds: Vec<BoundingBox>,
    tree: AabbTree,
}

/// Items with numbers and boxes. An index selects an item: first those of `old`, then those of `new`.
#[derive(Clone, Debug)]
pub(crate) struct DynamicAabbTree<T> {
    old: Arc<NumberedItems<T>>,
    /// Indices in `old` of removed or replaced items, in order.
    removed: Vec<u32>,
    new: NumberedItems<T>,
}

/// A number with its new item and box; `None` removes the item.
pub(crate) type ItemChange<T> = (u64, Option<(T, BoundingBox)>);

/// True if an index is in a sorted list.
#[inline]
fn is_in(indices: &[u32], index: u32) -> bool {
    !indices.is_empty() && indices.binary_search(&index).is_ok()
}

impl<T: Clone> DynamicAabbTree<T> {
    /// Builds a tree from items in the order of their numbers.
    pub(crate) fn new(items: impl IntoIterator<Item = (u64, T, BoundingBox)>) -> Self {
        Self {
            old: Arc::new(NumberedItems::new(items)),
            removed: Vec::new(),
            new: NumberedItems::default(),
        }
    }

    /// A copy with changes, which are in the order of their numbers.
    pub(crate) fn changed(&self, changes: Vec<ItemChange<T>>) -> Self {
        if changes.is_empty() {
            return self.clone();
        }
        let replaced = |number: u64| {
            changes
                .binary_search_by_key(&number, |change| change.0)
                .is_ok()
        };
        let replaced_indices = changes
            .iter()
            .filter_map(|(number, _)| self.old.index_of(*number));
        let mut removed: Vec<u32> = self
            .removed
            .iter()
            .copied()
            .chain(replaced_indices)
            .collect();
        removed.sort_unstable();
        removed.dedup();
        let unchanged = self.new.iter().filter(|(number, ..)| !replaced(*number));
        let mut new: Vec<_> = unchanged.collect();
        let added = changes.iter();
        new.extend(added.filter_map(|(number, new_item)| {
            let (item, bounds) = new_item.clone()?;
            Some((*number, item, bounds))
        }));
        if new.len() + removed.len() > max_small_size(self.old.numbers.len()) {
            let old = (0..).zip(self.old.iter());
            let old = old.filter(|(index, _)| removed.binary_search(index).is_err());
            new.extend(old.map(|(_, item)| item));
            new.sort_unstable_by_key(|(number, ..)| *number);
            return Self::new(new);
        }
        new.sort_unstable_by_key(|(number, ..)| *number);
        Self {
            old: Arc::clone(&self.old),
            removed,
            new: NumberedItems::new(new),
        }
    }
}

/// Largest size of the small tree plus the removed items. It is below `old / 8`, since two trees of half the items are
/// slower than one.
fn max_small_size(old: usize) -> usize {
    (2 * old.isqrt()).min(old / 8)
}

impl<T> DynamicAabbTree<T> {
    #[must_use]
    pub(crate) fn is_empty(&self) -> bool {
        self.old.numbers.len() == self.removed.len() && !self.has_new()
    }

    /// True if the small tree holds an item.
    #[must_use]
    pub(crate) fn has_new(&self) -> bool {
        !self.new.numbers.is_empty()
    }

    /// The stock that holds an item, and the item's index in that stock.
    #[inline]
    fn at(&self, index: u32) -> (&NumberedItems<T>, usize) {
        let old = self.old.numbers.len();
        match (index as usize).checked_sub(old) {
            None => (&self.old, index as usize),
            Some(index) => (&self.new, index),
        }
    }

    #[inline]
    pub(crate) fn item(&self, index: u32) -> &T {
        let (stored, at) = self.at(index);
        &stored.items[at]
    }

    #[inline]
    pub(crate) fn bounds(&self, index: u32) -> &BoundingBox {
        let (stored, at) = self.at(index);
        &stored.bounds[at]
    }

    /// Number of an item. Items of one tree are in the order of their numbers.
    #[inline]
    pub(crate) fn number(&self, index: u32) -> u64 {
        let (stored, at) = self.at(index);
        stored.numbers[at]
    }

    /// True if both share the large tree.
    #[cfg(test)]
    pub(crate) fn shares_old(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.old, &other.old)
    }

    /// True if an item of the large tree was removed or replaced.
    #[inline]
    fn is_removed(&self, index: u32) -> bool {
        is_in(&self.removed, index)
    }

    /// True if `predicate` holds for an item near a point, as [`AabbTree::any`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn any<M>(&self, point: Vector3<f64>, reach: f64, predicate: &M) -> bool
    where
        M: for<'a> Predicate<&'a T>,
    {
        for (stored, removed) in [(&*self.old, &*self.removed), (&self.new, &[])] {
            let remaining = RemainingMatches {
                stored,
                removed,
                predicate,
            };
            if stored.tree.any(point, reach, &remaining) {
                return true;
            }
        }
        false
    }

    /// Visits item indices as [`AabbTree::nearest`] does.
    pub(crate) fn nearest(
        &self,
        best: f64,
        bound: impl Fn(&BoundingBox) -> f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        let best =
            (self.old.tree).nearest(best, &bound, |index, best| match self.is_removed(index) {
                true => best,
                false => visit(index, best),
            });
        let first = self.old.numbers.len() as u32;
        (self.new.tree).nearest(best, bound, |index, best| visit(first + index, best))
    }
}

/// Predicate over the items of a stock, without the removed ones.
struct RemainingMatches<'a, T, M> {
    stored: &'a NumberedItems<T>,
    removed: &'a [u32],
    predicate: &'a M,
}

impl<T, M> Predicate<u32> for RemainingMatches<'_, T, M>
where
    M: for<'a> Predicate<&'a T>,
{
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, index: u32) -> bool {
        !is_in(self.removed, index) && self.predicate.is_met(&self.stored.items[index as usize])
    }
}

impl<T> NumberedItems<T> {
    fn new(items: impl IntoIterator<Item = (u64, T, BoundingBox)>) -> Self {
        let mut stored = Self::default();
        for (number, item, bounds) in items {
            stored.numbers.push(number);
            stored.items.push(item);
            stored.bounds.push(bounds);
        }
        stored.tree = AabbTree::new(stored.numbers.len(), |index| stored.bounds[index]);
        stored
    }

    fn index_of(&self, number: u64) -> Option<u32> {
        let index = self.numbers.binary_search(&number).ok()?;
        Some(index as u32)
    }
}

impl<T: Clone> NumberedItems<T> {
    fn iter(&self) -> impl Iterator<Item = (u64, T, BoundingBox)> {
        let items = self.numbers.iter().zip(&self.items).zip(&self.bounds);
        items.map(|((number, item), bounds)| (*number, item.clone(), *bounds))
    }
}

impl<T> Default for NumberedItems<T> {
    fn default() -> Self {
        Self {
            numbers: Vec::new(),
            items: Vec::new(),
            bounds: Vec::new(),
            tree: AabbTree::default(),
        }
    }
}

impl<T> Default for DynamicAabbTree<T> {
    fn default() -> Self {
        Self {
            old: Arc::default(),
            removed: Vec::new(),
            new: NumberedItems::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    /// Records the tested items; the predicate is never true.
    #[derive(Default)]
    struct Recorder(RefCell<Vec<&'static str>>);

    impl Predicate<&&'static str> for Recorder {
        fn is_met(&self, item: &&'static str) -> bool {
            self.0.borrow_mut().push(item);
            false
        }
    }

    fn around(x: f64) -> BoundingBox {
        BoundingBox::around([Vector3::new(x, 0.0, 0.0), Vector3::new(x + 0.5, 1.0, 1.0)])
    }

    /// All items whose boxes contain the coordinate along x, in the order of their numbers.
    fn matches(tree: &DynamicAabbTree<&'static str>, x: f64) -> Vec<(u64, &'static str)> {
        let mut matches = Vec::new();
        let squared_distance =
            |bounds: &BoundingBox| bounds.squared_distance(Vector3::new(x, 0.5, 0.5));
        tree.nearest(1e-9, squared_distance, |index, best| {
            if squared_distance(tree.bounds(index)) == 0.0 {
                matches.push((tree.number(index), *tree.item(index)));
            }
            best
        });
        matches.sort_unstable();
        let mut items: Vec<_> = matches.iter().map(|(_, item)| *item).collect();
        let recorder = Recorder::default();
        assert!(!tree.any(Vector3::new(x, 0.5, 0.5), 1e-9, &recorder));
        let mut tested = recorder.0.into_inner();
        items.sort_unstable();
        tested.sort_unstable();
        assert_eq!(items, tested);
        matches
    }

    #[test]
    fn dynamic_tree_few_changes_share_the_large_tree() {
        let all = (0..1000).map(|number| (number, "old", around(number as f64)));
        let first = DynamicAabbTree::new(all);
        assert_eq!(matches(&first, 10.2), [(10, "old")]);
        let moved = first.changed(vec![(10, Some(("new", around(20.1)))), (11, None)]);
        assert!(moved.shares_old(&first));
        assert!(matches(&moved, 10.2).is_empty() && matches(&moved, 11.2).is_empty());
        assert_eq!(matches(&moved, 20.2), [(10, "new"), (20, "old")]);
        // Repeated changes of one item count as one.
        let mut again = moved.clone();
        for step in 0..500 {
            again = again.changed(vec![(10, Some(("again", around(f64::from(step)))))]);
        }
        assert!(again.shares_old(&first));
        assert_eq!(matches(&again, 499.2), [(10, "again"), (499, "old")]);
        let others = (0..500).map(|number| (2 * number, Some(("other", around(number as f64)))));
        let many = again.changed(others.collect());
        assert!(!many.shares_old(&first) && !many.has_new());
        assert_eq!(matches(&many, 77.2), [(77, "old"), (154, "other")]);
        // The first tree is unchanged.
        assert_eq!(matches(&first, 10.2), [(10, "old")]);
    }
}
