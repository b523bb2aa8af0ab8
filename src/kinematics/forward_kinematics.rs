//! Where the frames of a model stand for a configuration, checked.

use thiserror::Error;

use super::{Tree, TreeState};
use crate::model::{BallVariables, FrameId, Model, ParameterMap, SegmentKind};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// Why frames cannot be placed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum KinematicsError {
    /// A frame id beyond the model's frames.
    #[error("frame number {index} was asked for, but model `{model}` has {frames} frames")]
    ForeignFrame {
        /// The model.
        model: String,
        /// The position that the id stands for.
        index: usize,
        /// How many frames the model has.
        frames: usize,
    },
    /// A parameter map of another model, told by its size.
    #[error("the parameter map has {map} coordinates, model `{model}` has {model_coordinates}")]
    ForeignMap {
        /// Coordinates in the map.
        map: usize,
        /// The model.
        model: String,
        /// Coordinates in the model.
        model_coordinates: usize,
    },
    /// Too few or too many numbers.
    #[error("{given} numbers were given, placing the frames of `{model}` takes {expected}")]
    Length {
        /// The model.
        model: String,
        /// Numbers given.
        given: usize,
        /// Numbers needed: those of a configuration, or the parameter map's variables.
        expected: usize,
    },
    /// A quaternion of length zero, or too large or small for its length to be a number.
    #[error("the quaternion from number {index} of a configuration of `{model}` is no rotation")]
    NoRotation {
        /// The model.
        model: String,
        /// Where it begins, from 0.
        index: usize,
    },
    /// A number that is NaN or infinite.
    #[error("number {index} of those that place the frames of `{model}` is not finite")]
    NotFinite {
        /// The model.
        model: String,
        /// Which number, from 0: a coordinate, or a variable of the parameter map.
        index: usize,
    },
}

/// Places frames of one model again and again in memory of its own; after it is made, nothing is
/// allocated. Joints that move none of its frames cost nothing.
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
    /// For models with ball joints.
    read: Option<ReadConfiguration<S>>,
}

/// How the variables of a tree are read out of configurations with quaternions.
#[derive(Clone, Debug)]
pub(super) struct ReadConfiguration<S> {
    pub(super) map: ParameterMap,
    /// What was read last.
    pub(super) x: Vec<S>,
    /// By ball: whether it is a free joint's, whose slides are the three variables before it.
    pub(super) is_free: Vec<bool>,
}

impl<S: Scalar> ForwardKinematics<S> {
    /// For all frames of a model, by [`FrameId::index`].
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let frames: Vec<FrameId> = model.frame_ids().collect();
        Self::of_configurations(model, &frames)
    }

    /// For some frames, in any order.
    ///
    /// # Errors
    /// An id beyond the model's frames.
    pub fn of_frames(model: &Model, frames: &[FrameId]) -> Result<Self, KinematicsError> {
        check_frames(model, frames)?;
        Ok(Self::of_configurations(model, frames))
    }

    /// For some frames, placed for the variables of `map` rather than for a configuration.
    ///
    /// # Errors
    /// An id beyond the model's frames, or a map of another model.
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

    pub(crate) fn of_configurations(model: &Model, frames: &[FrameId]) -> Self {
        let map = ParameterMap::identity(model);
        let mut own = Self::compile(model, &map, frames);
        if !map.balls().is_empty() {
            own.read = Some(ReadConfiguration {
                x: vec![S::zero(); map.variables()],
                is_free: (model.balls())
                    .map(|(segment, _)| segment.kind == SegmentKind::Free)
                    .collect(),
                map,
            });
        }
        own
    }

    /// For ids and a map of this model.
    pub(crate) fn compile(model: &Model, map: &ParameterMap, frames: &[FrameId]) -> Self {
        let tree = Tree::new(model, map, frames);
        Self {
            model: model.name().to_owned(),
            state: TreeState::new(&tree),
            tree,
            read: None,
        }
    }

    getters! {
        /// How many numbers [`place`](Self::place) reads: those of a configuration, or the
        /// variables of the parameter map.
        pub fn variables(&self) -> usize = match &self.read {
            Some(read) => read.map.sources().len(),
            None => self.tree.variables(),
        };
        /// What the last [`place`](Self::place) found; identities before the first.
        pub fn placements(&self) -> &[Placement<S>] = self.state.frames();
        pub(super) fn read(&self) -> Option<&ReadConfiguration<S>> = self.read.as_ref();
    }

    /// world_from_frame of each frame, in the order asked for, at the configuration `q` (radians
    /// and metres, within limits or not; quaternions of any length but zero).
    ///
    /// # Errors
    /// A wrong number of numbers, or one that is not finite, a quaternion of length zero.
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
                let lost = |ball: &&BallVariables| !x[ball.variable].is_finite();
                if let Some(ball) = map.balls().iter().find(lost) {
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
    let beyond = |frame: &&FrameId| frame.index() >= model.frames().len();
    match frames.iter().find(beyond) {
        None => Ok(()),
        Some(frame) => Err(KinematicsError::ForeignFrame {
            model: model.name().to_owned(),
            index: frame.index(),
            frames: model.frames().len(),
        }),
    }
}
