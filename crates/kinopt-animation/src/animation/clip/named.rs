//! Lookup of clips by name. A short name is accepted: `Walk` for `Armature|Walk`.

use super::Clip;
use crate::animation::ClipError;
use kinopt_kinematics::model::UnknownName;

impl Clip {
    /// Finds a clip by name among `clips`; the first one if several have that name. Without an exact match, a clip
    /// whose name ends with `name` after a separator is found. `Walk` matches `Armature|Walk`, but not `SlowWalk` or
    /// `Walk.001`.
    ///
    /// # Errors
    /// The name is unknown or ambiguous; the error lists the names.
    pub fn named<'c>(
        clips: impl IntoIterator<Item = &'c Self>,
        name: &str,
    ) -> Result<&'c Self, ClipError> {
        let clips: Vec<&Self> = clips.into_iter().collect();
        let index = position(clips.iter().map(|clip| clip.name()), name)?;
        Ok(clips[index])
    }
}

/// Index of the name that matches.
pub(crate) fn position<'n>(
    names: impl Iterator<Item = &'n str> + Clone,
    name: &str,
) -> Result<usize, ClipError> {
    if let Some(exact) = names.clone().position(|candidate| candidate == name) {
        return Ok(exact);
    }
    let mut matches: Vec<(usize, &str)> = Vec::new();
    for (index, candidate) in names.clone().enumerate() {
        if ends_with(candidate, name) && matches.iter().all(|(_, other)| *other != candidate) {
            matches.push((index, candidate));
        }
    }
    match matches.as_slice() {
        [(only, _)] => Ok(*only),
        [] => Err(UnknownName::new("clip", name, names).into()),
        several => Err(ClipError::AmbiguousName {
            name: name.to_owned(),
            clips: several
                .iter()
                .map(|(_, candidate)| format!("`{candidate}`"))
                .collect(),
        }),
    }
}

/// True if a name ends with `part` after a separator.
fn ends_with(name: &str, part: &str) -> bool {
    let prefix = name.strip_suffix(part).filter(|_| !part.is_empty());
    let separator = prefix.and_then(|prefix| prefix.chars().next_back());
    separator.is_some_and(|separator| !separator.is_alphanumeric())
}
