//! Typed indices, so that a joint cannot be taken for a frame.
//!
//! An id is a position in its model's list. One of another model is refused where it is out of
//! range; where it is not, it names whatever stands there, so look names up in the model they are
//! for.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(u32);

        impl $name {
            /// Only for ids of things that exist: counts are checked where those are built.
            pub(crate) fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// The position in the model's list.
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A joint of one model.
    JointId
);
id!(
    /// A frame of one model.
    FrameId
);
