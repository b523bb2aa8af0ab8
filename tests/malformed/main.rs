//! Damaged files of every format, with the memory that reading them takes.

mod mutated_files;
mod referenced_files;
