//! What allocates memory, and how much.

mod arm;
mod counting_allocator;
mod solver;
