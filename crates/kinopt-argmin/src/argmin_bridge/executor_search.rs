//! Search under an executor: not started, running, or read from a checkpoint.

use argmin::core::ArgminError;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use kinopt_solver::solver::{LeastSquares, Method, Progress, Snapshot, SolverState};

/// Search with the method's state `S`.
#[derive(Clone, Debug, Default)]
pub(super) enum ExecutorSearch<S> {
    #[default]
    Waiting,
    Running(Box<Running<S>>),
    Suspended(Box<Suspended<S>>),
}

/// A running search.
#[derive(Clone, Debug)]
pub(super) struct Running<S> {
    pub(super) progress: Progress,
    pub(super) state: SolverState,
    pub(super) method_state: S,
}

/// A search as stored in a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Suspended<S> {
    snapshot: Snapshot,
    own: S,
}

impl<S: Clone> ExecutorSearch<S> {
    /// Running search; a suspended one is restored first.
    pub(super) fn running<M: Method<State = S>>(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &M,
    ) -> Result<&mut Running<S>, ArgminError> {
        if let Self::Suspended(suspended) = self {
            let mut state = SolverState::default();
            if !state.restore(problem, (method, &suspended.own), &suspended.snapshot) {
                return Err(ArgminError::InvalidParameter {
                    text: "the checkpoint is of another problem".to_owned(),
                });
            }
            *self = Self::Running(Box::new(Running {
                progress: Progress::resumed(problem, &state),
                state,
                method_state: suspended.own.clone(),
            }));
        }
        match self {
            Self::Running(running) => Ok(running),
            _ => Err(ArgminError::NotInitialized {
                text: "the search was not initialised".to_owned(),
            }),
        }
    }
}

impl<S: Serialize + Clone> Serialize for ExecutorSearch<S> {
    fn serialize<T: Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        let suspended = match self {
            Self::Waiting => None,
            Self::Running(running) => Some(Suspended {
                snapshot: running.state.snapshot(),
                own: running.method_state.clone(),
            }),
            Self::Suspended(suspended) => Some(suspended.as_ref().clone()),
        };
        suspended.serialize(serializer)
    }
}

impl<'de, S: Deserialize<'de>> Deserialize<'de> for ExecutorSearch<S> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let suspended = Option::<Suspended<S>>::deserialize(deserializer)?;
        Ok(suspended.map_or(Self::Waiting, |suspended| {
            Self::Suspended(Box::new(suspended))
        }))
    }
}
