//! Dynamic AABB tree over items of which a few change at a time.
//!
//! Unchanged items stay in a large tree, which copies share. Changed items are in a small tree. Replaced items of the
//! large tree are skipped. Once the number of changes exceeds about the square root of the number of items, all items
//! move to one new tree.

use std::sync::Arc;

use super::aabb_tree::BoxTree;
use super::bounding_box::BoundingBox;
use super::wide_aabb_tree::Met;
use crate::spatial::Vector3;

/// Items in the order of their numbers, and an AABB tree over their boxes.
#[derive(Clone, Debug)]
struct Stock<T> {
    numbers: Vec<u64>,
    things: Vec<T>,
    bounds: Vec<BoundingBox>,
    tree: BoxTree,
}

/// Items with numbers and boxes. An index selects an item: first those of `old`, then those of `new`.
#[derive(Clone, Debug)]
pub(crate) struct ChangingTree<T> {
    old: Arc<Stock<T>>,
    /// Indices in `old` of removed or replaced items, in order.
    gone: Vec<u32>,
    new: Stock<T>,
}

/// A number with its new item and box; `None` removes the item.
pub(crate) type Changed<T> = (u64, Option<(T, BoundingBox)>);

/// True if an index is in a sorted list.
#[inline]
fn is_in(places: &[u32], place: u32) -> bool {
    !places.is_empty() && places.binary_search(&place).is_ok()
}

impl<T: Clone> ChangingTree<T> {
    /// Builds a tree from items in the order of their numbers.
    pub(crate) fn new(things: impl IntoIterator<Item = (u64, T, BoundingBox)>) -> Self {
        Self {
            old: Arc::new(Stock::new(things)),
            gone: Vec::new(),
            new: Stock::default(),
        }
    }

    /// A copy with changes, which are in the order of their numbers.
    pub(crate) fn changed(&self, changes: Vec<Changed<T>>) -> Self {
        if changes.is_empty() {
            return self.clone();
        }
        let replaced = |number: u64| {
            changes
                .binary_search_by_key(&number, |change| change.0)
                .is_ok()
        };
        let places = changes
            .iter()
            .filter_map(|(number, _)| self.old.place_of(*number));
        let mut gone: Vec<u32> = self.gone.iter().copied().chain(places).collect();
        gone.sort_unstable();
        gone.dedup();
        let kept = self.new.iter().filter(|(number, ..)| !replaced(*number));
        let mut new: Vec<_> = kept.collect();
        let added = changes.iter();
        new.extend(added.filter_map(|(number, now)| {
            let (thing, bounds) = now.clone()?;
            Some((*number, thing, bounds))
        }));
        if new.len() + gone.len() > few(self.old.numbers.len()) {
            let old = (0..).zip(self.old.iter());
            let old = old.filter(|(place, _)| gone.binary_search(place).is_err());
            new.extend(old.map(|(_, thing)| thing));
            new.sort_unstable_by_key(|(number, ..)| *number);
            return Self::new(new);
        }
        new.sort_unstable_by_key(|(number, ..)| *number);
        Self {
            old: Arc::clone(&self.old),
            gone,
            new: Stock::new(new),
        }
    }
}

/// Largest size of the small tree plus the removed items. It is below `old / 8`, since two trees of half the items are
/// slower than one.
fn few(old: usize) -> usize {
    (2 * old.isqrt()).min(old / 8)
}

impl<T> ChangingTree<T> {
    getters! {
        pub(crate) fn is_empty(&self) -> bool = self.old.numbers.len() == self.gone.len() && !self.has_new();
        /// True if the small tree holds an item.
        pub(crate) fn has_new(&self) -> bool = !self.new.numbers.is_empty();
    }

    /// The stock that holds an item, and the item's index in that stock.
    #[inline]
    fn at(&self, place: u32) -> (&Stock<T>, usize) {
        let old = self.old.numbers.len();
        match (place as usize).checked_sub(old) {
            None => (&self.old, place as usize),
            Some(place) => (&self.new, place),
        }
    }

    #[inline]
    pub(crate) fn thing(&self, place: u32) -> &T {
        let (stock, at) = self.at(place);
        &stock.things[at]
    }

    #[inline]
    pub(crate) fn bounds(&self, place: u32) -> &BoundingBox {
        let (stock, at) = self.at(place);
        &stock.bounds[at]
    }

    /// Number of an item. Items of one tree are in the order of their numbers.
    #[inline]
    pub(crate) fn number(&self, place: u32) -> u64 {
        let (stock, at) = self.at(place);
        stock.numbers[at]
    }

