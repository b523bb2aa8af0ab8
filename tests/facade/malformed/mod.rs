//! Damaged files of every format, and the memory that reading them takes.

mod mutated_files;
mod referenced_files;
