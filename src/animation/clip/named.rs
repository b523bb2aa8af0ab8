//! Clips by name: programs write `Armature|Walk` where people say `Walk`.

use super::Clip;
use crate::model::UnknownName;

/// Why a name means no clip.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipNameError {
    /// No clip has the name, nor one that ends with it.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// Several names end with it.
    #[error("clip name `{name}` may mean {}", clips.join(" or "))]
    Ambiguous {
        /// The name asked for.
        name: String,
        /// The whole names of the clips that it may mean, in their order.
        clips: Vec<String>,
    },
}

impl Clip {
    /// The clip of a name among `clips`; of several with one name the first. Where none has the name,
    /// the one whose name ends with it after a sign: `Walk` means `Armature|Walk`, but neither
    /// `SlowWalk` nor `Walk.001`.
    ///
    /// # Errors
    /// An unknown name, with the valid ones; several that end with it, by name.
    pub fn named<'c>(
        clips: impl IntoIterator<Item = &'c Self>,
        name: &str,
    ) -> Result<&'c Self, ClipNameError> {
        let clips: Vec<&Self> = clips.into_iter().collect();
        let found = position(clips.iter().map(|clip| clip.name()), name)?;
        Ok(clips[found])
    }
}

/// Where the name that is meant stands.
pub(crate) fn position<'n>(
    names: impl Iterator<Item = &'n str> + Clone,
    name: &str,
) -> Result<usize, ClipNameError> {
    if let Some(exact) = names.clone().position(|own| own == name) {
        return Ok(exact);
    }
    let mut meant: Vec<(usize, &str)> = Vec::new();
    for (index, own) in names.clone().enumerate() {
        if ends_with(own, name) && meant.iter().all(|(_, other)| *other != own) {
            meant.push((index, own));
        }
    }
    match meant.as_slice() {
        [(only, _)] => Ok(*only),
        [] => Err(UnknownName::new("clip", name, names).into()),
        several => Err(ClipNameError::Ambiguous {
            name: name.to_owned(),
            clips: several.iter().map(|(_, own)| format!("`{own}`")).collect(),
        }),
    }
}

/// Whether a name ends with a part after a sign.
fn ends_with(own: &str, part: &str) -> bool {
    let before = own.strip_suffix(part).filter(|_| !part.is_empty());
    let sign = before.and_then(|before| before.chars().next_back());
    sign.is_some_and(|sign| !sign.is_alphanumeric())
}
