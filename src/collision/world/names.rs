//! The numbers of obstacles by their names.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Shards: a change of a copy copies one of them.
const SHARDS: usize = 64;

/// Hashes and numbers, sorted.
type Shard = Vec<(u64, u64)>;

/// Hashes of names and the numbers under them, sorted, in shards that copies share until one of them changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    /// By the remainder of the hash; none while there is no name.
    shards: Arc<Vec<Arc<Shard>>>,
}

impl Names {
    /// The number under a name, of those that may be under it; `has` tells which bears it.
    pub(super) fn find(&self, name: &str, has: impl Fn(u64) -> bool) -> Option<u64> {
        let hash = hash(name);
        let shard = self.shards.get(shard(hash))?;
        let first = shard.partition_point(|(known, _)| *known < hash);
        let same = shard[first..]
            .iter()
            .take_while(|(known, _)| *known == hash);
        same.map(|(_, number)| *number).find(|number| has(*number))
    }

    /// Adds a name that is not there.
    pub(super) fn insert(&mut self, name: &str, number: u64) {
        let hash = hash(name);
        let shards = Arc::make_mut(&mut self.shards);
        if shards.is_empty() {
            shards.resize_with(SHARDS, Arc::default);
        }
        let own = Arc::make_mut(&mut shards[shard(hash)]);
        let at = own.partition_point(|known| *known < (hash, number));
        own.insert(at, (hash, number));
    }

    /// Takes a name out.
    pub(super) fn remove(&mut self, name: &str, number: u64) {
        let hash = hash(name);
        let shards = Arc::make_mut(&mut self.shards);
        if let Some(own) = shards.get_mut(shard(hash)) {
            Arc::make_mut(own).retain(|known| *known != (hash, number));
        }
    }
}

/// The same for the same name, always.
fn hash(name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    hasher.finish()
}

fn shard(hash: u64) -> usize {
    (hash % SHARDS as u64) as usize
}
