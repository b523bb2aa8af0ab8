//! Names of bones, an extension of kinopt to the format. The defaults are `bone/0`, `bone/1`, …

/// Default name of a bone.
pub(super) fn default_name(index: usize) -> String {
    format!("bone/{index}")
}

/// Problem of a name for bone `index`, if there is one. Slashes are reserved: `NAME/tip` is a frame.
pub(super) fn problem(name: &str, index: usize) -> Option<String> {
    if name.is_empty() {
        return Some("the name is empty; leave the key out instead".into());
    }
    if name.contains('/') && name != default_name(index) {
        let default = default_name(index);
        return Some(format!(
            "the name `{name}` contains a slash; only `{default}` may, this bone's default name"
        ));
    }
    None
}
