//! Obstacles by number, in chunks that copies of a world share until one of them changes.

use std::sync::Arc;

use super::Obstacle;

/// Largest number of obstacles in a chunk. A copy of a world copies one pointer for each chunk. A change copies one
/// pointer for each obstacle of a chunk.
const CHUNK: usize = 128;

type ObstacleChunk = Vec<(u64, Arc<Obstacle>)>;

/// Obstacles in increasing order of their numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Numbered {
    /// No chunk is empty.
    chunks: Vec<Arc<ObstacleChunk>>,
    len: usize,
}

/// A difference between two worlds at one obstacle.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Change<'a> {
    /// Number of the obstacle.
    #[doc(hidden)]
    pub number: u64,
    /// The obstacle in the first world, if it exists.
    #[doc(hidden)]
    pub before: Option<&'a Arc<Obstacle>>,
    /// The obstacle in the second world, if it exists.
    #[doc(hidden)]
    pub after: Option<&'a Arc<Obstacle>>,
}

impl Change<'_> {
    /// True if the obstacle is attached to a frame in one of the worlds.
    pub(crate) fn is_of_attached(&self) -> bool {
        let mut both = [self.before, self.after].into_iter().flatten();
        both.any(|obstacle| obstacle.attached.is_some())
    }

    /// True if more than the placement differs: the obstacle is new, removed, renamed, or has other allowed collisions.
    pub(crate) fn is_of_names(&self) -> bool {
        match (self.before, self.after) {
            (Some(before), Some(after)) => {
                before.allowed_collisions != after.allowed_collisions || before.name != after.name
            }
            _ => true,
        }
    }
}

impl Numbered {
    #[must_use]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[must_use]
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = (u64, &Arc<Obstacle>)> {
        Counted {
            inner: self
                .chunks
                .iter()
                .flat_map(|chunk| chunk.iter())
                .map(|(number, obstacle)| (*number, obstacle)),
            remaining: self.len,
        }
    }

    pub(super) fn get(&self, number: u64) -> Option<&Arc<Obstacle>> {
        let (chunk, index) = self.find(number)?;
        Some(&self.chunks[chunk][index].1)
    }

    pub(super) fn get_mut(&mut self, number: u64) -> Option<&mut Arc<Obstacle>> {
        let (chunk, index) = self.find(number)?;
        Some(&mut Arc::make_mut(&mut self.chunks[chunk])[index].1)
    }

    /// Index of the chunk, and the index in it.
    fn find(&self, number: u64) -> Option<(usize, usize)> {
        let after = self.chunks.partition_point(|chunk| chunk[0].0 <= number);
        let chunk = after.checked_sub(1)?;
        let index = self.chunks[chunk].binary_search_by_key(&number, |(number, _)| *number);
        Some((chunk, index.ok()?))
    }

    /// Adds an obstacle with a number above all others.
    pub(super) fn push(&mut self, number: u64, obstacle: Arc<Obstacle>) {
        self.len += 1;
        match self.chunks.last_mut() {
            Some(last) if last.len() < CHUNK => Arc::make_mut(last).push((number, obstacle)),
            _ => self.chunks.push(Arc::new(vec![(number, obstacle)])),
        }
    }

    pub(super) fn remove(&mut self, number: u64) {
        let Some((chunk, index)) = self.find(number) else {
            return;
        };
        self.len -= 1;
        let chunk_entries = Arc::make_mut(&mut self.chunks[chunk]);
        chunk_entries.remove(index);
        let remaining = chunk_entries.len();
        if remaining == 0 {
            self.chunks.remove(chunk);
        } else if self
            .chunks
            .get(chunk + 1)
            .is_some_and(|next| next.len() + remaining <= CHUNK / 2)
        {
            // Merges small chunks, so that their number remains small.
            let next = self.chunks.remove(chunk + 1);
            Arc::make_mut(&mut self.chunks[chunk]).extend(next.iter().cloned());
        }
    }

    /// Differences to another list, by number. Shared chunks are skipped.
    pub(super) fn changes<'a>(&'a self, to: &'a Self) -> Vec<Change<'a>> {
        let mut changes = Vec::new();
        let (mut before, mut after) = (TraversalPosition::new(self), TraversalPosition::new(to));
        loop {
            if let (Some(one), Some(other)) = (before.at_chunk(), after.at_chunk())
                && Arc::ptr_eq(one, other)
            {
                before.skip_chunk();
                after.skip_chunk();
                continue;
            }
            let (one, other) = (before.entry(), after.entry());
            let number = match (one, other) {
                (None, None) => return changes,
                (Some((one, _)), Some((other, _))) => *one.min(other),
                (Some((one, _)), None) => *one,
                (None, Some((other, _))) => *other,
            };
            let with_number = |entry: Option<&'a (u64, Arc<Obstacle>)>| {
                entry
                    .filter(|(entry_number, _)| *entry_number == number)
                    .map(|(_, obstacle)| obstacle)
            };
            let change = Change {
                number,
                before: with_number(one),
                after: with_number(other),
            };
            if change.before.is_some() {
                before.skip_entry();
            }
            if change.after.is_some() {
                after.skip_entry();
            }
            match (change.before, change.after) {
                (Some(one), Some(other)) if Arc::ptr_eq(one, other) => {}
                _ => changes.push(change),
            }
        }
    }
}

/// Position in a traversal of all obstacles.
struct TraversalPosition<'a> {
    all: &'a Numbered,
    chunk: usize,
    at: usize,
}

impl<'a> TraversalPosition<'a> {
    fn new(all: &'a Numbered) -> Self {
        let (chunk, at) = (0, 0);
        Self { all, chunk, at }
    }

    /// The next chunk, if none of its entries was passed.
    fn at_chunk(&self) -> Option<&'a Arc<ObstacleChunk>> {
        self.all.chunks.get(self.chunk).filter(|_| self.at == 0)
    }

    fn skip_chunk(&mut self) {
        self.chunk += 1;
        self.at = 0;
    }

    fn entry(&self) -> Option<&'a (u64, Arc<Obstacle>)> {
        self.all.chunks.get(self.chunk)?.get(self.at)
    }

    fn skip_entry(&mut self) {
        self.at += 1;
        if self
            .all
            .chunks
            .get(self.chunk)
            .is_none_or(|chunk| self.at == chunk.len())
        {
            self.skip_chunk();
        }
    }
}

/// An iterator with a known remaining length.
struct Counted<I> {
    inner: I,
    remaining: usize,
}

impl<I: Iterator> Iterator for Counted<I> {
    type Item = I::Item;

    fn next(&mut self) -> Option<I::Item> {
        let next = self.inner.next()?;
        self.remaining -= 1;
        Some(next)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.remaining, Some(self.remaining))
    }
}

impl<I: Iterator> ExactSizeIterator for Counted<I> {}
