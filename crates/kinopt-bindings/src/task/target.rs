//! Targets of tasks: conversion, and assignment to residuals.

use std::marker::PhantomData;

use kinopt::SizeMismatch;
use kinopt::ik::Drag;
use kinopt::problem::{ProblemError, Targets, TaskId};
use kinopt::spatial::Matrix3;
#[cfg(feature = "bodies")]
use kinopt::task::{
    Bounded, CentreOfMass, FrameVelocity, JointCoupling, Manipulability, SupportPolygon,
};
use kinopt::task::{
    Distance, FramePose, Gaze, LimitCentring, LookAt, Numeric, NumericResidual, Orientation, Pixel,
    Plane, Point, Posture, Ray, Residual, Smoothness,
};

use crate::error::ErrorKind;
use crate::placement::PoseTarget;
use crate::value::{OrRaise, Value};

/// A target in Rust form.
pub trait Goal<V: Value>: Sized + Send + Sync + 'static {
    /// Converts a target; `what` names it in messages.
    ///
    /// # Errors
    /// If the value is no target of this type.
    fn read(value: &V, what: &str) -> Result<Self, V::Error>;
}

/// A residual with a target that can be moved.
pub trait Target: Residual {
    /// The target in Rust form.
    type Goal: Send + Sync + 'static;

    /// Sets the target.
    ///
    /// # Errors
    /// If the target has another number of elements.
    fn aim(&mut self, goal: &Self::Goal) -> Result<(), SizeMismatch>;

    /// Reason why the residual cannot have a target of this kind; `what` names the target.
    fn misfit(&self, _goal: &Self::Goal, _what: &str) -> Option<String> {
        None
    }
}

/// A custom residual with a target that can be moved.
pub trait NumericTarget: NumericResidual {
    /// The target in Rust form.
    type Goal: Send + Sync + 'static;

    /// Sets the target.
    fn aim(&mut self, goal: &Self::Goal);
}

impl<N: NumericTarget> Target for Numeric<N> {
    type Goal = N::Goal;

    fn aim(&mut self, goal: &Self::Goal) -> Result<(), SizeMismatch> {
        self.0.aim(goal);
        Ok(())
    }
}

/// Object whose targets move.
pub enum Aimed<'a> {
    /// Targets of a query.
    Targets(&'a mut Targets),
    /// A drag.
    Drag(&'a mut Drag),
}

impl Aimed<'_> {
    fn residual<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        match self {
            Self::Targets(targets) => targets.get_mut(task),
            Self::Drag(drag) => drag.target_mut(task),
        }
    }
}

/// A converted target, as the function that assigns it.
pub type Move<V> = Box<dyn Fn(&mut Aimed<'_>) -> Result<(), <V as Value>::Error> + Send + Sync>;

/// A task of a problem, with any residual.
pub trait AnyTask<V: Value>: Send + Sync {
    /// Converts a target of the task; `what` names it in messages. The target is validated when it is assigned, and an
    /// invalid one leaves the task unchanged.
    ///
    /// # Errors
    /// If the value is no target of the task.
    fn read(&self, value: &V, what: &str) -> Result<Move<V>, V::Error>;
}

impl<V: Value + 'static, R: Target> AnyTask<V> for TaskId<R>
where
    R::Goal: Goal<V>,
{
    fn read(&self, value: &V, what: &str) -> Result<Move<V>, V::Error> {
        let (id, what) = (*self, what.to_owned());
        let goal = R::Goal::read(value, &what)?;
        Ok(Box::new(move |aimed| {
            let residual = aimed.residual(id).or_raise::<V>()?;
            *residual = moved::<V, R>(residual, &goal, &what, ":")?;
            Ok(())
        }))
    }
}

/// The residual with another target, validated. `what` and `separator` precede a message.
///
/// # Errors
/// If the target is invalid.
pub fn moved<V: Value, R: Target>(
    residual: &R,
    goal: &R::Goal,
    what: &str,
    separator: &str,
) -> Result<R, V::Error> {
    if let Some(misfit) = residual.misfit(goal, what) {
        return Err(V::error(ErrorKind::InvalidValue, misfit));
    }
    let mut moved = residual.clone();
    let aimed = moved.aim(goal);
    aimed.map_err(|mismatch| V::wrong_length(what, &mismatch))?;
    match moved.description().defect() {
        Some(defect) => Err(V::error(
            ErrorKind::InvalidValue,
            format!("{what}{separator} {defect}"),
        )),
        None => Ok(moved),
    }
}

impl<V: Value> Goal<V> for f64 {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.number(what)
    }
}

impl<V: Value, const N: usize> Goal<V> for [f64; N] {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.array(what)
    }
}

