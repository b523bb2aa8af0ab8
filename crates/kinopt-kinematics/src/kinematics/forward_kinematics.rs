//! Forward kinematics of a model's frames, with checked input.

use thiserror::Error;

use super::{Tree, TreeState};
use crate::model::{BallVariables, FrameId, Model, ModelError, ParameterMap, SegmentKind};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// Errors of forward kinematics, Jacobians and centres of mass.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum KinematicsError {
    /// A frame id that is not in the model.
    #[error("frame {index} does not exist: model `{model}` has {frames} frames")]
    ForeignFrame {
        /// Name of the model.
        model: String,
        /// The index of the frame id.
        index: usize,
        /// Number of frames in the model.
        frames: usize,
    },
    /// A parameter map of another model, detected by its size.
    #[error("the parameter map has {map} coordinates, model `{model}` has {model_coordinates}")]
    ForeignMap {
        /// Number of coordinates of the map.
        map: usize,
        /// Name of the model.
        model: String,
        /// Number of coordinates of the model.
        model_coordinates: usize,
    },
    /// A slice of wrong length.
    #[error("q has {given} numbers, expected {expected} for `{model}`")]
    Length {
        /// Name of the model.
        model: String,
        /// Given number of values.
        given: usize,
        /// Required number of values: the length of a configuration, or the number of the parameter map's variables.
        expected: usize,
    },
    /// A quaternion of length zero, or one whose length overflows or underflows.
    #[error("configuration of `{model}`: the quaternion at index {index} has length 0")]
    NoRotation {
        /// Name of the model.
        model: String,
        /// Index of its first component, from 0.
        index: usize,
    },
    /// A number that is NaN or infinite.
    #[error("model `{model}`: the number at index {index} is not finite")]
    NotFinite {
        /// Name of the model.
        model: String,
        /// Index of the number, from 0: a coordinate, or a variable of the parameter map.
        index: usize,
    },
    /// The model has no masses, or invalid ones, so it has no centre of mass.
    #[error(transparent)]
    Masses(#[from] ModelError),
}

/// Forward kinematics of frames of one model, with its own workspace.
///
/// After construction it allocates nothing. Joints that move none of its frames cost nothing.
///
/// ```
/// use kinopt::kinematics::ForwardKinematics;
/// use kinopt::model::{Limits, Model};
/// use kinopt::spatial::{Placement, Vector3};
///
/// let mut builder = Model::builder("pendulum");
/// let pivot = builder.revolute(
///     "pivot", None, Placement::identity(), Vector3::new(1.0, 0.0, 0.0), Limits::UNBOUNDED);
/// let bob = builder.frame("bob", Some(pivot), Placement::translation([0.0, 0.0, -2.0].into()));
/// let model = builder.build()?;
///
/// let mut kinematics = ForwardKinematics::of_frames(&model, &[bob])?;
/// let [world_from_bob] = kinematics.place(&[std::f64::consts::FRAC_PI_2])? else { unreachable!() };
/// assert!((world_from_bob.translation.y - 2.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ForwardKinematics<S = f64> {
    model: String,
    tree: Tree,
    state: TreeState<S>,
    /// Reads configurations of models with ball joints; `None` for other models.
    read: Option<ReadConfiguration<S>>,
}

/// Conversion of configurations with quaternions to the variables of a tree.
#[derive(Clone, Debug)]
pub(super) struct ReadConfiguration<S> {
    pub(super) map: ParameterMap,
    /// The variables of the last configuration.
    pub(super) x: Vec<S>,
    /// For each ball joint, true if it is part of a free joint, whose translations are the three variables before it.
    pub(super) is_free: Vec<bool>,
}

