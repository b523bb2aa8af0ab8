//! Index of obstacle numbers by name.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Number of shards. A change of a copy copies one shard.
const SHARDS: usize = 64;

/// Hashes and numbers, sorted.
type Shard = Vec<(u64, u64)>;

/// Hashes of names with their numbers, in shards that copies share until one of them changes.
#[derive(Clone, Debug, Default)]
pub(super) struct NameTable {
    /// Shards by the remainder of the hash; empty while there is no name.
    shards: Arc<Vec<Arc<Shard>>>,
}

impl NameTable {
    /// The number of a name. `has` tests if the obstacle of a number has the name, since hashes may collide.
    pub(super) fn find(&self, name: &str, has: impl Fn(u64) -> bool) -> Option<u64> {
        let hash = hash(name);
        let shard = self.shards.get(shard(hash))?;
        let first = shard.partition_point(|(known, _)| *known < hash);
        let same = shard[first..]
            .iter()
            .take_while(|(known, _)| *known == hash);
        same.map(|(_, number)| *number).find(|number| has(*number))
    }

    /// Adds a new name.
    pub(super) fn insert(&mut self, name: &str, number: u64) {
        let hash = hash(name);
        let shards = Arc::make_mut(&mut self.shards);
        if shards.is_empty() {
            shards.resize_with(SHARDS, Arc::default);
        }
        let shard_entries = Arc::make_mut(&mut shards[shard(hash)]);
        let index = shard_entries.partition_point(|known| *known < (hash, number));
        shard_entries.insert(index, (hash, number));
    }

    /// Removes a name.
    pub(super) fn remove(&mut self, name: &str, number: u64) {
        let hash = hash(name);
        let shards = Arc::make_mut(&mut self.shards);
        if let Some(shard_entries) = shards.get_mut(shard(hash)) {
            Arc::make_mut(shard_entries).retain(|known| *known != (hash, number));
        }
    }
}

/// A hash that is equal for equal names in all worlds.
fn hash(name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    hasher.finish()
}

fn shard(hash: u64) -> usize {
    (hash % SHARDS as u64) as usize
}
