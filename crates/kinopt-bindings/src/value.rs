//! Values and named arguments of another language.

use std::time::Duration;

use kinopt::model::{FrameId, JointId};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{Camera, PoseBounds};
use kinopt::{Model, SizeMismatch};

use crate::error::{Classify, ErrorKind};
use crate::placement::PoseTarget;
use crate::quantities::QuantityValues;

/// Lower and upper bounds by name.
pub type Ranges = Vec<(String, (f64, f64))>;

/// A value of another language.
///
/// Conversions return the error of the language, in its notation. `what` names the value in messages.
pub trait Value: Sized {
    /// Error of the language.
    type Error;

    /// An error of a kind.
    fn error(kind: ErrorKind, message: String) -> Self::Error;

    /// Name of an option in the language's notation, as in `joint_weights` or `jointWeights`.
    fn label(name: &str) -> String;

    /// Error for a number of elements.
    fn wrong_length(what: &str, mismatch: &SizeMismatch) -> Self::Error;

    /// Error for a target of a task without one.
    fn no_target(what: &str, task: &str) -> Self::Error;

    /// True for the value of a missing argument, such as null.
    fn is_missing(&self) -> bool;

    /// The string, if the value is one.
    fn as_text(&self) -> Option<String>;

    /// The number, if the value is one.
    fn as_number(&self) -> Option<f64>;

    /// True for values by name, such as a dict or an object.
    fn is_map(&self) -> bool;

    /// Reads a number.
    ///
    /// # Errors
    /// If the value is no number.
    fn number(&self, what: &str) -> Result<f64, Self::Error>;

    /// Reads a whole number from 0 to `max`.
    ///
    /// # Errors
    /// If the value is no whole number within the range.
    fn whole(&self, what: &str, max: u64) -> Result<u64, Self::Error>;

    /// Reads a boolean.
    ///
    /// # Errors
    /// If the value is no boolean.
    fn switch(&self, what: &str) -> Result<bool, Self::Error>;

    /// Reads a time limit in seconds.
    ///
    /// # Errors
    /// If the value is no finite number of at least 0.
    fn time_limit(&self, what: &str) -> Result<Duration, Self::Error>;

    /// Reads the name of an object or of an enum variant.
    ///
    /// # Errors
    /// If the value is no string.
    fn name(&self, what: &str) -> Result<String, Self::Error>;

    /// Reads a name of a value, such as a search; any other value is converted to text.
    ///
    /// # Errors
    /// If the value has no text.
    fn word(&self, what: &str) -> Result<String, Self::Error> {
        self.name(what)
    }

    /// Reads a list of names.
    ///
    /// # Errors
    /// If the value is no list of strings.
    fn names(&self, what: &str) -> Result<Vec<String>, Self::Error>;

    /// Reads a list of numbers.
    ///
    /// # Errors
    /// If the value is no list of numbers.
    fn numbers(&self, what: &str) -> Result<Vec<f64>, Self::Error>;

    /// Reads a list of `length` numbers.
    ///
    /// # Errors
    /// If the value is no list of numbers, or has another length.
    fn vector(&self, what: &str, length: usize) -> Result<Vec<f64>, Self::Error>;

    /// Reads `N` numbers.
    ///
    /// # Errors
    /// As [`vector`](Self::vector).
    fn array<const N: usize>(&self, what: &str) -> Result<[f64; N], Self::Error> {
        let mut array = [0.0; N];
        array.copy_from_slice(&self.vector(what, N)?);
        Ok(array)
    }

    /// Reads two positions: a table of shape (2, 3), or six numbers.
    ///
    /// # Errors
    /// If the value is not two positions.
    fn two_points(&self, what: &str) -> Result<[[f64; 3]; 2], Self::Error>;

    /// Reads a list of positions.
    ///
    /// # Errors
    /// If the value is no list of positions.
    fn points(&self, what: &str) -> Result<Vec<Vector3<f64>>, Self::Error>;

    /// Reads a placement.
    ///
    /// # Errors
    /// If the value is no placement.
    fn placement(&self, what: &str) -> Result<Placement<f64>, Self::Error>;

    /// Reads a placement, or a position without orientation.
    ///
    /// # Errors
    /// If the value is neither.
    fn pose_target(&self, what: &str) -> Result<PoseTarget, Self::Error> {
        let placement = self.placement(what)?;
        Ok(PoseTarget {
            placement,
            has_orientation: true,
        })
    }

    /// Reads a rotation, or that of a placement.
    ///
    /// # Errors
    /// If the value is no rotation.
    fn rotation(&self, what: &str) -> Result<Matrix3<f64>, Self::Error>;

    /// Reads goal bounds.
    ///
    /// # Errors
    /// If the value is no goal bounds.
    fn pose_bounds(&self, what: &str) -> Result<PoseBounds, Self::Error>;

    /// Reads a camera.
    ///
    /// # Errors
    /// If the value is no camera.
    fn camera(&self, what: &str) -> Result<Camera, Self::Error>;

    /// Reads a mass in kilograms, with an optional position in metres in its frame.
    ///
    /// # Errors
    /// If the value is no mass.
    fn mass(&self, what: &str) -> Result<(f64, [f64; 3]), Self::Error>;

    /// Reads values by name.
    ///
    /// # Errors
    /// If the value has no names.
    fn entries(&self, what: &str) -> Result<Vec<(String, Self)>, Self::Error>;

