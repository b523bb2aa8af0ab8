//! Frame names on the command line.

use kinopt::io::rig::Rig;
use kinopt::model::{FrameId, UnknownName};
use kinopt::skeleton::BoneId;

use crate::loaded_model::LoadedModel;

/// End of a bone that its name without suffix denotes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BareName {
    /// Tail of the bone, the origin of its frame.
    Tail,
    /// Tip of the bone, which targets move.
    Tip,
}

impl LoadedModel {
    /// Frame of a name: a link of a robot, or a bone of a rig by name or number, as in `bone/3` (from 0).
    ///
    /// `/tip` or `/tail` after a bone selects its end; otherwise `bare` does.
    pub(crate) fn frame(&self, name: &str, bare: BareName) -> Result<FrameId, UnknownName> {
        let Some(rig) = &self.rig else {
            // The frames of a robot are its links, so the message says `link`.
            let link = |mut error: UnknownName| {
                error.kind = "link";
                error.with_note("`kinopt info` lists all")
            };
            return self.model.frame(name).map_err(link);
        };
        let (bone, end) = split(rig, name)?;
        Ok(match end.unwrap_or(bare) {
            BareName::Tail => rig.skeleton.tail(bone),
            BareName::Tip => rig.skeleton.tip(bone),
        })
    }
}

/// Bone of a name, with the end if the name has one.
fn split(rig: &Rig, name: &str) -> Result<(BoneId, Option<BareName>), UnknownName> {
    if let Some(bone) = bone(rig, name) {
        return Ok((bone, None));
    }
    let ends = [("/tip", BareName::Tip), ("/tail", BareName::Tail)];
    for (suffix, end) in ends {
        if let Some(bone) = name.strip_suffix(suffix).and_then(|stem| bone(rig, stem)) {
            return Ok((bone, Some(end)));
        }
    }
    let names = rig.skeleton.bones().iter().map(|bone| bone.name.as_str());
    let note = "each also with /tip or /tail; `kinopt info` lists all";
    Err(UnknownName::new("bone", name, names).with_note(note))
}

/// Bone of a name, or of a number as in `bone/3`.
pub(crate) fn bone(rig: &Rig, name: &str) -> Option<BoneId> {
    let index = name.strip_prefix("bone/").and_then(|n| n.parse().ok());
    let numbered = index.and_then(|index| rig.skeleton.bone_at(index));
    numbered.or_else(|| rig.skeleton.bone(name).ok())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use kinopt::Skeleton;
    use kinopt::model::Limits;
    use kinopt::skeleton::Bone;
    use kinopt::spatial::Placement;

    use super::*;

    fn named() -> LoadedModel {
        let bone = |name: &str| Bone {
            name: name.to_owned(),
            parent: None,
            length: 1.0,
            model_from_rest: Placement::identity(),
            limits: [Limits::UNBOUNDED; 3],
        };
        // The last bone has the name of another bone's number.
        let bones = ["hip", "arm/left", "bone/0"].map(bone).to_vec();
        let skeleton = Skeleton::new("named", bones).unwrap();
        LoadedModel::of_skeleton("named.json".to_owned(), skeleton)
    }

    #[test]
    fn frame_names_numbers_and_ends_resolve() {
        let loaded = named();
        let index = |name: &str, bare| loaded.frame(name, bare).unwrap().index();
        for (name, bone) in [("hip", 0), ("arm/left", 1), ("bone/1", 1), ("bone/2", 2)] {
            assert_eq!(index(name, BareName::Tail), 2 * bone, "{name}");
            assert_eq!(index(name, BareName::Tip), 2 * bone + 1, "{name}");
            let (tip, tail) = (format!("{name}/tip"), format!("{name}/tail"));
            for bare in [BareName::Tip, BareName::Tail] {
                assert_eq!(index(&tip, bare), 2 * bone + 1);
                assert_eq!(index(&tail, bare), 2 * bone);
            }
        }
        // Numbers have priority over names.
        assert_eq!(index("bone/0", BareName::Tail), 0);
    }

    #[test]
    fn frame_unknown_name_lists_valid_names() {
        for name in ["arm", "bone/3", "bone/-1", "hip/top", "", "/tip"] {
            let error = named().frame(name, BareName::Tip).unwrap_err().to_string();
            assert!(error.contains(&format!("`{name}`")), "{error}");
            assert!(error.contains("hip, arm/left, bone/0"), "{error}");
        }
    }
}
