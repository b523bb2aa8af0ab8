//! A search under an executor: not begun, on its way, or read from a checkpoint.

use argmin::core::ArgminError;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::solver::{LeastSquares, Memory, Method, Search, Snapshot};

#[derive(Clone, Debug, Default)]
pub(super) enum Course {
    #[default]
    Waiting,
    Running {
        search: Search,
        memory: Box<Memory>,
    },
    Suspended(Box<Suspended>),
}

/// A search as a checkpoint keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Suspended {
    iterations: usize,
    projected_gradient: Option<f64>,
    snapshot: Snapshot,
}

impl Course {
    /// The search, brought back to where it stood if it was suspended.
    pub(super) fn running(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &dyn Method,
    ) -> Result<(&mut Search, &mut Memory), ArgminError> {
        if let Self::Suspended(suspended) = self {
            let mut memory = Box::<Memory>::default();
            if !memory.restore(problem, method, &suspended.snapshot) {
                return Err(ArgminError::InvalidParameter {
                    text: "the checkpoint is of another problem".to_owned(),
                });
            }
            let search = Search::resumed(suspended.iterations, suspended.projected_gradient);
            *self = Self::Running { search, memory };
        }
        match self {
            Self::Running { search, memory } => Ok((search, memory)),
            _ => Err(ArgminError::NotInitialized {
                text: "the search was not initialised".to_owned(),
            }),
        }
    }
}

impl Serialize for Course {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let suspended = match self {
            Self::Waiting => None,
            Self::Running { search, memory } => Some(Suspended {
                iterations: search.iterations,
                projected_gradient: search.projected_gradient,
                snapshot: memory.snapshot(),
            }),
            Self::Suspended(suspended) => Some(suspended.as_ref().clone()),
        };
        suspended.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Course {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let suspended = Option::<Suspended>::deserialize(deserializer)?;
        Ok(suspended.map_or(Self::Waiting, |suspended| {
            Self::Suspended(Box::new(suspended))
        }))
    }
}
