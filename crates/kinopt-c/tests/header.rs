//! Promise: the header in the repository is that of the Rust sources.
#![allow(clippy::unwrap_used)]

use std::path::Path;

#[test]
fn header_matches_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut header = Vec::new();
    cbindgen::generate_with_config(folder, config)
        .unwrap()
        .write(&mut header);
    let (header, path) = (
        String::from_utf8(header).unwrap(),
        folder.join("include/kinopt/kinopt.h"),
    );
    if std::env::var_os("KINOPT_BLESS").is_some() {
        std::fs::write(&path, &header).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        header,
        "KINOPT_BLESS=1 cargo test -p kinopt-c writes {}",
        path.display()
    );
}
