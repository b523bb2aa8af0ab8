//! Allowed collisions of a chain's bodies.

/// Numbers of the solids that each body may touch, sorted. All empty if there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Passed {
    of_body: Vec<Vec<u64>>,
    /// The union over all bodies, sorted.
    all: Vec<u64>,
}

impl Passed {
    pub(crate) fn new(of_bodies: impl IntoIterator<Item = Vec<u64>>) -> Self {
        let of_body: Vec<Vec<u64>> = of_bodies.into_iter().collect();
        let mut all: Vec<u64> = of_body.iter().flatten().copied().collect();
        if all.is_empty() {
            return Self::default();
        }
        all.sort_unstable();
        all.dedup();
        Self { of_body, all }
    }

    /// True if some body may touch a solid.
    pub(super) fn has(&self, number: u64) -> bool {
        self.all.binary_search(&number).is_ok()
    }

    pub(super) fn is_allowed(&self, body: usize, number: u64) -> bool {
        let allowed = self.of_body.get(body);
        allowed.is_some_and(|allowed| allowed.binary_search(&number).is_ok())
    }
}
