//! Masses of a model's frames, for its centre of mass.

use super::{FrameId, JointId, Model};
use crate::model::ModelError;
use crate::spatial::{Placement, Vector3};

/// A point mass on a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PointMass {
    /// The frame that carries the mass.
    pub frame: FrameId,
    /// Position in the frame's coordinates, metres.
    pub at: Vector3<f64>,
    /// Mass in kilograms; not negative.
    pub mass: f64,
}

/// The masses that a model's joints move, combined into one for each joint that carries any.
///
/// Masses fixed in the world are ignored, as in Pinocchio.
#[derive(Clone, Debug, PartialEq)]
pub struct Masses {
    points: Vec<PointMass>,
    total: f64,
}

impl Masses {
    /// Combines point masses on frames of `model`; ignores masses of 0.
    ///
    /// ```
    /// # use kinopt::kinematics::centre_of_mass;
    /// # use kinopt::model::{Limits, Masses, Model, PointMass};
    /// # use kinopt::spatial::{Placement, Vector3};
    /// # let mut builder = Model::builder("pendulum");
    /// # let x = Vector3::UNITS[0];
    /// # let hinge = builder.revolute("hinge", None, Placement::identity(), x, Limits::UNBOUNDED);
    /// # let bob = builder.frame("bob", Some(hinge), Placement::translation([0.0, 0.0, -1.0].into()));
    /// # let model = builder.build()?;
    /// let bob = PointMass { frame: bob, at: Vector3::zero(), mass: 2.0 };
    /// let masses = Masses::new(&model, [bob])?;
    /// let centre = centre_of_mass(&model, &masses, &[std::f64::consts::FRAC_PI_2])?;
    /// assert!(centre.x == 0.0 && (centre.y - 1.0).abs() < 1e-15 && centre.z.abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for:
    /// - a mass that is negative or not finite;
    /// - a position that is not finite;
    /// - a frame that is not in the model;
    /// - a total mass that is zero or not finite.
    pub fn new(
        model: &Model,
        masses: impl IntoIterator<Item = PointMass>,
    ) -> Result<Self, ModelError> {
        let mut combined: Vec<(JointId, PointMass)> = Vec::new();
        for point in masses {
            let Some(frame) = model.frames().get(point.frame.index()) else {
                return Err(ModelError::ForeignMass {
                    model: model.name().to_owned(),
                    index: point.frame.index(),
                    frames: model.frames().len(),
                });
            };
            if !(point.mass >= 0.0 && point.mass.is_finite()) {
                return Err(ModelError::BadMass {
                    frame: frame.name.clone(),
                    mass: point.mass,
                });
            }
            if let Some(coordinate) = point.at.to_array().into_iter().find(|at| !at.is_finite()) {
                return Err(ModelError::BadMassPosition {
                    frame: frame.name.clone(),
                    coordinate,
                });
            }
            let Some(carrier) = moving_joint(model, point.frame).filter(|_| point.mass > 0.0)
            else {
                continue;
            };
            match combined.iter_mut().find(|(joint, _)| *joint == carrier) {
                Some((_, other)) => other.join(model, &point),
                None => combined.push((carrier, point)),
            }
        }
        let points: Vec<PointMass> = combined.into_iter().map(|(_, point)| point).collect();
        let total: f64 = points.iter().map(|point| point.mass).sum();
        if points.is_empty() || !total.is_finite() {
            let model = model.name().to_owned();
            return Err(ModelError::NoMass { model });
        }
        Ok(Self { points, total })
    }

    /// The point masses, one for each moving joint that carries any.
    #[must_use]
    pub fn points(&self) -> &[PointMass] {
        &self.points
    }

    /// Total mass in kilograms, above 0.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The frames that carry the point masses.
    #[must_use]
    #[doc(hidden)]
    pub fn frames(&self) -> Vec<FrameId> {
        self.points.iter().map(|point| point.frame).collect()
    }

    /// For each point mass, its fraction of the total and its position in its frame, metres.
    #[doc(hidden)]
    pub fn shares(&self) -> impl Iterator<Item = (f64, Vector3<f64>)> + '_ {
        let points = self.points.iter();
        points.map(|point| (point.mass / self.total, point.at))
    }
}

impl PointMass {
    /// Adds a mass that is fixed relative to this one; the result is at the common centre.
    fn join(&mut self, model: &Model, other: &Self) {
        let frame_from_other = carrier_from_frame(model, self.frame).inverse()
            * carrier_from_frame(model, other.frame);
        let mass = self.mass + other.mass;
        let position = frame_from_other.apply(other.at);
        self.at = self.at + (position - self.at) * (other.mass / mass);
        self.mass = mass;
    }
}

/// The nearest moving joint above a frame; `None` for a frame fixed in the world.
#[doc(hidden)]
pub fn moving_joint(model: &Model, frame: FrameId) -> Option<JointId> {
    let mut ancestors = model.joints_above(frame);
    ancestors.find(|joint| model.joints()[joint.index()].kind.moves())
}

/// Placement of a frame in the joint that moves it, or in the world.
fn carrier_from_frame(model: &Model, frame: FrameId) -> Placement<f64> {
    let mut placement = model.frames()[frame.index()].joint_from_frame;
    for joint in model.joints_above(frame) {
        let joint = &model.joints()[joint.index()];
        if joint.kind.moves() {
            break;
        }
        placement = joint.parent_from_joint * placement;
    }
    placement
}
