//! Typed indices of joints and frames.
//!
//! An id is an index in its model's list. An id of another model is rejected only if it is out of range; otherwise it
//! refers to the object with that index. Look names up in the model that uses the ids.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(u32);

        impl $name {
            /// Only for existing objects: the builder checks counts.
            #[doc(hidden)]
            pub fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// The index in the model's list.
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