    /// True if both share the large tree.
    #[cfg(test)]
    pub(crate) fn shares_old(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.old, &other.old)
    }

    /// True if an item of the large tree was removed or replaced.
    #[inline]
    fn is_gone(&self, place: u32) -> bool {
        is_in(&self.gone, place)
    }

    /// True if `met` holds for an item near a point, as [`BoxTree::any`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn any<M>(&self, point: Vector3<f64>, reach: f64, met: &M) -> bool
    where
        M: for<'a> Met<&'a T>,
    {
        for (stock, gone) in [(&*self.old, &*self.gone), (&self.new, &[])] {
            let there = There { stock, gone, met };
            if stock.tree.any(point, reach, &there) {
                return true;
            }
        }
        false
    }

    /// Visits item indices as [`BoxTree::nearest`] does.
    pub(crate) fn nearest(
        &self,
        best: f64,
        bound: impl Fn(&BoundingBox) -> f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        let best = (self.old.tree).nearest(best, &bound, |place, best| match self.is_gone(place) {
            true => best,
            false => visit(place, best),
        });
        let first = self.old.numbers.len() as u32;
        (self.new.tree).nearest(best, bound, |place, best| visit(first + place, best))
    }
}

/// Predicate over the items of a stock, without the removed ones.
struct There<'a, T, M> {
    stock: &'a Stock<T>,
    gone: &'a [u32],
    met: &'a M,
}

impl<T, M> Met<u32> for There<'_, T, M>
where
    M: for<'a> Met<&'a T>,
{
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, place: u32) -> bool {
        !is_in(self.gone, place) && self.met.is_met(&self.stock.things[place as usize])
    }
}

impl<T> Stock<T> {
    fn new(things: impl IntoIterator<Item = (u64, T, BoundingBox)>) -> Self {
        let mut stock = Self::default();
        for (number, thing, bounds) in things {
            stock.numbers.push(number);
            stock.things.push(thing);
            stock.bounds.push(bounds);
        }
        stock.tree = BoxTree::new(stock.numbers.len(), |place| stock.bounds[place]);
        stock
    }

    fn place_of(&self, number: u64) -> Option<u32> {
        let place = self.numbers.binary_search(&number).ok()?;
        Some(place as u32)
    }
}

impl<T: Clone> Stock<T> {
    fn iter(&self) -> impl Iterator<Item = (u64, T, BoundingBox)> {
        let things = self.numbers.iter().zip(&self.things).zip(&self.bounds);
        things.map(|((number, thing), bounds)| (*number, thing.clone(), *bounds))
    }
}

impl<T> Default for Stock<T> {
    fn default() -> Self {
        Self {
            numbers: Vec::new(),
            things: Vec::new(),
            bounds: Vec::new(),
            tree: BoxTree::default(),
        }
    }
}

impl<T> Default for ChangingTree<T> {
    fn default() -> Self {
        Self {
            old: Arc::default(),
            gone: Vec::new(),
            new: Stock::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    /// Records the tested items; the predicate is never true.
    #[derive(Default)]
    struct Asked(RefCell<Vec<&'static str>>);

    impl Met<&&'static str> for Asked {
        fn is_met(&self, thing: &&'static str) -> bool {
            self.0.borrow_mut().push(thing);
            false
        }
    }

    fn around(x: f64) -> BoundingBox {
        BoundingBox::around([Vector3::new(x, 0.0, 0.0), Vector3::new(x + 0.5, 1.0, 1.0)])
    }

    /// All items whose boxes contain the coordinate along x, in the order of their numbers.
    fn met(tree: &ChangingTree<&'static str>, x: f64) -> Vec<(u64, &'static str)> {
        let mut met = Vec::new();
        let apart = |bounds: &BoundingBox| bounds.squared_distance(Vector3::new(x, 0.5, 0.5));
        tree.nearest(1e-9, apart, |place, best| {
            if apart(tree.bounds(place)) == 0.0 {
                met.push((tree.number(place), *tree.thing(place)));
            }
            best
        });
        met.sort_unstable();
        let mut things: Vec<_> = met.iter().map(|(_, thing)| *thing).collect();
        let all = Asked::default();
        assert!(!tree.any(Vector3::new(x, 0.5, 0.5), 1e-9, &all));
        let mut asked = all.0.into_inner();
        things.sort_unstable();
        asked.sort_unstable();
        assert_eq!(things, asked);
        met
    }

    #[test]
    fn few_changes_keep_the_large_tree() {
        let all = (0..1000).map(|number| (number, "old", around(number as f64)));
        let first = ChangingTree::new(all);
        assert_eq!(met(&first, 10.2), [(10, "old")]);
        let moved = first.changed(vec![(10, Some(("new", around(20.1)))), (11, None)]);
        assert!(moved.shares_old(&first));
        assert!(met(&moved, 10.2).is_empty() && met(&moved, 11.2).is_empty());
        assert_eq!(met(&moved, 20.2), [(10, "new"), (20, "old")]);
        // Repeated changes of one item count as one.
        let mut again = moved.clone();
        for step in 0..500 {
            again = again.changed(vec![(10, Some(("again", around(f64::from(step)))))]);
        }
        assert!(again.shares_old(&first));
        assert_eq!(met(&again, 499.2), [(10, "again"), (499, "old")]);
        let others = (0..500).map(|number| (2 * number, Some(("other", around(number as f64)))));
        let many = again.changed(others.collect());
        assert!(!many.shares_old(&first) && !many.has_new());
        assert_eq!(met(&many, 77.2), [(77, "old"), (154, "other")]);
        // The first tree is unchanged.
        assert_eq!(met(&first, 10.2), [(10, "old")]);
    }
}
