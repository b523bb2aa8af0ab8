//! Room for what a call writes.

/// Where a call writes a known number of values: a slice or an array of that length, or a [`Vec`],
/// which is made as long as it must be. Used again, a `Vec` allocates nothing once it has grown.
pub trait Buffer<T> {
    /// The room for `count` values. A `Vec` has exactly as many afterwards; a slice stays as it is, and
    /// whoever writes to it checks its length.
    fn sized(&mut self, count: usize) -> &mut [T];
}

impl<T> Buffer<T> for [T] {
    #[inline]
    fn sized(&mut self, _count: usize) -> &mut [T] {
        self
    }
}

impl<T, const N: usize> Buffer<T> for [T; N] {
    #[inline]
    fn sized(&mut self, _count: usize) -> &mut [T] {
        self
    }
}

impl<T: Default> Buffer<T> for Vec<T> {
    #[inline]
    fn sized(&mut self, count: usize) -> &mut [T] {
        self.resize_with(count, T::default);
        self
    }
}

/// Makes a vector hold so many of one value and nothing else, in the memory that it has.
#[inline]
pub(crate) fn refill<T: Clone>(vector: &mut Vec<T>, count: usize, value: T) {
    vector.clear();
    vector.resize(count, value);
}

/// Makes a vector empty, with room for so many.
pub(crate) fn vacate<T>(vector: &mut Vec<T>, room: usize) {
    vector.clear();
    vector.reserve(room);
}
