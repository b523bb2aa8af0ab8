//! Configurations by the joint in which they lie furthest apart, so that few are looked at where near ones are asked for.

use super::turns::Turns;

/// Configurations by one joint: one whose whole turns count, if there is one.
#[derive(Debug, Default)]
pub(super) struct Sorted {
    joint: Option<usize>,
    /// That joint's values, rising, and whose they are.
    values: Vec<f32>,
    places: Vec<usize>,
}

/// A little more than asked, for what rounding leaves out.
const MORE: f32 = 1.001;

impl Sorted {
    /// Of these configurations. `limits`: how near one is to another, joint by joint.
    pub(super) fn of(from: &[f32], limits: &[f32], turns: &Turns) -> Self {
        let mut own = Self::default();
        own.sort(from, widest(from, limits, turns), limits.len());
        own
    }

    /// Sorts `known` instead, by the joint in which those lie furthest apart that are looked up in it.
    pub(super) fn take(&mut self, known: &[f32], asked: &[f32], limits: &[f32], turns: &Turns) {
        self.sort(known, widest(asked, limits, turns), limits.len());
    }

    fn sort(&mut self, from: &[f32], joint: Option<usize>, n: usize) {
        let value = |place: &usize| joint.map_or(0.0, |joint| from[place * n + joint]);
        self.joint = joint;
        self.places.clear();
        self.places.extend(0..from.len() / n);
        self.places.sort_by(|a, b| value(a).total_cmp(&value(b)));
        self.values.clear();
        self.values.extend(self.places.iter().map(value));
    }

    /// Takes one more.
    pub(super) fn insert(&mut self, q: &[f32], place: usize) {
        let value = self.joint.map_or(0.0, |joint| q[joint]);
        let at = self.values.partition_point(|other| *other <= value);
        self.values.insert(at, value);
        self.places.insert(at, place);
    }

    /// Those of which that joint is near, rising by it.
    pub(super) fn near(&self, q: &[f32], limits: &[f32]) -> impl Iterator<Item = usize> {
        let (value, most) = match self.joint {
            Some(joint) => (q[joint], MORE * limits[joint]),
            None => (0.0, 0.0),
        };
        let first = self.values.partition_point(|other| *other < value - most);
        let last = self.values.partition_point(|other| *other <= value + most);
        self.places[first..last.max(first)].iter().copied()
    }
}

/// The joint in which configurations lie furthest apart, for how near one is to another.
fn widest(from: &[f32], limits: &[f32], turns: &Turns) -> Option<usize> {
    let n = limits.len();
    let (mut low, mut high) = (vec![f32::MAX; n], vec![f32::MIN; n]);
    for row in from.chunks_exact(n) {
        for ((value, low), high) in row.iter().zip(&mut low).zip(&mut high) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
    }
    let spread = |joint: usize| (high[joint] - low[joint]) / limits[joint];
    let joints = (0..n).filter(|joint| !turns.is_left_out(*joint));
    joints.max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
}