    /// Reads numbers by name; `_keys` describes a name in messages.
    ///
    /// # Errors
    /// If the value has no names, or one of its values is no number.
    fn numbers_by_name(&self, what: &str, _keys: &str) -> Result<Vec<(String, f64)>, Self::Error> {
        let entries = self.entries(what)?.into_iter();
        entries
            .map(|(key, value)| {
                let number = value.number(&format!("{what}.{key}"))?;
                Ok((key, number))
            })
            .collect()
    }

    /// Reads lower and upper bounds by name.
    ///
    /// # Errors
    /// If the value has no names, or one of its values is not two numbers.
    fn ranges(&self, what: &str) -> Result<Ranges, Self::Error> {
        let entries = self.entries(what)?.into_iter();
        entries
            .map(|(name, range)| {
                let [lower, upper] = range.array(&format!("{what}.{name}"))?;
                Ok((name, (lower, upper)))
            })
            .collect()
    }

    /// Reads a number for all quantities, or numbers by quantity.
    ///
    /// # Errors
    /// If the value has other content.
    fn quantity_values(&self, what: &str) -> Result<QuantityValues, Self::Error>;
}

/// Named arguments of another language: options, or the fields of a task.
pub trait Arguments {
    /// Values of the arguments.
    type Value: Value;

    /// The argument, or `None` if it is missing. Names are in snake case.
    ///
    /// # Errors
    /// If the language cannot read the argument.
    fn get(&self, name: &str) -> Result<Option<Self::Value>, ErrorOf<Self>>;

    /// The argument.
    ///
    /// # Errors
    /// If the argument is missing.
    fn required(&self, name: &str) -> Result<Self::Value, ErrorOf<Self>>;

    /// The frame that an argument names.
    ///
    /// # Errors
    /// If the argument is missing, or names no frame of the model.
    fn frame(&self, model: &Model, name: &str) -> Result<FrameId, ErrorOf<Self>> {
        frame_of(&self.required(name)?, model, name)
    }

    /// The frame that an argument names, if it is given.
    ///
    /// # Errors
    /// If the argument names no frame of the model.
    fn optional_frame(&self, model: &Model, name: &str) -> Result<Option<FrameId>, ErrorOf<Self>> {
        let value = self.get(name)?;
        value.map(|value| frame_of(&value, model, name)).transpose()
    }

    /// The number of an argument.
    ///
    /// # Errors
    /// If the argument is missing, or no number.
    fn number(&self, name: &str) -> Result<f64, ErrorOf<Self>> {
        self.required(name)?.number(&label(self, name))
    }

    /// The number of an argument, or a default.
    ///
    /// # Errors
    /// If the argument is no number.
    fn number_or(&self, name: &str, default: f64) -> Result<f64, ErrorOf<Self>> {
        let value = self.get(name)?;
        value.map_or(Ok(default), |value| value.number(&label(self, name)))
    }

    /// The `N` numbers of an argument.
    ///
    /// # Errors
    /// If the argument is missing, or has other content.
    fn array<const N: usize>(&self, name: &str) -> Result<[f64; N], ErrorOf<Self>> {
        self.required(name)?.array(&label(self, name))
    }

    /// The `N` numbers of an argument, if it is given.
    ///
    /// # Errors
    /// If the argument has other content.
    fn optional_array<const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[f64; N]>, ErrorOf<Self>> {
        let value = self.get(name)?;
        value
            .map(|value| value.array(&label(self, name)))
            .transpose()
    }

    /// The placement of an argument.
    ///
    /// # Errors
    /// If the argument is missing, or no placement.
    fn placement(&self, name: &str) -> Result<Placement<f64>, ErrorOf<Self>> {
        self.required(name)?.placement(&label(self, name))
    }

    /// The entries of an argument by name; none if it is missing.
    ///
    /// # Errors
    /// If the argument has no names.
    fn entries(&self, name: &str) -> Result<Vec<(String, Self::Value)>, ErrorOf<Self>> {
        let value = self.get(name)?;
        value.map_or(Ok(Vec::new()), |value| value.entries(&label(self, name)))
    }
}

/// Error of the language of arguments.
pub type ErrorOf<A> = <<A as Arguments>::Value as Value>::Error;

/// Name of an argument in messages.
fn label<A: Arguments + ?Sized>(_arguments: &A, name: &str) -> String {
    A::Value::label(name)
}

fn frame_of<V: Value>(value: &V, model: &Model, name: &str) -> Result<FrameId, V::Error> {
    let frame = value.name(&V::label(name))?;
    model.frame(&frame).or_raise::<V>()
}

/// Returns the joint of a name.
pub(crate) fn joint_of<V: Value>(model: &Model, name: &str) -> Result<JointId, V::Error> {
    model.joint(name).or_raise::<V>()
}

/// Conversion of the library's results to those of another language.
pub trait OrRaise<T> {
    /// Returns the value, or an error of the language with the library's message.
    ///
    /// # Errors
    /// If the result is an error.
    fn or_raise<V: Value>(self) -> Result<T, V::Error>;
}

impl<T, E: Classify> OrRaise<T> for Result<T, E> {
    fn or_raise<V: Value>(self) -> Result<T, V::Error> {
        self.map_err(|error| V::error(error.kind(), error.to_string()))
    }
}
