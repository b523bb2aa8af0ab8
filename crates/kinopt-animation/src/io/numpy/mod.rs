//! Arrays of NumPy: .npy files, and .npz files with arrays by name.

mod archive;
mod array;

pub use archive::NumpyArchive;
pub use array::NumpyArray;
