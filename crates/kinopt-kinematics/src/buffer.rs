//! Output buffers.

/// An output buffer for a known number of values: a slice or an array of that length, or a [`Vec`].
///
/// A `Vec` is resized as needed; reused, it allocates nothing after it has grown.
pub trait Buffer<T> {
    /// The buffer for `count` values.
    ///
    /// A `Vec` is resized to `count`. A slice stays unchanged, and its caller checks its length.
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

/// Fills a vector with `count` copies of a value, in its present allocation if that suffices.
#[inline]
#[doc(hidden)]
pub fn refill<T: Clone>(vector: &mut Vec<T>, count: usize, value: T) {
    vector.clear();
    vector.resize(count, value);
}

/// Empties a vector and reserves capacity for `capacity` elements.
#[doc(hidden)]
pub fn vacate<T>(vector: &mut Vec<T>, capacity: usize) {
    vector.clear();
    vector.reserve(capacity);
}
