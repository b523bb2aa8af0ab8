//! Type stubs with docstrings, for editors.
//!
//! `stubs/` has the types, written by hand. The docstrings come from the doc comments of `src/`. maturin packs the result
//! from `OUT_DIR` into the wheel.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

mod docstrings;
mod stub;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Files of the options whose documentation the module adds to a class.
const OPTIONS: [(&str, &str); 2] = [
    ("Arm", "../crates/kinopt-bindings/src/option/arm.rs"),
    ("Solver", "../crates/kinopt-bindings/src/option/solver.rs"),
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=stubs");
    let mut docs = docstrings::of_folder(Path::new("src"))?;
    for (class, file) in OPTIONS {
        println!("cargo::rerun-if-changed={file}");
        docs.add_options(class, Path::new(file))?;
    }
    let out = PathBuf::from(env::var("OUT_DIR")?).join("kinopt/_kinopt");
    fs::create_dir_all(&out)?;
    for entry in fs::read_dir("stubs")? {
        let path = entry?.path();
        let (Some(name), Some(stem)) = (path.file_name(), path.file_stem()) else {
            continue;
        };
        let module = stem.to_string_lossy().replace("__init__", "_kinopt");
        let text = stub::with_docstrings(&fs::read_to_string(&path)?, &module, &docs);
        fs::write(out.join(name), text)?;
    }
    Ok(())
}
