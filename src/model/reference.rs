//! A frame or a joint, said by its id or by its name.

use super::{FrameId, JointId, Model, UnknownName};

/// A thing of a model by its id `I` or by its name: what builders take, which look it up once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference<'a, I> {
    /// By its id in the same model.
    Id(I),
    /// By its name.
    Name(&'a str),
}

/// A frame by its id or its name.
pub type FrameRef<'a> = Reference<'a, FrameId>;
/// A joint by its id or its name.
pub type JointRef<'a> = Reference<'a, JointId>;

impl FrameRef<'_> {
    /// The frame of `model` that is meant.
    ///
    /// # Errors
    /// A name or an id that the model does not have; the error tells the valid names.
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
    /// The joint of `model` that is meant.
    ///
    /// # Errors
    /// A name or an id that the model does not have; the error tells the valid names.
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