impl<V: Value> Goal<V> for Vec<f64> {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.numbers(what)
    }
}

impl<V: Value> Goal<V> for [[f64; 3]; 2] {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.two_points(what)
    }
}

impl<V: Value> Goal<V> for PoseTarget {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.pose_target(what)
    }
}

impl<V: Value> Goal<V> for Matrix3<f64> {
    fn read(value: &V, what: &str) -> Result<Self, V::Error> {
        value.rotation(what)
    }
}

/// Target of a residual without one.
pub struct NoTarget<R>(PhantomData<fn(R)>);

impl<V: Value> Goal<V> for NoTarget<LimitCentring> {
    fn read(_value: &V, what: &str) -> Result<Self, V::Error> {
        Err(V::no_target(what, "limit centring"))
    }
}

impl Target for Point {
    type Goal = [f64; 3];

    fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for FramePose {
    type Goal = PoseTarget;

    fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(target.placement);
        Ok(())
    }

    fn misfit(&self, target: &Self::Goal, what: &str) -> Option<String> {
        target.within(&self.goal().unwrap_or_default(), what).err()
    }
}

impl Target for Orientation {
    type Goal = Matrix3<f64>;

    fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for LookAt {
    type Goal = [f64; 3];

    fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for Gaze {
    type Goal = [f64; 3];

    fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for Distance {
    type Goal = f64;

    fn aim(&mut self, distance: &f64) -> Result<(), SizeMismatch> {
        self.set_distance(*distance);
        Ok(())
    }
}

impl Target for Plane {
    type Goal = [[f64; 3]; 2];

    fn aim(&mut self, [point, normal]: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_plane(*point, *normal);
        Ok(())
    }
}

impl Target for Ray {
    type Goal = [[f64; 3]; 2];

    fn aim(&mut self, [eye, through]: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_line(*eye, *through);
        Ok(())
    }
}

impl Target for Pixel {
    type Goal = [f64; 2];

    fn aim(&mut self, pixel: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_target(*pixel);
        Ok(())
    }
}

impl Target for Posture {
    type Goal = Vec<f64>;

    fn aim(&mut self, reference: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_reference(reference)
    }
}

impl Target for Smoothness {
    type Goal = Vec<f64>;

    fn aim(&mut self, previous: &Self::Goal) -> Result<(), SizeMismatch> {
        self.set_previous(previous)
    }
}

impl Target for LimitCentring {
    type Goal = NoTarget<Self>;

    fn aim(&mut self, _target: &Self::Goal) -> Result<(), SizeMismatch> {
        Ok(())
    }
}

#[cfg(feature = "bodies")]
mod of_bodies {
    use super::{
        Bounded, CentreOfMass, FrameVelocity, Goal, JointCoupling, Manipulability, NoTarget,
        PoseTarget, SizeMismatch, SupportPolygon, Target, Value,
    };
    use kinopt::task::PoseBounds;

    impl Target for CentreOfMass {
        type Goal = [f64; 3];

        fn aim(&mut self, target: &Self::Goal) -> Result<(), SizeMismatch> {
            self.set_target(*target);
            Ok(())
        }
    }

    impl Target for FrameVelocity {
        type Goal = PoseTarget;

        fn aim(&mut self, previous: &Self::Goal) -> Result<(), SizeMismatch> {
            self.set_previous(previous.placement);
            Ok(())
        }

        fn misfit(&self, previous: &Self::Goal, what: &str) -> Option<String> {
            previous.within(&PoseBounds::pose(), what).err()
        }
    }

    impl Target for JointCoupling {
        type Goal = f64;

        fn aim(&mut self, offset: &f64) -> Result<(), SizeMismatch> {
            self.set_offset(*offset);
            Ok(())
        }
    }

    impl Target for Manipulability {
        type Goal = f64;

        fn aim(&mut self, least: &f64) -> Result<(), SizeMismatch> {
            self.set_least(*least);
            Ok(())
        }
    }

    impl<V: Value> Goal<V> for NoTarget<SupportPolygon> {
        fn read(_value: &V, what: &str) -> Result<Self, V::Error> {
            Err(V::no_target(what, "a support polygon"))
        }
    }

    impl Target for SupportPolygon {
        type Goal = NoTarget<Self>;

        fn aim(&mut self, _target: &Self::Goal) -> Result<(), SizeMismatch> {
            Ok(())
        }
    }

    impl<R: Target> Target for Bounded<R> {
        type Goal = R::Goal;

        fn aim(&mut self, goal: &R::Goal) -> Result<(), SizeMismatch> {
            self.residual_mut().aim(goal)
        }

        fn misfit(&self, goal: &Self::Goal, what: &str) -> Option<String> {
            self.residual().misfit(goal, what)
        }
    }
}
