//! A tree of boxes over things of which a few change at a time.
//!
//! What there was keeps its tree, which copies share; what changed since is in a small tree beside it, and what it stood for is passed over. Where
//! more changed than about the root of all, one tree is made of what there is: a change costs what that many take, whatever else there is.

use std::sync::Arc;

use super::bounding_box::BoundingBox;
use super::box_tree::BoxTree;
use super::wide_nodes::Met;
use crate::spatial::Vector3;

/// Things in the order of their numbers, and a tree over their boxes.
#[derive(Clone, Debug)]
struct Stock<T> {
    numbers: Vec<u64>,
    things: Vec<T>,
    bounds: Vec<BoundingBox>,
    tree: BoxTree,
}

/// Things with numbers and boxes. Each has a place, by which it is asked for: those that changed come after all others.
#[derive(Clone, Debug)]
pub(crate) struct ChangingTree<T> {
    old: Arc<Stock<T>>,
    /// The places in `old` of what is no more, in order.
    gone: Vec<u32>,
    new: Stock<T>,
}

/// A thing of a number, and its box; none where there is no more.
pub(crate) type Changed<T> = (u64, Option<(T, BoundingBox)>);

/// Whether a place is among others, which are in order.
#[inline]
fn is_in(places: &[u32], place: u32) -> bool {
    !places.is_empty() && places.binary_search(&place).is_ok()
}

impl<T: Clone> ChangingTree<T> {
    /// Of things in the order of their numbers.
    pub(crate) fn new(things: impl IntoIterator<Item = (u64, T, BoundingBox)>) -> Self {
        Self {
            old: Arc::new(Stock::new(things)),
            gone: Vec::new(),
            new: Stock::default(),
        }
    }

    /// The same with some of them changed, in the order of their numbers.
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

/// So many may be in the small tree or passed over: two parts in a tree of half of all would be slower than one.
fn few(old: usize) -> usize {
    (2 * old.isqrt()).min(old / 8)
}

impl<T> ChangingTree<T> {
    getters! {
        pub(crate) fn is_empty(&self) -> bool = self.old.numbers.len() == self.gone.len() && !self.has_new();
        /// Whether anything is in the small tree.
        pub(crate) fn has_new(&self) -> bool = !self.new.numbers.is_empty();
    }

    /// The stock that a place is in, and where in that.
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

    /// By which things are in order.
    #[inline]
    pub(crate) fn number(&self, place: u32) -> u64 {
        let (stock, at) = self.at(place);
        stock.numbers[at]
    }

    /// Whether the large tree is another's too.
    #[cfg(test)]
    pub(crate) fn shares_old(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.old, &other.old)
    }

    /// Whether a place in the large tree is of what is no more.
    #[inline]
    fn is_gone(&self, place: u32) -> bool {
        is_in(&self.gone, place)
    }

    /// Whether any thing is met, asked about as [`BoxTree::any`] does.
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

    /// Visits places as [`BoxTree::nearest`] does.
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

/// Things but for those that are no more.
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

    /// Keeps what it is asked about, and is not met.
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

    /// All things whose boxes hold so far along x, in order.
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
    fn a_change_leaves_the_large_tree_until_there_are_many() {
        let all = (0..1000).map(|number| (number, "old", around(number as f64)));
        let first = ChangingTree::new(all);
        assert_eq!(met(&first, 10.2), [(10, "old")]);
        let moved = first.changed(vec![(10, Some(("new", around(20.1)))), (11, None)]);
        assert!(moved.shares_old(&first));
        assert!(met(&moved, 10.2).is_empty() && met(&moved, 11.2).is_empty());
        assert_eq!(met(&moved, 20.2), [(10, "new"), (20, "old")]);
        // One again and again is one.
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
        // As it was.
        assert_eq!(met(&first, 10.2), [(10, "old")]);
    }
}