impl<S: Scalar> ForwardKinematics<S> {
    /// Kinematics of all frames of a model, in the order of [`FrameId::index`].
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let frames: Vec<FrameId> = model.frame_ids().collect();
        Self::of_configurations(model, &frames)
    }

    /// Kinematics of some frames, in any order.
    ///
    /// # Errors
    /// Returns an error for a frame id that is not in the model.
    pub fn of_frames(model: &Model, frames: &[FrameId]) -> Result<Self, KinematicsError> {
        check_frames(model, frames)?;
        Ok(Self::of_configurations(model, frames))
    }

    /// Kinematics of some frames as a function of the variables of `map` instead of a configuration.
    ///
    /// # Errors
    /// Returns an error for a frame id that is not in the model, or a map of another model.
    pub fn under(
        model: &Model,
        map: &ParameterMap,
        frames: &[FrameId],
    ) -> Result<Self, KinematicsError> {
        if map.sources().len() != model.configuration_len() {
            return Err(KinematicsError::ForeignMap {
                map: map.sources().len(),
                model: model.name().to_owned(),
                model_coordinates: model.configuration_len(),
            });
        }
        check_frames(model, frames)?;
        Ok(Self::compile(model, map, frames))
    }

    #[doc(hidden)]
    pub fn of_configurations(model: &Model, frames: &[FrameId]) -> Self {
        let map = ParameterMap::identity(model);
        let mut kinematics = Self::compile(model, &map, frames);
        if !map.balls().is_empty() {
            kinematics.read = Some(ReadConfiguration {
                x: vec![S::zero(); map.variables()],
                is_free: (model.balls())
                    .map(|(segment, _)| segment.kind == SegmentKind::Free)
                    .collect(),
                map,
            });
        }
        kinematics
    }

    /// Kinematics for ids and a map of this model, unchecked.
    pub(crate) fn compile(model: &Model, map: &ParameterMap, frames: &[FrameId]) -> Self {
        let tree = Tree::new(model, map, frames);
        Self {
            model: model.name().to_owned(),
            state: TreeState::new(&tree),
            tree,
            read: None,
        }
    }

    /// Number of values that [`place`](Self::place) reads: the length of a configuration, or the number of the
    /// parameter map's variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        match &self.read {
            Some(read) => read.map.sources().len(),
            None => self.tree.variables(),
        }
    }

    /// The placements of the last [`place`](Self::place); identities before the first.
    #[must_use]
    pub fn placements(&self) -> &[Placement<S>] {
        self.state.frames()
    }

    #[must_use]
    pub(super) fn read(&self) -> Option<&ReadConfiguration<S>> {
        self.read.as_ref()
    }

    /// Computes world_from_frame of each frame, in the order of construction, at the configuration `q`.
    ///
    /// `q` is in radians and metres, within limits or not; quaternions have any length except zero.
    ///
    /// # Errors
    /// Returns an error for a wrong number of coordinates, one that is not finite, or a quaternion of length zero.
    pub fn place(&mut self, q: &[S]) -> Result<&[Placement<S>], KinematicsError> {
        if q.len() != self.variables() {
            return Err(KinematicsError::Length {
                model: self.model.clone(),
                given: q.len(),
                expected: self.variables(),
            });
        }
        // Counted: a search that may end early does not vectorise.
        let finite = q.iter().map(|value| u64::from(value.is_finite()));
        if finite.sum::<u64>() != q.len() as u64 {
            let index = q.iter().position(|value| !value.is_finite()).unwrap_or(0);
            return Err(KinematicsError::NotFinite {
                model: self.model.clone(),
                index,
            });
        }
        match &mut self.read {
            None => self.tree.forward(q, &mut self.state),
            Some(ReadConfiguration { map, x, .. }) => {
                map.gather_all(q, x);
                let is_invalid = |ball: &&BallVariables| !x[ball.variable].is_finite();
                if let Some(ball) = map.balls().iter().find(is_invalid) {
                    return Err(KinematicsError::NoRotation {
                        model: self.model.clone(),
                        index: ball.coordinate,
                    });
                }
                self.tree.forward(x, &mut self.state);
            }
        }
        Ok(self.state.frames())
    }

    pub(super) fn parts(&self) -> (&Tree, &TreeState<S>) {
        (&self.tree, &self.state)
    }
}

fn check_frames(model: &Model, frames: &[FrameId]) -> Result<(), KinematicsError> {
    let is_foreign = |frame: &&FrameId| frame.index() >= model.frames().len();
    match frames.iter().find(is_foreign) {
        None => Ok(()),
        Some(frame) => Err(KinematicsError::ForeignFrame {
            model: model.name().to_owned(),
            index: frame.index(),
            frames: model.frames().len(),
        }),
    }
}
