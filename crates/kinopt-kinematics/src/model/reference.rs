//! References to frames and joints by id or name.

use super::{FrameId, JointId, Model, UnknownName};

/// A reference to an object of a model, by its id `I` or its name. Builders resolve it once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference<'a, I> {
    /// The id in the same model.
    Id(I),
    /// The name.
    Name(&'a str),
}

/// A frame by its id or its name.
pub type FrameRef<'a> = Reference<'a, FrameId>;
/// A joint by its id or its name.
pub type JointRef<'a> = Reference<'a, JointId>;

impl FrameRef<'_> {
    /// The id of the frame in `model`.
    ///
    /// # Errors
    /// Returns an error with the valid names for a name or an id that is not in the model.
    pub fn resolve(self, model: &Model) -> Result<FrameId, UnknownName> {
        match self {
            Self::Name(name) => model.frame(name),
            Self::Id(id) if id.index() < model.frames().len() => Ok(id),
            Self::Id(id) => {
                let names = model.frames().iter().map(|frame| frame.name.as_str());
                let id = format!("#{}", id.index());
                Err(UnknownName::new("frame", &id, names))
            }
        }
    }
}

impl JointRef<'_> {
    /// The id of the joint in `model`.
    ///
    /// # Errors
    /// Returns an error with the valid names for a name or an id that is not in the model.
    pub fn resolve(self, model: &Model) -> Result<JointId, UnknownName> {
        match self {
            Self::Name(name) => model.joint(name),
            Self::Id(id) if id.index() < model.joints().len() => Ok(id),
            Self::Id(id) => {
                let names = model.joints().iter().map(|joint| joint.name.as_str());
                let id = format!("#{}", id.index());
                Err(UnknownName::new("joint", &id, names))
            }
        }
    }
}

impl<'a, I> From<&'a str> for Reference<'a, I> {
    fn from(name: &'a str) -> Self {
        Self::Name(name)
    }
}

impl<'a, I> From<&'a &str> for Reference<'a, I> {
    fn from(name: &'a &str) -> Self {
        Self::Name(name)
    }
}

impl<'a, I> From<&'a String> for Reference<'a, I> {
    fn from(name: &'a String) -> Self {
        Self::Name(name)
    }
}

impl From<FrameId> for FrameRef<'_> {
    fn from(id: FrameId) -> Self {
        Self::Id(id)
    }
}

impl From<JointId> for JointRef<'_> {
    fn from(id: JointId) -> Self {
        Self::Id(id)
    }
}

impl From<&JointId> for JointRef<'_> {
    fn from(id: &JointId) -> Self {
        Self::Id(*id)
    }
}
