//! Names of bones: an extension of ours. A bone without one is `bone/0`, `bone/1`, …

/// What bone `index` is called where the file does not say.
pub(super) fn default_name(index: usize) -> String {
    format!("bone/{index}")
}

/// Why a file may not call bone `index` so. Slashes are ours: `NAME/tip` is a frame.
pub(super) fn problem(name: &str, index: usize) -> Option<String> {
    if name.is_empty() {
        return Some("the name is empty; leave the key out instead".into());
    }
    if name.contains('/') && name != default_name(index) {
        let own = default_name(index);
        return Some(format!(
            "the name `{name}` contains a slash; only `{own}` may, this bone's default name"
        ));
    }
    None
}
