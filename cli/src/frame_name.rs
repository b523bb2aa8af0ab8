//! Which frame a name on the command line means.

use kinopt::io::rig::Rig;
use kinopt::model::{FrameId, UnknownName};
use kinopt::skeleton::BoneId;

use crate::loaded_model::LoadedModel;

/// What a bone's bare name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BareName {
    /// The bone's tail, where its own frame is.
    Tail,
    /// The bone's tip, which is what one drags.
    Tip,
}

impl LoadedModel {
    /// The frame that `name` means. In a rig: `bone/3` counts from 0 and always works, a bone's own
    /// name does too, and `/tip` or `/tail` may follow either. In a robot: a frame's name.
    pub(crate) fn frame(&self, name: &str, bare: BareName) -> Result<FrameId, UnknownName> {
        let Some(rig) = &self.rig else {
            return self.model.frame(name);
        };
        let (bone, end) = split(rig, name)?;
        Ok(match end.unwrap_or(bare) {
            BareName::Tail => rig.skeleton.tail(bone),
            BareName::Tip => rig.skeleton.tip(bone),
        })
    }
}

/// The bone, and the end of it where the name says which.
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
    let mut error = UnknownName::new("bone", name, names);
    error.valid.push("each also with /tip or /tail".to_owned());
    Err(error)
}

fn bone(rig: &Rig, name: &str) -> Option<BoneId> {
    let index = name.strip_prefix("bone/").and_then(|n| n.parse().ok());
    index
        .and_then(|index| rig.skeleton.bone_at(index))
        .or_else(|| rig.skeleton.bone(name).ok())
}
