//! Armatures and poses. One file, because each refers to the other.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{Armature as Bones, Pose as Locals};
use pyo3::prelude::*;

use crate::error::invalid;

/// A tree of bones for character animation, parents before children, with their rest pose and the names of morph
/// targets, in single precision.
///
/// An armature of bones: `names`; `parents`, shape (bones,), the index of each bone's parent, which precedes it, or -1.
/// The rest pose has `translations` (bones, 3), `rotations_xyzw` or `rotations_wxyz` (bones, 4) and `scales` (bones,
/// 3), default the identity; `morph_targets` are names.
///
/// Raises `InvalidValueError` with the bone.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Armature {
    pub(crate) inner: Arc<Bones>,
}

impl From<Arc<Bones>> for Armature {
    fn from(inner: Arc<Bones>) -> Self {
        Self { inner }
    }
}

impl From<Bones> for Armature {
    fn from(bones: Bones) -> Self {
        Arc::new(bones).into()
    }
}

/// A local transform for each bone of an armature and a weight for each of its morph targets.
///
/// A bone's transform in its parent is scale, then rotation, then translation. Numbers are float32, lengths in the
/// armature's unit. A pose is mutable; calls from several threads are serialised.
///
/// A pose of an armature; missing arguments are at rest. `translations` and `scales` have shape
/// (bones, 3), `rotations_xyzw` or `rotations_wxyz` (bones, 4), of any length above 0,
/// `morph_weights` (targets,).
///
/// Raises `InvalidValueError` for another shape and for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Pose {
    pub(super) armature: Arc<Bones>,
    locals: Mutex<Locals>,
}

impl Pose {
    pub(crate) fn of(armature: &Arc<Bones>, locals: Locals) -> Self {
        Self {
            armature: Arc::clone(armature),
            locals: Mutex::new(locals),
        }
    }

    /// Copy of the current state.
    pub(crate) fn now(&self) -> Locals {
        self.with(|locals| locals.clone())
    }

    /// Calls a function that creates no Python objects, with the pose locked.
    pub(crate) fn with<T>(&self, run: impl FnOnce(&mut Locals) -> T) -> T {
        run(&mut self.locals.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Armature of the pose.
    pub(crate) fn bones(&self) -> &Arc<Bones> {
        &self.armature
    }
}

/// Immutable list of poses of one armature, such as samples of a clip.
///
/// N poses of an armature, with the arguments of `Pose` and a leading axis of N; or a list of `poses`.
///
/// Raises `InvalidValueError` for other shapes, for numbers that are not finite and for poses of another
/// armature.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Poses {
    pub(crate) armature: Arc<Bones>,
    pub(crate) list: Arc<Vec<Locals>>,
}

impl Poses {
    pub(crate) fn of(armature: &Arc<Bones>, list: Vec<Locals>) -> Self {
        Self {
            armature: Arc::clone(armature),
            list: Arc::new(list),
        }
    }
}

/// Reads the poses of a `Pose`, of `Poses` or of a list, with their number; `None` for a single `Pose`.
pub(crate) fn poses_of(value: &Bound<'_, PyAny>) -> PyResult<(Vec<Locals>, Option<usize>)> {
    if let Ok(pose) = value.cast::<Pose>() {
        return Ok((vec![pose.get().now()], None));
    }
    if let Ok(poses) = value.cast::<Poses>() {
        let list = Vec::clone(&poses.get().list);
        let count = list.len();
        return Ok((list, Some(count)));
    }
    let poses = value.try_iter().ok().map(|items| {
        let poses = items.map(|item| Ok(item?.cast::<Pose>()?.get().now()));
        poses.collect::<PyResult<Vec<_>>>().ok()
    });
    let list = poses.flatten().ok_or_else(|| {
        let kind = value.get_type();
        invalid(format!(
            "expected a Pose, Poses or a list of them, not {kind}"
        ))
    })?;
    let count = list.len();
    Ok((list, Some(count)))
}
